/* Printed rows and our cells: which stand for which, and what ours measured in each round. */
#include "report/paper.h"

#include "base/hash.h"
#include "stats/stats.h"

#include <math.h>
#include <string.h>

bool paper_side_matches(const struct paper_side *side, const struct paper_sample *sample)
{
    const struct paper_side *cell = &sample->cell;
    return (!side->scene || strcmp(side->scene, cell->scene) == 0) &&
           (!side->method || strcmp(side->method, cell->method) == 0) &&
           (!side->options || !cell->options || strcmp(side->options, cell->options) == 0) &&
           (!side->has_lod || side->lod == cell->lod) &&
           (side->trees == SIZE_MAX || side->trees == cell->trees) &&
           (!side->width_px ||
            (side->width_px == cell->width_px && side->height_px == cell->height_px));
}

/* A repetition's figure from its frames, in the unit. */
static double figure_of(const struct result *result, enum paper_unit unit,
                        enum paper_statistic statistic)
{
    static const double quantiles[] = {
        [PAPER_MEDIAN] = 0.5, [PAPER_WORST] = 0.95, [PAPER_BEST] = 0.05};
    double seconds =
        stats_quantile(result->frame_seconds, result->frames_count, quantiles[statistic]);
    if (result->status != STATUS_OK || !(seconds > 0))
        return NAN;
    return unit == PAPER_FPS ? 1 / seconds : seconds;
}

/* A row's cell with room for its values, all missing. */
static struct paper_sample sample_of(struct arena *arena, const struct row *row, size_t rounds)
{
    const struct cell *cell = &row->seen->cell;
    struct paper_sample sample = {.cell = {.scene = cell->scene,
                                           .method = row->method,
                                           .options = cell->options,
                                           .has_lod = true,
                                           .lod = cell->lod,
                                           .trees = row->trees,
                                           .width_px = cell->width_px,
                                           .height_px = cell->height_px},
                                  .seed = cell->seed,
                                  .format = cell->format,
                                  .row = row,
                                  .values = ARENA_ARRAY(arena, double, rounds + 1)};
    for (size_t r = 0; r < rounds; r++)
        sample.values[r] = NAN;
    return sample;
}

struct paper_sample *paper_samples(const struct book *book, enum paper_unit unit,
                                   enum paper_statistic statistic, size_t *rounds)
{
    struct paper_sample *samples =
        ARENA_ARRAY(book->arena, struct paper_sample, book->rows_count + 1);
    *rounds = 0;
    for (size_t i = 0; i < book->run->results_count; i++)
        if (book->run->results[i].repetition >= (int)*rounds)
            *rounds = (size_t)book->run->results[i].repetition + 1;
    for (size_t i = 0; i < book->rows_count; i++) {
        const struct summary *summary = book->rows[i].summary;
        samples[i] = sample_of(book->arena, &book->rows[i], *rounds);
        for (size_t k = 0; k < summary->repetitions + summary->failures; k++)
            if (summary->results[k]->repetition >= 0)
                samples[i].values[summary->results[k]->repetition] =
                    figure_of(summary->results[k], unit, statistic);
    }
    return samples;
}

/* The mean of an error against the reference with the same effects over the views that are seen
 * from an azimuth; NaN where there is none. */
static double value_seen_from(const struct row *row, const struct column *column,
                              const float azimuth_deg[2])
{
    const struct metric_info *metric = &metric_table[column - column_table - COLUMN_same_rmse];
    double sum = 0;
    size_t count = 0;
    for (size_t i = 0; i < row->seen->views_count && row->compared; i++) {
        const struct result_view *view = &row->seen->views[i];
        if (!view->compared || !(view->azimuth_deg >= (double)azimuth_deg[0] &&
                                 view->azimuth_deg <= (double)azimuth_deg[1]))
            continue;
        sum += metric_of(&view->same.value, metric);
        count++;
    }
    return count ? sum / (double)count : NAN;
}

