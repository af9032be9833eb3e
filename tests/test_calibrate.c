/* The calibration: that the work it times is really done; its record; limits by hand arithmetic. */
#include "testing.h"

#include "base/file.h"
#include "calibrate/bench.h"
#include "results/calibration.h"
#include "results/limit.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static void check_near(double a, double b, double within)
{
    if (!(fabs(a - b) <= within))
        fail_msg("%.17g is not %.17g within %g", a, b, within);
}

enum { WIDTH = 300, HEIGHT = 140 };

/* A bench on a small float target, and what its picture holds. */
struct scenery {
    struct arena *arena;
    struct gl_bench *bench;
    struct work works[CALIBRATION_COUNT];
    float *rgba;
};

static void scenery_open(struct scenery *scenery)
{
    const struct calibrate_request request = {
        .threads = 2, .width_px = WIDTH, .height_px = HEIGHT, .format = TARGET_RGBA32F};
    struct error error = {0};
    memset(scenery, 0, sizeof *scenery);
    scenery->arena = arena_create(0);
    scenery->rgba = ARENA_ARRAY(scenery->arena, float, (size_t)4 * WIDTH * HEIGHT);
    if (gl_bench_create(scenery->arena, &request, &scenery->bench, scenery->works, &error))
        fail_msg("%s", error.text);
}

static void scenery_close(struct scenery *scenery)
{
    struct error error = {0};
    assert_int_equal(gl_check(gl_bench_gl(scenery->bench), "test", &error), STATUS_OK);
    gl_bench_destroy(scenery->bench);
    arena_destroy(scenery->arena);
}

/* Clears to the value, works, and reads; what the driver counted meanwhile. */
static struct gl_statistics work_see(struct scenery *scenery, enum calibration_index index,
                                     int loops, float before)
{
    struct gl *gl = gl_bench_gl(scenery->bench);
    const struct target *target = gl_bench_target(scenery->bench);
    const float clear[4] = {before, before, before, before};
    gl->ClearNamedFramebufferfv(target->framebuffer, GL_COLOR, 0, clear);
    gl_counters_reset(gl);
    gl_statistics_begin(gl);
    scenery->works[index].pass(scenery->works[index].bench, index, loops);
    struct gl_statistics statistics = gl_statistics_end(gl);
    gl_target_read(gl, target, scenery->rgba);
    return statistics;
}

/* OpenGL's pixel (x, y), y upward. */
static const float *pixel(const struct scenery *scenery, int x, int y)
{
    return scenery->rgba + 4 * ((size_t)(HEIGHT - 1 - y) * WIDTH + (size_t)x);
}

static void test_calibrate__blended_fill_adds_to_every_pixel_once_a_loop(void **state)
{
    (void)state;
    struct scenery scenery;
    scenery_open(&scenery);
    struct gl_statistics counted = work_see(&scenery, CALIBRATION_fill_blended, 3, 0);
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++)
            check_near(pixel(&scenery, x, y)[0], 3.0 / 255, 1e-6);
    if (gl_bench_gl(scenery.bench)->has_pipeline_statistics) {
        assert_int_equal(counted.primitives, 3 * 2);
        assert_true(counted.fragments >= 3 * WIDTH * HEIGHT);
        check_near(scenery.works[CALIBRATION_fill_blended].count, (double)counted.fragments / 3, 0);
    }
    work_see(&scenery, CALIBRATION_fill_opaque, 3, 7);
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++)
            check_near(pixel(&scenery, x, y)[0], 1.0 / 255, 1e-6);
    scenery_close(&scenery);
}

/* A texel of layer 1 is its place; at one texel a pixel, bilinear filtering at texels' centres
 * gives just them. */
