/* One ray against one frustum with flat ends, in double precision.
 *
 * Embree's own cone curves (3.13.5) are right only for rays of length 1, which those of a scaled
 * instance are not: trees of scale 0.6 lost their needles. */
#ifndef TREELINE_WALL_EMBREE_CONES_H
#define TREELINE_WALL_EMBREE_CONES_H

#include <stdbool.h>

/* ends: 2 x 4, x, y, z, radius; origin, direction: not unit. The nearest hit in (near, far) and its
 * outward normal, not unit; false: none. */
bool embree_cone_hit(const float ends[8], const float origin[3], const float direction[3],
                     float near, float far, float *distance, float normal[3]);

#endif