struct paper_sample *paper_samples_column(const struct book *book, const struct column *column,
                                          const struct paper_side *side)
{
    struct paper_sample *samples =
        ARENA_ARRAY(book->arena, struct paper_sample, book->rows_count + 1);
    for (size_t i = 0; i < book->rows_count; i++) {
        samples[i] = sample_of(book->arena, &book->rows[i], 1);
        samples[i].values[0] = side->has_azimuth
                                   ? value_seen_from(&book->rows[i], column, side->azimuth_deg)
                                   : book->rows[i].values[column - column_table];
    }
    return samples;
}

/* The samples of every statistic, made once. */
struct bench {
    const struct book *book;
    size_t rounds;
    struct paper_sample *samples[2][PAPER_BEST + 1]; /* unit, statistic */
};

static struct paper_sample *bench_samples(struct bench *bench, enum paper_unit unit,
                                          enum paper_statistic statistic)
{
    struct paper_sample **samples = &bench->samples[unit][statistic];
    if (!*samples)
        *samples = paper_samples(bench->book, unit, statistic, &bench->rounds);
    return *samples;
}

/* Alike in what a variant is: method, options, seed, format. */
static bool same_variant(const struct row *a, const struct row *b)
{
    const struct cell *x = &a->seen->cell, *y = &b->seen->cell;
    return strcmp(a->method, b->method) == 0 && strcmp(x->options, y->options) == 0 &&
           x->seed == y->seed && x->format == y->format;
}

const char *paper_variant(struct arena *arena, const struct row *row)
{
    const char *options = row->seen->cell.options;
    return *options ? arena_printf(arena, "%s %s", row->method, options) : row->method;
}

size_t paper_variant_number(struct arena *arena, const struct paper_beside *beside, size_t block,
                            bool *is_first)
{
    const char *own = paper_variant(arena, beside->blocks[block].example);
    size_t number = 0;
    *is_first = true;
    for (size_t i = 0; i < block && *is_first; i++) {
        const char *earlier = paper_variant(arena, beside->blocks[i].example);
        bool begins = true;
        for (size_t k = 0; k < i && begins; k++)
            begins = strcmp(paper_variant(arena, beside->blocks[k].example), earlier) != 0;
        *is_first = strcmp(earlier, own) != 0;
        number +=
            begins && *is_first &&
            beside->blocks[i].example->method_index == beside->blocks[block].example->method_index;
    }
    return number;
}

/* Our sample of the variant that stands for a printed row; NULL: the run has none. */
static const struct paper_sample *find(struct bench *bench, const struct paper_table *table,
                                       const struct paper_row *printed, const struct row *variant)
{
    struct paper_sample *samples = bench_samples(bench, table->unit, printed->statistic);
    for (size_t i = 0; i < bench->book->rows_count; i++)
        if (same_variant(samples[i].row, variant) &&
            paper_side_matches(&printed->cell, &samples[i]))
            return &samples[i];
    return NULL;
}

static struct paper_line line_of(struct bench *bench, const struct paper_table *table,
                                 const struct paper_row *printed, const struct row *variant)
{
    const struct paper_row *base = &table->rows[table->base];
    const struct paper_sample *ours = find(bench, table, printed, variant);
    const struct paper_sample *ours_base = find(bench, table, base, variant);
    struct paper_line line = {.printed = printed,
                              .printed_ratio = printed->value / base->value,
                              .value = {NAN, NAN, NAN},
                              .ratio = {NAN, NAN, NAN}};
    if (!ours)
        return line;
    line.ours = ours->row;
    for (size_t r = 0; r < bench->rounds; r++)
        line.rounds += !isnan(ours->values[r]);
    uint64_t seed = hash_text(0, ours->row->seen->cell.name);
    line.value = stats_median_interval(ours->values, bench->rounds, seed);
    if (ours_base && ours != ours_base)
        line.ratio = stats_ratio_interval(ours->values, ours_base->values, bench->rounds, seed);
    else if (ours_base && line.rounds)
        line.ratio = (struct interval){1, 1, 1};
    return line;
}

