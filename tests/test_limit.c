/* Limits by hand arithmetic on a machine of round figures, and in the report. */
#include "round_machine.h"

#include "base/file.h"
#include "report/report.h"
#include "results/limit.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static double triangle_rate(double fragments)
{
    struct calibration machine = round_machine();
    struct interval rate = limit_triangle_rate(&machine, fragments);
    if (isnan(rate.high))
        return NAN;
    check_near(rate.low / rate.high, 0.25, 1e-9);
    check_near(rate.value / rate.high, 0.5, 1e-9);
    return rate.high;
}

static void test_limit__a_triangle_s_rate_goes_with_its_size(void **state)
{
    (void)state;
    check_near(triangle_rate(0), 50e6, 1);
    /* Half of them meet two fragments each: 0.02 and 0.1 us. */
    check_near(triangle_rate(1), 1e6 / 0.06, 1);
    check_near(triangle_rate(2), 10e6, 1);
    check_near(triangle_rate(16), 4e6, 1);
    check_near(triangle_rate(32), sqrt(4e6 * 2e6), 1); /* midway in logarithms */
    check_near(triangle_rate(512), 0.5e6, 1);
    check_near(triangle_rate(240000), 500e6 / 240000, 1e-3);
    check_near(triangle_rate(480000), 500e6 / 480000, 1e-3);
    assert_true(isnan(triangle_rate(NAN)));
}

/* A cell of 800 x 600 px that used so much of everything, in a frame of so many seconds. */
static struct limit limit_with(double calls, double vertices, double primitives, double fragments,
                               double frame_seconds)
{
    struct calibration machine = round_machine();
    struct cell cell = {.width_px = 800, .height_px = 600};
    struct result result;
    result_init(&result, &cell, 0);
    result.draw_calls = calls;
    result.vertices = vertices;
    result.primitives = primitives;
    result.fragments = fragments;
    return limit_of(&machine, &result,
                    (struct interval){frame_seconds, 0.5 * frame_seconds, 4 * frame_seconds});
}

static void check_limit(struct limit limit, enum limit_resource resource, double seconds,
                        double fraction)
{
    assert_int_equal(limit.resource, resource);
    check_near(limit.seconds.value, seconds, 1e-9);
    check_near(limit.fraction.value, fraction, 1e-9);
    /* The frame takes half to four times its median; the median rates are half the best. */
    check_near(limit.fraction.low, fraction / 4, 1e-9);
    check_near(limit.fraction.high, fraction * 2 * 2, 1e-9);
}

static void test_limit__bounds_are_counts_over_rates(void **state)
{
    (void)state;
    /* 20,000 calls at 2 M/s: 10 ms. 15,000 vertices at 150 M/s: 0.1 ms. 5,000 primitives of
     * (980,000 - 480,000) / 5,000 = 100 fragments: between 2 and 0.5 M/s. 980,000 / 500 M/s. */
    struct limit limit = limit_with(20000, 15000, 5000, 980000, 0.04);
    check_limit(limit, LIMIT_CALLS, 0.010, 0.25);
    check_near(limit.fragments_per_triangle, 100, 1e-9);
    check_near(limit.bounds[LIMIT_VERTICES], 1e-4, 1e-9);
    check_near(limit.bounds[LIMIT_FILL], 1.96e-3, 1e-9);
    assert_true(limit.bounds[LIMIT_TRIANGLES] > 5000 / 2e6);
    assert_true(limit.bounds[LIMIT_TRIANGLES] < 5000 / 0.5e6);
    check_limit(limit_with(2, 6e6, 1000, 480000, 0.05), LIMIT_VERTICES, 0.04, 0.8);
    /* 20,000 primitives of 16 fragments at 4 M/s. */
    check_limit(limit_with(2, 40000, 20000, 480000 + 320000, 0.01), LIMIT_TRIANGLES, 0.005, 0.5);
    check_limit(limit_with(2, 8, 4, 5e6, 0.02), LIMIT_FILL, 0.01, 0.5);
}

static void test_limit__a_frame_that_mixes_sizes_is_held_against_culled_triangles(void **state)
{
    (void)state;
    struct limit limit = limit_with(2, 40000, 20000, 480000 + 320000, 0.004);
    assert_true(limit.mixed);
    check_near(limit.bounds[LIMIT_TRIANGLES], 20000 / 50e6, 1e-9);
    check_limit(limit, LIMIT_FILL, 1.6e-3, 0.4);
    assert_false(limit_with(2, 40000, 20000, 480000 + 320000, 0.006).mixed);
}

