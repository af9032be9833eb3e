/* One summary a cell: its repetitions' frame times, and whether it is on the front of its group. */
#include "report/report.h"

#include "base/hash.h"
#include "stats/stats.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

size_t report_trees(const struct result *result)
{
    return result->cell.trees == SIZE_MAX ? result->instances : result->cell.trees;
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
    const struct result **succeeded =
        ARENA_ARRAY(arena, const struct result *, summary->repetitions + 1);
    const double **times = ARENA_ARRAY(arena, const double *, summary->repetitions + 1);
    size_t *counts = ARENA_ARRAY(arena, size_t, summary->repetitions + 1);
    size_t kept = 0;
    for (size_t i = 0; i < summary->repetitions + summary->failures; i++) {
        const struct result *result = summary->results[i];
        if (result->status != STATUS_OK)
            continue;
        succeeded[kept] = result;
        times[kept] = result->frame_seconds;
        counts[kept++] = result->frames_count;
    }
    struct interval interval =
        stats_nested_median_interval(times, counts, kept, hash_text(0, summary->first->cell.name));
    summary->frame_seconds.value = interval.value;
    summary->frame_seconds.low = interval.low;
    summary->frame_seconds.high = interval.high;
    summary->limit = limit_of_cell(run, succeeded, kept, summary->first, interval);
}

static int compare_groups(const void *a, const void *b)
{
    const struct result *x = (*(struct summary *const *)a)->first;
    const struct result *y = (*(struct summary *const *)b)->first;
    size_t tx = report_trees(x), ty = report_trees(y);
    int order = strcmp(x->cell.scene, y->cell.scene);
    if (!order)
        order = (tx > ty) - (tx < ty);
    if (!order)
        order = (x->cell.width_px > y->cell.width_px) - (x->cell.width_px < y->cell.width_px);
    if (!order)
        order = (x->cell.height_px > y->cell.height_px) - (x->cell.height_px < y->cell.height_px);
    return order ? order : (x->cell.seed > y->cell.seed) - (x->cell.seed < y->cell.seed);
}

/* Of cells of one scene, tree count, size and seed. */
static void mark_front(struct summary **members, size_t count)
{
    struct arena *arena = arena_create(0);
    double *cost = ARENA_ARRAY(arena, double, count);
    double *error = ARENA_ARRAY(arena, double, count);
    bool *on_front = ARENA_ARRAY(arena, bool, count);
    for (size_t i = 0; i < count; i++) {
        const struct result *result = members[i]->first;
        bool fit = result->status == STATUS_OK && !report_is_floor(result);
        cost[i] = fit ? members[i]->frame_seconds.value : NAN;
        error[i] = fit ? mean_flip(result) : NAN;
    }
    stats_pareto(cost, error, count, on_front);
    for (size_t i = 0; i < count; i++)
        members[i]->on_front = on_front[i];
    arena_destroy(arena);
}

static void mark_fronts(struct summary *summaries, size_t count)
{
    struct arena *arena = arena_create(0);
    struct summary **sorted = ARENA_ARRAY(arena, struct summary *, count + 1);
    for (size_t i = 0; i < count; i++)
        sorted[i] = &summaries[i];
    qsort(sorted, count, sizeof *sorted, compare_groups);
    for (size_t start = 0, end; start < count; start = end) {
        for (end = start + 1; end < count && compare_groups(&sorted[start], &sorted[end]) == 0;)
            end++;
        mark_front(sorted + start, end - start);
    }
    arena_destroy(arena);
}

/* By cell; those of a cell in file order. */
static int compare_cells(const void *a, const void *b)
{
    const struct result *x = *(const struct result *const *)a;
    const struct result *y = *(const struct result *const *)b;
    int order = strcmp(x->cell.name, y->cell.name);
    return order ? order : (x > y) - (x < y);
}

static int compare_places(const void *a, const void *b)
{
    const struct summary *x = a, *y = b;
    return (x->results[0] > y->results[0]) - (x->results[0] < y->results[0]);
}

struct summary *report_summaries(struct arena *arena, const struct run *run, size_t *count)
{
    struct summary *summaries = ARENA_ARRAY(arena, struct summary, run->results_count + 1);
    const struct result **sorted =
        ARENA_ARRAY(arena, const struct result *, run->results_count + 1);
    for (size_t i = 0; i < run->results_count; i++)
        sorted[i] = &run->results[i];
    qsort(sorted, run->results_count, sizeof *sorted, compare_cells);
    *count = 0;
    for (size_t i = 0; i < run->results_count; i++) {
        bool starts = i == 0 || strcmp(sorted[i - 1]->cell.name, sorted[i]->cell.name) != 0;
        *count += starts;
        struct summary *summary = &summaries[*count - 1];
        if (starts)
            summary->results = sorted + i;
        summary->first = best_of(summary->first, sorted[i]);
        summary->repetitions += sorted[i]->status == STATUS_OK;
        summary->failures += sorted[i]->status != STATUS_OK;
    }
    qsort(summaries, *count, sizeof *summaries, compare_places);
    for (size_t i = 0; i < *count; i++)
        summarise_time(arena, run, &summaries[i]);
    mark_fronts(summaries, *count);
    return summaries;
}
