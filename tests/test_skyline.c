/* Horizon maps against closed forms and against the slow walk over every edge. */
#include "testing.h"

#include "bake/skyline.h"

#include <math.h>
#include <stdlib.h>

static struct terrain terrain_make(struct arena *arena, uint32_t side, float size_m,
                                   double (*height)(double, double))
{
    struct terrain terrain = {
        .samples_x = side, .samples_z = side, .size_x_m = size_m, .size_z_m = size_m};
    terrain.heights_m = ARENA_ARRAY(arena, float, (size_t)side *side);
    for (uint32_t i = 0; i < side * side; i++)
        terrain.heights_m[i] = (float)height(((double)(i % side) / (side - 1) - 0.5) * size_m,
                                             ((double)(i / side) / (side - 1) - 0.5) * size_m);
    return terrain;
}

/* 10 m high, 20 m wide, at the middle. */
static double cone(double x, double z)
{
    return fmax(0, 10 * (1 - hypot(x, z) / 20));
}

static double wall(double x, double z)
{
    return fabs(x) < 0.5 ? 10 : 0 * z;
}

static double hills(double x, double z)
{
    return 6 * sin(0.11 * x + 1) * cos(0.09 * z) + 2 * sin(0.13 * x - 0.16 * z);
}

static float map_at(const struct skyline *map, int azimuth, uint32_t x, uint32_t z)
{
    return map->tangents[((size_t)azimuth * map->samples_z + z) * map->samples_x + x];
}

/* Steepest way to the true cone, in small steps. */
static double cone_tangent(double x, double z, double azimuth_rad)
{
    double best = -1;
    for (double t = 1; /* a sample: nearer the mesh is no cone */ t < 140; t += 0.02) {
        double at_x = x + t * sin(azimuth_rad), at_z = z + t * cos(azimuth_rad);
        if (fabs(at_x) > 50 || fabs(at_z) > 50)
            break;
        best = fmax(best, (cone(at_x, at_z) - cone(x, z)) / t);
    }
    return best;
}

static void test_skyline__a_cone_hides_what_geometry_says(void **unused)
{
    enum { SIDE = 101, AZIMUTHS = 24 };
    struct arena *arena = arena_create(0);
    struct terrain terrain = terrain_make(arena, SIDE, 100, cone);
    struct skyline map;
    skyline_bake(arena, &terrain, AZIMUTHS, 2, &map);
    /* straight to the top, in closed form */
    for (uint32_t x = 0; x < 30; x++)
        assert_float_equal(map_at(&map, AZIMUTHS / 4, x, SIDE / 2), 10.0 / (50.0 - x), 1e-5);
    double sum = 0;
    int count = 0;
    for (int k = 0; k < AZIMUTHS; k++)
        for (uint32_t z = 4; z < SIDE; z += 21)
            for (uint32_t x = 4; x < SIDE; x += 21) {
                double truth = cone_tangent(x - 50.0, z - 50.0, 2 * M_PI * k / AZIMUTHS);
                double error = fabs((double)map_at(&map, k, x, z) - truth);
                assert_true(error < 0.1); /* where a ray touches the cone between two lines */
                sum += error;
                count++;
            }
    assert_true(sum / count < 0.005);
    arena_destroy(arena);
    (void)unused;
}

/* A ridge one sample wide: no azimuth may look through between its samples. */
static void test_skyline__a_wall_hides_as_much_along_every_azimuth(void **unused)
{
    enum { SIDE = 65, AZIMUTHS = 40 };
    struct arena *arena = arena_create(0);
    struct terrain terrain = terrain_make(arena, SIDE, 64, wall);
    struct skyline map;
    skyline_bake(arena, &terrain, AZIMUTHS, 1, &map);
    for (int k = 1; k < AZIMUTHS / 2; k++) {
        double azimuth = 2 * M_PI * k / AZIMUTHS, away_m = 6 / sin(azimuth);
        float tangent = map_at(&map, k, 32 - 6, 32);
        if (away_m * fabs(cos(azimuth)) < 30)                     /* else beside the wall's end */
            assert_float_equal(tangent, 10 / away_m, 0.015);      /* mixed of two lines */
        assert_float_equal(map_at(&map, k, 32 + 6, 32), 0, 1e-5); /* the wall is behind */
    }
    arena_destroy(arena);
    (void)unused;
}

