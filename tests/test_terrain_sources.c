/* What terrains are made of: files of every kind against their bytes, colours against closed forms,
 * bad values by their lines, noise, and where trees may stand. */
#include "own_folder.h"

#include "base/file.h"
#include "scene/place.h"
#include "scene/terrain.h"
#include "scene/terrain_image.h"
#include "wall/image.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *path_of(struct arena *arena, const char *name)
{
    return arena_printf(arena, "%s/%s", folder, name);
}

static struct description description_of(const char *image, double height_m)
{
    struct description description = {.path = "scene.json"};
    description.ground = (struct ground){.given = true,
                                         .size_m = {100, 50},
                                         .image = image,
                                         .height_m = height_m,
                                         .albedo = {1, 1, 1}};
    return description;
}

static void write_image(const char *path, int width, int height, int channels, float *values,
                        int bits)
{
    struct image image = {width, height, channels, values, NULL};
    struct error error = {STATUS_OK, ""};
    image_write(path, &image, bits, false, &error);
    assert_string_equal(error.text, "");
}

static void assert_heights(const char *image, double height_m, const double *expected_m,
                           double tolerance)
{
    struct arena *arena = arena_create(0);
    struct description description = description_of(image, height_m);
    for (int round = 0; round < 2; round++) { /* decoded, then from the cache */
        struct terrain terrain;
        struct error error = {STATUS_OK, ""};
        terrain_build(arena, &description, &terrain, &error);
        assert_string_equal(error.text, "");
        assert_int_equal(terrain.samples_x, 3);
        assert_int_equal(terrain.samples_z, 2);
        for (int k = 0; k < 6; k++)
            assert_float_equal(terrain.heights_m[k], expected_m[k], tolerance);
    }
    arena_destroy(arena);
}

static void test_source__png_of_8_bits_is_a_share_of_white_and_exr_is_in_its_own_unit(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    float bytes[6] = {0, 1 / 255.0f, 2 / 255.0f, 128 / 255.0f, 254 / 255.0f, 1};
    const double heights_m[6] = {0, 200 / 255.0, 400 / 255.0, 25600 / 255.0, 50800 / 255.0, 200};
    write_image(path_of(arena, "8.png"), 3, 2, 1, bytes, 8);
    assert_heights(path_of(arena, "8.png"), 200, heights_m, 2e-5);
    float metres[6] = {-12.5f, 0, 812.25f, 1e-3f, 4000, 7.5f};
    const double doubled_m[6] = {-25, 0, 1624.5, 2e-3, 8000, 15};
    write_image(path_of(arena, "32.exr"), 3, 2, 1, metres, 32);
    assert_heights(path_of(arena, "32.exr"), 2, doubled_m, 1e-6);
    arena_destroy(arena);
}

/* A little-endian GeoTIFF of one strip, 3 x 2, with the pixel's size in metres (33550), the corner
 * (33922) and UTM zone 31 as its projection (34735). format: 2 signed integer, 3 float. */
static size_t put(unsigned char *file, size_t at, uint64_t value, size_t bytes)
{
    for (size_t k = 0; k < bytes; k++)
        file[at + k] = (unsigned char)(value >> (8 * k));
    return at + bytes;
}

static size_t geotiff(unsigned char *file, unsigned bits, unsigned format, const void *values)
{
    enum { TAGS = 13, DATA = 8 + 2 + 12 * TAGS + 4 };
    const size_t pixels = 6 * bits / 8, scale = DATA + 24, tie = scale + 24, keys = tie + 48;
    const unsigned tags[TAGS][4] = {{256, 3, 1, 3},
                                    {257, 3, 1, 2},
                                    {258, 3, 1, bits},
                                    {259, 3, 1, 1},
                                    {262, 3, 1, 1},
                                    {273, 4, 1, DATA},
                                    {277, 3, 1, 1},
                                    {278, 3, 1, 2},
                                    {279, 4, 1, (unsigned)pixels},
                                    {339, 3, 1, format},
                                    {33550, 12, 3, (unsigned)scale},
                                    {33922, 12, 6, (unsigned)tie},
                                    {34735, 3, 8, (unsigned)keys}};
    const uint16_t directory[8] = {1, 1, 0, 1, 3072, 0, 1, 32631};
    const double places[9] = {30, 30, 0, 0, 0, 0, 500000, 4649776, 0};
    size_t at = put(file, 0, 0x002a4949, 4);
    at = put(file, put(file, at, 8, 4), TAGS, 2);
    for (int t = 0; t < TAGS; t++) {
        at = put(file, put(file, at, tags[t][0], 2), tags[t][1], 2);
        at = put(file, put(file, at, tags[t][2], 4), tags[t][3], 4);
    }
    put(file, at, 0, 4);
    memcpy(file + DATA, values, pixels);
    memcpy(file + scale, places, sizeof places);
    memcpy(file + keys, directory, sizeof directory);
    return keys + sizeof directory;
}

