/* The calibration: that the work it times is really done, and counted right. */
#include "testing.h"

#include "calibrate/bench.h"

#include <math.h>
#include <string.h>

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

/* The mean of 16 texels in a row, which begin again behind the last. */
static void test_calibrate__every_sample_is_another_texel(void **state)
{
    (void)state;
    struct scenery scenery;
    scenery_open(&scenery);
    work_see(&scenery, CALIBRATION_samples_bilinear, 1, 7);
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++) {
            double sum = 0;
            for (int i = 0; i < 16; i++)
                sum += (x + i) % 256 / 255.0;
            check_near(pixel(&scenery, x, y)[0], sum / 16, 2e-3);
            check_near(pixel(&scenery, x, y)[1], (y % 256) / 255.0, 2e-3);
        }
    check_near(scenery.works[CALIBRATION_samples_bilinear].count,
               16 * scenery.works[CALIBRATION_fill_opaque].count, 0);
    scenery_close(&scenery);
}

/* Every word is its place: the sum of the places that a fragment's sequence visits. */
static void test_calibrate__a_shader_looks_up_scattered_words(void **state)
{
    (void)state;
    struct scenery scenery;
    scenery_open(&scenery);
    work_see(&scenery, CALIBRATION_lookups_shader, 1, -1);
    for (uint32_t y = 0; y < HEIGHT; y++)
        for (uint32_t x = 0; x < WIDTH; x++) {
            uint32_t at = x + (y << 13), sum = 0;
            for (int i = 0; i < 32; i++) {
                at += UINT32_C(0x9e3779b9);
                sum += at >> 16;
            }
            check_near(pixel(&scenery, (int)x, (int)y)[1], sum, 0);
        }
    check_near(scenery.works[CALIBRATION_lookups_shader].count,
               32 * scenery.works[CALIBRATION_fill_opaque].count, 0);
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
    uint64_t sum = 0;
    for (size_t i = 0; i < COUNT; i++) {
        uint64_t bits;
        memcpy(&bits, &(double){(double)i + 3}, sizeof bits);
        sum += 3 * bits;
    }
    works[CALIBRATION_memory_read].pass(&bench, CALIBRATION_memory_read, 3);
    assert_true(bench.sum == sum);
    check_near(works[CALIBRATION_memory_read].count, 8.0 * COUNT, 0);
    check_near(works[CALIBRATION_memory_copy].count, 16.0 * COUNT, 0);
    check_near(works[CALIBRATION_memory_triad].count, 24.0 * COUNT, 0);
    arena_destroy(arena);
}

/* Every word is its place: places that fill the words evenly have their mean. */
static void test_calibrate__lookups_meet_all_of_each_thread_s_words(void **state)
{
    (void)state;
    enum { THREADS = 3, LOOPS = 4 };
    struct arena *arena = arena_create(0);
    struct work works[CALIBRATION_COUNT];
    struct memory_bench bench;
    memory_bench_create(arena, 16, THREADS, &bench, works);
    struct work *work = &works[CALIBRATION_lookups_near];
    check_near(work->count, (double)THREADS * LOOKUP_WORDS, 0);
    work->pass(work->bench, CALIBRATION_lookups_near, LOOPS);
    for (int thread = 0; thread < THREADS; thread++)
        check_near((double)bench.near_sums[thread] / (LOOPS * LOOKUP_WORDS),
                   0.5 * (LOOKUP_WORDS - 1), 2);
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

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_calibrate__blended_fill_adds_to_every_pixel_once_a_loop),
        cmocka_unit_test(test_calibrate__textured_fill_meets_every_texel),
        cmocka_unit_test(test_calibrate__small_triangles_are_all_drawn_and_leave_no_gap),
        cmocka_unit_test(test_calibrate__culled_and_outside_triangles_shade_nothing),
        cmocka_unit_test(test_calibrate__draw_calls_are_as_many_as_counted),
        cmocka_unit_test(test_calibrate__every_sample_is_another_texel),
        cmocka_unit_test(test_calibrate__a_shader_looks_up_scattered_words),
        cmocka_unit_test(test_calibrate__memory_is_copied_and_added_whole),
        cmocka_unit_test(test_calibrate__lookups_meet_all_of_each_thread_s_words),
        cmocka_unit_test(test_calibrate__a_secondary_ray_starts_at_every_hit),
        cmocka_unit_test(test_calibrate__every_rate_lies_in_its_interval),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
