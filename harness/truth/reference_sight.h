/* What the lanes of a packet of camera rays see, for the shading of a tile. */
#ifndef TREELINE_TRUTH_REFERENCE_SIGHT_H
#define TREELINE_TRUTH_REFERENCE_SIGHT_H

#include "truth/reference_parts.h"

/* What the lanes of a packet see. Directions are unit; geometric and normal are on the eye's side.
 */
struct sights {
    const struct surface *surface[EMBREE_LANES]; /* NULL: the sky */
    float turn_cos[EMBREE_LANES], turn_sin[EMBREE_LANES], rise[EMBREE_LANES];
    float point[3][EMBREE_LANES], geometric[3][EMBREE_LANES], normal[3][EMBREE_LANES];
    float offset_m[EMBREE_LANES];   /* more than the error of point */
    float sun_facing[EMBREE_LANES]; /* normal . sun */
};

/* Of a packet that Embree has followed, its first `lanes` lanes; the others see the sky. */
void sights_find(const struct picture *picture, const struct embree_packet *packet, int lanes,
                 struct sights *sights);

#endif
