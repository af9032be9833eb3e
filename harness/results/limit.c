/* From counts and calibrated rates to the least time of a frame and the share of it. */
#include "results/limit.h"

#include "results/calibration.h"

#include <math.h>
#include <string.h>

static const struct interval nothing = {NAN, NAN, NAN};

const char *limit_word(enum limit_resource resource)
{
    static const char *const words[LIMIT_COUNT] = {
#define LIMIT_WORD(name, word, doc) [name] = (word),
        LIMIT_LIST(LIMIT_WORD)
#undef LIMIT_WORD
    };
    return words[resource];
}

static bool is_without_gl(const struct result *result)
{
    return result->renderer && strcmp(result->renderer, "cpu") == 0;
}

const struct calibration *limit_calibration(const struct run *run, const struct result *result)
{
    const struct calibration *best = NULL;
    double nearest = INFINITY;
    for (size_t i = 0; i < run->calibrations_count; i++) {
        const struct calibration *one = &run->calibrations[i];
        if (one->threads != result->threads || !result->renderer)
            continue;
        if (!is_without_gl(result) &&
            (one->format != result->cell.format || strcmp(one->renderer, result->renderer) != 0))
            continue;
        double pixels = (double)result->cell.width_px * result->cell.height_px;
        double away = fabs(log((double)one->width_px * one->height_px / pixels));
        if (away < nearest) {
            nearest = away;
            best = one;
        }
    }
    return best;
}

/* A triangle's size in fragments and its time at the rate's value, low and high end. */
struct size_point {
    double fragments, seconds[3];
};

static void seconds_of(struct interval rate, double seconds[3])
{
    seconds[0] = 1 / rate.value;
    seconds[1] = 1 / rate.high;
    seconds[2] = 1 / rate.low;
}

/* Sizes that were measured, ascending; returns how many. */
static size_t size_points(const struct calibration *calibration, struct size_point points[5])
{
    static const enum calibration_index sizes[] = {CALIBRATION_triangles_shared,
                                                   CALIBRATION_quads_2px, CALIBRATION_quads_8px,
                                                   CALIBRATION_quads_32px};
    size_t count = 0;
    double before = 0;
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
        const struct calibration_measure *measure = &calibration->measures[sizes[i]];
        if (!(measure->rate.low > 0) || !(measure->fragments_per_triangle > before))
            continue;
        before = points[count].fragments = measure->fragments_per_triangle;
        seconds_of(measure->rate, points[count++].seconds);
    }
    const struct calibration_measure *fill = &calibration->measures[CALIBRATION_fill_opaque];
    if (fill->rate.low > 0 && fill->fragments_per_triangle > before) {
        points[count].fragments = fill->fragments_per_triangle;
        seconds_of(fill->rate, points[count].seconds);
        for (int end = 0; end < 3; end++)
            points[count].seconds[end] *= fill->fragments_per_triangle;
        count++;
    }
    return count;
}

struct interval limit_triangle_rate(const struct calibration *calibration,
                                    double fragments_per_triangle)
{
    struct interval culled = calibration->measures[CALIBRATION_triangles_culled].rate;
    struct size_point points[6];
    points[0].fragments = 0;
    seconds_of(culled, points[0].seconds);
    size_t count = 1 + size_points(calibration, points + 1), k = 1;
    double at = fragments_per_triangle, seconds[3];
    if (!(culled.low > 0) || count < 2 || isnan(at))
        return nothing;
    while (k < count - 1 && points[k].fragments < at)
        k++;
    const struct size_point *low = &points[k - 1], *high = &points[k];
    for (int end = 0; end < 3; end++) {
        if (at > high->fragments)
            seconds[end] = high->seconds[end] * at / high->fragments;
        else if (k == 1)
            seconds[end] =
                low->seconds[end] + (high->seconds[end] - low->seconds[end]) * at / high->fragments;
        else
            seconds[end] = low->seconds[end] *
                           pow(high->seconds[end] / low->seconds[end],
                               log(at / low->fragments) / log(high->fragments / low->fragments));
    }
    return (struct interval){1 / seconds[0], 1 / seconds[2], 1 / seconds[1]};
}

/* Least time for a count of things at the best of a rate; to its median. */
static struct interval least_seconds(double count, struct interval rate)
{
    if (isnan(count) || !(rate.low > 0))
        return nothing;
    return (struct interval){count / rate.high, count / rate.high, count / rate.value};
}

/* The sum of two least times, of which one may not be known. */
static struct interval seconds_add(struct interval a, struct interval b)
{
    if (isnan(a.value) || isnan(b.value))
        return isnan(a.value) ? b : a;
    return (struct interval){a.value + b.value, a.low + b.low, a.high + b.high};
}

struct interval limit_memory_rate(const struct calibration *calibration)
{
    static const enum calibration_index ways[] = {CALIBRATION_memory_read, CALIBRATION_memory_copy,
                                                  CALIBRATION_memory_triad};
    struct interval best = nothing;
    for (size_t i = 0; i < sizeof ways / sizeof *ways; i++) {
        struct interval rate = calibration->measures[ways[i]].rate;
        if (rate.low > 0 && !(rate.high <= best.high))
            best = rate;
    }
    return best;
}

static struct limit limit_nothing(void)
{
    struct limit limit = {.resource = LIMIT_UNKNOWN,
                          .seconds = nothing,
                          .fraction = nothing,
                          .fragments_per_triangle = NAN};
    for (size_t i = 0; i < LIMIT_COUNT; i++)
        limit.bounds[i] = NAN;
    return limit;
}

