/* The static plot of frame rate against trees. */
#include "report/plot.h"

#include <math.h>

/* How many series of the same method come before this one: tells them apart by dashes. */
static int plot_variant(const struct book *book, size_t series)
{
    size_t *method_of = ARENA_ARRAY(book->arena, size_t, book->series_count);
    for (size_t i = 0; i < book->rows_count; i++)
        method_of[book->rows[i].series] = book->rows[i].method_index;
    int before = 0;
    for (size_t s = 0; s < series; s++)
        before += method_of[s] == method_of[series];
    return before;
}

/* The method's symbol filled, then open, then crosses, which tell more variants apart than dashes
 * between points that are near each other. */
static int variant_symbol(const struct book *book, size_t method, int variant)
{
    static const int crosses[] = {2, 3, 1};
    int place = variant % 5;
    return place < 2 ? symbol_gnuplot(book, method, place == 0) : crosses[place - 2];
}

void plot_row_line(struct plot *plot, const struct row *row, int block)
{
    const struct book *book = plot->book;
    int variant = plot_variant(book, row->series);
    plot_curve(plot);
    fprintf(
        plot->gp,
        "\"%s.dat\" index %d with linespoints pointtype %d pointsize 0.8 linewidth 1.2 dashtype "
        "%d linecolor rgb \"#%06x\" title ",
        plot->name, block, variant_symbol(book, row->method_index, variant), 1 + variant % 5,
        tint_rgb(tint_method(book, row->method_index)));
    plot_text(plot->gp, row->label);
    plot->key_rows++;
}

/* One series of a family: frame rate by trees, with its law. */
static void growth_series(struct plot *plot, const struct law *law, int variant)
{
    const struct book *book = plot->book;
    const struct law_point *points = law->points;
    size_t series = points->series, method = book->rows[points->row].method_index;
    int block = plot_block(plot, book->series[series]);
    for (size_t i = 0; i < law->points_count; i++) {
        const struct row *row = &book->rows[points[i].row];
        fprintf(plot->dat, "%zu %.9g %.9g %.9g\n", row->trees, row->values[COLUMN_fps],
                1 / row->values[COLUMN_frame_seconds_high],
                1 / row->values[COLUMN_frame_seconds_low]);
    }
    unsigned color = tint_rgb(tint_method(book, method));
    plot_curve(plot);
    fprintf(plot->gp,
            "\"%s.dat\" index %d with yerrorbars pointtype %d pointsize 0.9 linewidth 1 "
            "linecolor rgb \"#%06x\" notitle",
            plot->name, block, variant_symbol(book, method, variant), color);
    if (law->is_fitted) {
        block = plot_block(plot, "its power law");
        for (int end = 0; end < 2; end++) {
            double at = (double)book->rows[points[end ? law->points_count - 1 : 0].row].trees;
            fprintf(plot->dat, "%.9g %.9g\n", at, 1 / (law->time.a * pow(at, law->time.b.value)));
        }
    }
    plot_curve(plot);
    fprintf(plot->gp,
            "\"%s.dat\" index %d using 1:2 with lines linewidth 1.3 dashtype %d linecolor rgb "
            "\"#%06x\" notitle, \\\n    keyentry with linespoints pointtype %d pointsize 0.9 "
            "linewidth 1.3 dashtype %d linecolor rgb \"#%06x\" title ",
            plot->name, block, 1 + variant % 5, color, variant_symbol(book, method, variant),
            1 + variant % 5, color);
    const char *title = book->series[series];
    if (law->is_fitted)
        title = arena_printf(book->arena, "%s: N^(%.2f)", title, -law->time.b.value);
    plot_text(plot->gp, title);
    plot->key_rows++;
}

enum status plot_growth(const struct book *book, size_t family, const char *folder,
                        struct figure *figure, struct error *error)
{
    struct axis x = axis_empty(), y = axis_empty();
    const char *slug = NULL;
    for (size_t i = 0; i < book->rows_count; i++) {
        const struct row *row = &book->rows[i];
        if (book->groups[row->group].family != family)
            continue;
        slug = slug ? slug : book->groups[row->group].slug;
        if (row->trees > 0 && row->values[COLUMN_frame_seconds] > 0) {
            axis_add(&x, (double)row->trees);
            axis_add(&y, 1 / row->values[COLUMN_frame_seconds_low]);
            axis_add(&y, 1 / row->values[COLUMN_frame_seconds_high]);
        }
    }
    size_t lines = 0;
    for (size_t i = 0; i < book->laws_count; i++)
        lines += book->laws[i].points->family == family;
    if (!(x.low < x.high && y.low <= y.high) || lines > PLOT_LINES_MAX)
        return STATUS_OK;
    axis_widen(&x, 0.05, 0.05);
    axis_widen(&y, 0.08, 0.08);
    struct plot plot;
    figure->kind = FIGURE_GROWTH;
    plot_open(&plot, book, folder, arena_printf(book->arena, "growth-%s", slug),
              book->families[family]);
    plot_axes(&plot, &x, &y, "trees", "frames a second");
    fputs("set key maxcols 1\n", plot.gp);
    for (size_t i = 0; i < book->laws_count; i++)
        if (book->laws[i].points->family == family)
            growth_series(&plot, &book->laws[i], plot_variant(book, book->laws[i].points->series));
    return plot_close(&plot, figure, error);
}