static void test_source__a_geotiff_is_in_its_own_unit_whole_or_float(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    unsigned char file[512] = {0};
    const int16_t whole[6] = {-428, 0, 1, 3478, 8848, 255};
    const float floats[6] = {-428.5f, 0.25f, 1, 3478.125f, 8848.5f, 0.001f};
    double whole_m[6], float_m[6];
    for (int k = 0; k < 6; k++) {
        whole_m[k] = whole[k];
        float_m[k] = (double)floats[k];
    }
    const char *path = path_of(arena, "whole.tif");
    assert_int_equal(file_write(path, file, geotiff(file, 16, 2, whole), NULL), STATUS_OK);
    assert_heights(path, 1, whole_m, 1e-3);
    path = path_of(arena, "float.tif");
    assert_int_equal(file_write(path, file, geotiff(file, 32, 3, floats), NULL), STATUS_OK);
    assert_heights(path, 1, float_m, 0);
    const int16_t holes[6] = {0, 1, 2, -32768, 4, 5};
    path = path_of(arena, "holes.tif");
    assert_int_equal(file_write(path, file, geotiff(file, 16, 2, holes), NULL), STATUS_OK);
    struct description description = description_of(path, 1);
    struct terrain terrain;
    struct error error = {STATUS_OK, ""};
    assert_int_equal(terrain_build(arena, &description, &terrain, &error), STATUS_INVALID);
    assert_non_null(strstr(error.text, "the height at pixel (0, 1) is -32768 m; allowed: -20000"));
    arena_destroy(arena);
}

struct bad {
    const char *name;
    int width, height, channels, bits;
    float last; /* the last value; the others are 0.5 */
    bool color;
    const char *says;
};

static void test_source__bad_values_are_refused_in_one_line_that_names_them(void **state)
{
    (void)state;
    static const struct bad bads[] = {
        {"nan.exr", 2, 2, 1, 32, NAN, false, "the height at pixel (1, 1) is nan; allowed: finite"},
        {"inf.exr", 2, 2, 1, 32, INFINITY, false, "is inf; allowed: finite"},
        {"deep.exr", 2, 2, 1, 32, -3e38f, false, " m; allowed: -20000..20000"},
        {"one.png", 1, 1, 1, 8, 0, false, "is 1 x 1 px; allowed: 2..8193 on each side"},
        {"wide.png", 8194, 2, 1, 8, 0, false, "is 8194 x 2 px; allowed: 2..8193"},
        {"rgb.png", 2, 2, 3, 8, 0, false, "has 3 channels; allowed: 1 (grey)"},
        {"grey.png", 2, 2, 1, 8, 0, true, "has 1 channel; allowed: 3 (red, green, blue)"},
        {"dark.exr", 2, 2, 3, 32, -0.5f, true, "the colour at pixel (1, 1) is -0.5; allowed: 0..1"},
        {"nan-color.exr", 2, 2, 3, 32, NAN, true, "the colour at pixel (1, 1) is nan; allowed"},
    };
    struct arena *arena = arena_create(0);
    for (size_t k = 0; k < sizeof bads / sizeof *bads; k++) {
        const struct bad *bad = &bads[k];
        const char *path = path_of(arena, bad->name);
        size_t count = (size_t)(bad->width * bad->height * bad->channels);
        float *values = ARENA_ARRAY(arena, float, count);
        for (size_t i = 0; i < count; i++)
            values[i] = i + 1 < count ? 0.5f : bad->last;
        write_image(path, bad->width, bad->height, bad->channels, values, bad->bits);
        struct description description = description_of(bad->color ? NULL : path, 1);
        description.ground.color = bad->color ? path : NULL;
        struct terrain terrain;
        struct error error = {STATUS_OK, ""};
        assert_int_equal(terrain_build(arena, &description, &terrain, &error), STATUS_INVALID);
        if (!strstr(error.text, bad->says) || !strstr(error.text, bad->name) ||
            strchr(error.text, '\n') ||
            !strstr(error.text, bad->color ? "scene.json: terrain.color: " : "terrain.image: "))
            fail_msg("%s: %s", bad->name, error.text);
    }
    arena_destroy(arena);
}