static void test_limit__what_was_not_counted_bounds_nothing(void **state)
{
    (void)state;
    struct limit limit = limit_with(20000, NAN, NAN, NAN, 0.02);
    check_limit(limit, LIMIT_CALLS, 0.010, 0.5);
    assert_true(isnan(limit.bounds[LIMIT_FILL]));
    limit = limit_with(NAN, NAN, NAN, NAN, 0.02);
    assert_int_equal(limit.resource, LIMIT_UNKNOWN);
    assert_true(isnan(limit.fraction.value));
    struct result result = {.cell = {.width_px = 8, .height_px = 6}};
    limit = limit_of(NULL, &result, (struct interval){1, 1, 1});
    assert_int_equal(limit.resource, LIMIT_UNKNOWN);
    assert_true(isnan(limit.seconds.value));
}

/* A cell without OpenGL that counted so much, in a frame of so many seconds. */
static struct limit limit_counted(double rays, double occlusion_rays, double lookups, double bytes,
                                  double frame_seconds)
{
    struct calibration machine = round_machine();
    struct cell cell = {.width_px = 800, .height_px = 600};
    struct result result;
    result_init(&result, &cell, 0);
    result.renderer = "cpu";
    result.rays = rays;
    result.occlusion_rays = occlusion_rays;
    result.lookups = lookups;
    result.moved_bytes = bytes;
    return limit_of(&machine, &result,
                    (struct interval){frame_seconds, 0.5 * frame_seconds, 4 * frame_seconds});
}

static void test_limit__a_cell_without_opengl_is_bound_by_what_it_counted(void **state)
{
    (void)state;
    /* A ray a pixel at 10 M/s: 48 ms; 120,000 to the sun at 5 M/s: 24 ms more. */
    check_limit(limit_counted(480000, NAN, NAN, 7.68e6, 0.096), LIMIT_RAYS, 0.048, 0.5);
    check_limit(limit_counted(480000, 120000, NAN, 7.68e6, 0.096), LIMIT_RAYS, 0.072, 0.75);
    check_limit(limit_counted(NAN, 120000, NAN, 7.68e6, 0.096), LIMIT_RAYS, 0.024, 0.25);
    /* 20 million at 2 G/s; the picture's 7.68 MB at 20 GB/s, the fastest of three. */
    struct limit limit = limit_counted(NAN, NAN, 20e6, 7.68e6, 0.04);
    check_limit(limit, LIMIT_LOOKUPS, 0.010, 0.25);
    check_near(limit.bounds[LIMIT_MEMORY], 7.68e6 / 20e9, 1e-12);
    assert_true(isnan(limit.bounds[LIMIT_RAYS]) && isnan(limit.bounds[LIMIT_FILL]));
    check_limit(limit_counted(NAN, NAN, 20e6, 400e6, 0.04), LIMIT_MEMORY, 0.020, 0.5);
}

static void test_limit__a_shader_s_lookups_and_samples_go_by_its_own_rates(void **state)
{
    (void)state;
    struct calibration machine = round_machine();
    struct cell cell = {.width_px = 800, .height_px = 600};
    struct result result;
    result_init(&result, &cell, 0);
    result.renderer = "round";
    result.lookups = 20e6; /* at 1 G/s; the CPU has 2 G/s */
    result.samples = 2e6;  /* at 200 M/s */
    struct interval seconds = {0.04, 0.02, 0.16};
    check_limit(limit_of(&machine, &result, seconds), LIMIT_LOOKUPS, 0.02, 0.5);
    check_near(limit_of(&machine, &result, seconds).bounds[LIMIT_SAMPLES], 0.01, 1e-12);
    result.samples = 6e6;
    check_limit(limit_of(&machine, &result, seconds), LIMIT_SAMPLES, 0.03, 0.75);
}

static void test_limit__a_frame_faster_than_its_bytes_found_them_in_caches(void **state)
{
    (void)state;
    struct limit limit = limit_counted(NAN, NAN, 20e6, 400e6, 0.019);
    assert_true(limit.cached && isnan(limit.bounds[LIMIT_MEMORY]));
    assert_int_equal(limit.resource, LIMIT_LOOKUPS);
    assert_false(limit_counted(NAN, NAN, 20e6, 400e6, 0.021).cached);
}