/* Along axes and diagonals lines pass through samples: exact. Elsewhere what is far is the
 * mean of two lines. */
static void test_skyline__sweeps_find_what_a_walk_over_every_edge_finds(void **unused)
{
    enum { SIDE = 61, AZIMUTHS = 16 };
    struct arena *arena = arena_create(0);
    struct terrain terrain = terrain_make(arena, SIDE, 120, hills);
    struct skyline map;
    skyline_bake(arena, &terrain, AZIMUTHS, 2, &map);
    for (int k = 0; k < AZIMUTHS; k++) {
        double sum = 0;
        int count = 0;
        for (uint32_t z = 2; z < SIDE - 2; z += 5)
            for (uint32_t x = 2; x < SIDE - 2; x += 5) {
                float exact = skyline_exact(&terrain, x, z, 2 * M_PI * k / AZIMUTHS);
                double error = fabs((double)map_at(&map, k, x, z) - (double)exact);
                if (k % 2 == 0)
                    assert_true(error < 1e-3);
                sum += error;
                count++;
            }
        assert_true(sum / count < 0.004); /* slopes reach 1 */
    }
    arena_destroy(arena);
    (void)unused;
}

/* A finer grid over the same surface, and what is seen from the samples of the coarse one. */
static void test_skyline__refining_changes_neither_the_surface_nor_what_is_seen(void **unused)
{
    enum { SIDE = 25, PARTS = 3 };
    struct arena *arena = arena_create(0);
    struct terrain terrain = terrain_make(arena, SIDE, 120, hills), fine;
    skyline_refine(arena, &terrain, PARTS, &fine);
    assert_int_equal(fine.samples_x, (SIDE - 1) * PARTS + 1);
    for (int i = 0; i < 500; i++) {
        float x = 0.117f * (float)(i - 250), z = 0.0713f * (float)((i * 37) % 500 - 250);
        assert_float_equal(terrain_height(&fine, x, z), terrain_height(&terrain, x, z), 1e-3);
    }
    for (uint32_t k = 0; k < 40; k++) {
        uint32_t x = 1 + k % 23, z = 1 + (7 * k) % 23;
        assert_float_equal(skyline_exact(&fine, PARTS * x, PARTS * z, 0.3 * k),
                           skyline_exact(&terrain, x, z, 0.3 * k), 1e-3);
    }
    arena_destroy(arena);
    (void)unused;
}

/* Twice as large is as steep; another number of threads is the same. */
static void test_skyline__scale_and_threads_change_nothing(void **unused)
{
    enum { SIDE = 21, AZIMUTHS = 7, COUNT = SIDE * SIDE * AZIMUTHS };
    struct arena *arena = arena_create(0);
    struct terrain terrain = terrain_make(arena, SIDE, 40, hills), large = terrain;
    struct skyline maps[2];
    large.size_x_m *= 2;
    large.size_z_m *= 2;
    large.heights_m = ARENA_ARRAY(arena, float, SIDE *SIDE);
    for (int i = 0; i < SIDE * SIDE; i++)
        large.heights_m[i] = 2 * terrain.heights_m[i];
    skyline_bake(arena, &terrain, AZIMUTHS, 1, &maps[0]);
    skyline_bake(arena, &large, AZIMUTHS, 3, &maps[1]);
    for (int i = 0; i < COUNT; i++)
        assert_true(maps[0].tangents[i] == maps[1].tangents[i]);
    arena_destroy(arena);
    (void)unused;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_skyline__a_cone_hides_what_geometry_says),
        cmocka_unit_test(test_skyline__a_wall_hides_as_much_along_every_azimuth),
        cmocka_unit_test(test_skyline__sweeps_find_what_a_walk_over_every_edge_finds),
        cmocka_unit_test(test_skyline__refining_changes_neither_the_surface_nor_what_is_seen),
        cmocka_unit_test(test_skyline__scale_and_threads_change_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
