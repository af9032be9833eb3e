/* How far rays go through empty voxels: against brute force, and against what lies on them. */
#include "testing.h"

#include "bake/march_free.h"
#include "base/random.h"
#include "march_block.h"

#include <stdlib.h>

enum { ACROSS = 23, DOWN = 9, DEEP = 17, CELLS = ACROSS * DOWN * DEEP };

struct grid {
    struct arena *arena;
    struct voxels_level level;
    uint32_t *cells; /* made of it */
};

/* One of so many cells is full. */
static struct grid grid_of(uint32_t one_of, uint64_t seed)
{
    struct grid grid = {.arena = arena_create(0),
                        .level = {.size = {ACROSS, DOWN, DEEP}, .voxel_m = 1}};
    struct random random = random_seed(seed, 1);
    grid.level.cells = ARENA_ARRAY(grid.arena, uint32_t, CELLS);
    for (uint32_t i = 0; i < CELLS; i++)
        grid.level.cells[i] = random_below(&random, one_of) ? 0 : VOXELS_FIRST;
    grid.cells = march_free_cells(grid.arena, &grid.level);
    return grid;
}

/* Chessboard distance from a place to the nearest full cell that a ray of the way may come to. */
static long distance_ahead(const struct grid *grid, long at, int way)
{
    const long place[3] = {at % ACROSS, at / ACROSS % DOWN, at / (ACROSS * DOWN)};
    long least = 1000;
    for (long other = 0; other < CELLS; other++) {
        if (grid->level.cells[other] < VOXELS_FIRST)
            continue;
        const long there[3] = {other % ACROSS, other / ACROSS % DOWN, other / (ACROSS * DOWN)};
        long distance = 0;
        bool ahead = true;
        for (int i = 0; i < 3; i++) {
            long apart = way >> i & 1 ? place[i] - there[i] : there[i] - place[i];
            ahead &= apart >= 0;
            distance = apart > distance ? apart : distance;
        }
        least = ahead && distance < least ? distance : least;
    }
    return least;
}

static void test_march_free__cells_tell_the_distance_ahead_for_each_of_eight_ways(void **state)
{
    (void)state;
    for (uint32_t one_of = 40; one_of <= 1000; one_of *= 25) {
        struct grid grid = grid_of(one_of, one_of);
        for (long at = 0; at < CELLS; at++) {
            const uint32_t cell = grid.cells[at];
            const bool full = grid.level.cells[at] >= VOXELS_FIRST;
            assert_int_equal(full, cell >> 31);
            for (int way = 0; way < 8 && !full; way++) {
                long most = way == 7 ? 7 : 15, ahead = distance_ahead(&grid, at, way) - 1;
                assert_int_equal(ahead < most ? ahead : most,
                                 cell >> (MARCH_WAY_BITS * way) & MARCH_WAY_MASK);
            }
        }
        arena_destroy(grid.arena);
    }
}

/* What of a ray from the eye lies in full cells, by small steps in double. */
static double length_met(const struct grid *grid, const float eye[3], const float ray[3])
{
    const double step = 1e-3;
    double length = 0;
    for (double t = 0.5 * step; t < 100; t += step) {
        long at[3];
        for (int i = 0; i < 3; i++)
            at[i] = (long)floor(eye[i] + t * ray[i]);
        if (at[0] < 0 || at[1] < 0 || at[2] < 0 || at[0] >= ACROSS || at[1] >= DOWN ||
            at[2] >= DEEP)
            continue;
        length +=
            grid->level.cells[(at[2] * DOWN + at[1]) * ACROSS + at[0]] >= VOXELS_FIRST ? step : 0;
    }
    return length;
}

/* From everywhere around, by every kernel: each ray's loss is that of all that lies on it. */
static void test_march_free__rays_skip_nothing_that_hides(void **state)
{
    (void)state;
    const float depth = 0.2f, most[3] = {ACROSS, DOWN, DEEP};
    struct march_isa isas[4];
    const size_t count = march_isas(isas);
    struct grid grid = grid_of(30, 5);
    struct voxel_optics optics = {.extinction = depth, .evenness = 1, .albedo = {1, 1, 1}};
    struct voxel voxel = voxel_pack(&optics, (const float[3]){1, 1, 1});
    struct random random = random_seed(9, 4);
    double met = 0;
    for (uint32_t i = 0; i < CELLS; i++) /* all of them the same */
        grid.cells[i] = grid.cells[i] & MARCH_FULL ? MARCH_FULL : grid.cells[i];
    for (int n = 0; n < 150; n++) {
        struct march_job job = {.cells = grid.cells,
                                .voxels = (const uint32_t *)(const void *)&voxel,
                                .size = {ACROSS, DOWN, DEEP},
                                .speed = 1,
                                .step = 1.0f / 32,
                                .far_m = INFINITY,
                                .hidden = {{1}},
                                .seen = {{1}},
                                .lit = {{1}},
                                .clear = 1};
        float length = 0;
        for (int i = 0; i < 3; i++) {
            job.eye[i] = most[i] * (2 * random_float(&random) - 0.5f);
            job.first[i] = most[i] * random_float(&random) - job.eye[i];
            length += job.first[i] * job.first[i];
        }
        for (int i = 0; i < 3; i++)
            job.first[i] /= sqrtf(length);
        double hidden = depth * length_met(&grid, job.eye, job.first);
        met += hidden > 0;
        for (size_t isa = 0; isa < count; isa++) {
            struct block rays;
            block_open(&rays);
            block_march(&isas[isa], &job, &rays);
            double off = -log(rays.left[0]) - hidden;
            if (!(fabs(off) < 0.1 * depth))
                fail_msg("ray %d, %s: depth off by %g of a voxel's", n, isas[isa].name,
                         off / depth);
        }
    }
    assert_true(met > 50);
    arena_destroy(grid.arena);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_march_free__cells_tell_the_distance_ahead_for_each_of_eight_ways),
        cmocka_unit_test(test_march_free__rays_skip_nothing_that_hides),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
