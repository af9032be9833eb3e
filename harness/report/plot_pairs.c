/* The static plot of pairs: total error and frame time without and with the sun's shadows. */
#include "report/pairs.h"
#include "report/plot.h"

#include <math.h>

struct pairs_plot {
    struct plot plot;
    const struct shadow_pair *pairs;
    size_t count;
};

static const struct row *row_of(const struct pairs_plot *pairs, size_t pair, bool with)
{
    const struct shadow_pair *ends = &pairs->pairs[pair];
    return &pairs->plot.book->rows[with ? ends->with : ends->without];
}

static double ms_of(const struct row *row)
{
    return 1e3 * row->values[COLUMN_frame_seconds];
}

static bool is_drawn(const struct row *row)
{
    return ms_of(row) > 0 && row->values[COLUMN_full_flip] > 0;
}

/* One of several rows with shadows that one without stands for. */
static bool is_one_of_several(const struct pairs_plot *pairs, size_t pair)
{
    for (size_t i = 0; i < pairs->count; i++)
        if (i != pair && pairs->pairs[i].without == pairs->pairs[pair].without)
            return true;
    return false;
}

/* Settings that tell such rows apart, where there is room; first of all no label hides a point. */
static void put_notes(struct pairs_plot *pairs)
{
    for (int pass = 0; pass < 3; pass++)
        for (size_t i = 0; i < pairs->count; i++) {
            const struct row *row = row_of(pairs, i, pass != 0);
            if (!is_drawn(row))
                continue;
            if (pass < 2)
                plot_keep_clear(&pairs->plot, ms_of(row), row->values[COLUMN_full_flip]);
            else if (*row->variant && is_one_of_several(pairs, i))
                plot_note(&pairs->plot, ms_of(row), row->values[COLUMN_full_flip], row->variant);
        }
}

/* A method's block of data: a line for each pair, or one end of each. Returns its index; -1: the
 * method has no pair. */
static int put_block(struct pairs_plot *pairs, size_t method, bool without, bool with)
{
    static const char *const what[2][2] = {{"", "ms error, with"},
                                           {"ms error, without", "ms error, from without to with"}};
    int block = -1;
    for (size_t i = 0; i < pairs->count; i++) {
        if (row_of(pairs, i, false)->method_index != method || !is_drawn(row_of(pairs, i, false)) ||
            !is_drawn(row_of(pairs, i, true)))
            continue;
        if (block < 0)
            block = plot_block(&pairs->plot, what[without][with]);
        else if (without && with)
            fputc('\n', pairs->plot.dat);
        for (int end = !without; end <= (int)with; end++) {
            const struct row *row = row_of(pairs, i, end);
            fprintf(pairs->plot.dat, "%.9g %.9g # %s\n", ms_of(row), row->values[COLUMN_full_flip],
                    row->label);
        }
    }
    return block;
}

static void put_method(struct pairs_plot *pairs, size_t method)
{
    struct plot *plot = &pairs->plot;
    const struct book *book = plot->book;
    int lines = put_block(pairs, method, true, true);
    if (lines < 0)
        return;
    int ends[2] = {put_block(pairs, method, true, false), put_block(pairs, method, false, true)};
    plot_curve(plot);
    fprintf(plot->gp,
            "\"%s.dat\" index %d with lines linewidth 1.2 dashtype 2 linecolor rgb \"#%06x\" "
            "notitle",
            plot->name, lines, tint_rgb(tint_method(book, method)));
    for (int end = 0; end < 2; end++)
        plot_points(plot, ends[end], "with points", method, end,
                    end ? book->methods[method] : NULL);
}

enum status plot_pairs(const struct book *book, const struct group *group, const char *folder,
                       struct figure *figure, struct error *error)
{
    struct pairs_plot pairs = {.pairs = NULL};
    struct plot *plot = &pairs.plot;
    struct axis x = axis_empty(), y = axis_empty();
    pairs.pairs = shadow_pairs(book, group, &pairs.count);
    plot->book = book;
    for (size_t i = 0; i < pairs.count; i++)
        for (int with = 0; with < 2; with++) {
            axis_add(&x, ms_of(row_of(&pairs, i, with)));
            axis_add(&y, row_of(&pairs, i, with)->values[COLUMN_full_flip]);
        }
    if (!(x.low <= x.high && y.low <= y.high))
        return STATUS_OK;
    axis_widen(&x, 0.1, 0.12);
    axis_widen(&y, 0.1, 0.08);
    figure->kind = FIGURE_PAIRS;
    plot_open(plot, book, folder, arena_printf(book->arena, "pairs-%s", group->slug), group->title);
    plot_axes(plot, &x, &y, "time a frame [ms]", "FLIP, reference with all effects");
    put_notes(&pairs); /* settings stand before the first curve */
    for (size_t m = 0; m < book->methods_count; m++)
        put_method(&pairs, m);
    plot->columns = 2;
    plot->key_rows = (plot->key_rows + 1) / 2;
    return plot_close(plot, figure, error);
}
