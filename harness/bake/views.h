/* The directions a plant is looked at from when its pictures are baked, and the picture planes that
 * go with them. */
#ifndef TREELINE_BAKE_VIEWS_H
#define TREELINE_BAKE_VIEWS_H

#include <stddef.h>

/* circle:     count directions on the horizon, direction k at azimuth 2 pi k / count.
 * hemisphere: side x side points of the hemi-octahedral map, rim on the horizon, for eyes above it.
 * octahedron: side x side points of the octahedral map of the whole sphere (Cigolle et al. 2014, "A
 * Survey of Efficient Representations for Independent Unit Vectors", JCGT 3(2)); a point of the
 * square's rim occurs twice, so that neighbours in the grid are always neighbours on the sphere.
 * planes:     count vertical planes that cross, plane k turned by pi k / count, each seen from its
 * front (view k) and from its back (view count + k). */
enum views_layout { VIEWS_CIRCLE, VIEWS_HEMISPHERE, VIEWS_OCTAHEDRON, VIEWS_PLANES };

/* Side of the square grid for a wish of `views` directions: the largest whose square is not above
 * it, at least 2; for circle and planes the number itself. */
size_t views_side(enum views_layout layout, size_t views);
/* Number of pictures: side, side^2 or 2 side. */
size_t views_count(enum views_layout layout, size_t side);

/* Unit direction from the plant toward the eye of picture index < views_count. Azimuth 0 is +z and
 * grows toward +x. */
void views_direction(enum views_layout layout, size_t side, size_t index, float direction[3]);

/* The picture plane of a unit direction: right = normalize(+y x direction), up = direction x right,
 * unit and right-handed with the direction. Seen from straight above or below right is +x. */
void views_plane(const float direction[3], float right[3], float up[3]);

#endif
