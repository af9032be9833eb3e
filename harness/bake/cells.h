/* A forest as a hierarchy of cells: a cell holds trees of one species, and its two halves. Cells
 * outside a picture are left with all that is in them; cells about as small as a pixel stand for
 * their trees, by the moments of what the trees hide. */
#ifndef TREELINE_BAKE_CELLS_H
#define TREELINE_BAKE_CELLS_H

#include "bake/cull.h"

struct cells;

/* The trees of a cell as one thing. A tree hides as its scale's square; so weighed are the means.
 */
struct cells_sums {
    float foot_m[3];    /* mean of the feet */
    float spread_m2[6]; /* the feet's covariance: xx, yy, zz, xy, xz, yz */
    float square;       /* sum of the scales' squares */
    float fourth;       /* sum of their fourth powers */
    float scale;        /* square root of the scales' mean square */
    uint32_t species;
} __attribute__((aligned(64)));

/* bounds: one for each species of the scene. */
struct cells *cells_create(struct arena *arena, const struct scene *scene,
                           const struct cull_bound *bounds);

/* What a picture holds, from front to back. An entry below the number of the scene's instances is
 * a tree, from there on a cell: cell = entry - instances. The arrays belong to the cells and last
 * until the next call. */
struct cells_list {
    size_t count;
    uint32_t *entries;
    float *depths_m; /* of spheres' centres along view->forward; a cell's: of its mean tree */
    uint8_t *shares; /* of 255, of what is listed of a tree more than once; NULL: all is whole */
};

/* When cells stand for trees: a cell spreads most_px at most over the picture, and its trees'
 * spheres are of tree_px at most; most_px 0: no cells. Over so many octaves below these limits a
 * cell gradually replaces what is in it, and both are listed; 0: at once. */
struct cells_limits {
    float most_px, tree_px, octaves;
};
/* Each tree that cull_view lists is listed by itself or within one cell; or in several of these,
 * with shares that sum to a whole but for rounding. */
struct cells_list cells_view(struct cells *cells, const struct view *view,
                             const struct cells_limits *limits, int threads);

size_t cells_count(const struct cells *cells);
const struct cells_sums *cells_sums(const struct cells *cells, uint32_t cell);
/* The trees of a cell, all of them; returns how many. */
size_t cells_trees(const struct cells *cells, uint32_t cell, const uint32_t **instances);

/* The variance of a cell's feet along a direction, m2. */
static inline float cells_spread_m2(const struct cells_sums *sums, const float along[3])
{
    const float *m = sums->spread_m2, *a = along;
    float variance = a[0] * a[0] * m[0] + a[1] * a[1] * m[1] + a[2] * a[2] * m[2] +
                     2 * (a[0] * a[1] * m[3] + a[0] * a[2] * m[4] + a[1] * a[2] * m[5]);
    return variance > 0 ? variance : 0;
}

#endif
