/* The static plot of a paper: ratios of ours against the printed ones. */
#include "report/paper.h"
#include "report/plot.h"

#include <math.h>

static bool is_drawn(const struct paper_line *line)
{
    return line->ratio.value > 0 && line->ratio.low > 0;
}

static size_t survey(const struct paper_beside *beside, struct axis *both)
{
    size_t count = 0;
    for (size_t b = 0; b < beside->blocks_count; b++)
        for (size_t i = 0; i < beside->blocks[b].lines_count; i++) {
            const struct paper_line *line = &beside->blocks[b].lines[i];
            if (!is_drawn(line))
                continue;
            axis_add(both, line->printed_ratio);
            axis_add(both, line->ratio.low);
            axis_add(both, line->ratio.high);
            count += line->printed != &beside->blocks[b].table->rows[beside->blocks[b].table->base];
        }
    return count;
}

/* The first variant of a method is filled; each is named once, whatever tables it is in. */
static void put_block(struct plot *plot, const struct paper_beside *beside, size_t index)
{
    const struct book *book = plot->book;
    const struct paper_block *block = &beside->blocks[index];
    bool is_first;
    size_t variant = paper_variant_number(book->arena, beside, index, &is_first);
    int data = plot_block(plot, "printed ratio, ours, low, high");
    size_t count = 0;
    for (size_t i = 0; i < block->lines_count; i++) {
        const struct paper_line *line = &block->lines[i];
        if (!is_drawn(line))
            continue;
        const struct paper_side *cell = &line->printed->cell;
        fprintf(plot->dat, "%.9g %.9g %.9g %.9g # %zu trees, %s, %s\n", line->printed_ratio,
                line->ratio.value, line->ratio.low, line->ratio.high, cell->trees,
                lod_word(cell->lod), line->printed->effects);
        count++;
    }
    if (!count)
        return;
    plot_points(plot, data, "with yerrorbars", block->example->method_index, variant == 0,
                is_first ? paper_variant(book->arena, block->example) : NULL);
}

enum status plot_paper(const struct book *book, const struct paper_beside *beside,
                       const char *folder, struct figure *figure, struct error *error)
{
    struct axis both = axis_empty();
    if (!survey(beside, &both))
        return STATUS_OK;
    axis_widen(&both, 0.08, 0.08);
    struct plot plot;
    figure->kind = FIGURE_PAPER;
    plot_open(&plot, book, folder, arena_printf(book->arena, "paper-%s", beside->paper->name),
              arena_printf(book->arena, "Ratios beside %s", beside->paper->name));
    plot_axes(&plot, &both, &both, "printed over its base row", "ours over our base row");
    fputs("set key maxcols 1\n", plot.gp);
    plot_curve(&plot);
    fprintf(plot.gp, "x with lines linewidth 1 dashtype 2 linecolor rgb \"#%06x\" notitle",
            tint_rgb(TINT_MUTED));
    for (size_t b = 0; b < beside->blocks_count; b++)
        put_block(&plot, beside, b);
    return plot_close(&plot, figure, error);
}
