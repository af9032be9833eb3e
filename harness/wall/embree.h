/* Ray tracing on Embree 3 or 4: meshes, a million instances, packets of 16 rays. */
#ifndef TREELINE_WALL_EMBREE_H
#define TREELINE_WALL_EMBREE_H

#include "base/arena.h"
#include "base/error.h"

#include <stdalign.h>
#include <stdbool.h>
#include <stdint.h>

#define EMBREE_LANES 16
#define EMBREE_NONE UINT32_MAX

struct embree; /* a two-level scene */

/* Sixteen rays and what they hit, laid out as Embree's own packet. far is set to the hit's
 * distance, or by embree_occluded to -infinity. geometry is EMBREE_NONE when nothing was hit. */
struct embree_packet {
    alignas(64) float origin[3][EMBREE_LANES];
    float near[EMBREE_LANES];
    float direction[3][EMBREE_LANES];
    float time[EMBREE_LANES];
    float far[EMBREE_LANES];
    uint32_t mask[EMBREE_LANES], id[EMBREE_LANES], flags[EMBREE_LANES];
    float normal[3][EMBREE_LANES];          /* of the surface, in the mesh's space, not unit */
    float u[EMBREE_LANES], v[EMBREE_LANES]; /* weights of the second and third vertex */
    uint32_t primitive[EMBREE_LANES];       /* triangle or cone of the part, from 0 */
    uint32_t geometry[EMBREE_LANES];        /* part of the mesh or set of cones, from 0 */
    uint32_t instance[EMBREE_LANES];        /* in the order of embree_add_instance */
    uint32_t reserved[EMBREE_LANES];
};

/* True where the triangle is opaque; called from every thread. */
typedef bool embree_opaque(const void *data, uint32_t primitive, float u, float v);

/* Some triangles of a mesh. opaque: NULL for all of them. */
struct embree_part {
    uint32_t first_triangle, triangles_count;
    embree_opaque *opaque;
    const void *data; /* for opaque */
};

/* Everything is copied, cones into the arena. positions: vertices_count x 3; triangles:
 * triangles_count x 3. */
struct embree_mesh {
    const float *positions;
    size_t vertices_count;
    const uint32_t *triangles;
    size_t triangles_count;
    const struct embree_part *parts;
    size_t parts_count;
};

/* threads: that building may use. STATUS_UNAVAILABLE where Embree does not start. Of the memory
 * only the handle is the arena's: call embree_destroy. */
enum status embree_create(struct arena *arena, int threads, struct embree **embree,
                          struct error *error);
void embree_destroy(struct embree *embree); /* NULL is allowed */

/* Builds a mesh; its number is the count of meshes before. */
enum status embree_add_mesh(struct embree *embree, const struct embree_mesh *mesh,
                            struct error *error);
/* Frusta of cones with flat ends: round, their normals exact everywhere. */
struct embree_cones {
    const float *ends; /* cones_count x 2 x 4: x, y, z, radius */
    size_t cones_count;
};
/* Builds sets of cones, numbered as a mesh is: each is a part. */
enum status embree_add_cones(struct embree *embree, const struct embree_cones *sets,
                             size_t sets_count, struct error *error);
/* to_world: 3 x 4, column-major. Errors are told by embree_commit. */
void embree_add_instance(struct embree *embree, uint32_t mesh, const float to_world[12]);
enum status embree_commit(struct embree *embree, struct error *error);

/* The lanes [0, count) must have origin, near, direction and far. Directions need not be unit. The
 * result does not depend on time or threads. coherent: neighbouring lanes are likely to meet the
 * same triangles. */
void embree_intersect(const struct embree *embree, struct embree_packet *packet, int count,
                      bool coherent);
/* Bit i of the result is set when lane i is blocked between near and far. Only the ray half is
 * used. Never asks for coherent traversal: that hangs in 3.13.5 on AVX-512. */
uint32_t embree_occluded(const struct embree *embree, struct embree_packet *packet, int count);

/* "Embree 3.13.5" */
const char *embree_version(void);

#endif
