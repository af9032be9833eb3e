/* A paper's claims judged by a run's cells.
 *
 * A claim's figure is computed in every round from the cells of that round alone, so that a drift
 * of the machine's speed cancels; its median over the rounds and the 95 % bootstrap interval are
 * held against the claim's band. It holds when the interval lies within the band, it does not when
 * the interval lies outside, and is open when the interval crosses the band's end or there are
 * fewer than three rounds. No figure is formed from a cell that did not succeed. A claim on a
 * column that every round gives alike (errors, memory) has no interval: its figure decides. */
#include "report/paper.h"

#include "base/hash.h"
#include "base/plural.h"
#include "stats/stats.h"

#include <math.h>
#include <string.h>

enum { ROUNDS_MIN = 3 };

/* What one claim is judged from: ours, or what is printed as one round. */
struct court {
    struct arena *arena;
    const struct paper_claim *claim;
    const struct paper_sample *samples, *over_samples; /* of either side, of the same cells */
    size_t samples_count, rounds;
    const char *variant; /* options of the first side; NULL: any */
};

/* Sums over pairs, a round: of logarithms, exponents; or the smallest value. */
struct poll {
    size_t pairs, usable;
    double *sums;
    double smallest, largest;
};

/* A figure of one pair in every round joins the poll; a round that lacks it drops out. */
static void poll_add(struct court *court, struct poll *poll, const double *figures)
{
    double median = stats_median(figures, court->rounds);
    poll->pairs++;
    if (isnan(median))
        return;
    poll->usable++;
    for (size_t r = 0; r < court->rounds; r++)
        poll->sums[r] = court->claim->kind == PAPER_VALUE
                            ? (isnan(figures[r]) ? NAN : fmin(poll->sums[r], figures[r]))
                            : poll->sums[r] + figures[r];
    poll->smallest = fmin(poll->smallest, median);
    poll->largest = fmax(poll->largest, median);
}

static bool same_text(const char *a, const char *b)
{
    return !a || !b || strcmp(a, b) == 0;
}

/* Alike in all that no side of the claim says; trees may differ in a series. */
static bool is_alike(const struct court *court, const struct paper_sample *a,
                     const struct paper_sample *b)
{
    const struct paper_side *of = &court->claim->of, *over = &court->claim->over;
    bool growth = court->claim->kind == PAPER_GROWTH || court->claim->kind == PAPER_LAW;
    return (of->scene || over->scene || same_text(a->cell.scene, b->cell.scene)) &&
           (of->options || over->options || same_text(a->cell.options, b->cell.options)) &&
           (of->has_lod || over->has_lod || a->cell.lod == b->cell.lod) &&
           (growth || of->trees != SIZE_MAX || over->trees != SIZE_MAX ||
            a->cell.trees == b->cell.trees) &&
           (of->width_px || over->width_px ||
            (a->cell.width_px == b->cell.width_px && a->cell.height_px == b->cell.height_px)) &&
           a->seed == b->seed && a->format == b->format;
}

static bool is_of(const struct court *court, const struct paper_sample *sample)
{
    return paper_side_matches(&court->claim->of, sample) &&
           (!court->variant || same_text(court->variant, sample->cell.options));
}

static void poll_ratios(struct court *court, struct poll *poll)
{
    double *logs = ARENA_ARRAY(court->arena, double, court->rounds + 1);
    for (size_t i = 0; i < court->samples_count; i++)
        for (size_t k = 0; k < court->samples_count; k++) {
            const struct paper_sample *a = &court->samples[i], *b = &court->over_samples[k];
            if ((i == k && !court->claim->of.has_azimuth) || !is_of(court, a) ||
                !paper_side_matches(&court->claim->over, b) || !is_alike(court, a, b))
                continue;
            for (size_t r = 0; r < court->rounds; r++)
                logs[r] =
                    a->values[r] > 0 && b->values[r] > 0 ? log(a->values[r] / b->values[r]) : NAN;
            poll_add(court, poll, logs);
        }
}

/* What the claim asks of a series, rates against trees. */
static double series_figure(enum paper_kind kind, const double *trees, double *rates, size_t count)
{
    if (kind == PAPER_GROWTH)
        return stats_power_law(trees, rates, count).b.value;
    for (size_t i = 0; i < count; i++)
        rates[i] = 1 / rates[i];
    return paper_exponential(trees, rates, count);
}

