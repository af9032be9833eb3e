/* Octagons around voxels, slab by slab, and their bounds on the screen. */
#include "bake/silhouette.h"

#include <limits.h>
#include <math.h>

enum { SLABS = HULL_RINGS - 1 };

/* The least and most of x, z, x + z, x - z of a slab's corners, and of its height. */
struct slab {
    int low[4], high[4], bottom, top; /* bottom above top: an empty one */
};

static const struct slab empty_slab = {
    {INT_MAX, INT_MAX, INT_MAX, INT_MAX}, {INT_MIN, INT_MIN, INT_MIN, INT_MIN}, INT_MAX, INT_MIN};

static int least(int a, int b)
{
    return a < b ? a : b;
}

static int most(int a, int b)
{
    return a > b ? a : b;
}

static void slab_add(struct slab *slab, int x, int y, int z)
{
    const int low[4] = {x, z, x + z, x - z - 1};
    const int high[4] = {x + 1, z + 1, x + z + 2, x + 1 - z};
    for (int i = 0; i < 4; i++) {
        slab->low[i] = least(slab->low[i], low[i]);
        slab->high[i] = most(slab->high[i], high[i]);
    }
    slab->bottom = least(slab->bottom, y);
    slab->top = most(slab->top, y + 1);
}

static struct slab slab_both(const struct slab *a, const struct slab *b)
{
    struct slab both;
    for (int i = 0; i < 4; i++) {
        both.low[i] = least(a->low[i], b->low[i]);
        both.high[i] = most(a->high[i], b->high[i]);
    }
    both.bottom = least(a->bottom, b->bottom);
    both.top = most(a->top, b->top);
    return both;
}

/* The corners of a slab's octagon at a height. */
static void hull_add(struct hull *hull, const struct slab *slab, int y)
{
    const int *low = slab->low, *high = slab->high;
    const int corners[HULL_SIDES][2] = {{high[0], high[2] - high[0]}, {high[2] - high[1], high[1]},
                                        {low[3] + high[1], high[1]},  {low[0], low[0] - low[3]},
                                        {low[0], low[2] - low[0]},    {low[2] - low[1], low[1]},
                                        {high[3] + low[1], low[1]},   {high[0], high[0] - high[3]}};
    for (int i = 0; i < HULL_SIDES; i++) {
        float *point = hull->points[hull->count++];
        point[0] = (float)corners[i][0];
        point[1] = (float)y;
        point[2] = (float)corners[i][1];
    }
}

void hull_of_level(const struct voxels_level *level, struct hull *hull)
{
    const int x_count = (int)level->size[0], y_count = (int)level->size[1];
    const int z_count = (int)level->size[2];
    const uint32_t *cell = level->cells;
    struct slab slabs[SLABS], below = empty_slab;
    for (int k = 0; k < SLABS; k++)
        slabs[k] = empty_slab;
    for (int z = 0; z < z_count; z++)
        for (int y = 0; y < y_count; y++)
            for (int x = 0; x < x_count; x++)
                if (*cell++ >= VOXELS_FIRST)
                    slab_add(&slabs[y * SLABS / y_count], x, y, z);
    /* a ring at each slab's bottom, around it and what ends there; one at the last one's top */
    hull->count = 0;
    for (int k = 0; k < SLABS; k++) {
        if (slabs[k].bottom > slabs[k].top)
            continue;
        struct slab ring = slab_both(&below, &slabs[k]);
        hull_add(hull, &ring, slabs[k].bottom);
        below = slabs[k];
    }
    if (hull->count)
        hull_add(hull, &below, below.top);
}

static float along(const float axis[4], const float point[3])
{
    return axis[0] * point[0] + axis[1] * point[1] + axis[2] * point[2] + axis[3];
}

/* The way across per row between the middles of the first ring and the last. */
static float lean_of(float (*px)[2], int count)
{
    float first[2] = {0, 0}, last[2] = {0, 0};
    for (int i = 0; i < HULL_SIDES; i++)
        for (int axis = 0; axis < 2; axis++) {
            first[axis] += px[i][axis];
            last[axis] += px[count - 1 - i][axis];
        }
    float across = last[0] - first[0], down = last[1] - first[1];
    return fabsf(across) < 2 * fabsf(down) ? across / down : 0;
}

/* Bounds of x - slope (y - from) among points. */
static void bound(float (*px)[2], int count, float slope, float from, float bounds[2])
{
    bounds[0] = INFINITY;
    bounds[1] = -INFINITY;
    for (int i = 0; i < count; i++) {
        float at = px[i][0] - slope * (px[i][1] - from);
        bounds[0] = fminf(bounds[0], at);
        bounds[1] = fmaxf(bounds[1], at);
    }
}

void silhouette_of(const struct hull *hull, const struct hull_frame *frame,
                   struct silhouette *silhouette)
{
    float px[HULL_RINGS * HULL_SIDES][2];
    struct silhouette s = {.low = {INFINITY, INFINITY}, .high = {-INFINITY, -INFINITY}};
    for (int i = 0; i < hull->count; i++) {
        float scale = 1 / along(frame->depth, hull->points[i]);
        px[i][0] = scale * along(frame->across, hull->points[i]);
        px[i][1] = scale * along(frame->down, hull->points[i]);
        for (int axis = 0; axis < 2; axis++) {
            s.low[axis] = fminf(s.low[axis], px[i][axis]);
            s.high[axis] = fmaxf(s.high[axis], px[i][axis]);
        }
    }
    s.lean = lean_of(px, hull->count);
    bound(px, hull->count, s.lean, s.low[1], s.bounds[0]);
    float rows = s.high[1] - s.low[1];
    s.spread = rows > 0 ? fminf((s.bounds[0][1] - s.bounds[0][0]) / rows, 4) : 0;
    bound(px, hull->count, s.lean - s.spread, s.low[1], s.bounds[1]);
    bound(px, hull->count, s.lean + s.spread, s.low[1], s.bounds[2]);
    *silhouette = s;
}
