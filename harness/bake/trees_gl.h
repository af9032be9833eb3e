/* Trees in view as a shader that marches rays reads them, with their places on the screen. */
#ifndef TREELINE_BAKE_TREES_GL_H
#define TREELINE_BAKE_TREES_GL_H

#include "bake/march_tree.h"
#include "bake/tiles.h"
#include "bake/voxels_gl.h"

/* A tree as the shader reads it: four texels. The pixels where it may be come first: rows, and the
 * bounds of x - lean (y - rows[0]), in quarters of a pixel from TREE_TEXELS_BIAS on, which end at 0
 * and 65535. */
struct tree_texels {
    uint16_t rows[2]; /* both ends included, row 0 on top */
    float lean;       /* quarters of a pixel a row */
    uint16_t bounds[2];
    uint32_t volume; /* sun shadows: four texels of bake/sunlight_gl.h from 4 x this on */
    uint32_t first_cell;
    uint32_t size;   /* three times 10 bits; bit 30: smaller than a pixel; 31: opaque */
    uint32_t shares; /* what fog leaves, and of the optical depth what is drawn: 16 bits each */
    uint32_t albedo; /* three times 10 bits */
    float where[3];  /* the eye in voxels from the box's corner; of a small tree: its middle on
                        the screen, from pixel centres, px; its area, px^2 */
    float per_m;     /* voxels a metre; of a small tree: its depth along the view, m */
    float turn[2];   /* cosine, sine, both over the stretch */
    uint32_t gains;  /* sun shadows: the first of its corners */
    float lit;       /* the same, of a small tree: share of the sun that is left; else -1 */
};
enum { TREE_TEXELS_BIAS = 1 << 14 };

struct trees_gl;
struct sunlight_gl;

/* bias: added to the level of detail that a pixel asks for. smooth: levels over which one turns
 * into the next, both being drawn; 0: at once. */
struct trees_gl *trees_gl_create(struct arena *arena, const struct scene *scene,
                                 const struct voxels_gl *voxels, float bias, float smooth);
/* One an instance. */
const struct march_tree *trees_gl_trees(const struct trees_gl *trees);
/* In the sun's shadows from now on. */
void trees_gl_shade(struct trees_gl *trees, struct sunlight_gl *sunlight);
/* So many texels there are at most: a tree that turns into something else has several. */
size_t trees_gl_most(const struct trees_gl *trees);
/* The trees of a list, in its order; returns how many texels and rectangles, which stay valid until
 * the next call. fog_density_per_m: 0 for none. */
size_t trees_gl_see(struct trees_gl *trees, const struct view *view, const struct cull_list *list,
                    float fog_density_per_m, const struct tiles_rect **rects,
                    const struct tree_texels **texels);

#endif