static void test_calibrate__textured_fill_meets_every_texel(void **state)
{
    (void)state;
    struct scenery scenery;
    scenery_open(&scenery);
    work_see(&scenery, CALIBRATION_fill_textured, 1, 0);
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++) {
            check_near(pixel(&scenery, x, y)[0], (x % 256) / 255.0, 2e-3);
            check_near(pixel(&scenery, x, y)[1], (y % 256) / 255.0, 2e-3);
        }
    work_see(&scenery, CALIBRATION_fill_tested, 1, 7);
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++)
            check_near(pixel(&scenery, x, y)[1], x % 256 < 128 ? (y % 256) / 255.0 : 7, 2e-3);
    scenery_close(&scenery);
}

/* The region that whole cells of the size cover, filled and nothing else. */
static void check_covered(struct scenery *scenery, enum calibration_index index, int side_px,
                          int most)
{
    struct gl_statistics counted = work_see(scenery, index, 1, 7);
    const struct gl *gl = gl_bench_gl(scenery->bench);
    int columns = WIDTH / side_px, rows = HEIGHT / side_px;
    int cells = columns * rows < most ? columns * rows : most;
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++) {
            int column = x / side_px, row = y / side_px;
            bool inside = column < columns && row * columns + column < cells;
            check_near(pixel(scenery, x, y)[0], inside ? 1.0 / 255 : 7, 1e-6);
        }
    check_near((double)gl->counters.triangles, scenery->works[index].count, 0);
    if (gl->has_pipeline_statistics)
        assert_int_equal(counted.primitives, gl->counters.triangles);
}

static void test_calibrate__small_triangles_are_all_drawn_and_leave_no_gap(void **state)
{
    (void)state;
    struct scenery scenery;
    scenery_open(&scenery);
    /* Patches of 64 x 64 cells of half a pixel, 4 of them. */
    check_covered(&scenery, CALIBRATION_triangles_shared, 32, 4);
    check_near(scenery.works[CALIBRATION_triangles_shared].count, 4 * 64 * 64 * 2, 0);
    check_covered(&scenery, CALIBRATION_triangles_single, 32, 4);
    check_near(scenery.works[CALIBRATION_triangles_single].count, 4 * 64 * 64 * 2, 0);
    check_covered(&scenery, CALIBRATION_quads_2px, 2, 8192);
    check_covered(&scenery, CALIBRATION_quads_8px, 8, 8192);
    check_covered(&scenery, CALIBRATION_quads_32px, 32, 8192);
    check_near(scenery.works[CALIBRATION_quads_32px].count, 2 * 9 * 4, 0);
    scenery_close(&scenery);
}

static void test_calibrate__culled_and_outside_triangles_shade_nothing(void **state)
{
    (void)state;
    struct scenery scenery;
    scenery_open(&scenery);
    const enum calibration_index hidden[] = {CALIBRATION_triangles_culled, CALIBRATION_vertices};
    for (size_t i = 0; i < 2; i++) {
        struct gl_statistics counted = work_see(&scenery, hidden[i], 2, 7);
        for (int k = 0; k < WIDTH * HEIGHT; k++)
            check_near(scenery.rgba[4 * k], 7, 0);
        assert_int_equal(counted.fragments, 0);
        assert_int_equal(gl_bench_gl(scenery.bench)->counters.triangles, 2 * 4 * 64 * 64 * 2);
    }
    check_near(scenery.works[CALIBRATION_vertices].count, 4 * 64 * 64 * 6, 0);
    scenery_close(&scenery);
}

static void test_calibrate__draw_calls_are_as_many_as_counted(void **state)
{
    (void)state;
    struct scenery scenery;
    scenery_open(&scenery);
    for (int i = CALIBRATION_calls_bare; i <= CALIBRATION_calls_texture; i++) {
        struct gl_statistics counted = work_see(&scenery, (enum calibration_index)i, 5, 7);
        const struct gl *gl = gl_bench_gl(scenery.bench);
        check_near((double)gl->counters.draw_calls, 5 * scenery.works[i].count, 0);
        if (gl->has_pipeline_statistics)
            assert_int_equal(counted.primitives, gl->counters.draw_calls);
        assert_true(pixel(&scenery, 0, 0)[0] < 7);
    }
    scenery_close(&scenery);
}

