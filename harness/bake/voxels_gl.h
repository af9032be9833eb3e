/* The voxels of all species of a scene, as a shader that marches rays reads them.
 *
 * Cells are those of the CPU's march (bake/march_free.h), the indices of all species in one row. */
#ifndef TREELINE_BAKE_VOXELS_GL_H
#define TREELINE_BAKE_VOXELS_GL_H

#include "bake/cull.h"
#include "bake/silhouette.h"
#include "method/method.h"

struct voxels_gl {
    size_t species_count;
    int resolution; /* voxels along a plant's longest extent, as the level of detail has them */
    const struct voxels **volumes;              /* one a species */
    const struct mesh **meshes;                 /* the same */
    struct cull_bound *bounds;                  /* the same */
    struct hull (*hulls)[VOXELS_LEVELS_MAX];    /* the same: of each level */
    uint32_t (*first_cells)[VOXELS_LEVELS_MAX]; /* the same: where a level begins in the cells */
    GLuint cells;  /* a word each, all levels of all species in one row */
    GLuint voxels; /* struct voxel */
};

/* resolution: voxels along a plant's longest extent; a lower level of detail has fewer. */
enum status voxels_gl_prepare(struct workspace *workspace, const struct scene *scene,
                              int resolution, struct voxels_gl **voxels);

#endif
