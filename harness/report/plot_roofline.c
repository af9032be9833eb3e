/* The static plot of triangles a second against their size, under the roof of the calibration:
 * Williams et al. 2009, doi:10.1145/1498765.1498785, with fragments in the place of operations. */
#include "report/plot.h"
#include "results/limit.h"

#include <math.h>

/* Rows of the group that this calibration fits and whose triangles were counted; the backdrop's few
 * large ones would stretch the plot. */
static bool is_drawn(const struct book *book, const struct row *row,
                     const struct calibration *calibration)
{
    return row->ok && !row->is_floor && row->summary->limit.fragments_per_triangle > 0 &&
           row->values[COLUMN_frame_seconds] > 0 &&
           limit_calibration(book->run, row->seen) == calibration;
}

static double million_a_second(const struct row *row, enum column_index seconds)
{
    return 1e-6 * row->values[COLUMN_primitives] / row->values[seconds];
}

/* The roof, lowered to what fill at this rate leaves; nothing where that is nowhere lower. */
static void roof_line(struct plot *plot, const struct axis *x,
                      const struct calibration *calibration, double fill_rate, const char *title,
                      int dash)
{
    enum { STEPS = 96 };
    int block = -1;
    for (int i = 0; i <= STEPS; i++) {
        double at = x->low * pow(x->high / x->low, (double)i / STEPS);
        double roof = limit_triangle_rate(calibration, at).high, fill = fill_rate / at;
        if (roof < fill && isfinite(fill_rate))
            continue;
        if (block < 0)
            block = plot_block(plot, title);
        fprintf(plot->dat, "%.9g %.9g\n", at, 1e-6 * fmin(roof, fill));
    }
    if (block < 0)
        return;
    plot_curve(plot);
    fprintf(plot->gp,
            "\"%s.dat\" index %d with lines linewidth %g dashtype %d linecolor rgb \"#%06x\" title "
            "\"%s\"",
            plot->name, block, dash == 1 ? 1.6 : 1.0, dash,
            tint_rgb(dash == 1 ? TINT_INK : TINT_MUTED), title);
    plot->key_rows++;
}

/* The points of a method. */
static void method_points(struct plot *plot, const struct group *group, size_t method,
                          const struct calibration *calibration)
{
    const struct book *book = plot->book;
    int block = -1;
    for (size_t i = 0; i < group->rows_count; i++) {
        const struct row *row = &book->rows[group->rows[i]];
        if (row->method_index != method || !is_drawn(book, row, calibration))
            continue;
        if (block < 0)
            block = plot_block(plot, "fragments a triangle, million triangles a second, low, high");
        fprintf(plot->dat, "%.9g %.9g %.9g %.9g # %s\n", row->summary->limit.fragments_per_triangle,
                million_a_second(row, COLUMN_frame_seconds),
                million_a_second(row, COLUMN_frame_seconds_high),
                million_a_second(row, COLUMN_frame_seconds_low), row->label);
    }
    if (block < 0)
        return;
    plot_curve(plot);
    fprintf(plot->gp,
            "\"%s.dat\" index %d with yerrorbars pointtype %d pointsize 0.9 linewidth 1 linecolor "
            "rgb \"#%06x\" title ",
            plot->name, block, symbol_gnuplot(book, method, true),
            tint_rgb(tint_method(book, method)));
    plot_text(plot->gp, book->methods[method]);
    plot->key_rows++;
}

enum status plot_roofline(const struct book *book, const struct group *group, const char *folder,
                          struct figure *figure, struct error *error)
{
    const struct calibration *calibration = NULL;
    for (size_t i = 0; i < group->rows_count && !calibration; i++)
        calibration = limit_calibration(book->run, book->rows[group->rows[i]].seen);
    struct axis x = axis_empty(), y = axis_empty();
    for (size_t i = 0; i < group->rows_count && calibration; i++) {
        const struct row *row = &book->rows[group->rows[i]];
        if (!is_drawn(book, row, calibration))
            continue;
        double size = row->summary->limit.fragments_per_triangle;
        axis_add(&x, size);
        axis_add(&y, million_a_second(row, COLUMN_frame_seconds_low));
        axis_add(&y, million_a_second(row, COLUMN_frame_seconds_high));
        axis_add(&y, 1e-6 * limit_triangle_rate(calibration, size).high);
    }
    if (!calibration || !(y.low < y.high))
        return STATUS_OK;
    axis_widen(&x, 0.1, 0.1);
    axis_widen(&y, 0.08, 0.08);
    struct plot plot;
    figure->kind = FIGURE_ROOFLINE;
    plot_open(&plot, book, folder, arena_printf(book->arena, "roofline-%s", group->slug),
              group->title);
    plot_axes(&plot, &x, &y, "fragments a triangle, beyond one a pixel",
              "million triangles a second");
    const struct calibration_measure *fill = calibration->measures;
    roof_line(&plot, &x, calibration, INFINITY, "limit, one colour", 1);
    roof_line(&plot, &x, calibration, fill[CALIBRATION_fill_blended].rate.high, "the same, blended",
              2);
    roof_line(&plot, &x, calibration, fill[CALIBRATION_fill_textured].rate.high,
              "blended and textured", 3);
    for (size_t m = 0; m < book->methods_count; m++)
        method_points(&plot, group, m, calibration);
    plot.columns = 3;
    plot.key_rows = (plot.key_rows + 2) / 3;
    return plot_close(&plot, figure, error);
}
