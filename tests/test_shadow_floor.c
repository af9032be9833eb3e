/* Where the ground ends shadows: against rays through spheres. */
#include "bake/shadow_floor.h"
#include "base/random.h"

#include "testing.h"

#include <math.h>
#include <string.h>

enum { SIDE = 81 };

/* Hills of 8 m, or a plane of no samples. */
static struct terrain ground_make(struct arena *arena, bool hills)
{
    struct terrain ground = {.size_x_m = 200, .size_z_m = 160};
    if (!hills)
        return ground;
    ground.samples_x = ground.samples_z = SIDE;
    ground.heights_m = ARENA_ARRAY(arena, float, SIDE *SIDE);
    for (int i = 0; i < SIDE * SIDE; i++)
        ground.heights_m[i] = 4 * sinf(0.31f * (float)(i % SIDE)) * cosf(0.23f * (float)(i / SIDE));
    return ground;
}

static void sun_toss(struct random *random, float sun[3])
{
    double azimuth = 2 * M_PI * (double)random_float(random);
    double elevation = 0.06 + 1.5 * (double)random_float(random);
    sun[0] = (float)(cos(elevation) * sin(azimuth));
    sun[1] = (float)sin(elevation);
    sun[2] = (float)(cos(elevation) * cos(azimuth));
}

/* Of rays that come through the sphere, those that reach the floor above ground. */
static int rays_above(struct random *random, const struct terrain *ground, const float center[3],
                      float radius_m, const float sun[3], float floor_m)
{
    int above = 0;
    for (int ray = 0; ray < 100; ray++) {
        float offset[3], square = 0;
        for (int i = 0; i < 3; i++) {
            offset[i] = radius_m * (2 * random_float(random) - 1);
            square += offset[i] * offset[i];
        }
        if (square > radius_m * radius_m || center[1] + offset[1] < floor_m)
            continue;
        float along_m = (center[1] + offset[1] - floor_m) / sun[1];
        float x = center[0] + offset[0] - along_m * sun[0];
        float z = center[2] + offset[2] - along_m * sun[2];
        above += terrain_height(ground, x, z) < floor_m;
    }
    return above;
}

static void test_floor__rays_that_come_down_to_it_are_in_the_ground(void **unused)
{
    struct arena *arena = arena_create(0);
    struct terrain ground = ground_make(arena, true);
    struct shadow_floor *made = shadow_floor_create(arena, &ground);
    struct random random = random_seed(3, 1);
    int known = 0, above_lowest = 0;
    for (int trial = 0; trial < 400; trial++) {
        float sun[3], center[3], radius_m = 0.3f + 4 * random_float(&random);
        for (int i = 0; i < 3; i += 2)
            center[i] = 120 * (random_float(&random) - 0.5f);
        center[1] = terrain_height(&ground, center[0], center[2]) + 5 * random_float(&random);
        sun_toss(&random, sun);
        float floor_m = shadow_floor_of(made, center, radius_m, sun);
        if (isnan(floor_m))
            continue;
        known++;
        above_lowest += floor_m > -3.5f;
        assert_true(floor_m > -4 - 0.03f * radius_m);
        assert_int_equal(rays_above(&random, &ground, center, radius_m, sun, floor_m), 0);
    }
    assert_true(known > 300 && above_lowest > known / 4);
    arena_destroy(arena);
    (void)unused;
}

static void test_floor__of_a_plane_is_the_plane(void **unused)
{
    struct arena *arena = arena_create(0);
    struct terrain plane = ground_make(arena, false);
    struct shadow_floor *made = shadow_floor_create(arena, &plane);
    float low_sun[3] = {0.995f, 0.1f, 0};
    float floor_m = shadow_floor_of(made, (float[3]){1e4f, 6, -1e5f}, 5, low_sun);
    assert_true(floor_m <= 0 && floor_m > -0.2f);
    arena_destroy(arena);
    (void)unused;
}

static void test_floor__there_is_none_for_shadows_that_leave_the_ground(void **unused)
{
    struct arena *arena = arena_create(0);
    struct terrain ground = ground_make(arena, true);
    struct shadow_floor *made = shadow_floor_create(arena, &ground);
    const float center[3] = {0, 6, 0}, rim[3] = {99, 6, 0}, up[3] = {0, 1, 0};
    assert_false(isnan(shadow_floor_of(made, center, 2, up)));
    assert_true(isnan(shadow_floor_of(made, rim, 2, up)));
    assert_true(isnan(shadow_floor_of(made, center, 2, (float[3]){1, 0, 0})));
    assert_true(isnan(shadow_floor_of(made, center, 2, (float[3]){0.6f, -0.8f, 0})));
    assert_true(isnan(shadow_floor_of(made, center, 2, (float[3]){0.9999f, 0.01f, 0})));
    ground.detail_px = 0.5f;
    assert_true(isnan(shadow_floor_of(made, center, 2, up)));
    arena_destroy(arena);
    (void)unused;
}

static void test_floor__an_eye_is_above_the_ground_or_beside_it(void **unused)
{
    struct arena *arena = arena_create(0);
    struct terrain ground = ground_make(arena, true);
    struct shadow_floor *made = shadow_floor_create(arena, &ground);
    struct view view = {.near_m = 0.1f};
    float height_m = terrain_height(&ground, 20, -30);
    memcpy(view.eye_m, (float[3]){20, height_m + 0.5f, -30}, sizeof view.eye_m);
    assert_true(shadow_floor_is_below(made, &view));
    view.eye_m[1] = height_m + 0.1f;
    assert_false(shadow_floor_is_below(made, &view));
    memcpy(view.eye_m, (float[3]){120, 50, 0}, sizeof view.eye_m);
    assert_false(shadow_floor_is_below(made, &view));
    arena_destroy(arena);
    (void)unused;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_floor__rays_that_come_down_to_it_are_in_the_ground),
        cmocka_unit_test(test_floor__of_a_plane_is_the_plane),
        cmocka_unit_test(test_floor__there_is_none_for_shadows_that_leave_the_ground),
        cmocka_unit_test(test_floor__an_eye_is_above_the_ground_or_beside_it),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
