/* Trees as the march has them, and what one of them is to a block of pixels. */
#ifndef TREELINE_BAKE_MARCH_JOB_H
#define TREELINE_BAKE_MARCH_JOB_H

#include "bake/backdrop_cpu.h"
#include "bake/march.h"
#include "bake/march_parts.h"

struct march_tree {
    float position_m[3], cosine, sine, scale;
    uint32_t species;
};

/* Constants of a picture. */
struct march_view {
    const struct view *view;
    const struct scene *scene;
    struct backdrop_rays rays;
    float focal_px;
    unsigned effects;
    struct march_options options;
};

enum { MARCH_SPLAT = 255 };

/* Where a tree is on the screen: pixels whose centres its box may cover, at a level; low above
 * high: none. Smaller than a pixel: level MARCH_SPLAT, the four pixels around its middle. */
struct march_seen {
    int16_t low[2], high[2];
    uint8_t level;
};
struct march_seen march_see(const struct march_view *picture, const struct march_tree *tree,
                            const struct voxels *voxels, float depth_m);

/* Everything but the block's own first ray, for pixels around (x, y). */
void march_job_fill(const struct march_view *picture, const struct march_tree *tree,
                    const struct voxels *voxels, uint32_t level, float x_px, float y_px,
                    struct march_job *job);
/* The first ray for the block whose upper left pixel is (x, y). */
void march_job_aim(const struct march_view *picture, const struct march_tree *tree, float x_px,
                   float y_px, float voxel_m, struct march_job *job);

/* A tree smaller than a pixel: what of its four pixels it covers, and with which radiance. */
struct march_splat {
    int x_px, y_px; /* the upper left one */
    float depth_m, rgb[3];
    float shares[4]; /* upper left, upper right, lower left, lower right */
};
void march_splat_of(const struct march_view *picture, const struct march_tree *tree,
                    const struct voxels *voxels, march_block *block, struct march_splat *splat);

#endif