static void test_calibrate__memory_is_copied_and_added_whole(void **state)
{
    (void)state;
    enum { COUNT = 100003 };
    struct arena *arena = arena_create(0);
    struct work works[CALIBRATION_COUNT];
    struct memory_bench bench;
    memory_bench_create(arena, COUNT, 2, &bench, works);
    works[CALIBRATION_memory_copy].pass(&bench, CALIBRATION_memory_copy, 1);
    for (size_t i = 0; i < COUNT; i++)
        check_near(bench.a[i], (double)i, 0);
    works[CALIBRATION_memory_triad].pass(&bench, CALIBRATION_memory_triad, 1);
    for (size_t i = 0; i < COUNT; i++)
        check_near(bench.a[i], (double)i + 3, 0);
    check_near(works[CALIBRATION_memory_copy].count, 16.0 * COUNT, 0);
    check_near(works[CALIBRATION_memory_triad].count, 24.0 * COUNT, 0);
    arena_destroy(arena);
}

static void test_calibrate__a_secondary_ray_starts_at_every_hit(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct work works[CALIBRATION_COUNT];
    struct ray_bench *bench;
    struct error error = {0};
    if (ray_bench_create(arena, 2, &bench, works, &error))
        fail_msg("%s", error.text);
    check_near(works[CALIBRATION_rays_primary].count, 128 * 128, 0);
    /* A crown of 100,000 triangles, seen from the side: neither empty nor a wall. */
    assert_true(works[CALIBRATION_rays_shadow].count > 0.2 * 128 * 128);
    assert_true(works[CALIBRATION_rays_shadow].count < 128 * 128);
    check_near(works[CALIBRATION_rays_ambient].count, works[CALIBRATION_rays_shadow].count, 0);
    ray_bench_destroy(bench);
    arena_destroy(arena);
}

static void test_calibrate__every_rate_lies_in_its_interval(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    const struct calibrate_request request = {
        .threads = 1, .width_px = 1, .height_px = 100000, .seconds = 0.02};
    struct calibration calibration;
    struct error error = {0};
    if (calibrate_run(arena, &request, &calibration, &error))
        fail_msg("%s", error.text);
    assert_int_equal(calibration.width_px, CALIBRATE_SIDE_MIN);
    assert_int_equal(calibration.height_px, CALIBRATE_SIDE_MAX);
    assert_int_equal(calibration.threads, 1);
    for (size_t i = 0; i < CALIBRATION_COUNT; i++) {
        struct interval rate = calibration.measures[i].rate;
        if (!(rate.low > 0 && rate.low <= rate.value && rate.value <= rate.high) ||
            isinf(rate.high))
            fail_msg("%s: %g in %g..%g", calibration_table[i].field, rate.value, rate.low,
                     rate.high);
    }
    arena_destroy(arena);
}

/* A machine of round figures, at its best. */
static struct calibration round_machine(void)
{
    struct calibration made = {.width_px = 800,
                               .height_px = 600,
                               .format = TARGET_RGBA8,
                               .threads = 2,
                               .core_ghz = NAN,
                               .seconds = 3.5,
                               .backend = "osmesa",
                               .renderer = "round"};
    static const struct {
        enum calibration_index index;
        double rate, fragments;
    } known[] = {
        {CALIBRATION_fill_opaque, 500e6, 240000}, {CALIBRATION_triangles_culled, 50e6, 0},
        {CALIBRATION_triangles_shared, 10e6, 2},  {CALIBRATION_quads_2px, 4e6, 16},
        {CALIBRATION_quads_8px, 2e6, 64},         {CALIBRATION_quads_32px, 0.5e6, 512},
        {CALIBRATION_vertices, 150e6, NAN},       {CALIBRATION_calls_bare, 2e6, NAN},
    };
    for (size_t i = 0; i < CALIBRATION_COUNT; i++)
        made.measures[i] = (struct calibration_measure){{NAN, NAN, NAN}, NAN};
    for (size_t i = 0; i < sizeof known / sizeof *known; i++)
        made.measures[known[i].index] = (struct calibration_measure){
            {0.5 * known[i].rate, 0.25 * known[i].rate, known[i].rate}, known[i].fragments};
    return made;
}

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
    struct result result = {.cell = {.width_px = 800, .height_px = 600}};
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
    result.renderer = NULL;
    assert_null(limit_calibration(&run, &result));
}

