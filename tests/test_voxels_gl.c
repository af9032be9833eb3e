/* Voxels as shaders march through them: outlines on the screen, against brute force. */
#include "testing.h"

#include "bake/voxels_gl.h"
#include "base/random.h"

#include <math.h>
#include <stdlib.h>

/* A grid of random sizes, of which about one cell in `rare` is not empty. */
static struct voxels_level grid(struct arena *arena, struct random *random, uint32_t most,
                                uint32_t rare)
{
    struct voxels_level level = {.voxel_m = 1};
    size_t count = 1;
    for (int i = 0; i < 3; i++)
        count *= level.size[i] = 1 + random_below(random, most);
    level.cells = ARENA_ARRAY(arena, uint32_t, count);
    for (size_t at = 0; at < count; at++)
        level.cells[at] = random_below(random, rare) ? 1 : VOXELS_FIRST + (uint32_t)at;
    return level;
}

static int place_of(const struct voxels_level *level, size_t at, int place[3])
{
    place[0] = (int)(at % level->size[0]);
    place[1] = (int)(at / level->size[0] % level->size[1]);
    place[2] = (int)(at / level->size[0] / level->size[1]);
    return level->cells[at] >= VOXELS_FIRST;
}

/* A camera anywhere around a grid that looks at its middle. */
static struct hull_frame frame_around(struct random *random, const uint32_t size[3])
{
    float forward[3], right[3], down[3], length = 0, middle = 0;
    for (int i = 0; i < 3; i++) {
        forward[i] = 2 * random_float(random) - 1;
        length += forward[i] * forward[i];
    }
    for (int i = 0; i < 3; i++)
        forward[i] /= sqrtf(length);
    const float level = sqrtf(forward[0] * forward[0] + forward[2] * forward[2]);
    right[0] = -forward[2] / level;
    right[1] = 0;
    right[2] = forward[0] / level;
    down[0] = forward[1] * right[2] - forward[2] * right[1];
    down[1] = forward[2] * right[0] - forward[0] * right[2];
    down[2] = forward[0] * right[1] - forward[1] * right[0];
    const float away = 40 + 200 * random_float(random), focal_px = 300;
    const float turn = 6.2831853f * random_float(random), c = cosf(turn), s = sinf(turn);
    struct hull_frame frame;
    for (int i = 0; i < 3; i++) {
        float x = c * right[i] + s * down[i], y = c * down[i] - s * right[i];
        frame.depth[i] = forward[i];
        frame.across[i] = focal_px * x + 100 * forward[i];
        frame.down[i] = focal_px * y + 80 * forward[i];
        middle += 0.5f * (float)size[i] * forward[i];
    }
    frame.depth[3] = away - middle;
    frame.across[3] = frame.down[3] = 0;
    for (int i = 0; i < 3; i++) {
        frame.across[3] -= 0.5f * (float)size[i] * frame.across[i];
        frame.down[3] -= 0.5f * (float)size[i] * frame.down[i];
    }
    frame.across[3] += 100 * away;
    frame.down[3] += 80 * away;
    return frame;
}

static float seen(const float axis[4], const float point[3])
{
    return axis[0] * point[0] + axis[1] * point[1] + axis[2] * point[2] + axis[3];
}

enum { SIDES = 6 }; /* of a silhouette: of its rows, of its rectangle, leaning */

/* The voxels' corners within a silhouette: least, px, of all its sides; of each. */
struct margins {
    float least, sides[SIDES];
};

static struct margins margins_of(const struct voxels_level *level,
                                 const struct silhouette *silhouette,
                                 const struct hull_frame *frame)
{
    struct margins margins = {99, {99, 99, 99, 99, 99, 99}};
    const size_t count = (size_t)level->size[0] * level->size[1] * level->size[2];
    for (size_t at = 0; at < 8 * count; at++) {
        int place[3];
        float corner[3];
        if (!place_of(level, at / 8, place))
            continue;
        for (int i = 0; i < 3; i++)
            corner[i] = (float)(place[i] + (int)(at >> i & 1));
        const float depth = seen(frame->depth, corner);
        const float x = seen(frame->across, corner) / depth, y = seen(frame->down, corner) / depth;
        const float leaning = x - silhouette->lean * (y - silhouette->low[1]);
        const float within[SIDES] = {
            y - silhouette->low[1],          silhouette->high[1] - y,
            x - silhouette->low[0],          silhouette->high[0] - x,
            leaning - silhouette->bounds[0], silhouette->bounds[1] - leaning};
        for (int i = 0; i < SIDES; i++) {
            margins.sides[i] = fminf(margins.sides[i], within[i]);
            margins.least = fminf(margins.least, within[i]);
        }
    }
    return margins;
}

