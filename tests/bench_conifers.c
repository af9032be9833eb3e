/* Conifers: the fast way beside the straightforward one, and at equal error beside the tracer.
 *
 *     bench_conifers [scene [trees [rounds [parts [method options...]]]]]      pines 204 5 fnt
 *
 * Parts: f the fast way, n the straightforward one too, t the tracer. Several options: each of
 * them. Light is that which the method models, on both sides. The truth is a traced picture of many
 * samples; then the tracer's error and time at 4, 8, 16... samples a pixel, and from these the
 * samples and the time that it needs for the method's error, by a power law between two counts.
 * Run it on an idle machine. */
#include "base/clock.h"
#include "method/method.h"
#include "stats/stats.h"
#include "truth/reference.h"

#include "bench_error.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { ROUNDS_LIMIT = 99, TRUTH_SAMPLES = 256, STEPS = 5 };

struct bench {
    struct arena *arena;
    struct scene *scene;
    struct view view;
    unsigned effects;
    int threads;
};

struct way {
    const struct method *method;
    struct workspace workspace;
    void *state;
    struct frame *frame;
};

static enum status way_open(const struct bench *bench, const char *text, struct way *way,
                            struct error *error)
{
    enum status status = method_find("conifers", &way->method, error);
    if (status)
        return status;
    void *options = arena_alloc(bench->arena, 1, way->method->options_size);
    options_default(way->method->options, options);
    status = options_parse(way->method->options, text, options, error);
    way->workspace = (struct workspace){.arena = bench->arena,
                                        .error = error,
                                        .effects = bench->effects,
                                        .lod = LOD_AUTO,
                                        .threads = bench->threads};
    way->frame = frame_create(bench->arena, bench->view.width_px, bench->view.height_px, false);
    return status ? status
                  : way->method->prepare(&way->workspace, bench->scene, options, &way->state);
}

static double way_seconds(const struct bench *bench, struct way *way)
{
    struct target target = {.width_px = bench->view.width_px,
                            .height_px = bench->view.height_px,
                            .format = TARGET_RGBA32F,
                            .pixels = way->frame->rgba};
    const double start = clock_wall_seconds();
    way->method->draw(&way->workspace, way->state, &bench->view, &target);
    return clock_wall_seconds() - start;
}

static void seconds_say(const char *name, const double *seconds, int rounds)
{
    struct interval all = stats_median_interval(seconds, (size_t)rounds, 1);
    printf("%-10s %.4f s [%.4f, %.4f] of %d frames\n", name, all.value, all.low, all.high, rounds);
}

/* Median seconds of the fast way, NaN after an error. */
static double ways_compare(const struct bench *bench, const char *options, int rounds,
                           bool with_naive, struct way *fast, struct error *error)
{
    struct way naive;
    double times[2][ROUNDS_LIMIT];
    const char *more = arena_printf(bench->arena, "%s%spath=naive", options, *options ? "," : "");
    if (way_open(bench, options, fast, error) ||
        (with_naive && way_open(bench, more, &naive, error)))
        return NAN;
    printf("'%s': first frame, with the sun's light, %.3f s\n", options, way_seconds(bench, fast));
    if (with_naive)
        way_seconds(bench, &naive);
    for (int round = 0; round < rounds; round++) {
        times[0][round] = way_seconds(bench, fast);
        times[1][round] = with_naive ? way_seconds(bench, &naive) : 1;
    }
    seconds_say("fast", times[0], rounds);
    printf("strips     %.0f a frame\n",
           (double)fast->workspace.tally.lookups / (double)(rounds + 1));
    if (with_naive) {
        seconds_say("naive", times[1], rounds);
        struct interval ratio = stats_ratio_interval(times[1], times[0], (size_t)rounds, 1);
        printf("ratio      %.2f [%.2f, %.2f]; the pictures differ by %.2g RMSE\n", ratio.value,
               ratio.low, ratio.high, rmse(fast->frame, naive.frame, 1));
    }
    return stats_median(times[0], (size_t)rounds);
}