static void test_limit__is_told_by_a_calibration_of_the_same_kind(void **state)
{
    (void)state;
    struct calibration all[] = {round_machine(), round_machine(), round_machine(), round_machine(),
                                round_machine()};
    all[1].format = TARGET_RGBA16F;
    all[2].threads = 3;
    all[3].renderer = "square";
    all[4].width_px = 200;
    struct run run = {.calibrations_count = 5, .calibrations = all};
    struct result result = {.cell = {.width_px = 1000, .height_px = 600, .format = TARGET_RGBA8},
                            .threads = 2,
                            .renderer = "round"};
    assert_ptr_equal(limit_calibration(&run, &result), &all[0]);
    result.cell.width_px = 100;
    assert_ptr_equal(limit_calibration(&run, &result), &all[4]);
    result.threads = 3;
    assert_ptr_equal(limit_calibration(&run, &result), &all[2]);
    result.threads = 4;
    assert_null(limit_calibration(&run, &result));
    result.threads = 2;
    /* Rays and memory do not ask for a format or a renderer. */
    result.renderer = "cpu";
    result.cell.format = TARGET_RGBA32F;
    assert_non_null(limit_calibration(&run, &result));
    assert_int_equal(limit_calibration(&run, &result)->threads, 2);
    result.renderer = NULL;
    assert_null(limit_calibration(&run, &result));
}

static void test_limit__a_reference_is_held_against_the_rates_of_rays(void **state)
{
    (void)state;
    struct calibration machine = round_machine();
    struct run run = {.calibrations = &machine, .calibrations_count = 1};
    machine.measures[CALIBRATION_rays_ambient].rate = (struct interval){2e6, 1e6, 4e6};
    /* 20, 10 and 8 million at 10, 5 and 4 M/s: 2 s each; half of that at the median rates. */
    struct tracing tracing = {.threads = 2,
                              .trace_seconds = 8,
                              .primary_rays = 20e6,
                              .shadow_rays = 10e6,
                              .occlusion_rays = 8e6};
    struct limit limit = limit_of_tracing(&run, &tracing);
    assert_int_equal(limit.resource, LIMIT_RAYS);
    check_near(limit.seconds.value, 6, 1e-9);
    check_near(limit.fraction.value, 0.75, 1e-9);
    check_near(limit.fraction.high, 1.5, 1e-9);
    tracing.threads = 3;
    assert_true(isnan(limit_of_tracing(&run, &tracing).fraction.value));
}

/* Rates of the machine at so many times its best; and one repetition of 20,000 calls in a frame. */
struct round {
    int number;
    double speed, frame_seconds;
};

/* A run with a calibration in each round, and what its cell reaches. */
static struct limit limit_over(const struct round *rounds, size_t count, double cell_seconds)
{
    struct calibration measured[8];
    struct result results[8];
    const struct result *repetitions[8];
    struct cell cell = {.width_px = 800, .height_px = 600, .format = TARGET_RGBA8};
    double seconds[8];
    struct run run = {.measured = measured};
    for (size_t i = 0; i < count; i++) {
        measured[i] = round_machine();
        measured[i].round = rounds[i].number;
        for (size_t k = 0; k < CALIBRATION_COUNT; k++) {
            struct interval *rate = &measured[i].measures[k].rate;
            rate->value = rate->low = rate->high = rate->high * rounds[i].speed;
        }
        run.measured_count += rounds[i].speed > 0;
        result_init(&results[i], &cell, (int)i);
        results[i].threads = 2;
        results[i].renderer = "round";
        results[i].draw_calls = 20000;
        results[i].frames_count = 1;
        results[i].frame_seconds = &seconds[i];
        seconds[i] = rounds[i].frame_seconds;
        repetitions[i] = &results[i];
    }
    struct arena *arena = arena_create(0);
    calibrations_merge(arena, &run);
    struct limit limit = limit_of_cell(&run, repetitions, count, results,
                                       (struct interval){cell_seconds, cell_seconds, cell_seconds});
    arena_destroy(arena);
    return limit;
}

/* 10 ms at 2 M calls a second, of 40 ms; in the second and third round all takes thrice as long. */
static void test_limit__a_machine_that_drifts_leaves_the_fraction_alone(void **state)
{
    (void)state;
    const struct round drifting[] = {
        {0, 1, 0.04}, {1, 1.0 / 3, 0.12}, {2, 1.0 / 3, 0.12}, {3, 1, 0.04}, {4, 1, 0.04}};
    struct limit limit = limit_over(drifting, 5, 0.04);
    assert_int_equal(limit.resource, LIMIT_CALLS);
    check_near(limit.fraction.value, 0.25, 1e-12);
    check_near(limit.fraction.low, 0.25, 1e-12);
    check_near(limit.fraction.high, 0.25, 1e-12);
}

