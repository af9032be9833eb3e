/* Normals from triangles. */
#ifndef TREELINE_PLANT_NORMALS_H
#define TREELINE_PLANT_NORMALS_H

#include <stddef.h>
#include <stdint.h>

/* For each vertex that the triangles use: the unit mean of its triangles' normals weighted by area;
 * +y where that mean vanishes. Other vertices' normals stay. positions, normals: a row of 3 each
 * vertex. */
void normals_smooth(const float (*positions)[3], uint32_t (*triangles)[3], size_t triangles_count,
                    float (*normals)[3]);

/* Twice the triangle's area along its unit normal: the cross product of its edges. */
void triangle_cross(const float a[3], const float b[3], const float c[3], double cross[3]);

#endif
