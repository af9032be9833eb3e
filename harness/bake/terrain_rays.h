/* Rays against a terrain by a quadtree of its least and largest heights: no mesh, no hierarchy of
 * triangles, only the heights themselves. Musgrave 1988, Grid Tracing, and Tevs, Ihrke and Seidel
 * 2008, doi:10.1145/1342250.1342279 ("inverse displacement mapping", as ABDERRAHMANI 2018 has it):
 * a cell is left out where the ray is higher, or lower, than all of it. What is met are the two
 * triangles of each quad that terrain_mesh() has, exactly. */
#ifndef TREELINE_BAKE_TERRAIN_RAYS_H
#define TREELINE_BAKE_TERRAIN_RAYS_H

#include "scene/scene.h"

struct terrain_rays;

/* Memory: 2.7 bytes a sample. The terrain must stay alive. */
struct terrain_rays *terrain_rays_create(struct arena *arena, const struct terrain *terrain);

struct terrain_hit {
    double distance;     /* in lengths of the direction */
    uint32_t corners[3]; /* samples, in the order of terrain_mesh() */
    float weights[3];    /* of the corners; their sum is 1 */
    bool front;          /* the upper side */
};

/* The first hit at a distance in (0, farthest); false where there is none. Any origin and
 * direction: upward, downward, along the ground, from below and from outside. A ray through an edge
 * or a vertex meets at least one of the triangles there: none passes between two of them. */
bool terrain_rays_hit(const struct terrain_rays *rays, const float origin_m[3],
                      const float direction[3], double farthest, struct terrain_hit *hit);
/* The same, of any hit. */
bool terrain_rays_blocked(const struct terrain_rays *rays, const float origin_m[3],
                          const float direction[3], double farthest);

#endif
