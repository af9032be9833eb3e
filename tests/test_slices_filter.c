/* Filters of slices beside their formulas, and the casting of lines that graze. */
#include "slices_meshes.h"

#include "bake/slices.h"
#include "bake/slices_raster.h"

enum { F = SLICES_FLOATS };

/* Premultiplied texels: random coverage, some of it 0 or 1, colours below it. */
static float *random_texels(struct arena *arena, size_t count, uint64_t seed)
{
    struct random random = random_seed(seed, 1);
    float *texels = ARENA_ARRAY(arena, float, count *F);
    for (size_t i = 0; i < count; i++) {
        float kind = random_float(&random), coverage = random_float(&random);
        coverage = kind < 0.2f ? 0 : kind > 0.9f ? 1 : coverage;
        for (int k = 0; k < F; k++) {
            float value = random_float(&random);
            texels[i * F + (size_t)k] = coverage * (k == 3            ? 1
                                                    : k >= 4 && k < 7 ? 1.1f * value - 0.55f
                                                                      : value);
        }
    }
    return texels;
}

static void test_slices_filter__fusing_is_associative_and_multiplies_transmittances(void **state)
{
    (void)state;
    enum { COUNT = 500 };
    struct arena *arena = arena_create(0);
    float *a = random_texels(arena, COUNT, 1), *b = random_texels(arena, COUNT, 2),
          *c = random_texels(arena, COUNT, 3);
    float *left = ARENA_ARRAY(arena, float, COUNT *F), *right = ARENA_ARRAY(arena, float, COUNT *F);
    slices_fuse(a, b, COUNT, left);
    slices_fuse(left, c, COUNT, left);
    slices_fuse(b, c, COUNT, right);
    slices_fuse(a, right, COUNT, right);
    for (size_t i = 0; i < COUNT * F; i++) {
        assert_float_equal(left[i], right[i], 1e-6);
        if (i % F == 3) {
            assert_float_equal(left[i], 1 - (1 - a[i]) * (1 - b[i]) * (1 - c[i]), 1e-6);
            /* a1 C1 + (1 - a1) a2 C2 + ..., of premultiplied colours */
            double color = a[i - 3] + (1 - a[i]) * b[i - 3] + (1 - a[i]) * (1 - b[i]) * c[i - 3];
            assert_float_equal(left[i - 3], color, 1e-6);
        }
    }
    /* Twice .3 is .51. */
    float half[F] = {0.3f, 0.3f, 0.3f, 0.3f}, both[F];
    slices_fuse(half, half, 1, both);
    assert_float_equal(both[3], 0.51, 1e-6);
    arena_destroy(arena);
}

static void test_slices_filter__halving_keeps_the_mean(void **state)
{
    (void)state;
    static const int sides[7] = {1, 2, 3, 5, 8, 13, 30};
    struct arena *arena = arena_create(0);
    for (int n = 0; n < 49; n++) {
        int width = sides[n % 7], height = sides[n / 7];
        size_t count = (size_t)width * (size_t)height;
        size_t half = (size_t)(width > 1 ? width / 2 : 1) * (size_t)(height > 1 ? height / 2 : 1);
        float *from = random_texels(arena, count, 100 + (uint64_t)n);
        float *to = ARENA_ARRAY(arena, float, half *F);
        slices_halve(from, width, height, to);
        for (size_t k = 0; k < F; k++) {
            double before = 0, after = 0;
            for (size_t i = 0; i < count; i++)
                before += (double)from[i * F + k] / (double)count;
            for (size_t i = 0; i < half; i++)
                after += (double)to[i * F + k] / (double)half;
            assert_float_equal(before, after, 1e-5);
        }
    }
    arena_destroy(arena);
}

static void test_slices_filter__bytes_hold_straight_colour_and_unit_normals(void **state)
{
    (void)state;
    enum { COUNT = 400 };
    struct arena *arena = arena_create(0);
    float *texels = random_texels(arena, COUNT, 7);
    uint8_t color[COUNT][4], normal[COUNT][4];
    for (int form = 0; form < 4; form++) {
        slices_encode(texels, COUNT, form & 1, form & 2, color, normal);
        for (int i = 0; i < COUNT; i++) {
            const float *t = texels + i * F;
            double length = sqrt(t[4] * t[4] + t[5] * t[5] + t[6] * t[6]);
            if (t[3] == 0) {
                const uint8_t none[4] = {0}, zero[4] = {128, 128, 128, 0};
                assert_memory_equal(color[i], none, 4);
                assert_memory_equal(normal[i], zero, 4);
                continue;
            }
            assert_float_equal(color[i][3], 255 * t[3], 0.51);
            for (int k = 0; k < 3; k++) {
                assert_float_equal(color[i][k], 255 * t[k] / (form & 1 ? t[3] : 1), 0.51);
                assert_float_equal(normal[i][k] - 128, 127 * t[4 + k] / (form & 2 ? length : t[3]),
                                   0.51);
            }
            assert_float_equal(normal[i][3], 255 * t[7] / t[3], 0.51);
        }
    }
    arena_destroy(arena);
}