static bool is_known(const struct paper_block *blocks, size_t count, const struct row *variant)
{
    for (size_t i = 0; i < count; i++)
        if (same_variant(blocks[i].example, variant))
            return true;
    return false;
}

/* Which of a table's rows a variant has; a row that failed counts. */
static size_t rows_had(struct bench *bench, const struct paper_table *table,
                       const struct row *variant)
{
    size_t count = 0;
    for (size_t k = 0; k < table->rows_count; k++)
        count += find(bench, table, &table->rows[k], variant) != NULL;
    return count;
}

/* The variants of a table in the book's order: those with cells for two printed rows at least,
 * since a single one has no ratio. */
static size_t find_blocks(struct bench *bench, const struct paper_table *table,
                          struct paper_block *blocks)
{
    size_t count = 0;
    const struct book *book = bench->book;
    const struct paper_sample *samples = bench_samples(bench, table->unit, PAPER_MEDIAN);
    for (size_t i = 0; i < book->rows_count; i++)
        for (size_t k = 0; k < table->rows_count; k++) {
            if (!paper_side_matches(&table->rows[k].cell, &samples[i]) ||
                is_known(blocks, count, samples[i].row) ||
                rows_had(bench, table, samples[i].row) < 2)
                continue;
            struct paper_block *block = &blocks[count++];
            *block = (struct paper_block){.table = table, .example = samples[i].row};
            block->lines_count = table->rows_count;
            block->lines = ARENA_ARRAY(book->arena, struct paper_line, table->rows_count);
        }
    for (size_t b = 0; b < count; b++)
        for (size_t k = 0; k < table->rows_count; k++)
            blocks[b].lines[k] = line_of(bench, table, &table->rows[k], blocks[b].example);
    for (size_t b = 0; b < count; b++)
        paper_fit(book->arena, &blocks[b]);
    return count;
}

/* Whether a claim names a scene that none of the paper's tables has. */
static bool is_apart(const struct paper *paper, const struct paper_claim *claim)
{
    bool apart = !paper->tables_count || claim->of.scene;
    for (size_t t = 0; t < paper->tables_count && apart; t++)
        for (size_t i = 0; i < paper->tables[t].rows_count && apart; i++) {
            const char *scene = paper->tables[t].rows[i].cell.scene;
            apart = !scene || strcmp(scene, claim->of.scene) != 0;
        }
    return apart;
}

/* A run without a printed row has cells for one of the paper's claims: of any where it has no
 * tables, else of one that they say nothing of. */
static bool decides(const struct paper_beside *beside)
{
    for (size_t i = 0; i < beside->findings_count; i++)
        if (beside->findings[i].pairs && is_apart(beside->paper, beside->findings[i].claim))
            return true;
    return false;
}

struct paper_beside *papers_beside(const struct book *book, const struct paper *papers,
                                   size_t papers_count, size_t *count)
{
    struct bench bench = {.book = book};
    struct paper_beside *list = ARENA_ARRAY(book->arena, struct paper_beside, papers_count + 1);
    *count = 0;
    for (size_t i = 0; i < papers_count; i++) {
        struct paper_beside *beside = &list[*count];
        *beside = (struct paper_beside){.paper = &papers[i]};
        beside->blocks = ARENA_ARRAY(book->arena, struct paper_block,
                                     papers[i].tables_count * book->rows_count + 1);
        for (size_t t = 0; t < papers[i].tables_count; t++)
            beside->blocks_count +=
                find_blocks(&bench, &papers[i].tables[t], beside->blocks + beside->blocks_count);
        beside->findings = paper_judge(book, &papers[i], &beside->findings_count);
        *count += beside->blocks_count || decides(beside);
    }
    return list;
}
