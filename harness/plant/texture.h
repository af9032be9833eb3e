/* What the texture of a mesh says at a point of it. */
#ifndef TREELINE_PLANT_TEXTURE_H
#define TREELINE_PLANT_TEXTURE_H

#include "plant/mesh.h"

/* u, v of a point of a triangle from its weights u and v of the second and third corner. The mesh
 * has uvs. */
void mesh_uv(const struct mesh *mesh, uint32_t triangle, float u, float v, float uv[2]);

/* Bilinear, wrapping; rgba: linear RGB, straight alpha. */
void texture_sample(const struct texture *texture, const float uv[2], float rgba[4]);

#endif
