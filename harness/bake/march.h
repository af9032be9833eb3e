/* Forests marched through by rays on the CPU: voxels of each plant, tiles of the picture, packets
 * of rays. Trees are sorted by depth; where crowns interlock, the nearer tree is drawn whole before
 * the farther one, or both in slabs. */
#ifndef TREELINE_BAKE_MARCH_H
#define TREELINE_BAKE_MARCH_H

#include "method/method.h"

struct march;

enum march_model {
    MARCH_SGGX,      /* hides and is lit by the second moments of its normals */
    MARCH_ISOTROPIC, /* as if the normals in a voxel pointed everywhere alike: a scalar density d,
                        transmittance exp(-d length) in every direction (Kajiya and Kay 1989) */
    MARCH_NOMA,      /* hides by the opacities of voxels_noma, is lit as with sggx */
    MARCH_VISIBLE,   /* hides and is lit by the mean of its normals: voxels_visible */
};

struct march_options {
    int resolution; /* voxels along a plant's longest extent */
    enum march_model model;
    float stop;            /* a ray ends when it lets through no more */
    float step;            /* voxels */
    float bias;            /* added to the level of detail */
    float smooth;          /* levels over which one turns into the next, and octaves over which
                              voxels, far pictures and cells do; 0: at once */
    float slab;            /* voxels; 0: trees are drawn whole */
    int tile_px;           /* side of a tile */
    float far_px;          /* trees of so large a radius, px, are drawn from a far picture; none
                              with slab > 0 */
    bool cells;            /* trees below a pixel are drawn by cells of many */
    int shadow_resolution; /* cells of sun shadows along a plant's longest extent, 1 or more where
                              the scene wants them */
    const char *isa; /* a name of march_isas(), or plain C for what is not there; NULL: the last */
};

enum status march_prepare(struct workspace *workspace, const struct scene *scene,
                          const struct march_options *options, struct march **march);
enum status march_draw(struct workspace *workspace, struct march *march, const struct view *view,
                       struct target *target);

#endif
