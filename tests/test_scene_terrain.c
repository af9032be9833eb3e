/* Terrain: heights and normals against closed forms, the mesh against ray casting, images against
 * their bytes. */
#include "own_folder.h"

#include "base/arena.h"
#include "base/file.h"
#include "base/hash.h"
#include "base/random.h"
#include "scene/terrain.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static struct terrain terrain_of(struct arena *arena, uint32_t samples_x, uint32_t samples_z,
                                 float size_x_m, float size_z_m, double (*height)(double, double))
{
    struct terrain terrain = {.samples_x = samples_x,
                              .samples_z = samples_z,
                              .size_x_m = size_x_m,
                              .size_z_m = size_z_m,
                              .albedo = {0.1f, 0.2f, 0.3f}};
    terrain.heights_m = ARENA_ARRAY(arena, float, (size_t)samples_x *samples_z);
    for (uint32_t j = 0; j < samples_z; j++)
        for (uint32_t i = 0; i < samples_x; i++)
            terrain.heights_m[j * samples_x + i] =
                (float)height(((double)i / (samples_x - 1) - 0.5) * (double)size_x_m,
                              ((double)j / (samples_z - 1) - 0.5) * (double)size_z_m);
    terrain_normals(arena, &terrain);
    return terrain;
}

static double plane(double x, double z)
{
    return 5 + 0.25 * x - 0.5 * z;
}

static double bowl(double x, double z)
{
    return 0.01 * (x * x + z * z);
}

static double bumps(double x, double z)
{
    return 3 * sin(0.9 * x) * cos(0.7 * z) + 0.2 * x;
}

static void test_terrain__a_plane_is_exact_everywhere(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct terrain terrain = terrain_of(arena, 9, 5, 40, 30, plane);
    struct random random = random_seed(1, 1);
    for (int k = 0; k < 2000; k++) {
        float x = 40 * (random_float(&random) - 0.5f), z = 30 * (random_float(&random) - 0.5f);
        assert_float_equal(terrain_height(&terrain, x, z), plane(x, z), 2e-5);
        assert_float_equal(terrain_slope_deg(&terrain, x, z), atan(sqrt(0.3125)) * 180 / acos(-1),
                           1e-3);
    }
    double length = sqrt(1 + 0.25 * 0.25 + 0.5 * 0.5);
    for (int k = 0; k < 45; k++) {
        assert_float_equal(terrain.normals[k][0], -0.25 / length, 1e-5);
        assert_float_equal(terrain.normals[k][1], 1 / length, 1e-5);
        assert_float_equal(terrain.normals[k][2], 0.5 / length, 1e-5);
    }
    arena_destroy(arena);
}

/* Central differences of a quadratic are exact; linear interpolation on a right triangle of sides a
 * and b errs by at most 0.01 (a^2 + b^2) / 4. */
static void test_terrain__a_bowl_has_exact_normals_inside_and_bounded_heights(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct terrain terrain = terrain_of(arena, 21, 11, 40, 40, bowl);
    for (int j = 1; j < 10; j++)
        for (int i = 1; i < 20; i++) {
            double x = -20 + 2.0 * i, z = -20 + 4.0 * j;
            double length = sqrt(1 + 0.02 * 0.02 * (x * x + z * z));
            const float *normal = terrain.normals[j * 21 + i];
            assert_float_equal(normal[0], -0.02 * x / length, 1e-5);
            assert_float_equal(normal[1], 1 / length, 1e-5);
            assert_float_equal(normal[2], -0.02 * z / length, 1e-5);
        }
    struct random random = random_seed(2, 1);
    for (int k = 0; k < 5000; k++) {
        float x = 40 * (random_float(&random) - 0.5f), z = 40 * (random_float(&random) - 0.5f);
        double above = (double)terrain_height(&terrain, x, z) - bowl(x, z);
        assert_true(above >= -1e-5 && above <= 0.01 * (4 + 16) / 4 + 1e-5);
    }
    arena_destroy(arena);
}

/* Height of the mesh's triangles over (x, z), by barycentric coordinates, asking each triangle. */
static double mesh_height(const struct mesh *mesh, double x, double z, int *hits)
{
    double height = NAN;
    *hits = 0;
    for (size_t t = 0; t < mesh->triangles_count; t++) {
        const float *a = mesh->positions[mesh->triangles[t][0]];
        const float *b = mesh->positions[mesh->triangles[t][1]];
        const float *c = mesh->positions[mesh->triangles[t][2]];
        double abx = (double)b[0] - a[0], abz = (double)b[2] - a[2];
        double acx = (double)c[0] - a[0], acz = (double)c[2] - a[2];
        double area = abx * acz - abz * acx, px = x - a[0], pz = z - a[2];
        double u = (px * acz - pz * acx) / area, v = (abx * pz - abz * px) / area;
        if (u < 0 || v < 0 || u + v > 1)
            continue;
        ++*hits;
        height = a[1] + u * ((double)b[1] - a[1]) + v * ((double)c[1] - a[1]);
    }
    return height;
}

