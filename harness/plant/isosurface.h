/* The closed surface where a sampled field is zero, as triangles. */
#ifndef TREELINE_PLANT_ISOSURFACE_H
#define TREELINE_PLANT_ISOSURFACE_H

#include "base/arena.h"

#include <stddef.h>
#include <stdint.h>

/* Values at the points of a regular grid, negative inside. Where the grid's border is not negative,
 * the surface is closed. */
struct field {
    size_t points[3];    /* along x, y, z; at least 2 each */
    double minimum_m[3]; /* of the first point */
    double cell_m;
    const float *values; /* points z x y x x; finite */
};

struct isosurface {
    size_t vertices_count, triangles_count;
    float (*positions_m)[3];
    uint32_t (*triangles)[3]; /* counter-clockwise seen from where the field is positive */
};

/* Marching tetrahedra: each cell is cut into the six tetrahedra about its diagonal (Kuhn's
 * triangulation, Freudenthal 1942), which fit those of the neighbours, so the surface has no crack,
 * no edge of more than two triangles and no ambiguous case. Doi and Koide 1991, IEICE E74(1). A
 * vertex lies where the field is zero on a line between two grid points, at least a fiftieth of it
 * from either, so that no triangle is empty. */
struct isosurface isosurface_extract(struct arena *arena, const struct field *field);

#endif