/* An image of the terrain's own size is taken pixel by pixel, decoded from sRGB. */
static void test_color__of_the_terrains_size_is_a_colour_a_vertex(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    float values[12], heights[4] = {0, 0.5f, 0.25f, 1};
    for (int k = 0; k < 12; k++)
        values[k] = (float)(20 * k) / 255;
    write_image(path_of(arena, "four.png"), 2, 2, 3, values, 8);
    write_image(path_of(arena, "ground.png"), 2, 2, 1, heights, 8);
    struct description description = description_of(path_of(arena, "ground.png"), 10);
    description.ground.color = path_of(arena, "four.png");
    struct terrain terrain;
    for (int round = 0; round < 2; round++) {
        assert_int_equal(terrain_build(arena, &description, &terrain, NULL), STATUS_OK);
        for (int k = 0; k < 12; k++) {
            double stored = 20 * k / 255.0; /* IEC 61966-2-1 */
            double linear = stored <= 0.04045 ? stored / 12.92 : pow((stored + 0.055) / 1.055, 2.4);
            assert_float_equal(terrain.colors[k / 3][k % 3], linear, 1e-6);
        }
    }
    arena_destroy(arena);
}

/* The tent of a finer image averages and of a coarser one interpolates: both give a slope of colour
 * back as it was, but for the border, where half the tent is missing. */
static void test_color__of_another_size_keeps_a_slope_of_colour(void **state)
{
    (void)state;
    static const uint32_t sides[] = {2, 3, 17, 40, 33};
    struct arena *arena = arena_create(0);
    for (int k = 0; k < 5; k++) {
        const uint32_t side = sides[k];
        struct terrain_image image = {side, side, ARENA_ARRAY(arena, float, 3 * side * side)};
        for (uint32_t i = 0; i < side * side; i++)
            for (uint32_t c = 0; c < 3; c++)
                image.values[3 * i + c] = (float)(c == 0   ? i % side
                                                  : c == 1 ? i / side
                                                           : side - 1) /
                                          (float)(side - 1);
        const float(*colors)[3] = (const float(*)[3])terrain_image_resample(arena, &image, 17, 9);
        for (int z = 0; z < 9; z++)
            for (int x = 0; x < 17; x++) {
                const float *color = colors[17 * z + x];
                assert_float_equal(color[2], 1, 1e-6);
                if (x > 0 && x < 16 && z > 0 && z < 8) {
                    assert_float_equal(color[0], x / 16.0, k < 3 ? 1e-6 : 0.01);
                    assert_float_equal(color[1], z / 8.0, k < 2 ? 1e-6 : 0.01);
                }
            }
    }
    arena_destroy(arena);
}

/* Pixels in turn black and white are grey where two of them come to one vertex. */
static void test_color__of_a_finer_image_is_a_mean(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct terrain_image image = {33, 17, ARENA_ARRAY(arena, float, 3 * 33 * 17)};
    for (size_t i = 0; i < 33 * 17; i++)
        image.values[3 * i] = (float)((i % 33 + i / 33) % 2);
    const float(*colors)[3] = (const float(*)[3])terrain_image_resample(arena, &image, 17, 9);
    for (size_t i = 17 + 1; i < 17 * 8 - 1; i++) /* half a tent stands over the border */
        if (i % 17 > 0 && i % 17 < 16)
            assert_float_equal(colors[i][0], 0.5, 1e-6);
    arena_destroy(arena);
}

/* Perlin 1985: 0 in the mean, within its amplitude; of one octave linear combinations of the
 * gradients' ramps, so bounded slopes; another seed is another terrain. */
static void test_perlin__makes_the_papers_patches_smooth_within_bounds_and_by_seed(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct description description = description_of(NULL, 0);
    description.ground.noise = (struct relief_noise){{101, 101}, 30, 20, 1, 0.5, 1};
    struct terrain one, two, rough;
    assert_int_equal(terrain_build(arena, &description, &one, NULL), STATUS_OK);
    description.ground.noise.seed = 2;
    assert_int_equal(terrain_build(arena, &description, &two, NULL), STATUS_OK);
    description.ground.noise.octaves = 6;
    assert_int_equal(terrain_build(arena, &description, &rough, NULL), STATUS_OK);
    assert_int_equal(terrain_mesh(arena, &one)->triangles_count, 2 * 10000);
    double range[2] = {0, 0}, bend = 0, rough_bend = 0;
    size_t same = 0;
    for (size_t k = 1; k + 1 < 101 * 101; k++) {
        range[0] = fmin(range[0], (double)one.heights_m[k]);
        range[1] = fmax(range[1], (double)one.heights_m[k]);
        same += one.heights_m[k] == two.heights_m[k];
        if (k % 101 == 0 || k % 101 == 100)
            continue;
        bend += fabs((double)(two.heights_m[k - 1] - 2 * two.heights_m[k] + two.heights_m[k + 1]));
        rough_bend += fabs(
            (double)(rough.heights_m[k - 1] - 2 * rough.heights_m[k] + rough.heights_m[k + 1]));
    }
    assert_true(range[0] > -30 && range[0] < -8 && range[1] < 30 && range[1] > 8);
    assert_true(same < 100); /* but where lattice points agree */
    assert_true(rough_bend > 3 * bend);
    arena_destroy(arena);
}