/* Samples, seconds and errors of the tracer, one row a step. */
static enum status tracer_rows(const struct bench *bench, const struct frame *truth,
                               double rows[STEPS][4], struct error *error)
{
    for (int step = 0; step < STEPS; step++) {
        struct arena *arena = arena_create(0);
        struct reference_options options = {.effects = bench->effects,
                                            .samples_min = 4 << step,
                                            .samples_max = 4 << step,
                                            .threads = bench->threads,
                                            .seed = 7,
                                            .quiet = true};
        struct reference_stats stats;
        struct frame *frame;
        enum status status =
            reference_render(arena, bench->scene, &bench->view, &options, &frame, &stats, error);
        if (status)
            return status;
        rows[step][0] = 4 << step;
        rows[step][1] = stats.trace_seconds;
        rows[step][2] = rmse(frame, truth, 1);
        rows[step][3] = rmse(frame, truth, 4);
        printf("tracer %4d samples  %7.3f s, RMSE %.5f, of 4 x 4 pixels %.5f\n", 4 << step,
               rows[step][1], rows[step][2], rows[step][3]);
        arena_destroy(arena);
    }
    return STATUS_OK;
}

/* Where the error of a column is that of the method; below 4 samples by the first two rows' law. */
static void equal_error(double rows[STEPS][4], int column, double error, double seconds)
{
    int step = 0;
    while (step < STEPS - 2 && rows[step + 1][column] > error)
        step++;
    double slope =
        log(rows[step + 1][column] / rows[step][column]) / log(rows[step + 1][0] / rows[step][0]);
    double share = log(error / rows[step][column]) / slope / log(rows[step + 1][0] / rows[step][0]);
    double samples = rows[step][0] * pow(rows[step + 1][0] / rows[step][0], share);
    double traced = rows[step][1] * pow(rows[step + 1][1] / rows[step][1], share);
    printf("%s %.5f: the tracer needs %.1f samples, %.3f s: %.1f times the method's %.3f s\n",
           column == 2 ? "RMSE" : "RMSE of 4 x 4 pixels", error, samples, traced, traced / seconds,
           seconds);
}

static enum status bench_run(struct bench *bench, int argc, char **argv, struct error *error)
{
    struct scene_request request = {.trees = argc > 2 ? strtoul(argv[2], NULL, 10) : 204,
                                    .seed = 1};
    const int rounds = argc > 3 ? atoi(argv[3]) : 5;
    if (rounds < 1 || rounds > ROUNDS_LIMIT)
        return error_set(error, STATUS_USAGE, "rounds: 1..%d", ROUNDS_LIMIT);
    enum status status =
        scene_load(bench->arena, argc > 1 ? argv[1] : "pines", &request, &bench->scene, error);
    if (status)
        return status;
    const struct method *method;
    if ((status = method_find("conifers", &method, error)))
        return status;
    bench->effects = bench->scene->effects & method->traits;
    bench->threads = clock_cpu_count();
    view_at(bench->scene, 0, &bench->view);
    printf("%s, %zu trees, %d x %d px, %d threads\n", bench->scene->name,
           bench->scene->instances_count, bench->view.width_px, bench->view.height_px,
           bench->threads);
    const char *parts = argc > 4 ? argv[4] : "fnt";
    double rows[STEPS][4];
    struct frame *truth = NULL;
    struct reference_options most = {.effects = bench->effects,
                                     .samples_min = TRUTH_SAMPLES,
                                     .samples_max = TRUTH_SAMPLES,
                                     .threads = bench->threads,
                                     .quiet = true};
    struct reference_stats stats;
    if (strchr(parts, 't'))
        status = reference_cached(bench->arena, bench->scene, &bench->view, &most, &truth, &stats,
                                  error);
    if (!status && truth)
        status = tracer_rows(bench, truth, rows, error);
    for (int k = 5; (k < argc || k == 5) && !status; k++) {
        struct way fast;
        double seconds = ways_compare(bench, k < argc ? argv[k] : "", rounds,
                                      strchr(parts, 'n') != NULL, &fast, error);
        status = error->status;
        for (int column = 2; column < 4 && !status && truth; column++)
            equal_error(rows, column, rmse(fast.frame, truth, column == 2 ? 1 : 4), seconds);
    }
    return status;
}

int main(int argc, char **argv)
{
    struct error error = {0};
    struct bench bench = {.arena = arena_create(0)};
    enum status status = bench_run(&bench, argc, argv, &error);
    if (status)
        fprintf(stderr, "bench_conifers: %s\n", error.text);
    arena_destroy(bench.arena);
    return (int)status;
}
