/* How fast is the reference against a bare Embree loop over the same camera rays, and how soon is
 * it at a given error?
 *
 *     bench_embree [scene [trees [samples [rounds]]]]      poplar-forest 1000 16 15
 *
 * The bare loop reads sample positions made beforehand, traces packets of 16, casts one shadow ray
 * a hit towards the sun in full packets, and counts; it shades nothing. Both take turns, in random
 * order; the ratio is that of pairs. */
#include "base/clock.h"
#include "base/random.h"
#include "stats/stats.h"
#include "truth/reference_parts.h"
#include "truth/sampler.h"

#include <math.h>
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>

#define ROUNDS_LIMIT 1000

struct bench {
    struct scene *scene;
    struct view view;
    struct traced_scene traced;
    int samples, threads;
    float (*points)[2]; /* pixels x samples */
};

/* Sun rays of one thread, traced sixteen at a time. */
struct shadow_lanes {
    struct embree_packet packet;
    int count;
    double traced, lit;
};

static void shadows_trace(const struct bench *bench, struct shadow_lanes *lanes)
{
    if (!lanes->count)
        return;
    uint32_t blocked = embree_occluded(bench->traced.embree, &lanes->packet, lanes->count);
    lanes->traced += lanes->count;
    lanes->lit += lanes->count - __builtin_popcount(blocked);
    lanes->count = 0;
}

/* From a little before the hit towards the sun. */
static void shadow_push(const struct bench *bench, const struct embree_packet *seen, int lane,
                        struct shadow_lanes *lanes)
{
    int at = lanes->count++;
    for (int axis = 0; axis < 3; axis++) {
        lanes->packet.origin[axis][at] =
            seen->origin[axis][lane] + 0.99999f * seen->far[lane] * seen->direction[axis][lane];
        lanes->packet.direction[axis][at] = bench->view.sun_direction[axis];
    }
    lanes->packet.near[at] = 0;
    lanes->packet.far[at] = INFINITY;
    if (lanes->count == EMBREE_LANES)
        shadows_trace(bench, lanes);
}

static void packet_bare(const struct bench *bench, struct embree_packet *seen,
                        struct shadow_lanes *lanes)
{
    embree_intersect(bench->traced.embree, seen, EMBREE_LANES, false);
    for (int lane = 0; lane < EMBREE_LANES; lane++)
        if (seen->geometry[lane] != EMBREE_NONE)
            shadow_push(bench, seen, lane, lanes);
}

static void tile_bare(const struct bench *bench, int tile, struct embree_packet *seen,
                      struct shadow_lanes *lanes)
{
    const struct view *view = &bench->view;
    int columns = (view->width_px + TILE_SIDE - 1) / TILE_SIDE, lane = 0;
    int left = tile % columns * TILE_SIDE, top = tile / columns * TILE_SIDE;
    for (int y = top; y < top + TILE_SIDE && y < view->height_px; y++)
        for (int x = left; x < left + TILE_SIDE && x < view->width_px; x++) {
            size_t pixel = (size_t)y * (size_t)view->width_px + (size_t)x;
            for (int k = 0; k < bench->samples; k++) {
                const float *point = bench->points[pixel * (size_t)bench->samples + (size_t)k];
                float direction[3];
                view_ray(view, (float)x + point[0], (float)y + point[1], direction);
                for (int axis = 0; axis < 3; axis++) {
                    seen->origin[axis][lane] = view->eye_m[axis];
                    seen->direction[axis][lane] = direction[axis];
                }
                seen->near[lane] = view->near_m;
                seen->far[lane++] = INFINITY;
                if (lane == EMBREE_LANES) {
                    packet_bare(bench, seen, lanes);
                    lane = 0;
                }
            }
        }
    shadows_trace(bench, lanes);
}

/* Seconds of the bare loop; shadow rays traced. */
static double bare_seconds(const struct bench *bench, double *shadow_rays)
{
    int tiles = ((bench->view.width_px + TILE_SIDE - 1) / TILE_SIDE) *
                ((bench->view.height_px + TILE_SIDE - 1) / TILE_SIDE);
    double traced = 0, lit = 0, start = clock_wall_seconds();
#pragma omp parallel num_threads(bench->threads) reduction(+ : traced, lit)
    {
        struct shadow_lanes lanes = {.count = 0};
        struct embree_packet seen;
#pragma omp for schedule(dynamic, 1)
        for (int tile = 0; tile < tiles; tile++)
            tile_bare(bench, tile, &seen, &lanes);
        traced += lanes.traced;
        lit += lanes.lit;
    }
    *shadow_rays = traced;
    return lit >= 0 ? clock_wall_seconds() - start : 0;
}

static void points_make(struct arena *arena, struct bench *bench)
{
    uint32_t pixels = (uint32_t)(bench->view.width_px * bench->view.height_px);
    uint32_t samples = (uint32_t)bench->samples;
    bench->points = arena_alloc(arena, (size_t)pixels * samples, sizeof *bench->points);
    for (uint32_t pixel = 0; pixel < pixels; pixel++)
        for (uint32_t k = 0; k < samples; k++) {
            uint32_t each = samples / REFERENCE_REPLICATES;
            struct sampler sampler = sampler_create(0, pixel, k / each, SAMPLER_PIXEL);
            sampler_point(&sampler, k % each, bench->points[(size_t)pixel * samples + k]);
        }
}

