/* By which law a printed table's times grow, and ours beside it. */
#include "report/paper.h"

#include <math.h>

static double seconds_of(const struct paper_table *table, double value)
{
    return table->unit == PAPER_SECONDS ? value : 1 / value;
}

void paper_fit(struct arena *arena, struct paper_block *block)
{
    const struct paper_table *table = block->table;
    double *sizes = ARENA_ARRAY(arena, double, 3 * block->lines_count + 1);
    double *printed = sizes + block->lines_count, *ours = printed + block->lines_count;
    size_t count = 0;
    for (size_t i = 0; i < block->lines_count && table->law; i++) {
        const struct paper_line *line = &block->lines[i];
        if (!line->rounds)
            continue;
        sizes[count] = line->printed->size;
        printed[count] = seconds_of(table, line->printed->value);
        ours[count++] = seconds_of(table, line->value.value);
    }
    for (int law = 0; law < GROWTH_LAWS; law++) {
        block->printed_fits[law] = stats_growth((enum growth_law)law, sizes, printed, count);
        block->fits[law] = stats_growth((enum growth_law)law, sizes, ours, count);
    }
}

double paper_exponential(const double *sizes, const double *seconds, size_t count)
{
    double line = stats_growth(GROWTH_LINEAR, sizes, seconds, count).residual;
    double power = stats_growth(GROWTH_POWER, sizes, seconds, count).residual;
    return stats_growth(GROWTH_EXPONENTIAL, sizes, seconds, count).residual / fmin(line, power);
}

const char *paper_law(struct arena *arena, enum growth_law law, const struct growth_fit *fit)
{
    if (isnan(fit->residual))
        return "\u2013";
    if (law == GROWTH_LINEAR)
        return arena_printf(arena, "%.3g %s %.3g N", fit->a, fit->b < 0 ? "\u2212" : "+",
                            fabs(fit->b));
    return arena_printf(arena, law == GROWTH_POWER ? "%.3g N^%.3g" : "%.3g e^(%.3g N)", fit->a,
                        fit->b);
}
