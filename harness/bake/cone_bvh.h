/* A bounding hierarchy of spheres' boxes for cones of pixels. */
#ifndef TREELINE_BAKE_CONE_BVH_H
#define TREELINE_BAKE_CONE_BVH_H

#include "bake/cone_emit.h"

/* center and radius */
struct cone_ball {
    float center_m[3], radius_m;
};

struct cone_bvh;
struct cone_bvh *cone_bvh_create(struct arena *arena, const struct cone_ball *balls, size_t count);
/* Numbers of the balls that a beam may meet, in no order; returns how many, never more than room,
 * and adds the nodes that were looked at. */
size_t cone_bvh_find(const struct cone_bvh *bvh, const struct cone_beam *beam, uint32_t *found,
                     size_t room, uint64_t *nodes);

#endif