static void test_terrain__height_is_that_of_the_mesh_under_a_vertical_ray(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct terrain terrain = terrain_of(arena, 13, 8, 24, 20, bumps);
    struct mesh *mesh = terrain_mesh(arena, &terrain);
    struct random random = random_seed(3, 1);
    for (int k = 0; k < 5000; k++) {
        float x = 23.9f * (random_float(&random) - 0.5f),
              z = 19.9f * (random_float(&random) - 0.5f);
        int hits;
        double height = mesh_height(mesh, x, z, &hits);
        assert_true(hits == 1 || hits == 2); /* 2 on an edge */
        assert_float_equal(terrain_height(&terrain, x, z), height, 2e-5);
    }
    arena_destroy(arena);
}

static void test_terrain__mesh_is_sound_faces_up_and_is_cut_along_one_diagonal(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct terrain terrain = terrain_of(arena, 13, 8, 24, 20, bumps);
    struct mesh *mesh = terrain_mesh(arena, &terrain);
    struct error error = {STATUS_OK, ""};
    assert_int_equal(mesh_check(mesh, &error), STATUS_OK);
    assert_int_equal(mesh->triangles_count, 2 * 12 * 7);
    assert_int_equal(mesh->vertices_count, 13 * 8);
    assert_int_equal(mesh->materials[0].kind, MATERIAL_BARK);
    assert_float_equal(mesh->materials[0].albedo[2], 0.3, 1e-7);
    assert_float_equal(mesh->minimum_m[0], -12, 1e-6);
    assert_float_equal(mesh->maximum_m[2], 10, 1e-6);
    for (size_t t = 0; t < mesh->triangles_count; t++) {
        const uint32_t *corner = mesh->triangles[t];
        const float *a = mesh->positions[corner[0]], *b = mesh->positions[corner[1]];
        const float *c = mesh->positions[corner[2]];
        float up = (b[2] - a[2]) * (c[0] - a[0]) - (b[0] - a[0]) * (c[2] - a[2]);
        assert_true(up > 0);
        /* One edge joins (i, j) and (i + 1, j + 1): vertex numbers that differ by 13 + 1. */
        int diagonals = 0;
        for (int e = 0; e < 3; e++)
            diagonals += abs((int)corner[e] - (int)corner[(e + 1) % 3]) == 14;
        assert_int_equal(diagonals, 1);
    }
    arena_destroy(arena);
}

static void test_terrain__outside_the_border_is_as_high_as_the_border(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct terrain terrain = terrain_of(arena, 9, 5, 40, 30, plane);
    assert_float_equal(terrain_height(&terrain, 1e6f, 0), plane(20, 0), 1e-5);
    assert_float_equal(terrain_height(&terrain, -1e6f, 1e6f), plane(-20, 15), 1e-5);
    assert_float_equal(terrain_height(&terrain, 20, 15), plane(20, 15), 1e-5);
    assert_true(isfinite(terrain_height(&terrain, NAN, NAN)));
    arena_destroy(arena);
}

static struct description description_of(const char *image)
{
    struct description description = {.path = "scene.json"};
    description.ground =
        (struct ground){.given = true, .size_m = {100, 50}, .image = image, .height_m = 200};
    return description;
}

static const char *path_of(struct arena *arena, const char *name)
{
    return arena_printf(arena, "%s/%s", folder, name);
}

static void test_terrain__an_image_of_16_bits_gives_its_heights_to_the_last_bit(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    const char *path = path_of(arena, "heights.png");
    static const unsigned values[6] = {0, 1, 256, 32768, 65534, 65535};
    /* 3 x 2, grey, 16 bits; packed by Python's zlib. */
    static const unsigned char bytes[] = {
        0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a, 0x00, 0x00, 0x00, 0x0d, 0x49, 0x48,
        0x44, 0x52, 0x00, 0x00, 0x00, 0x03, 0x00, 0x00, 0x00, 0x02, 0x10, 0x00, 0x00, 0x00,
        0x00, 0xe8, 0x8f, 0xe5, 0x85, 0x00, 0x00, 0x00, 0x16, 0x49, 0x44, 0x41, 0x54, 0x78,
        0xda, 0x63, 0x60, 0x60, 0x60, 0x60, 0x64, 0x64, 0x60, 0x68, 0x60, 0xf8, 0xff, 0xef,
        0xff, 0x7f, 0x00, 0x0d, 0x14, 0x04, 0x7e, 0x0d, 0x9c, 0x3e, 0x24, 0x00, 0x00, 0x00,
        0x00, 0x49, 0x45, 0x4e, 0x44, 0xae, 0x42, 0x60, 0x82};
    assert_int_equal(file_write(path, bytes, sizeof bytes, NULL), STATUS_OK);
    struct description description = description_of(path);
    for (int round = 0; round < 2; round++) { /* decoded, then from the cache */
        struct terrain terrain;
        struct error error = {STATUS_OK, ""};
        terrain_build(arena, &description, &terrain, &error);
        assert_string_equal(error.text, "");
        assert_int_equal(terrain.samples_x, 3);
        assert_int_equal(terrain.samples_z, 2);
        for (int k = 0; k < 6; k++)
            assert_float_equal(terrain.heights_m[k], values[k] / 65535.0 * 200, 2e-5);
        /* The first row is at the smallest z. */
        assert_float_equal(terrain_height(&terrain, 50, -25), 256 / 65535.0 * 200, 2e-5);
        assert_float_equal(terrain_height(&terrain, -50, 25), 32768 / 65535.0 * 200, 2e-5);
    }
    arena_destroy(arena);
}