/* The fraction of the limit, by what was measured. */
static void limit_reach(struct limit *limit, struct interval seconds)
{
    if (seconds.value > 0)
        limit->fraction =
            (struct interval){limit->seconds.value / seconds.value,
                              limit->seconds.low / seconds.high, limit->seconds.high / seconds.low};
}

static void bind(struct limit *limit, enum limit_resource resource, struct interval seconds)
{
    limit->bounds[resource] = seconds.value;
    if (isnan(seconds.value) || seconds.value <= limit->seconds.value)
        return;
    limit->resource = resource;
    limit->seconds = seconds;
}

/* What a method counts itself, and the memory that every picture takes. */
static void bind_tally(struct limit *limit, const struct calibration *calibration,
                       const struct result *result, double frame_seconds)
{
    const struct calibration_measure *measures = calibration->measures;
    bind(
        limit, LIMIT_RAYS,
        seconds_add(least_seconds(result->rays, measures[CALIBRATION_rays_primary].rate),
                    least_seconds(result->occlusion_rays, measures[CALIBRATION_rays_shadow].rate)));
    bind(limit, LIMIT_LOOKUPS,
         least_seconds(
             result->lookups,
             measures[is_without_gl(result) ? CALIBRATION_lookups_near : CALIBRATION_lookups_shader]
                 .rate));
    bind(limit, LIMIT_SAMPLES,
         least_seconds(result->samples, measures[CALIBRATION_samples_bilinear].rate));
    struct interval memory = least_seconds(result->moved_bytes, limit_memory_rate(calibration));
    limit->cached = memory.value > frame_seconds;
    if (!limit->cached)
        bind(limit, LIMIT_MEMORY, memory);
}

struct limit limit_of(const struct calibration *calibration, const struct result *result,
                      struct interval frame_seconds)
{
    struct limit limit = limit_nothing();
    if (!calibration)
        return limit;
    const struct calibration_measure *measures = calibration->measures;
    double pixels = (double)result->cell.width_px * result->cell.height_px;
    if (result->primitives > 0)
        limit.fragments_per_triangle = fmax(0, result->fragments - pixels) / result->primitives;
    struct interval triangles = least_seconds(
        result->primitives, limit_triangle_rate(calibration, limit.fragments_per_triangle));
    limit.mixed = triangles.value > frame_seconds.value;
    if (limit.mixed)
        triangles = least_seconds(result->primitives, measures[CALIBRATION_triangles_culled].rate);
    bind(&limit, LIMIT_CALLS,
         least_seconds(result->draw_calls, measures[CALIBRATION_calls_bare].rate));
    bind(&limit, LIMIT_VERTICES,
         least_seconds(result->vertices, measures[CALIBRATION_vertices].rate));
    bind(&limit, LIMIT_TRIANGLES, triangles);
    bind(&limit, LIMIT_FILL,
         least_seconds(result->fragments, measures[CALIBRATION_fill_opaque].rate));
    bind_tally(&limit, calibration, result, frame_seconds.value);
    limit_reach(&limit, frame_seconds);
    return limit;
}

/* The calibration of this kind that was made last before the round, else the first after it. */
static const struct calibration *calibration_of_round(const struct run *run,
                                                      const struct calibration *kind, int round)
{
    const struct calibration *best = NULL;
    for (size_t i = 0; i < run->measured_count; i++) {
        const struct calibration *one = &run->measured[i];
        if (!calibration_same_kind(one, kind))
            continue;
        bool before = one->round <= round, best_before = best && best->round <= round;
        if (!best || (before && (!best_before || one->round > best->round)) ||
            (!before && !best_before && one->round < best->round))
            best = one;
    }
    return best;
}

struct limit limit_of_cell(const struct run *run, const struct result *const *repetitions,
                           size_t count, const struct result *counted,
                           struct interval frame_seconds)
{
    const struct calibration *kind = limit_calibration(run, counted);
    if (!kind || !count)
        return limit_of(NULL, counted, frame_seconds);
    struct arena *arena = arena_create(0);
    struct calibration_part *parts = ARENA_ARRAY(arena, struct calibration_part, count);
    size_t kept = 0;
    for (size_t i = 0; i < count; i++) {
        const struct result *one = repetitions[i];
        double scale = stats_median(one->frame_seconds, one->frames_count) / frame_seconds.value;
        if (scale > 0)
            parts[kept++] =
                (struct calibration_part){calibration_of_round(run, kind, one->repetition), scale};
    }
    struct calibration paired = kept ? calibration_merge(arena, parts, kept) : *kind;
    struct limit limit = limit_of(&paired, counted, frame_seconds);
    arena_destroy(arena);
    return limit;
}

struct limit limit_of_tracing(const struct run *run, const struct tracing *tracing)
{
    struct limit limit = limit_nothing();
    const struct calibration *calibration = NULL;
    for (size_t i = 0; i < run->calibrations_count && !calibration; i++)
        if (run->calibrations[i].threads == tracing->threads)
            calibration = &run->calibrations[i];
    if (!calibration)
        return limit;
    const struct calibration_measure *measures = calibration->measures;
    struct interval primary =
        least_seconds(tracing->primary_rays, measures[CALIBRATION_rays_primary].rate);
    struct interval shadow =
        least_seconds(tracing->shadow_rays, measures[CALIBRATION_rays_shadow].rate);
    struct interval ambient =
        least_seconds(tracing->occlusion_rays, measures[CALIBRATION_rays_ambient].rate);
    bind(&limit, LIMIT_RAYS, seconds_add(primary, seconds_add(shadow, ambient)));
    double seconds = tracing->trace_seconds;
    limit_reach(&limit, (struct interval){seconds, seconds, seconds});
    return limit;
}