/* The figures of the series that begins with a sample; false: an earlier sample has it. */
static bool series_figures(struct court *court, size_t first, double *figures)
{
    const struct paper_sample *samples = court->samples;
    double *trees = ARENA_ARRAY(court->arena, double, court->samples_count);
    double *values = ARENA_ARRAY(court->arena, double, court->samples_count);
    for (size_t r = 0; r < court->rounds; r++) {
        size_t count = 0;
        for (size_t i = 0; i < court->samples_count; i++) {
            if (!is_of(court, &samples[i]) || !is_alike(court, &samples[first], &samples[i]))
                continue;
            if (i < first)
                return false;
            if (isnan(samples[i].values[r]))
                continue;
            trees[count] = (double)samples[i].cell.trees;
            values[count++] = samples[i].values[r];
        }
        figures[r] = series_figure(court->claim->kind, trees, values, count);
    }
    return true;
}

static void poll_growth(struct court *court, struct poll *poll)
{
    double *figures = ARENA_ARRAY(court->arena, double, court->rounds + 1);
    for (size_t i = 0; i < court->samples_count; i++)
        if (is_of(court, &court->samples[i]) && series_figures(court, i, figures))
            poll_add(court, poll, figures);
}

static void poll_values(struct court *court, struct poll *poll)
{
    for (size_t i = 0; i < court->samples_count; i++)
        if (is_of(court, &court->samples[i]))
            poll_add(court, poll, court->samples[i].values);
}

/* The claim's figure in each round in the poll's sums; NaN where a round lacks a pair. */
static struct poll poll_make(struct court *court)
{
    struct poll poll = {.sums = ARENA_ARRAY(court->arena, double, court->rounds + 1),
                        .smallest = INFINITY,
                        .largest = -INFINITY};
    bool is_ratio = court->claim->kind == PAPER_RATIO, is_value = court->claim->kind == PAPER_VALUE;
    for (size_t r = 0; r < court->rounds; r++)
        poll.sums[r] = is_value ? INFINITY : 0;
    if (is_ratio)
        poll_ratios(court, &poll);
    else if (is_value)
        poll_values(court, &poll);
    else
        poll_growth(court, &poll);
    for (size_t r = 0; r < court->rounds; r++) {
        double mean = is_value ? poll.sums[r] : poll.sums[r] / (double)poll.usable;
        poll.sums[r] = poll.usable ? (is_ratio ? exp(mean) : mean) : NAN;
    }
    poll.smallest = !poll.usable ? NAN : is_ratio ? exp(poll.smallest) : poll.smallest;
    poll.largest = !poll.usable ? NAN : is_ratio ? exp(poll.largest) : poll.largest;
    return poll;
}

static void decide(struct arena *arena, struct paper_finding *finding)
{
    const struct paper_claim *claim = finding->claim;
    const struct interval *ours = &finding->ours;
    size_t lost = finding->pairs - finding->usable;
    finding->verdict = PAPER_NOT_MEASURED;
    if (!finding->pairs)
        finding->reason = "the run holds no cells that decide it";
    else if (!finding->usable)
        finding->reason = "the cells that would decide it failed";
    else if (!finding->rounds)
        finding->reason = "no round has all cells";
    if (finding->reason)
        return;
    const char *missing =
        lost ? arena_printf(arena, "; %zu of %zu left out, a cell failed", lost, finding->pairs)
             : "";
    finding->verdict = PAPER_OPEN;
    const char *why = "the interval crosses the end of the band";
    if (!claim->column && finding->rounds < ROUNDS_MIN) {
        why = arena_printf(arena, "%zu round%s; an interval needs three", finding->rounds,
                           plural(finding->rounds));
    } else if (ours->low >= claim->low && ours->high <= claim->high) {
        finding->verdict = PAPER_HOLDS;
        why =
            claim->column ? "the figure lies within the band" : "the interval lies within the band";
    } else if (ours->high < claim->low || ours->low > claim->high) {
        finding->verdict = PAPER_FAILS;
        why = claim->column ? "the figure lies outside of the band"
                            : "the interval lies outside of the band";
    }
    finding->reason = arena_printf(arena, "%s%s", why, missing);
}

static struct paper_finding find(struct court *court, const struct row *example)
{
    struct poll poll = poll_make(court);
    struct paper_finding finding = {.claim = court->claim,
                                    .example = example,
                                    .pairs = poll.pairs,
                                    .usable = poll.usable,
                                    .smallest = poll.smallest,
                                    .largest = poll.largest};
    for (size_t r = 0; r < court->rounds; r++)
        finding.rounds += !isnan(poll.sums[r]);
    finding.ours = stats_median_interval(poll.sums, court->rounds, hash_text(0, court->claim->id));
    return finding;
}

