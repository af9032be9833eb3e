/* Rays that march through voxels, by the CPU or by OpenGL: settings beside each other, with errors.
 *
 *     bench_march [method [scene [trees [rounds [samples [options...]]]]]]
 *     bench_march ray-texels poplar-forest 1000 15 64 shadows=0 shadows=0,step=1.5
 *
 * Takes the settings by turns, round by round. A line a setting: least and median milliseconds a
 * frame, least of the processors' time, the ratio to the first's, lookups, and the error by the
 * pixel and by boxes of 8 x 8 pixels against a traced picture (samples 0: none is made) with the
 * effects of the setting. Run it on an idle machine. */
#include "base/clock.h"
#include "method/method.h"
#include "stats/stats.h"
#include "truth/reference.h"

#include "bench_error.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { ROUNDS_LIMIT = 199, WAYS_LIMIT = 16 };

struct bench {
    struct arena *arena;
    struct scene *scene;
    struct gl *gl; /* NULL: the method draws on the CPU */
    const struct method *method;
    struct view view;
    struct target target;
    struct frame *frame;
    int rounds, samples, threads;
};

struct way {
    const char *options;
    struct workspace workspace;
    void *state;
    double seconds[ROUNDS_LIMIT], cpu_seconds; /* least of a frame */
};

static enum status way_open(const struct bench *bench, struct way *way, struct error *error)
{
    const struct method *method = bench->method;
    void *options = arena_alloc(bench->arena, 1, method->options_size);
    options_default(method->options, options);
    enum status status = options_parse(method->options, way->options, options, error);
    way->workspace = (struct workspace){
        .arena = bench->arena,
        .gl = bench->gl,
        .error = error,
        .effects = method_effects(method, options, bench->scene->effects),
        .lod = LOD_AUTO,
        .format = TARGET_RGBA16F,
        .threads = bench->threads,
    };
    return status ? status : method->prepare(&way->workspace, bench->scene, options, &way->state);
}

static double way_draw(struct bench *bench, struct way *way)
{
    const double start = clock_wall_seconds(), cpu_start = clock_cpu_seconds();
    bench->method->draw(&way->workspace, way->state, &bench->view, &bench->target);
    if (bench->gl)
        bench->gl->Finish();
    way->cpu_seconds = fmin(way->cpu_seconds, clock_cpu_seconds() - cpu_start);
    return clock_wall_seconds() - start;
}

static enum status way_say(struct bench *bench, struct way *way, const struct way *first,
                           struct error *error)
{
    const size_t rounds = (size_t)bench->rounds;
    double least = way->seconds[0];
    for (size_t k = 1; k < rounds; k++)
        least = fmin(least, way->seconds[k]);
    struct interval ratio = stats_ratio_interval(first->seconds, way->seconds, rounds, 1);
    printf("%-40s least %8.2f median %8.2f cpu %8.2f ms  ratio %.3f [%.3f, %.3f]  lookups %.0f",
           way->options, 1e3 * least, 1e3 * stats_median(way->seconds, rounds),
           1e3 * way->cpu_seconds, ratio.value, ratio.low, ratio.high,
           (double)way->workspace.tally.lookups / (double)(bench->rounds + 1));
    if (bench->samples > 0) {
        struct reference_options options = {.effects = way->workspace.effects,
                                            .samples_min = bench->samples,
                                            .samples_max = bench->samples,
                                            .threads = bench->threads};
        struct reference_stats stats;
        struct frame *truth;
        enum status status = reference_cached(bench->arena, bench->scene, &bench->view, &options,
                                              &truth, &stats, error);
        if (status)
            return status;
        way_draw(bench, way);
        if (bench->gl)
            gl_target_read(bench->gl, &bench->target, bench->frame->rgba);
        printf("  RMSE %.5f, 8 x 8 %.5f", rmse(bench->frame, truth, 1),
               rmse(bench->frame, truth, 8));
    }
    printf("\n");
    return STATUS_OK;
}

static enum status bench_open(struct bench *bench, int argc, char **argv, struct error *error)
{
    struct scene_request request = {.trees = argc > 3 ? strtoul(argv[3], NULL, 10) : 1000,
                                    .seed = 1};
    bench->rounds = argc > 4 ? atoi(argv[4]) : 15;
    bench->samples = argc > 5 ? atoi(argv[5]) : 0;
    bench->threads = clock_cpu_count();
    if (bench->rounds < 1 || bench->rounds > ROUNDS_LIMIT)
        return error_set(error, STATUS_USAGE, "rounds: 1..%d", ROUNDS_LIMIT);
    enum status status = method_find(argc > 1 ? argv[1] : "ray-texels", &bench->method, error);
    if (!status)
        status = scene_load(bench->arena, argc > 2 ? argv[2] : "poplar-forest", &request,
                            &bench->scene, error);
    if (status)
        return status;
    view_at(bench->scene, 0, &bench->view);
    const int width_px = bench->view.width_px, height_px = bench->view.height_px;
    bench->frame = frame_create(bench->arena, width_px, height_px, false);
    bench->target = (struct target){.width_px = width_px,
                                    .height_px = height_px,
                                    .format = TARGET_RGBA32F,
                                    .pixels = bench->frame->rgba};
    if (bench->method->traits & TRAIT_CPU)
        return STATUS_OK;
    status = gl_context_create(NULL, bench->threads, &bench->gl, error);
    return status
               ? status
               : gl_target(bench->gl, width_px, height_px, TARGET_RGBA16F, &bench->target, error);
}

static enum status bench_run(struct bench *bench, int argc, char **argv, struct error *error)
{
    static struct way ways[WAYS_LIMIT];
    int count = argc > 6 ? argc - 6 : 1;
    count = count < WAYS_LIMIT ? count : WAYS_LIMIT;
    enum status status = bench_open(bench, argc, argv, error);
    for (int k = 0; k < count && !status; k++) {
        ways[k].options = argc > 6 + k ? argv[6 + k] : "";
        ways[k].cpu_seconds = INFINITY;
        status = way_open(bench, &ways[k], error);
        if (!status)
            way_draw(bench, &ways[k]); /* warm */
    }
    for (int round = 0; round < bench->rounds && !status; round++)
        for (int k = 0; k < count; k++)
            ways[k].seconds[round] = way_draw(bench, &ways[k]);
    for (int k = 0; k < count && !status; k++)
        status = way_say(bench, &ways[k], &ways[0], error);
    return status;
}

int main(int argc, char **argv)
{
    struct error error = {0};
    struct bench bench = {.arena = arena_create(0)};
    enum status status = bench_run(&bench, argc, argv, &error);
    if (status)
        fprintf(stderr, "bench_march: %s\n", error.text);
    if (bench.gl)
        gl_context_destroy(bench.gl);
    arena_destroy(bench.arena);
    return (int)status;
}
