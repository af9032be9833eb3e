/* The calibration's order of things: benches, how long a pass is, turns, medians. */
#include "calibrate/calibrate.h"

#include "base/clock.h"
#include "calibrate/bench.h"

#include <math.h>
#include <stdio.h>

const struct calibration_info calibration_table[CALIBRATION_COUNT] = {
#define CALIBRATION_ROW(field, kind, unit, doc) {#field, CALIBRATION_##kind, unit, doc},
    CALIBRATION_LIST(CALIBRATION_ROW)
#undef CALIBRATION_ROW
};

const char *calibration_unit(enum calibration_kind kind, double *factor)
{
    static const struct {
        const char *unit;
        double factor;
    } units[] = {
        [CALIBRATION_FILL] = {"Mpix/s", 1e-6},      [CALIBRATION_TRIANGLES] = {"Mtri/s", 1e-6},
        [CALIBRATION_VERTICES] = {"Mvert/s", 1e-6}, [CALIBRATION_CALLS] = {"kcalls/s", 1e-3},
        [CALIBRATION_RAYS] = {"Mrays/s", 1e-6},     [CALIBRATION_LOOKUPS] = {"Mloads/s", 1e-6},
        [CALIBRATION_MEMORY] = {"GB/s", 1e-9},      [CALIBRATION_SAMPLES] = {"Msamp/s", 1e-6},
    };
    *factor = units[kind].factor;
    return units[kind].unit;
}

enum { REPEATS = 11, LOOPS_MAX = 1 << 16 };

static double pass_seconds(const struct work *work, size_t index, int loops)
{
    double start = clock_wall_seconds();
    work->pass(work->bench, (enum calibration_index)index, loops);
    return clock_wall_seconds() - start;
}

/* As many loops as fit into the slice; found by doubling, so that a short pass is not misjudged. */
static int loops_find(const struct work *work, size_t index, double slice_seconds)
{
    int loops = 1;
    double seconds = pass_seconds(work, index, loops);
    while (seconds < slice_seconds / 4 && loops < LOOPS_MAX) {
        loops *= 2;
        seconds = pass_seconds(work, index, loops);
    }
    double fit = loops * slice_seconds / fmax(seconds, 1e-9);
    return fit < 1 ? 1 : fit > LOOPS_MAX ? LOOPS_MAX : (int)fit;
}

/* Every work once a turn; the order is turned around every other time. */
static void turns_take(const struct work *works, double seconds, struct calibration *calibration)
{
    double rates[CALIBRATION_COUNT][REPEATS];
    int loops[CALIBRATION_COUNT];
    size_t able = 0;
    for (size_t i = 0; i < CALIBRATION_COUNT; i++)
        able += works[i].pass != NULL;
    /* Finding the loops takes about one and a half slices more. */
    double slice = seconds / ((REPEATS + 1.5) * (double)(able ? able : 1));
    for (size_t i = 0; i < CALIBRATION_COUNT; i++)
        loops[i] = works[i].pass ? loops_find(&works[i], i, slice) : 0;
    for (int turn = 0; turn < REPEATS; turn++)
        for (size_t k = 0; k < CALIBRATION_COUNT; k++) {
            size_t i = turn % 2 ? CALIBRATION_COUNT - 1 - k : k;
            if (loops[i])
                rates[i][turn] = works[i].count * loops[i] / pass_seconds(&works[i], i, loops[i]);
        }
    for (size_t i = 0; i < CALIBRATION_COUNT; i++) {
        struct calibration_measure *measure = &calibration->measures[i];
        measure->rate = (struct interval){NAN, NAN, NAN};
        measure->fragments_per_triangle = NAN;
        if (!loops[i])
            continue;
        measure->rate = stats_median_interval(rates[i], REPEATS, i);
        measure->fragments_per_triangle = works[i].fragments_per_triangle;
    }
}

/* The first "cpu MHz" of /proc/cpuinfo; NaN where the system does not say. */
static double core_ghz(void)
{
    FILE *file = fopen("/proc/cpuinfo", "re");
    char line[256];
    double mhz = NAN;
    while (file && isnan(mhz) && fgets(line, sizeof line, file))
        if (sscanf(line, "cpu MHz : %lf", &mhz) != 1 || !(mhz > 0))
            mhz = NAN;
    if (file)
        fclose(file);
    return mhz / 1000;
}

static int side_hold(int side_px)
{
    return side_px < CALIBRATE_SIDE_MIN   ? CALIBRATE_SIDE_MIN
           : side_px > CALIBRATE_SIDE_MAX ? CALIBRATE_SIDE_MAX
                                          : side_px;
}

struct calibrate_request calibrate_held(const struct calibrate_request *request)
{
    struct calibrate_request held = *request;
    held.threads = request->threads ? request->threads : clock_cpu_count();
    held.width_px = side_hold(request->width_px);
    held.height_px = side_hold(request->height_px);
    return held;
}

enum status calibrate_run(struct arena *arena, const struct calibrate_request *request,
                          struct calibration *calibration, struct error *error)
{
    double start = clock_wall_seconds();
    struct calibrate_request held = calibrate_held(request);
    *calibration = (struct calibration){.width_px = held.width_px,
                                        .height_px = held.height_px,
                                        .format = held.format,
                                        .threads = held.threads,
                                        .core_ghz = core_ghz(),
                                        .backend = "none",
                                        .renderer = "none"};
    struct work works[CALIBRATION_COUNT] = {{0}};
    struct arena *scratch = arena_create(0);
    struct memory_bench memory;
    struct gl_bench *gl = NULL;
    struct ray_bench *rays = NULL;
    struct error ray_error = {0};
    memory_bench_create(scratch, MEMORY_BENCH_VALUES, held.threads, &memory, works);
    enum status status = gl_bench_create(scratch, &held, &gl, works, error);
    enum status ray_status = ray_bench_create(scratch, held.threads, &rays, works, &ray_error);
    if (!status) {
        calibration->backend = arena_strdup(arena, gl_bench_gl(gl)->backend);
        calibration->renderer = arena_strdup(arena, gl_bench_gl(gl)->renderer);
    }
    if (!status || !ray_status)
        turns_take(works, held.seconds, calibration);
    if (!status)
        status = gl_check(gl_bench_gl(gl), "calibration", error);
    else if (!ray_status && status == STATUS_UNAVAILABLE && !request->backend)
        status = STATUS_OK; /* rays and memory alone */
    gl_bench_destroy(gl);
    ray_bench_destroy(rays);
    arena_destroy(scratch);
    calibration->seconds = clock_wall_seconds() - start;
    return status;
}