/* Dilation as its definition says it, one ring after the other, each read from a copy. */
static void dilate_slowly(double (*color)[3], double (*normal)[3], bool *known, int side, int rings)
{
    for (int ring = 0; ring < rings; ring++) {
        static double old_color[24 * 24][3], old_normal[24 * 24][3];
        static bool old_known[24 * 24];
        memcpy(old_color, color, sizeof(double[3]) * (size_t)(side * side));
        memcpy(old_normal, normal, sizeof(double[3]) * (size_t)(side * side));
        memcpy(old_known, known, sizeof(bool) * (size_t)(side * side));
        for (int i = 0; i < side * side; i++) {
            double colors[3] = {0}, normals[3] = {0}, lengths = 0, found = 0;
            for (int j = 0; j < side * side && !old_known[i]; j++) {
                const double *n = old_normal[j];
                if (!old_known[j] || abs(i % side - j % side) > 1 || abs(i / side - j / side) > 1)
                    continue;
                found++;
                lengths += sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
                for (int k = 0; k < 3; k++) {
                    colors[k] += old_color[j][k];
                    normals[k] += n[k];
                }
            }
            double sum =
                sqrt(normals[0] * normals[0] + normals[1] * normals[1] + normals[2] * normals[2]);
            for (int k = 0; k < 3 && found > 0; k++) {
                known[i] = true;
                color[i][k] = floor(colors[k] / found + 0.5);
                normal[i][k] = sum > 0 ? nearbyint(normals[k] * lengths / found / sum) : 0;
            }
        }
    }
}

static void test_slices_filter__dilation_takes_from_covered_neighbours_alone(void **state)
{
    (void)state;
    enum { SIDE = 24, COUNT = SIDE * SIDE };
    struct random random = random_seed(5, 5);
    for (int rings = 0; rings < 5; rings++) {
        static uint8_t color[COUNT][4], normal[COUNT][4], before[COUNT][4];
        static double colors[COUNT][3], normals[COUNT][3];
        static bool known[COUNT];
        for (int i = 0; i < COUNT; i++) {
            bool covered = random_float(&random) < 0.06f;
            known[i] = covered;
            color[i][3] = covered ? (uint8_t)(1 + random_below(&random, 255)) : 0;
            normal[i][3] = (uint8_t)(covered ? 200 : 0);
            for (int k = 0; k < 3; k++) { /* what stands in empty texels must not be read */
                colors[i][k] = color[i][k] = (uint8_t)random_below(&random, 256);
                normal[i][k] = (uint8_t)(55 + random_below(&random, 147));
                normals[i][k] = normal[i][k] - 128;
            }
        }
        memcpy(before, color, sizeof before);
        dilate_slowly(colors, normals, known, SIDE, rings);
        slices_dilate(color, normal, SIDE, SIDE, rings);
        for (int i = 0; i < COUNT; i++) {
            assert_int_equal(color[i][3], before[i][3]);
            for (int k = 0; k < 3; k++) {
                assert_int_equal(color[i][k], (int)colors[i][k]);
                assert_float_equal(normal[i][k] - 128, normals[i][k], 1);
            }
            if (known[i])
                assert_int_equal(normal[i][3], 200);
        }
    }
}

/* A stack's composite as seen from the front or from behind. */
static float *composite(struct arena *arena, const struct slices *slices, size_t stack, bool behind)
{
    size_t texels = (size_t)slices->width_px * (size_t)slices->height_px;
    float *sum = ARENA_ARRAY(arena, float, texels *F), *next = ARENA_ARRAY(arena, float, texels *F);
    for (int k = 0; k < slices->count; k++) {
        slices_expand(slices, stack, behind ? slices->count - 1 - k : k, next);
        slices_fuse(next, sum, texels, sum);
    }
    return sum;
}

