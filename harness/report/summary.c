/* One summary a cell: its repetitions' frame times, and whether it is on the front of its group. */
#include "report/report.h"

#include "base/hash.h"
#include "stats/stats.h"

#include <math.h>
#include <string.h>

size_t report_trees(const struct result *result)
{
    return result->cell.trees == SIZE_MAX ? result->instances : result->cell.trees;
}

/* Of one scene, tree count, size and seed: the cells that a front is made of. */
static bool comparable(const struct result *a, const struct result *b)
{
    return strcmp(a->cell.scene, b->cell.scene) == 0 && report_trees(a) == report_trees(b) &&
           a->cell.width_px == b->cell.width_px && a->cell.height_px == b->cell.height_px &&
           a->cell.seed == b->cell.seed;
}

bool report_is_floor(const struct result *result)
{
    return strcmp(result->cell.method_name, "null") == 0;
}

/* Mean FLIP over the compared views, same effects; NaN without one. */
static double mean_flip(const struct result *result)
{
    double sum = 0;
    size_t count = 0;
    for (size_t i = 0; i < result->views_count; i++)
        if (result->views[i].compared && !isnan(result->views[i].same.value.flip)) {
            sum += result->views[i].same.value.flip;
            count++;
        }
    return count ? sum / (double)count : NAN;
}

/* The successful repetition to show: one with compared pictures before one without. */
static const struct result *best_of(const struct result *known, const struct result *candidate)
{
    if (!known || (known->status != STATUS_OK && candidate->status == STATUS_OK))
        return candidate;
    if (candidate->status == STATUS_OK && isnan(mean_flip(known)) && !isnan(mean_flip(candidate)))
        return candidate;
    return known;
}

static void summarise_time(struct arena *arena, const struct run *run, struct summary *summary)
{
    const char *name = summary->first->cell.name;
    const double **times = ARENA_ARRAY(arena, const double *, summary->repetitions + 1);
    size_t *counts = ARENA_ARRAY(arena, size_t, summary->repetitions + 1);
    size_t kept = 0;
    for (size_t i = 0; i < run->results_count; i++) {
        const struct result *result = &run->results[i];
        if (result->status != STATUS_OK || strcmp(result->cell.name, name) != 0)
            continue;
        times[kept] = result->frame_seconds;
        counts[kept++] = result->frames_count;
    }
    struct interval interval =
        stats_nested_median_interval(times, counts, kept, hash_text(0, name));
    summary->frame_seconds.value = interval.value;
    summary->frame_seconds.low = interval.low;
    summary->frame_seconds.high = interval.high;
    summary->limit = limit_of(limit_calibration(run, summary->first), summary->first, interval);
}

static void mark_front(struct arena *arena, struct summary *summaries, size_t count, size_t leader)
{
    double *cost = ARENA_ARRAY(arena, double, count);
    double *error = ARENA_ARRAY(arena, double, count);
    bool *on_front = ARENA_ARRAY(arena, bool, count);
    size_t *members = ARENA_ARRAY(arena, size_t, count), members_count = 0;
    for (size_t i = leader; i < count; i++) {
        const struct result *result = summaries[i].first;
        if (!comparable(summaries[leader].first, result))
            continue;
        bool fit = result->status == STATUS_OK && !report_is_floor(result);
        cost[members_count] = fit ? summaries[i].frame_seconds.value : NAN;
        error[members_count] = fit ? mean_flip(result) : NAN;
        members[members_count++] = i;
    }
    stats_pareto(cost, error, members_count, on_front);
    for (size_t k = 0; k < members_count; k++)
        summaries[members[k]].on_front = on_front[k];
}

struct summary *report_summaries(struct arena *arena, const struct run *run, size_t *count)
{
    struct summary *summaries = ARENA_ARRAY(arena, struct summary, run->results_count + 1);
    *count = 0;
    for (size_t i = 0; i < run->results_count; i++) {
        const struct result *result = &run->results[i];
        size_t k = 0;
        while (k < *count && strcmp(summaries[k].first->cell.name, result->cell.name) != 0)
            k++;
        *count += k == *count;
        summaries[k].first = best_of(summaries[k].first, result);
        summaries[k].repetitions += result->status == STATUS_OK;
        summaries[k].failures += result->status != STATUS_OK;
    }
    for (size_t i = 0; i < *count; i++)
        summarise_time(arena, run, &summaries[i]);
    struct arena *scratch = arena_create(0);
    for (size_t i = 0; i < *count; i++) {
        bool led = true; /* by an earlier cell of its group */
        for (size_t k = 0; k < i && led; k++)
            led = !comparable(summaries[k].first, summaries[i].first);
        if (led)
            mark_front(scratch, summaries, *count, i);
    }
    arena_destroy(scratch);
    return summaries;
}