/* What the cache holds for a file's bytes is taken, so that the image library is not needed: these
 * bytes are no image. */
static void test_terrain__heights_in_the_cache_need_no_image_library(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    const char *path = path_of(arena, "cached.png"), *text = "not an image";
    assert_int_equal(file_write(path, text, strlen(text), NULL), STATUS_OK);
    struct {
        uint32_t sides[2];
        float values[4];
    } entry = {{2, 2}, {0, 0.5f, 0.25f, 1}};
    cache_put("terrain", hash_bytes(0, text, strlen(text)), &entry, sizeof entry);
    struct description description = description_of(path);
    struct terrain terrain;
    assert_int_equal(terrain_build(arena, &description, &terrain, NULL), STATUS_OK);
    assert_float_equal(terrain.heights_m[1], 100, 1e-5);
    assert_float_equal(terrain.heights_m[3], 200, 1e-5);
    arena_destroy(arena);
}

static void test_terrain__what_is_no_image_is_refused_by_name(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    const char *path = path_of(arena, "broken.png"), *text = "\x89PNG\r\n\x1a\n broken";
    assert_int_equal(file_write(path, text, strlen(text), NULL), STATUS_OK);
    struct description description = description_of(path);
    struct terrain terrain;
    struct error error = {STATUS_OK, ""};
    assert_int_not_equal(terrain_build(arena, &description, &terrain, &error), STATUS_OK);
    assert_non_null(strstr(error.text, "scene.json: terrain.image: "));
    assert_non_null(strstr(error.text, "broken.png"));
    description.ground.image = path_of(arena, "line.pgm");
    assert_int_equal(file_write(description.ground.image, "P2 1 4 9\n1 2 3 4\n", 17, NULL),
                     STATUS_OK);
    assert_int_equal(terrain_build(arena, &description, &terrain, &error), STATUS_INVALID);
    assert_non_null(strstr(error.text, "is 1 x 4 px; allowed: 2..8193"));
    description.ground.image = folder;
    assert_int_not_equal(terrain_build(arena, &description, &terrain, &error), STATUS_OK);
    arena_destroy(arena);
}

static void test_hills__fill_their_range_and_are_gentle(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct description description =
        description_of(arena_printf(arena, "%s/scenes/terrain/hills.png", data_folder()));
    description.ground.size_m[0] = description.ground.size_m[1] = 12000;
    description.ground.height_m = 700;
    struct terrain terrain;
    struct error error = {STATUS_OK, ""};
    terrain_build(arena, &description, &terrain, &error);
    assert_string_equal(error.text, "");
    assert_int_equal(terrain.samples_x, 257);
    assert_int_equal(terrain.samples_z, 257);
    float low = INFINITY, high = -INFINITY, steepest = 1;
    for (size_t k = 0; k < 257 * 257; k++) {
        low = fminf(low, terrain.heights_m[k]);
        high = fmaxf(high, terrain.heights_m[k]);
        steepest = fminf(steepest, terrain.normals[k][1]);
    }
    assert_float_equal(low, 0, 1e-3);
    assert_float_equal(high, 700, 1e-3);
    assert_true(steepest > 0.5f); /* 60 degrees, what the automatic near plane relies on */
    arena_destroy(arena);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_terrain__a_plane_is_exact_everywhere),
        cmocka_unit_test(test_terrain__a_bowl_has_exact_normals_inside_and_bounded_heights),
        cmocka_unit_test(test_terrain__height_is_that_of_the_mesh_under_a_vertical_ray),
        cmocka_unit_test(test_terrain__mesh_is_sound_faces_up_and_is_cut_along_one_diagonal),
        cmocka_unit_test(test_terrain__outside_the_border_is_as_high_as_the_border),
        cmocka_unit_test(test_terrain__an_image_of_16_bits_gives_its_heights_to_the_last_bit),
        cmocka_unit_test(test_terrain__heights_in_the_cache_need_no_image_library),
        cmocka_unit_test(test_terrain__what_is_no_image_is_refused_by_name),
        cmocka_unit_test(test_hills__fill_their_range_and_are_gentle),
    };
    return cmocka_run_group_tests(tests, folder_make, folder_remove);
}
