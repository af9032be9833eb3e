/* Inside of the slices: one line of sight's hits, cut into slabs. */
#ifndef TREELINE_BAKE_SLICES_LINES_H
#define TREELINE_BAKE_SLICES_LINES_H

#include "bake/slices.h"
#include "bake/slices_raster.h"

/* Facts of a triangle that do not depend on the direction. */
struct slices_baking {
    const struct mesh *mesh;
    const struct slices_request *request;
    struct slices *slices;
    int threads;
    uint32_t *triangles; /* those wanted */
    size_t triangles_count;
    uint32_t *material;   /* mesh's triangles */
    float (*centroid)[3]; /* mesh's triangles: of the leaf; NULL: by depth */
};

/* A stack while it is baked. */
struct slices_sight {
    const struct slices_baking *bake;
    const struct slices_stack *stack;
    struct raster_plane plane;
    int16_t *slab; /* mesh's triangles; -1: by depth; NULL: all by depth */
    /* lights_count x 2: toward the sun for normals of leaves and of bark, turned as the eye is */
    float (*suns)[2][3];
};

/* What falls into one slab of one texel. */
struct slices_cell {
    uint32_t line; /* last line of sight counted, from 1 */
    int count, leaves;
    float color[3], normal[3], depth;
};

/* One thread's row of slabs. */
struct slices_column {
    struct slices_cell *cells; /* request->count */
    float (*lit)[3];           /* request->count x lights_count */
    int *touched;
    int touched_count;
    uint32_t line;
};

static inline bool slices_is_leaf(const struct slices_baking *bake, uint32_t triangle)
{
    return bake->mesh->materials[bake->material[triangle]].kind == MATERIAL_LEAF;
}

static inline float slices_dot(const float a[3], const float b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Adds line (i, j)'s hits, foremost first, to the slabs that they fall into. */
void slices_line(const struct slices_sight *sight, struct slices_column *column,
                 const struct raster_hit *hits, size_t count, int i, int j);

#endif
