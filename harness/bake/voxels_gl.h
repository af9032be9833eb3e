/* The voxels of all species of a scene, as a shader that marches rays reads them.
 *
 * Cells: below VOXELS_GL_EMPTY an index into the voxels; else an empty one: 4 bits an octant of
 * directions (bit 0 of its number: down x, 1: down y, 2: down z), from bit 0 on, of how far a ray
 * may go there: the Chebyshev distance, 1..15 voxels, to the nearest voxel of that octant that is
 * not empty. A ray that has passed a crown's middle leaves it by one step, where distances to all
 * sides (Zuiderveld, Koning and Viergever 1992, doi:10.1117/12.131088) make it creep along it. */
#ifndef TREELINE_BAKE_VOXELS_GL_H
#define TREELINE_BAKE_VOXELS_GL_H

#include "bake/cull.h"
#include "bake/silhouette.h"
#include "method/method.h"

enum { VOXELS_GL_EMPTY = 1 << 28 };

struct voxels_gl {
    size_t species_count;
    const struct voxels **volumes;              /* one a species */
    const struct mesh **meshes;                 /* the same */
    struct cull_bound *bounds;                  /* the same */
    struct hull (*hulls)[VOXELS_LEVELS_MAX];    /* the same: of each level */
    uint32_t (*first_cells)[VOXELS_LEVELS_MAX]; /* the same: where a level begins in the cells */
    GLuint cells;  /* a word each, as voxels_level.cells, all levels of all species in one row */
    GLuint voxels; /* struct voxel */
};

/* resolution: voxels along a plant's longest extent; a lower level of detail has fewer. */
enum status voxels_gl_prepare(struct workspace *workspace, const struct scene *scene,
                              int resolution, struct voxels_gl **voxels);

/* A level's cells as words, with `first` added to indices. cells: z, y, x (x fastest). */
void voxels_gl_cells(const struct voxels_level *level, uint32_t first, uint32_t *cells);

#endif
