/* How far down a shadow can be seen: lowest heights of blocks of the terrain. */
#include "bake/shadow_floor.h"

enum { BLOCKS = 64, STEPS_MOST = 64 };

struct shadow_floor {
    const struct terrain *terrain;
    bool flat;                    /* the plane y = 0 */
    float lows_m[BLOCKS][BLOCKS]; /* z, x */
};

/* First and last sample along a side of a block; neighbours share samples. */
static void span_of(uint32_t samples, uint32_t block, uint32_t *first, uint32_t *last)
{
    uint64_t quads = samples - 1;
    *first = (uint32_t)(block * quads / BLOCKS);
    *last = (uint32_t)(((block + 1) * quads + BLOCKS - 1) / BLOCKS);
}

struct shadow_floor *shadow_floor_create(struct arena *arena, const struct terrain *terrain)
{
    struct shadow_floor *ground = ARENA_NEW(arena, struct shadow_floor);
    ground->terrain = terrain;
    ground->flat = terrain->samples_x < 2 || terrain->samples_z < 2;
    for (uint32_t z = 0; z < BLOCKS && !ground->flat; z++)
        for (uint32_t x = 0; x < BLOCKS; x++) {
            uint32_t first[2], last[2];
            float low_m = INFINITY;
            span_of(terrain->samples_x, x, &first[0], &last[0]);
            span_of(terrain->samples_z, z, &first[1], &last[1]);
            for (uint32_t j = first[1]; j <= last[1]; j++)
                for (uint32_t i = first[0]; i <= last[0]; i++)
                    low_m = fminf(low_m, terrain->heights_m[(size_t)j * terrain->samples_x + i]);
            ground->lows_m[z][x] = low_m;
        }
    return ground;
}

/* Blocks that a stretch of an axis touches; false: it leaves the terrain. */
static bool blocks_of(float low_m, float high_m, float size_m, int *first, int *last)
{
    float a = (low_m / size_m + 0.5f) * BLOCKS, b = (high_m / size_m + 0.5f) * BLOCKS;
    if (!(a >= 0 && b <= BLOCKS))
        return false;
    *first = (int)fmaxf(0, floorf(a - 0.01f));
    *last = (int)fminf(BLOCKS - 1, floorf(b + 0.01f));
    return true;
}

/* The lowest ground where rays through the sphere come down to a height; NaN: beyond the terrain.
 */
static float lowest(const struct shadow_floor *ground, const float center_m[3], float radius_m,
                    const float sun[3], float down_to_m)
{
    int first[2], last[2];
    float fall_m = center_m[1] + radius_m - down_to_m, low_m = INFINITY;
    const float sizes_m[2] = {ground->terrain->size_x_m, ground->terrain->size_z_m};
    for (int i = 0; i < 2; i++) {
        float at_m = center_m[2 * i], shift_m = -sun[2 * i] / sun[1] * fall_m;
        if (!blocks_of(at_m - radius_m + fminf(shift_m, 0), at_m + radius_m + fmaxf(shift_m, 0),
                       sizes_m[i], &first[i], &last[i]))
            return NAN;
    }
    for (int z = first[1]; z <= last[1]; z++)
        for (int x = first[0]; x <= last[0]; x++)
            low_m = fminf(low_m, ground->lows_m[z][x]);
    return low_m;
}

float shadow_floor_of(const struct shadow_floor *ground, const float center_m[3], float radius_m,
                      const float sun[3])
{
    float margin_m = 0.02f * radius_m, floor_m = center_m[1] + radius_m;
    if (!(sun[1] > 1e-3f))
        return NAN;
    if (ground->flat)
        return fminf(0, floor_m) - margin_m;
    if (ground->terrain->detail_px > 0)
        return NAN;
    for (int step = 0; step < STEPS_MOST; step++) {
        float low_m = lowest(ground, center_m, radius_m, sun, floor_m - margin_m);
        if (isnan(low_m) || low_m >= floor_m)
            return low_m >= floor_m ? floor_m - margin_m : NAN;
        floor_m = low_m;
    }
    return NAN;
}

bool shadow_floor_is_below(const struct shadow_floor *ground, const struct view *view)
{
    const struct terrain *terrain = ground->terrain;
    const float *eye_m = view->eye_m;
    bool within = ground->flat || (2 * fabsf(eye_m[0]) < terrain->size_x_m &&
                                   2 * fabsf(eye_m[2]) < terrain->size_z_m);
    return within && eye_m[1] > terrain_height(terrain, eye_m[0], eye_m[2]) + 2 * view->near_m;
}