static void test_slices_filter__a_pyramid_of_slices_looks_as_its_foot_does(void **state)
{
    (void)state;
    enum { SIDE = 32 };
    struct arena *arena = arena_create(0);
    struct error error;
    struct plant *plant = plant_from_mesh(arena, "tree", tree_mesh(arena, 200));
    for (int count = 1; count < 17; count += 5) {
        struct slices_request request = {.directions_count = 3,
                                         .directions = slices_axes,
                                         .width_px = SIDE,
                                         .height_px = SIDE,
                                         .count = count,
                                         .samples = 3,
                                         .parts = SLICES_BARK | SLICES_LEAVES};
        const struct slices *foot;
        assert_int_equal(slices_create(arena, plant, &request, 2, &foot, &error), STATUS_OK);
        for (int behind = 0; behind < 2; behind++)
            for (const struct slices *level = foot; level->count > 1;) {
                const struct slices *next = slices_fused(arena, level, behind);
                assert_int_equal(next->count, (level->count + 1) / 2);
                for (size_t stack = 0; stack < 3; stack++) {
                    const float *a = composite(arena, foot, stack, behind);
                    const float *b = composite(arena, next, stack, behind);
                    const struct slices_stack *box = &foot->stacks[stack],
                                              *wide = &next->stacks[stack];
                    assert_float_equal((wide->high_m[2] - wide->low_m[2]) / (float)next->count,
                                       2 * (level->stacks[stack].high_m[2] - box->low_m[2]) /
                                           (float)level->count,
                                       1e-4);
                    for (int i = 0; i < SIDE * SIDE * F; i++)
                        assert_float_equal(a[i], b[i], 0.03);
                }
                level = next;
            }
    }
    arena_destroy(arena);
}

static void test_raster__a_line_through_edges_and_corners_meets_one_triangle(void **state)
{
    (void)state;
    /* A sheet of SIDE x SIDE cells, in eight triangles each, whose corners and edges all lie on
     * lines; every second triangle is seen from behind. */
    enum { SIDE = 4, CELL = 4, LINES = SIDE * CELL + 1, TRIANGLES = SIDE * SIDE * 8 };
    static const int ring[9][2] = {{0, 0}, {2, 0}, {4, 0}, {4, 2}, {4, 4},
                                   {2, 4}, {0, 4}, {0, 2}, {0, 0}};
    static int32_t points[3 * TRIANGLES][2];
    static float depths[3 * TRIANGLES];
    static uint32_t triangles[TRIANGLES][3], list[TRIANGLES];
    for (uint32_t t = 0; t < TRIANGLES; t++) {
        int cell = (int)(t / 8), n = (int)(t % 8);
        const int corners[3][2] = {
            {2, 2}, {ring[n][0], ring[n][1]}, {ring[n + 1][0], ring[n + 1][1]}};
        list[t] = t;
        for (uint32_t k = 0; k < 3; k++) {
            int x = cell % SIDE * CELL + corners[k][0], y = cell / SIDE * CELL + corners[k][1];
            triangles[t][k] = 3 * t + (t & 1 ? 2 - k : k);
            points[3 * t + k][0] = x * 1024 + 512;
            points[3 * t + k][1] = y * 1024 + 512;
            depths[3 * t + k] = (float)x + 10 * (float)y;
        }
    }
    struct arena *arena = arena_create(0);
    struct raster_plane plane = {LINES, LINES, points, depths, (const uint32_t(*)[3])triangles};
    for (int first = 0; first < LINES; first += 5) { /* in bands */
        int rows = LINES - first < 5 ? LINES - first : 5;
        struct raster_band band;
        raster_cast(arena, &plane, list, TRIANGLES, first, rows, &band);
        for (int at = 0; at < rows * LINES; at++) {
            int i = at % LINES, j = first + at / LINES;
            size_t hits = band.first[at + 1] - band.first[at];
            if (i > 0 && j > 0 && i < LINES - 1 && j < LINES - 1)
                assert_int_equal(hits, 1);
            assert_true(hits <= 1);
            if (hits)
                assert_float_equal(band.hits[band.first[at]].depth, i + 10 * j, 1e-3);
        }
    }
    arena_destroy(arena);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_slices_filter__fusing_is_associative_and_multiplies_transmittances),
        cmocka_unit_test(test_slices_filter__halving_keeps_the_mean),
        cmocka_unit_test(test_slices_filter__bytes_hold_straight_colour_and_unit_normals),
        cmocka_unit_test(test_slices_filter__dilation_takes_from_covered_neighbours_alone),
        cmocka_unit_test(test_raster__a_line_through_edges_and_corners_meets_one_triangle),
        cmocka_unit_test(test_slices_filter__a_pyramid_of_slices_looks_as_its_foot_does),
    };
    setenv("TREELINE_CACHE", "off", 1);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
