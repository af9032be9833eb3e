/* The static plot of a printed table whose times grow by a law: printed and ours over their base
 * rows, with the law that fits each best. */
#include "report/paper.h"
#include "report/plot.h"

#include <math.h>

enum { STEPS = 48 };

/* Times over the base row's: of a block's own cells, or as printed. */
struct curve {
    const char *label;
    const struct growth_fit *fits;
    bool is_printed;
    double base_s;
    int type; /* gnuplot's point type */
    unsigned color;
    int dashes;
};

static double time_at(const struct paper_block *block, size_t line, bool is_printed)
{
    double value = is_printed ? block->lines[line].printed->value : block->lines[line].value.value;
    return block->table->unit == PAPER_SECONDS ? value : 1 / value;
}

static bool is_drawn(const struct paper_block *block)
{
    return block->table->law && !isnan(block->fits[GROWTH_LINEAR].residual) &&
           block->lines[block->table->base].rounds;
}

static void survey(const struct paper_block *block, struct axis *x, struct axis *y)
{
    for (int printed = 0; printed < 2; printed++)
        for (size_t i = 0; i < block->lines_count; i++)
            if (block->lines[i].rounds) {
                axis_add(x, block->lines[i].printed->size);
                axis_add(y,
                         time_at(block, i, printed) / time_at(block, block->table->base, printed));
            }
}

static void put_curve(struct plot *plot, const struct paper_block *block, const struct curve *curve)
{
    int best = 0, points = plot_block(plot, curve->label);
    double low = INFINITY, high = 0;
    for (size_t i = 0; i < block->lines_count; i++) {
        if (!block->lines[i].rounds)
            continue;
        double size = block->lines[i].printed->size;
        low = fmin(low, size);
        high = fmax(high, size);
        fprintf(plot->dat, "%.9g %.9g\n", size,
                time_at(block, i, curve->is_printed) / curve->base_s);
    }
    for (int law = 1; law < GROWTH_LAWS; law++)
        best = curve->fits[law].residual < curve->fits[best].residual ? law : best;
    int line = plot_block(plot, growth_word((enum growth_law)best));
    for (int i = 0; i <= STEPS; i++) {
        double size = low * pow(high / low, (double)i / STEPS);
        double at = growth_at((enum growth_law)best, &curve->fits[best], size) / curve->base_s;
        if (at > 0)
            fprintf(plot->dat, "%.9g %.9g\n", size, at);
    }
    plot_curve(plot);
    fprintf(plot->gp,
            "\"%s.dat\" index %d with points pointtype %d pointsize 0.9 linecolor rgb \"#%06x\" "
            "notitle, \\\n    \"\" index %d with lines linewidth 1.2 dashtype %d linecolor rgb "
            "\"#%06x\" title ",
            plot->name, points, curve->type, curve->color, line, curve->dashes, curve->color);
    plot_text(plot->gp, arena_printf(plot->book->arena, "%s: %s", curve->label,
                                     growth_word((enum growth_law)best)));
    plot->key_rows++;
}

static void put_blocks(struct plot *plot, const struct paper_beside *beside,
                       const struct paper_table *table)
{
    const struct book *book = plot->book;
    bool any = false, is_first;
    for (size_t b = 0; b < beside->blocks_count; b++) {
        const struct paper_block *block = &beside->blocks[b];
        if (block->table != table || !is_drawn(block))
            continue;
        size_t method = block->example->method_index;
        size_t variant = paper_variant_number(book->arena, beside, b, &is_first);
        struct curve curve = {.label = "printed",
                              .fits = block->printed_fits,
                              .is_printed = true,
                              .base_s = time_at(block, table->base, true),
                              .type = 2,
                              .color = tint_rgb(TINT_INK),
                              .dashes = 1};
        if (!any)
            put_curve(plot, block, &curve);
        curve = (struct curve){.label = paper_variant(book->arena, block->example),
                               .fits = block->fits,
                               .base_s = time_at(block, table->base, false),
                               .type = symbol_gnuplot(book, method, variant == 0),
                               .color = tint_rgb(tint_method(book, method)),
                               .dashes = 1 + (int)(variant % 5)};
        put_curve(plot, block, &curve);
        any = true;
    }
}

enum status plot_law(const struct book *book, const struct paper_beside *beside, size_t table,
                     const char *folder, struct figure *figure, struct error *error)
{
    const struct paper_table *printed = &beside->paper->tables[table];
    struct axis x = axis_empty(), y = axis_empty();
    bool any = false;
    for (size_t b = 0; b < beside->blocks_count; b++)
        if (beside->blocks[b].table == printed && is_drawn(&beside->blocks[b])) {
            survey(&beside->blocks[b], &x, &y);
            any = true;
        }
    if (!any)
        return STATUS_OK;
    axis_widen(&x, 0.05, 0.05);
    axis_widen(&y, 0.08, 0.08);
    struct plot plot;
    figure->kind = FIGURE_LAW;
    plot_open(&plot, book, folder,
              arena_printf(book->arena, "law-%s-%zu", beside->paper->name, table + 1),
              printed->title);
    plot_axes(&plot, &x, &y, printed->law, "time over the base row's");
    fputs("set key maxcols 1\n", plot.gp);
    put_blocks(&plot, beside, printed);
    return plot_close(&plot, figure, error);
}