static void check_same(double a, double b)
{
    if (a != b && !(isnan(a) && isnan(b)))
        fail_msg("%.17g became %.17g", a, b);
}

static void test_calibration__a_line_reads_back_to_the_same_values(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct error error = {0};
    struct calibration before = round_machine(), after;
    before.measures[0].rate.value = 1e9 / 3;
    char *line = calibration_to_json(arena, &before);
    assert_null(strchr(line, '\n'));
    if (calibration_from_json(arena, line, "here:1", &after, &error))
        fail_msg("%s", error.text);
    assert_int_equal(after.width_px, 800);
    assert_int_equal(after.height_px, 600);
    assert_int_equal(after.format, TARGET_RGBA8);
    assert_int_equal(after.threads, 2);
    assert_string_equal(after.backend, "osmesa");
    assert_string_equal(after.renderer, "round");
    check_same(before.core_ghz, after.core_ghz);
    check_same(before.seconds, after.seconds);
    for (size_t i = 0; i < CALIBRATION_COUNT; i++) {
        const struct calibration_measure *a = &before.measures[i], *b = &after.measures[i];
        check_same(a->rate.value, b->rate.value);
        check_same(a->rate.low, b->rate.low);
        check_same(a->rate.high, b->rate.high);
        check_same(a->fragments_per_triangle, b->fragments_per_triangle);
    }
    arena_destroy(arena);
}

/* The line with one text in place of another is refused, and the error holds the word. */
static void check_refused(const char *from, const char *to, const char *word)
{
    struct arena *arena = arena_create(0);
    struct error error = {0};
    struct calibration machine = round_machine(), after;
    char *line = calibration_to_json(arena, &machine), *at = strstr(line, from);
    assert_non_null(at);
    char *bad = arena_printf(arena, "%.*s%s%s", (int)(at - line), line, to, at + strlen(from));
    assert_int_equal(calibration_from_json(arena, bad, "there:7", &after, &error), STATUS_INVALID);
    if (!strstr(error.text, "there:7") || !strstr(error.text, word))
        fail_msg("'%s' lacks there:7 or '%s'", error.text, word);
    arena_destroy(arena);
}

static void test_calibration__a_malformed_line_names_key_and_value(void **state)
{
    (void)state;
    check_refused("\"version\":2", "\"version\":3", "this treeline reads version 1 to 2");
    check_refused(CALIBRATION_KIND, "treeline-run", CALIBRATION_KIND);
    check_refused("\"rgba8\"", "\"rgb\"", "rgba8|rgba16f|rgba32f");
    check_refused("\"threads\":2", "\"threads\":0", "threads");
    check_refused("\"width_px\":800", "\"width_px\":-1", "width_px");
    check_refused("\"rate\":250000000", "\"rate\":-5", "rate");
    check_refused("\"fill_opaque\"", "\"fill_purple\"", "fill_purple");
    check_refused("}}", "}", "JSON");
}

/* A run of version 1, committed before there was a calibration, is one without. */
static void test_run__of_version_1_is_read_as_one_without_calibration(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct error error = {0};
    struct run *run;
    const char *path = arena_printf(arena, "%s/results/baselines/quick-xeon-2cores", data_folder());
    if (run_read(arena, path, &run, &error))
        fail_msg("%s", error.text);
    assert_int_equal(run->calibrations_count, 0);
    assert_true(run->results_count > 0);
    arena_destroy(arena);
}

