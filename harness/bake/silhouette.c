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
    for (int i = 0; i < HULL_SIDES; i++, hull->count++) {
        hull->points[0][hull->count] = (float)corners[i][0];
        hull->points[1][hull->count] = (float)y;
        hull->points[2][hull->count] = (float)corners[i][1];
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

/* A hull on the screen, px. */
struct seen {
    int count;
    float x[HULL_POINTS], y[HULL_POINTS];
};

static void see(const struct hull *hull, const struct hull_frame *frame, struct seen *seen)
{
    const float *x = hull->points[0], *y = hull->points[1], *z = hull->points[2];
    const float *across = frame->across, *down = frame->down, *depth = frame->depth;
    seen->count = hull->count;
    for (int i = 0; i < HULL_SIDES || i < hull->count; i++) { /* a ring at least */
        float scale = 1 / (depth[0] * x[i] + depth[1] * y[i] + depth[2] * z[i] + depth[3]);
        seen->x[i] = scale * (across[0] * x[i] + across[1] * y[i] + across[2] * z[i] + across[3]);
        seen->y[i] = scale * (down[0] * x[i] + down[1] * y[i] + down[2] * z[i] + down[3]);
    }
}

/* The way across per row between the middles of the first ring and the last. */
static float lean_of(const struct seen *seen)
{
    const int last = seen->count - HULL_SIDES;
    float across = 0, down = 0;
    for (int i = 0; i < HULL_SIDES; i++) {
        across += seen->x[last + i] - seen->x[i];
        down += seen->y[last + i] - seen->y[i];
    }
    return fabsf(across) < 2 * fabsf(down) ? across / down : 0;
}

/* Bounds of a x + b (y - from); side by side, for a compiler that has lanes. */
static void bound(const struct seen *seen, float a, float b, float from, float bounds[2])
{
    float low[HULL_SIDES], high[HULL_SIDES];
    for (int k = 0; k < HULL_SIDES; k++)
        low[k] = high[k] = a * seen->x[k] + b * (seen->y[k] - from);
    for (int i = HULL_SIDES; i < seen->count; i += HULL_SIDES)
        for (int k = 0; k < HULL_SIDES; k++) {
            float at = a * seen->x[i + k] + b * (seen->y[i + k] - from);
            low[k] = at < low[k] ? at : low[k];
            high[k] = at > high[k] ? at : high[k];
        }
    bounds[0] = low[0];
    bounds[1] = high[0];
    for (int k = 1; k < HULL_SIDES; k++) {
        bounds[0] = low[k] < bounds[0] ? low[k] : bounds[0];
        bounds[1] = high[k] > bounds[1] ? high[k] : bounds[1];
    }
}

void silhouette_of(const struct hull *hull, const struct hull_frame *frame,
                   struct silhouette *silhouette)
{
    struct seen seen;
    struct silhouette s;
    float ends[2][2];
    see(hull, frame, &seen);
    bound(&seen, 1, 0, 0, ends[0]);
    bound(&seen, 0, 1, 0, ends[1]);
    for (int i = 0; i < 2; i++) {
        s.low[i] = ends[i][0];
        s.high[i] = ends[i][1];
    }
    s.lean = lean_of(&seen);
    bound(&seen, 1, -s.lean, s.low[1], s.bounds);
    *silhouette = s;
}
