/* Fractal relief: the paper's triangle counts, each vertex near the middle of its edge, no crack,
 * no drift. */
#include "testing.h"

#include "scene/relief.h"
#include "scene/terrain.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static struct terrain relief_terrain(struct arena *arena, int level, double spike_m, uint64_t seed)
{
    struct description description = {.path = "test"};
    description.ground = (struct ground){
        .given = true, .size_m = {200, 100}, .level = level, .spike_m = spike_m, .seed = seed};
    struct terrain terrain;
    assert_int_equal(terrain_build(arena, &description, &terrain, NULL), STATUS_OK);
    return terrain;
}

static void test_relief__has_the_triangles_of_the_papers_law(void **state)
{
    (void)state;
    static const size_t rows[][2] = {{1, 4}, {2, 8}, {5, 64}, {7, 256}, {9, 1024}, {14, 32768}};
    struct arena *arena = arena_create(0);
    for (size_t k = 0; k < 6; k++) {
        struct terrain terrain = relief_terrain(arena, (int)rows[k][0], 5, 1);
        const struct mesh *mesh = terrain_mesh(arena, &terrain);
        assert_int_equal(mesh->triangles_count, rows[k][1]);
        struct error error = {STATUS_OK, ""};
        assert_int_equal(mesh_check(mesh, &error), STATUS_OK);
    }
    arena_destroy(arena);
}

/* The level that made a vertex is where its index along x or z is odd in units of the stride: it
 * stands within that level's amplitude of its two neighbours' mean, and some come near it. */
static void test_relief__moves_a_vertex_from_its_edges_middle_within_bounds(void **state)
{
    (void)state;
    enum { LEVEL = 11 };
    const double spike = 7;
    struct arena *arena = arena_create(0);
    uint32_t samples[2];
    float *heights = relief_heights(arena, LEVEL, spike, 5, samples);
    assert_int_equal(samples[0], 65);
    assert_int_equal(samples[1], 33);
    size_t seen = 0;
    for (int k = 0; k < LEVEL; k++) {
        uint32_t along = 64u >> (k + 1) / 2, across = 32u >> k / 2; /* strides of x, z before */
        double amplitude = spike * (LEVEL - k) / LEVEL, largest = 0;
        for (uint32_t z = k % 2 ? across / 2 : 0; z < samples[1]; z += across)
            for (uint32_t x = k % 2 ? 0 : along / 2; x < samples[0]; x += along, seen++) {
                size_t at = (size_t)z * samples[0] + x;
                size_t step = k % 2 ? (size_t)samples[0] * across / 2 : along / 2;
                double mean = ((double)heights[at - step] + (double)heights[at + step]) / 2;
                largest = fmax(largest, fabs((double)heights[at] - mean));
            }
        assert_true(largest <= amplitude * (1 + 1e-6));
        assert_true(k < 6 || largest > 0.8 * amplitude);
    }
    assert_int_equal(seen + 4, 65 * 33); /* the corners stay */
    assert_true(heights[0] == 0 && heights[64] == 0 && heights[65 * 33 - 1] == 0);
    arena_destroy(arena);
}

static int by_edge(const void *a, const void *b)
{
    return memcmp(a, b, 2 * sizeof(uint32_t));
}

/* No crack: each edge is of two triangles, or of one where the rectangle ends. */
static void test_relief__has_no_crack(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct terrain terrain = relief_terrain(arena, 9, 12, 3);
    const struct mesh *mesh = terrain_mesh(arena, &terrain);
    uint32_t(*edges)[2] = arena_alloc(arena, 3 * mesh->triangles_count, sizeof *edges);
    size_t count = 0, open = 0;
    for (size_t t = 0; t < mesh->triangles_count; t++)
        for (int k = 0; k < 3; k++, count++) {
            uint32_t a = mesh->triangles[t][k], b = mesh->triangles[t][(k + 1) % 3];
            edges[count][0] = a < b ? a : b;
            edges[count][1] = a < b ? b : a;
        }
    qsort(edges, count, sizeof *edges, by_edge);
    for (size_t i = 0, end; i < count; i = end) {
        for (end = i + 1; end < count && by_edge(edges[i], edges[end]) == 0; end++)
            continue;
        assert_true(end - i <= 2);
        if (end - i == 2)
            continue;
        open++;
        const float *a = mesh->positions[edges[i][0]], *b = mesh->positions[edges[i][1]];
        assert_true((a[0] == b[0] && fabsf(a[0]) == 100) || (a[2] == b[2] && fabsf(a[2]) == 50));
    }
    assert_int_equal(open, 2 * (32 + 16));
    arena_destroy(arena);
}

/* The displacement is centred: over many seeds the middle's mean height is 0 within its error. */
static void test_relief__does_not_drift_upward(void **state)
{
    (void)state;
    enum { SEEDS = 2000 };
    double sum = 0, square = 0;
    for (uint64_t seed = 0; seed < SEEDS; seed++) {
        struct arena *arena = arena_create(0);
        uint32_t samples[2];
        float *heights = relief_heights(arena, 5, 1, seed, samples);
        double mean = 0;
        for (uint32_t i = 0; i < samples[0] * samples[1]; i++)
            mean += (double)heights[i] / (samples[0] * samples[1]);
        sum += mean;
        square += mean * mean;
        arena_destroy(arena);
    }
    assert_true(fabs(sum / SEEDS) < 4 * sqrt(square) / SEEDS);
    assert_true(square > 0);
}

static void test_relief__is_the_same_for_a_seed_and_another_for_another(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct terrain one = relief_terrain(arena, 7, 4, 1), same = relief_terrain(arena, 7, 4, 1);
    struct terrain other = relief_terrain(arena, 7, 4, 2), flat = relief_terrain(arena, 7, 0, 2);
    size_t bytes = (size_t)one.samples_x * one.samples_z * sizeof(float);
    assert_memory_equal(one.heights_m, same.heights_m, bytes);
    assert_memory_not_equal(one.heights_m, other.heights_m, bytes);
    for (size_t i = 0; i < bytes / sizeof(float); i++)
        assert_true(flat.heights_m[i] == 0);
    arena_destroy(arena);
}

/* clang-format off */
int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_relief__has_the_triangles_of_the_papers_law),
        cmocka_unit_test(test_relief__moves_a_vertex_from_its_edges_middle_within_bounds),
        cmocka_unit_test(test_relief__has_no_crack),
        cmocka_unit_test(test_relief__does_not_drift_upward),
        cmocka_unit_test(test_relief__is_the_same_for_a_seed_and_another_for_another),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