static void test_run__keeps_its_calibrations_among_its_results(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct error error = {0};
    char folder[] = "/tmp/treeline-calibrate-XXXXXX";
    assert_non_null(mkdtemp(folder));
    struct provenance provenance = {.cores = 2};
    struct cell cell = {.name = "tiny/null/trees=1", .width_px = 8, .height_px = 6};
    struct result result;
    struct run *run;
    result_init(&result, &cell, 0);
    result.message = CALIBRATION_KIND; /* a word in a text makes no calibration */
    assert_int_equal(run_open(folder, &provenance, false, &error), STATUS_OK);
    for (int i = 0; i < 5; i++) {
        struct calibration machine = round_machine();
        machine.width_px = 100 + i;
        assert_int_equal(run_append_calibration(folder, &machine, &error), STATUS_OK);
        result.repetition = i;
        assert_int_equal(run_append(folder, &result, &error), STATUS_OK);
    }
    if (run_read(arena, folder, &run, &error))
        fail_msg("%s", error.text);
    assert_int_equal(run->calibrations_count, 5);
    assert_int_equal(run->results_count, 5);
    for (int i = 0; i < 5; i++) {
        assert_int_equal(run->calibrations[i].width_px, 100 + i);
        assert_int_equal(run->results[i].repetition, i);
    }
    unlink(arena_printf(arena, "%s/cells.jsonl", folder));
    rmdir(folder);
    arena_destroy(arena);
}

static void test_calibration__the_readme_documents_every_measure(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct error error = {0};
    char *text;
    size_t size;
    const char *path = arena_printf(arena, "%s/results/README.md", data_folder());
    assert_int_equal(file_read(arena, path, 0, &text, &size, &error), STATUS_OK);
    for (size_t i = 0; i < CALIBRATION_COUNT; i++) {
        const struct calibration_info *info = &calibration_table[i];
        char *row = arena_printf(arena, "| `%s` | %s/s | %s |", info->field, info->unit, info->doc);
        if (!strstr(text, row))
            fail_msg("%s lacks the row\n%s", path, row);
    }
#define LIMIT_ROW(name, word, doc)                                                                 \
    if (*(word) && !strstr(text, "| " word " | " doc " |"))                                        \
        fail_msg("%s lacks the row\n%s", path, "| " word " | " doc " |");
    LIMIT_LIST(LIMIT_ROW)
#undef LIMIT_ROW
    arena_destroy(arena);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_calibrate__blended_fill_adds_to_every_pixel_once_a_loop),
        cmocka_unit_test(test_calibrate__textured_fill_meets_every_texel),
        cmocka_unit_test(test_calibrate__small_triangles_are_all_drawn_and_leave_no_gap),
        cmocka_unit_test(test_calibrate__culled_and_outside_triangles_shade_nothing),
        cmocka_unit_test(test_calibrate__draw_calls_are_as_many_as_counted),
        cmocka_unit_test(test_calibrate__memory_is_copied_and_added_whole),
        cmocka_unit_test(test_calibrate__a_secondary_ray_starts_at_every_hit),
        cmocka_unit_test(test_calibrate__every_rate_lies_in_its_interval),
        cmocka_unit_test(test_limit__a_triangle_s_rate_goes_with_its_size),
        cmocka_unit_test(test_limit__bounds_are_counts_over_rates),
        cmocka_unit_test(test_limit__a_frame_that_mixes_sizes_is_held_against_culled_triangles),
        cmocka_unit_test(test_limit__what_was_not_counted_bounds_nothing),
        cmocka_unit_test(test_limit__is_told_by_a_calibration_of_the_same_kind),
        cmocka_unit_test(test_calibration__a_line_reads_back_to_the_same_values),
        cmocka_unit_test(test_calibration__a_malformed_line_names_key_and_value),
        cmocka_unit_test(test_run__of_version_1_is_read_as_one_without_calibration),
        cmocka_unit_test(test_run__keeps_its_calibrations_among_its_results),
        cmocka_unit_test(test_calibration__the_readme_documents_every_measure),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