static enum status reference_seconds(const struct bench *bench, struct reference_options options,
                                     struct reference_stats *stats, struct error *error)
{
    struct arena *arena = arena_create(0);
    struct frame *frame;
    options.effects = EFFECT_SUN_SHADOWS | EFFECT_TWO_SIDED;
    options.threads = bench->threads;
    options.quiet = true;
    enum status status =
        reference_render(arena, bench->scene, &bench->view, &options, &frame, stats, error);
    arena_destroy(arena);
    return status;
}

static enum status bench_ratio(const struct bench *bench, int rounds, struct error *error)
{
    double ours[ROUNDS_LIMIT], bare[ROUNDS_LIMIT], shadow_rays = 0;
    double samples = (double)bench->samples * bench->view.width_px * bench->view.height_px;
    struct reference_options options = {.samples_min = bench->samples,
                                        .samples_max = bench->samples};
    struct reference_stats stats = {0};
    struct random random = random_seed(1, 1);
    for (int round = -1; round < rounds; round++) { /* the first one warms up */
        bool bare_first = random_u32(&random) & 1;
        double seconds = bare_first ? bare_seconds(bench, &shadow_rays) : 0;
        enum status status = reference_seconds(bench, options, &stats, error);
        if (status)
            return status;
        if (!bare_first)
            seconds = bare_seconds(bench, &shadow_rays);
        if (round >= 0) {
            ours[round] = samples / stats.trace_seconds / 1e6;
            bare[round] = samples / seconds / 1e6;
        }
    }
    struct interval a = stats_median_interval(ours, (size_t)rounds, 1);
    struct interval b = stats_median_interval(bare, (size_t)rounds, 1);
    struct interval ratio = stats_ratio_interval(ours, bare, (size_t)rounds, 1);
    printf("reference  %6.2f [%.2f, %.2f] million samples/s, %.2f sun rays a sample\n", a.value,
           a.low, a.high, stats.shadow_rays / samples);
    printf("bare loop  %6.2f [%.2f, %.2f] million samples/s, %.2f sun rays a sample\n", b.value,
           b.low, b.high, shadow_rays / samples);
    printf("ratio      %6.3f [%.3f, %.3f] of %d pairs\n", ratio.value, ratio.low, ratio.high,
           rounds);
    return STATUS_OK;
}

static enum status bench_error(const struct bench *bench, struct error *error)
{
    static const float targets[] = {0.0338f, 0.0152f, 0.0068f};
    for (size_t i = 0; i < sizeof targets / sizeof *targets; i++) {
        struct reference_options options = {.standard_error = targets[i], .samples_min = 8};
        struct reference_stats stats;
        enum status status = reference_seconds(bench, options, &stats, error);
        if (status)
            return status;
        printf("error %.4f  %6.2f s, %.1f samples a pixel, stated error %.5f\n", (double)targets[i],
               stats.trace_seconds, stats.samples / bench->view.width_px / bench->view.height_px,
               (double)stats.standard_error);
    }
    return STATUS_OK;
}

static enum status bench_run(struct arena *arena, int argc, char **argv, struct bench *bench,
                             struct error *error)
{
    struct scene_request request = {.trees = argc > 2 ? strtoul(argv[2], NULL, 10) : 1000};
    int rounds = argc > 4 ? atoi(argv[4]) : 15;
    bench->samples = argc > 3 ? atoi(argv[3]) : 16;
    bench->threads = clock_cpu_count();
    if (rounds < 1 || rounds > ROUNDS_LIMIT || bench->samples < REFERENCE_REPLICATES ||
        bench->samples & (bench->samples - 1))
        return error_set(error, STATUS_USAGE, "rounds: 1..%d; samples: a power of two from %d on",
                         ROUNDS_LIMIT, REFERENCE_REPLICATES);
    enum status status =
        scene_load(arena, argc > 1 ? argv[1] : "poplar-forest", &request, &bench->scene, error);
    if (status)
        return status;
    view_at(bench->scene, 0, &bench->view);
    double start = clock_wall_seconds();
    status = traced_scene_build(arena, bench->scene, bench->threads, &bench->traced, error);
    if (status)
        return status;
    printf("%s, %zu trees, %d x %d px, %d samples, %d threads, %s: built in %.2f s\n",
           bench->scene->name, bench->scene->instances_count, bench->view.width_px,
           bench->view.height_px, bench->samples, bench->threads, embree_version(),
           clock_wall_seconds() - start);
    points_make(arena, bench);
    status = bench_ratio(bench, rounds, error);
    return status ? status : bench_error(bench, error);
}

int main(int argc, char **argv)
{
    struct arena *arena = arena_create(0);
    struct bench bench = {0};
    struct error error = {0};
    enum status status = bench_run(arena, argc, argv, &bench, &error);
    embree_destroy(bench.traced.embree);
    arena_destroy(arena);
    if (status)
        fprintf(stderr, "%s\n", error.text);
    return status;
}
