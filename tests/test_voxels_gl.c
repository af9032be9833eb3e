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

/* How far within its bounds a corner of a voxel lies, px; less than 0: beyond them. touched: the
 * least distances to both rows and to the bounds. */
static float margin(const struct silhouette *silhouette, const struct hull_frame *frame,
                    const float corner[3], float touched[4])
{
    const float depth = seen(frame->depth, corner);
    const float x = seen(frame->across, corner) / depth, y = seen(frame->down, corner) / depth;
    const float at = x - silhouette->lean * (y - silhouette->low[1]);
    const float within[4] = {y - silhouette->low[1], silhouette->high[1] - y,
                             at - silhouette->bounds[0], silhouette->bounds[1] - at};
    float least = fminf(x - silhouette->low[0], silhouette->high[0] - x);
    for (int i = 0; i < 4; i++) {
        touched[i] = fminf(touched[i], within[i]);
        least = fminf(least, within[i]);
    }
    return least;
}

static void test_silhouette__holds_every_voxel_and_little_more(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct random random = random_seed(2, 1);
    for (int round = 0; round < 60; round++) {
        struct voxels_level level = grid(arena, &random, 12, 1 + random_below(&random, 40));
        size_t count = (size_t)level.size[0] * level.size[1] * level.size[2], full = 0;
        struct hull hull;
        hull_of_level(&level, &hull);
        struct hull_frame frame = frame_around(&random, level.size);
        struct silhouette silhouette;
        float least = 1, touched[4] = {99, 99, 99, 99};
        if (hull.count)
            silhouette_of(&hull, &frame, &silhouette);
        for (size_t at = 0; at < 8 * count; at++) {
            int place[3];
            if (!place_of(&level, at / 8, place))
                continue;
            float corner[3];
            for (int i = 0; i < 3; i++)
                corner[i] = (float)(place[i] + (int)(at >> i & 1));
            full++;
            assert_true(hull.count > 0);
            least = fminf(least, margin(&silhouette, &frame, corner, touched));
        }
        assert_true(full > 0 || hull.count == 0);
        if (least < -0.01f)
            fail_msg("round %d: a voxel lies %g px beyond its outline", round, (double)-least);
        if (count == full / 8) /* a block: its corners are the hull's */
            for (int i = 0; i < 4; i++)
                assert_true(touched[i] < 0.01f);
    }
    arena_destroy(arena);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_silhouette__holds_every_voxel_and_little_more),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
