/* Trees as the march has them, and what one of them is to a block of pixels. */
#ifndef TREELINE_BAKE_MARCH_JOB_H
#define TREELINE_BAKE_MARCH_JOB_H

#include "bake/backdrop_cpu.h"
#include "bake/march.h"
#include "bake/march_parts.h"
#include "bake/march_tree.h"

/* A species as the march has it. */
struct march_species {
    const struct voxels *voxels;
    float center_m[3]; /* of the finest level's box, in the plant's axes */
    float radius_m;    /* of a sphere around it that holds the plant */
};

/* Constants of a picture. */
struct march_view {
    const struct view *view;
    const struct scene *scene;
    struct backdrop_rays rays;
    float focal_px;
    unsigned effects;
    struct march_options options;
    const struct march_species *species;
};

enum { MARCH_SPLAT = 255 };

/* Where a tree is on the screen: pixels whose centres its box may cover, at a level; low above
 * high: none. Smaller than a pixel: level MARCH_SPLAT, the four pixels around its middle. */
struct march_seen {
    int16_t low[2], high[2];
    uint8_t level;
};
struct march_seen march_see(const struct march_view *picture, const struct march_tree *tree,
                            float depth_m);

/* Depths along the view that a tree's box at a level takes (m), the side of its voxels there; of a
 * splat, its box at the finest. */
struct march_span {
    float near_m, far_m, voxel_m;
    float rest_m; /* the least near_m from here to the list's end */
};
struct march_span march_span_of(const struct march_view *picture, const struct march_tree *tree,
                                uint32_t level);

/* Everything but the block's own first ray, for pixels around (x, y). */
void march_job_fill(const struct march_view *picture, const struct march_tree *tree, uint32_t level,
                    float x_px, float y_px, struct march_job *job);
/* The first ray for the block whose upper left pixel is (x, y). */
void march_job_aim(const struct march_view *picture, const struct march_tree *tree, float x_px,
                   float y_px, float voxel_m, struct march_job *job);

/* How a species, turned by a step, looks from far away in a direction. */
struct march_far {
    bool made;
    float cover_m2, rgb[3]; /* hidden of the screen's plane at its depth, for scale 1; radiance */
};
void march_far_fill(const struct march_view *picture, uint32_t species, uint32_t turn, float x_px,
                    float y_px, march_block *block, struct march_far *far);

/* A tree that is hardly larger than a pixel: the shares of four pixels that it covers. */
struct march_splat {
    int x_px, y_px;        /* the upper left one */
    float depth_m, lift_m; /* of its middle; of its foot above the eye */
    float rgb[3];
    float shares[4]; /* upper left, upper right, lower left, lower right */
};
void march_splat_of(const struct march_view *picture, const struct march_tree *tree,
                    const struct march_far *far, struct march_splat *splat);

#endif
