/* Trees as a march of rays has them, whoever draws it: boxes of voxels in the world, levels of
 * detail, outlines on the screen. */
#ifndef TREELINE_BAKE_MARCH_TREE_H
#define TREELINE_BAKE_MARCH_TREE_H

#include "bake/voxels.h"
#include "scene/scene.h"

struct march_tree {
    float position_m[3], cosine, sine, scale, stretch;
    uint32_t species;
    uint16_t turn; /* rotation, in MARCH_TURNS steps */
    bool alone;    /* none of the scene's: no other shades it */
};
enum { MARCH_TURNS = 8 };

/* One an instance. */
void march_trees_fill(const struct scene *scene, struct march_tree *trees);

/* A vector of the world times scale, in the plant's axes and height: a way, or, as light is
 * expressed for normals that are stretched the other way, the direction to the sun. */
void march_to_plant(const struct march_tree *tree, const float world[3], float scale,
                    float plant[3]);
/* The eye in voxels of a level from the box's corner; per_m: voxels a metre. */
void march_eye_of(const struct view *view, const struct march_tree *tree,
                  const struct voxels *voxels, uint32_t level, float per_m, float eye[3]);

/* The level whose voxels are as large as pixels, were there one for every size. */
float march_detail_of(const struct view *view, const struct march_tree *tree,
                      const struct voxels *voxels, float focal_px, float bias, float depth_m);

/* The middle of a level's box from the eye, and its half extents' vectors. */
struct march_box {
    float middle_m[3], half_m[3][3];
};
struct march_box march_box_of(const struct view *view, const struct march_tree *tree,
                              const struct voxels *voxels, uint32_t level);
/* Half of what a box spreads along a direction. */
float march_box_reach(const struct march_box *box, const float direction[3]);
/* The same along an axis of the screen, per depth of 1. slope: of its middle. */
float march_box_spread(const struct march_box *box, const float axis[3], const float forward[3],
                       float slope);
/* The share that fog leaves of what is at its middle. */
float march_box_clear(const struct march_box *box, float fog_density_per_m);

/* A box on the screen, px from the first pixel's centre, y down; the whole picture where it reaches
 * behind the eye's near plane. */
struct march_outline {
    float low[2], high[2], middle[2];
    bool before; /* all of it is before the near plane */
    bool any;    /* some of it */
};
struct march_outline march_outline_of(const struct view *view, const struct march_box *box,
                                      float focal_px);

/* True where all of the picture's near plane lies within bark that is closed around it: where every
 * horizontal way out of it leaves bark once more than it enters some. Of such a tree any voxel is
 * opaque. mesh: of the tree's plant. */
bool march_within_bark(const struct view *view, const struct march_tree *tree,
                       const struct mesh *mesh);
/* Then optical depths are so many times as large. */
static const float march_solid = 1000;

#endif