static void test_silhouette__holds_every_voxel(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct random random = random_seed(2, 1);
    for (int round = 0; round < 60; round++) {
        struct voxels_level level = grid(arena, &random, 12, 1 + random_below(&random, 40));
        size_t count = (size_t)level.size[0] * level.size[1] * level.size[2], full = 0;
        for (size_t at = 0; at < count; at++)
            full += level.cells[at] >= VOXELS_FIRST;
        struct hull hull;
        hull_of_level(&level, &hull);
        struct hull_frame frame = frame_around(&random, level.size);
        struct silhouette silhouette;
        assert_int_equal(hull.count > 0, full > 0);
        if (!full)
            continue;
        silhouette_of(&hull, &frame, &silhouette);
        struct margins margins = margins_of(&level, &silhouette, &frame);
        if (margins.least < -0.01f)
            fail_msg("round %d: a voxel lies %g px beyond its outline", round,
                     (double)-margins.least);
    }
    arena_destroy(arena);
}

/* Octagons of voxels that shrink from row to row, each around the same axis: the corners of the
 * hull are theirs. */
static struct voxels_level octagons(struct arena *arena, struct random *random)
{
    enum { ROWS = HULL_RINGS - 1 };
    const int side = 9 + (int)random_below(random, 5), cut = (int)random_below(random, 3);
    struct voxels_level level = {
        .voxel_m = 1, .size = {(uint32_t)side, ROWS, (uint32_t)side}, .cells = NULL};
    uint32_t *cell = level.cells = ARENA_ARRAY(arena, uint32_t, (size_t)(side * ROWS * side));
    int inset[ROWS] = {0}; /* of a row's square; cut: of its corners */
    for (int y = 1; y < ROWS; y++)
        inset[y] = inset[y - 1] + (inset[y - 1] < 3 && random_below(random, 2));
    for (int z = 0; z < side; z++)
        for (int y = 0; y < ROWS; y++)
            for (int x = 0; x < side; x++, cell++) {
                const int low = inset[y], high = side - inset[y], across = high - low - cut;
                const bool inside = x >= low && x < high && z >= low && z < high &&
                                    x + z >= 2 * low + cut && x + z + 2 <= 2 * high - cut &&
                                    x + 1 - z <= across && z + 1 - x <= across;
                *cell = inside ? VOXELS_FIRST : 1;
            }
    return level;
}

static void test_silhouette__of_shrinking_octagons_is_no_larger_than_they(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct random random = random_seed(3, 1);
    for (int round = 0; round < 60; round++) {
        struct voxels_level level = octagons(arena, &random);
        struct hull hull;
        struct silhouette silhouette;
        hull_of_level(&level, &hull);
        struct hull_frame frame = frame_around(&random, level.size);
        silhouette_of(&hull, &frame, &silhouette);
        struct margins margins = margins_of(&level, &silhouette, &frame);
        for (int i = 0; i < SIDES; i++)
            if (!(fabsf(margins.sides[i]) < 0.01f))
                fail_msg("round %d: side %d is %g px from every voxel", round, i,
                         (double)margins.sides[i]);
    }
    arena_destroy(arena);
}

/* A pole: its lines lean as its axis does where that is nearer to a column than to a row. */
static void test_silhouette__leans_as_a_pole_does(void **state)
{
    (void)state;
    enum { HEIGHT = 40 };
    struct arena *arena = arena_create(0);
    struct random random = random_seed(4, 1);
    struct voxels_level level = {.voxel_m = 1, .size = {1, HEIGHT, 1}};
    level.cells = ARENA_ARRAY(arena, uint32_t, HEIGHT);
    for (int i = 0; i < HEIGHT; i++)
        level.cells[i] = VOXELS_FIRST;
    struct hull hull;
    hull_of_level(&level, &hull);
    int leaning = 0, level_ones = 0;
    for (int round = 0; round < 60; round++) {
        struct hull_frame frame = frame_around(&random, level.size);
        struct silhouette silhouette;
        const float foot[3] = {0.5f, 0, 0.5f}, top[3] = {0.5f, HEIGHT, 0.5f};
        float way[2];
        silhouette_of(&hull, &frame, &silhouette);
        for (int i = 0; i < 2; i++) {
            const float *axis = i ? frame.down : frame.across;
            way[i] = seen(axis, top) / seen(frame.depth, top) -
                     seen(axis, foot) / seen(frame.depth, foot);
        }
        if (fabsf(way[0]) < 1.8f * fabsf(way[1])) {
            assert_true(fabsf(silhouette.lean - way[0] / way[1]) < 0.01f);
            leaning++;
        } else if (fabsf(way[0]) > 2.2f * fabsf(way[1])) {
            assert_true(silhouette.lean == 0);
            level_ones++;
        }
    }
    assert_true(leaning > 10 && level_ones > 10);
    arena_destroy(arena);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_silhouette__holds_every_voxel),
        cmocka_unit_test(test_silhouette__of_shrinking_octagons_is_no_larger_than_they),
        cmocka_unit_test(test_silhouette__leans_as_a_pole_does),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