static void test_limit__a_round_without_calibration_takes_the_last_one_before_it(void **state)
{
    (void)state;
    /* Two calibrations, before rounds 0 and 2: repetitions 0 and 1 belong to the first. */
    const struct round rounds[] = {{0, 1, 0.04}, {2, 0.5, 0.04}, {9, 0, 0.08}, {9, 0, 0.08}};
    check_near(limit_over(rounds, 4, 0.08).fraction.value, 0.125 + 0.125, 1e-12);
    check_near(limit_over(rounds, 2, 0.04).fraction.value, 0.25, 1e-12);
    check_near(limit_over(rounds, 2, 0.04).fraction.high, 0.25, 1e-12); /* by the median rate */
    /* All that is known came later. */
    const struct round late[] = {{7, 0.5, 0.04}};
    check_near(limit_over(late, 1, 0.04).fraction.value, 0.5, 1e-12);
}

/* One cell of 20,000 triangles of 16 fragments each in 10 ms, on the machine of round figures. */
static void test_report__tables_and_roofline_tell_what_bounds_a_cell(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct error error = {0};
    char folder[] = "/tmp/treeline-calibrate-XXXXXX";
    assert_non_null(mkdtemp(folder));
    struct provenance provenance = {.cores = 2};
    struct calibration machine = round_machine();
    struct cell cell = {.name = "tiny/polygons/trees=7",
                        .scene = "tiny",
                        .method_name = "polygons",
                        .options = "",
                        .trees = 7,
                        .width_px = 800,
                        .height_px = 600};
    double seconds[] = {0.01, 0.01, 0.01};
    struct result result;
    struct run *run;
    result_init(&result, &cell, 0);
    result.threads = 2;
    result.renderer = "round";
    result.frames_count = 3;
    result.frame_seconds = seconds;
    result.draw_calls = 2;
    result.vertices = 40000;
    result.primitives = 20000;
    result.triangles = 30000;
    result.fragments = 480000 + 320000;
    assert_int_equal(run_open(folder, &provenance, false, &error), STATUS_OK);
    assert_int_equal(run_append_calibration(folder, &machine, &error), STATUS_OK);
    assert_int_equal(run_append(folder, &result, &error), STATUS_OK);
    /* 20 million rays at 10 M/s: 2 of 8 s; one of them cached. */
    for (int i = 0; i < 2; i++) {
        const struct tracing tracing = {.scene = "tiny",
                                        .trees = 7,
                                        .width_px = 800,
                                        .height_px = 600,
                                        .threads = 2,
                                        .trace_seconds = 8,
                                        .primary_rays = 20e6,
                                        .from_cache = i == 1};
        assert_int_equal(run_append_tracing(folder, &tracing, &error), STATUS_OK);
    }
    if (run_read(arena, folder, &run, &error) ||
        report_write_run(arena, run, arena_printf(arena, "%s/out", folder), &error))
        fail_msg("%s", error.text);
    /* 20,000 / 4 M/s of 10 ms; rates and roof by hand. */
    static const char check[] =
        "import csv\n"
        "row = next(csv.DictReader(open('tables/results.csv')))\n"
        "def near(key, value): assert abs(float(row[key]) / value - 1) < 1e-9, (key, row[key])\n"
        "near('limit_fraction', 0.5)\n"
        "near('trees_per_second', 700)\n"
        "near('triangles_per_second', 3e6)\n"
        "near('fragments_per_second', 8e7)\n"
        "assert row['bound_by'] == 'triangles'\n"
        "table = open('tables/results.md').read().splitlines()\n"
        "cells = dict(zip(*([c.strip() for c in table[i].split('|')] for i in (0, 2))))\n"
        "assert float(cells['of limit [%]']) == 50 and cells['bound by'] == 'triangles', cells\n"
        "assert len({line.count('|') for line in table}) == 1\n"
        "assert 'triangles [M/s]' in cells and 'rays [M/s]' not in cells, cells\n"
        "tex = [l for l in open('tables/results.tex') if l.rstrip().endswith(chr(92) * 2)]\n"
        "assert len({line.count('&') for line in tex}) == 1 and '& triangles &' in tex[1]\n"
        "blocks = open('plots/roofline-tiny-7.dat').read().split('\\n\\n\\n')\n"
        "point = [float(v) for v in blocks[-1].splitlines()[1].split('#')[0].split()]\n"
        "assert point == [16, 2, 2, 2], point\n"
        "roof = [[float(v) for v in l.split()] for l in blocks[0].splitlines()[1:]]\n"
        "above = min(y for x, y in roof if x <= 16)\n"
        "below = max(y for x, y in roof if x >= 16)\n"
        "assert below <= 4 <= above < 1.1 * below, (below, above)\n"
        /* 4 M/s of 20,000 triangles would give 200 frames a second, 100 are reached. */
        "blocks = open('plots/limit-tiny-7.dat').read().split('\\n\\n\\n')\n"
        "line = [[float(v) for v in l.split()] for l in blocks[0].splitlines()[1:]]\n"
        "assert len(line) > 9 and all(abs(x / y - 1) < 1e-6 for x, y in line), line\n"
        "point = blocks[-1].splitlines()[1].split('#')\n"
        "at = [float(v) for v in point[0].split()]\n"
        "assert abs(at[0] / 200 - 1) < 1e-6 and at[1:] == [100, 100, 100], at\n"
        "assert point[1].strip().endswith(': triangles'), point\n"
        "assert 'title \"polygons: triangles\"' in open('plots/limit-tiny-7.gp').read()\n"
        /* 20 million rays in 8 s, 2.6 for each of the 16 bytes of a pixel. */
        "blocks = open('plots/roofline-rays-tiny-7.dat').read().split('\\n\\n\\n')\n"
        "at = [float(v) for v in blocks[-1].splitlines()[1].split()]\n"
        "assert abs(at[0] / (20e6 / 16 / 480000) - 1) < 1e-6 and at[1] == 2.5, at\n"
        "roof = [[float(v) for v in l.split()] for l in blocks[0].splitlines()[1:]]\n"
        "assert all(abs(y / min(10, 0.02e6 * x) - 1) < 1e-6 for x, y in roof), roof\n"
        "assert roof[0][1] < 9 and abs(roof[-1][1] - 10) < 1e-6, (roof[0], roof[-1])\n"
        "import os\n"
        "assert not os.path.exists('plots/roofline-lookups-tiny-7.dat')\n"
        "page = open('index.html').read()\n"
        "import re\n"
        "row = page.split('ray-traced references cost')[1].split('<tbody>')[1].split('</tr>')[0]\n"
        "row = [re.sub('<[^>]*>', '', c) for c in row.split('</td>')][:-1]\n"
        "assert row[4:6] == ['2', '1'] and row[7] == '8 s', row\n"
        "assert float(row[9]) == 2.5 and float(row[10]) == 25, row\n"
        "assert 'id=\"limit\"' in page and 'aria-label=\"tiny, 7 trees\"' in page\n";
    assert_int_equal(
        file_write(arena_printf(arena, "%s/out/check.py", folder), check, strlen(check), &error),
        STATUS_OK);
    assert_int_equal(system(arena_printf(arena, "cd %s/out && python3 check.py", folder)), 0);
    assert_int_equal(system(arena_printf(arena, "rm -rf %s", folder)), 0);
    arena_destroy(arena);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_limit__a_triangle_s_rate_goes_with_its_size),
        cmocka_unit_test(test_limit__bounds_are_counts_over_rates),
        cmocka_unit_test(test_limit__a_frame_that_mixes_sizes_is_held_against_culled_triangles),
        cmocka_unit_test(test_limit__what_was_not_counted_bounds_nothing),
        cmocka_unit_test(test_limit__a_cell_without_opengl_is_bound_by_what_it_counted),
        cmocka_unit_test(test_limit__a_shader_s_lookups_and_samples_go_by_its_own_rates),
        cmocka_unit_test(test_limit__a_frame_faster_than_its_bytes_found_them_in_caches),
        cmocka_unit_test(test_limit__is_told_by_a_calibration_of_the_same_kind),
        cmocka_unit_test(test_limit__a_reference_is_held_against_the_rates_of_rays),
        cmocka_unit_test(test_limit__a_machine_that_drifts_leaves_the_fraction_alone),
        cmocka_unit_test(test_limit__a_round_without_calibration_takes_the_last_one_before_it),
        cmocka_unit_test(test_report__tables_and_roofline_tell_what_bounds_a_cell),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
