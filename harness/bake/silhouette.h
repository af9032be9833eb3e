/* What a level of a plant's voxels covers of the screen at most: the bounds that a march of rays
 * need not look beyond. */
#ifndef TREELINE_BAKE_SILHOUETTE_H
#define TREELINE_BAKE_SILHOUETTE_H

#include "bake/voxels.h"

enum { HULL_RINGS = 6, HULL_SIDES = 8, HULL_POINTS = HULL_RINGS * HULL_SIDES };

/* Octagons across the plant at rising heights; all voxels that are not empty lie within the convex
 * hull of them. Points: voxels from the box's corner. */
struct hull {
    int count;                    /* of points: HULL_SIDES a ring */
    float points[3][HULL_POINTS]; /* x, y, z */
};
/* An empty level has no points. */
void hull_of_level(const struct voxels_level *level, struct hull *hull);

/* Where places in voxels are on the screen: depth along the view, and px times depth from the
 * first pixel's centre, y down; each the last column and the others times the place's x, y, z. */
struct hull_frame {
    float across[4], down[4], depth[4];
};

/* Lines of pixels that lean on their way down: x - lean (y - low[1]) lies between the bounds, px;
 * low and high: the hull's rectangle. */
struct silhouette {
    float low[2], high[2], lean, bounds[2];
};
/* Of a hull with points, all of positive depth. */
void silhouette_of(const struct hull *hull, const struct hull_frame *frame,
                   struct silhouette *silhouette);

#endif