/* The printed rows of a statistic as samples of one round. */
static struct paper_sample *printed_samples(struct arena *arena, const struct paper *paper,
                                            enum paper_statistic statistic, size_t *count)
{
    size_t most = 0;
    for (size_t t = 0; t < paper->tables_count; t++)
        most += paper->tables[t].rows_count;
    struct paper_sample *samples = ARENA_ARRAY(arena, struct paper_sample, most + 1);
    *count = 0;
    for (size_t t = 0; t < paper->tables_count; t++)
        for (size_t i = 0; i < paper->tables[t].rows_count; i++) {
            const struct paper_row *row = &paper->tables[t].rows[i];
            if (row->statistic != statistic)
                continue;
            double *value = ARENA_ARRAY(arena, double, 1);
            *value = paper->tables[t].unit == PAPER_FPS ? row->value : 1 / row->value;
            samples[(*count)++] = (struct paper_sample){.cell = row->cell, .values = value};
        }
    return samples;
}

static struct interval printed_figure(struct arena *arena, const struct paper *paper,
                                      const struct paper_claim *claim)
{
    struct court court = {.arena = arena, .claim = claim, .rounds = 1};
    if (claim->column)
        return (struct interval){NAN, NAN, NAN};
    court.samples = printed_samples(arena, paper, claim->statistic, &court.samples_count);
    court.over_samples = court.samples;
    struct paper_finding finding = find(&court, NULL);
    return (struct interval){finding.ours.value, finding.smallest, finding.largest};
}

/* The claim's findings from samples of its statistic, one a variant of the first side. */
static size_t judge(const struct book *book, const struct paper *paper,
                    const struct paper_claim *claim, const struct paper_sample *samples,
                    const struct paper_sample *over_samples, size_t rounds,
                    struct paper_finding *findings)
{
    struct arena *arena = book->arena;
    struct court court = {.arena = arena,
                          .claim = claim,
                          .samples = samples,
                          .over_samples = over_samples,
                          .samples_count = book->rows_count,
                          .rounds = rounds};
    struct interval printed = printed_figure(arena, paper, claim);
    size_t count = 0;
    for (size_t i = 0; i < book->rows_count; i++) {
        const struct paper_sample *sample = &court.samples[i];
        bool known = !paper_side_matches(&claim->of, sample);
        for (size_t k = 0; k < count && !known; k++)
            known = strcmp(findings[k].example->seen->cell.options, sample->cell.options) == 0;
        if (known)
            continue;
        court.variant = sample->cell.options;
        struct paper_finding finding = find(&court, sample->row);
        if (finding.pairs)
            findings[count++] = finding;
    }
    if (!count)
        findings[count++] = (struct paper_finding){
            .claim = claim, .ours = {NAN, NAN, NAN}, .smallest = NAN, .largest = NAN};
    for (size_t i = 0; i < count; i++) {
        findings[i].printed = printed;
        decide(arena, &findings[i]);
    }
    return count;
}

struct paper_finding *paper_judge(const struct book *book, const struct paper *paper, size_t *count)
{
    struct paper_finding *findings = ARENA_ARRAY(book->arena, struct paper_finding,
                                                 paper->claims_count * (book->rows_count + 1) + 1);
    const struct paper_sample *samples[PAPER_BEST + 1] = {NULL};
    size_t rounds = 0;
    *count = 0;
    for (size_t i = 0; i < paper->claims_count; i++) {
        const struct paper_claim *claim = &paper->claims[i];
        if (claim->column) {
            *count += judge(
                book, paper, claim, paper_samples_column(book, claim->column, &claim->of),
                paper_samples_column(book, claim->column, &claim->over), 1, findings + *count);
            continue;
        }
        if (claim->kind != PAPER_UNTESTED) {
            const struct paper_sample **of = &samples[claim->statistic];
            *of = *of ? *of : paper_samples(book, PAPER_FPS, claim->statistic, &rounds);
            *count += judge(book, paper, claim, *of, *of, rounds, findings + *count);
            continue;
        }
        static const struct interval none = {NAN, NAN, NAN};
        findings[(*count)++] = (struct paper_finding){.claim = claim,
                                                      .ours = none,
                                                      .printed = none,
                                                      .smallest = NAN,
                                                      .largest = NAN,
                                                      .verdict = PAPER_NOT_MEASURED,
                                                      .reason = "no figure of a run decides it"};
    }
    return findings;
}

const char *paper_verdict_word(enum paper_verdict verdict)
{
    static const char *const words[] = {[PAPER_HOLDS] = "holds",
                                        [PAPER_FAILS] = "does not hold",
                                        [PAPER_OPEN] = "open",
                                        [PAPER_NOT_MEASURED] = "not measured"};
    return words[verdict];
}

const char *paper_unit_word(enum paper_unit unit)
{
    return unit == PAPER_FPS ? "fps" : "s";
}

const char *paper_band(struct arena *arena, const struct paper_claim *claim)
{
    if (isinf(claim->high))
        return arena_printf(arena, "%g or more", claim->low);
    if (isinf(claim->low))
        return arena_printf(arena, "%g or less", claim->high);
    return arena_printf(arena, "%g to %g", claim->low, claim->high);
}