/* A ramp along x that grows steeper, by an image of 41 x 41: heights (x / 100 + 1 / 2)^2 60 m, so
 * that slope and height at a foot are known. */
static double ramp_m(double x)
{
    return 60 * (x / 100 + 0.5) * (x / 100 + 0.5);
}

static void ramp_terrain(struct arena *arena, struct terrain *terrain)
{
    *terrain = (struct terrain){.samples_x = 401, .samples_z = 2, .size_x_m = 100, .size_z_m = 100};
    terrain->heights_m = ARENA_ARRAY(arena, float, 802);
    for (int k = 0; k < 802; k++)
        terrain->heights_m[k] = (float)ramp_m(k % 401 / 400.0 * 100 - 50);
    terrain_normals(arena, terrain);
}

static void test_trees__stand_where_slope_and_height_allow_them_and_all_of_them(void **state)
{
    (void)state;
    static struct plant_entry plant = {
        .name = "oak", .weight = 1, .scale = {1, 1}, .stretch = {1, 1}};
    struct arena *arena = arena_create(0);
    struct terrain terrain;
    ramp_terrain(arena, &terrain);
    for (int kind = 0; kind < 3; kind++) {
        struct description description = {.path = "t.json", .plants = &plant, .plants_count = 1};
        description.placement =
            (struct placement){.kind = kind ? PLACEMENT_POISSON : PLACEMENT_GRID,
                               .extent_m = 100,
                               .jitter = 1,
                               .min_distance_m = kind == 2 ? 0.5 : 0,
                               .bounded = true,
                               .slope_max_deg = 30,
                               .heights_m = {5, kind ? 40 : 12},
                               .terrain = &terrain};
        struct instance *trees;
        struct error error = {STATUS_OK, ""};
        double half_m, low_m = INFINITY, high_m = -INFINITY, south = 0;
        place_trees(arena, &description, 500, 3, &trees, &half_m, &error);
        assert_string_equal(error.text, "");
        for (int k = 0; k < 500; k++) {
            double x = (double)trees[k].position_m[0];
            double slope_deg = atan(1.2 * (x / 100 + 0.5)) * 57.29577951308232;
            if (!(slope_deg < 30.05) || ramp_m(x) < 4.99 || ramp_m(x) > (kind ? 14 : 12.01))
                fail_msg("kind %d: %g m: %g degrees, %g m high", kind, x, slope_deg, ramp_m(x));
            low_m = fmin(low_m, ramp_m(x));
            high_m = fmax(high_m, ramp_m(x));
            south += trees[k].position_m[2] > 0;
        }
        assert_true(low_m < 5.3 && high_m > (kind ? 13.4 : 11.5)); /* all of the strip is used */
        assert_true(south > 200 && south < 300);
        description.placement.heights_m[0] = 70;
        description.placement.heights_m[1] = 80;
        if (kind != 2) {
            assert_int_equal(place_trees(arena, &description, 500, 3, &trees, &half_m, &error),
                             STATUS_INVALID);
            assert_non_null(strstr(error.text, "t.json: placement: 500 trees do not fit where the "
                                               "slope is up to 30 degrees and the height 70..80"));
        }
    }
    arena_destroy(arena);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_source__png_of_8_bits_is_a_share_of_white_and_exr_is_in_its_own_unit),
        cmocka_unit_test(test_source__a_geotiff_is_in_its_own_unit_whole_or_float),
        cmocka_unit_test(test_source__bad_values_are_refused_in_one_line_that_names_them),
        cmocka_unit_test(test_color__of_the_terrains_size_is_a_colour_a_vertex),
        cmocka_unit_test(test_color__of_another_size_keeps_a_slope_of_colour),
        cmocka_unit_test(test_color__of_a_finer_image_is_a_mean),
        cmocka_unit_test(test_perlin__makes_the_papers_patches_smooth_within_bounds_and_by_seed),
        cmocka_unit_test(test_trees__stand_where_slope_and_height_allow_them_and_all_of_them),
    };
    return cmocka_run_group_tests(tests, folder_make, folder_remove);
}
