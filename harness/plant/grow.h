/* Shared by the generators: vectors, portable sine and cosine, bark tubes, leaves, the mesh they
 * end in. Only + - * / and sqrt touch a coordinate, so a plant has the same bytes on every machine.
 */
#ifndef TREELINE_PLANT_GROW_H
#define TREELINE_PLANT_GROW_H

#include "base/arena.h"
#include "base/random.h"
#include "plant/mesh.h"

#include <math.h>

struct vec {
    double x, y, z;
};

static inline struct vec vec_add(struct vec a, struct vec b)
{
    return (struct vec){a.x + b.x, a.y + b.y, a.z + b.z};
}

static inline struct vec vec_sub(struct vec a, struct vec b)
{
    return (struct vec){a.x - b.x, a.y - b.y, a.z - b.z};
}

static inline struct vec vec_scale(struct vec a, double s)
{
    return (struct vec){a.x * s, a.y * s, a.z * s};
}

/* a + s b */
static inline struct vec vec_mad(struct vec a, double s, struct vec b)
{
    return (struct vec){a.x + s * b.x, a.y + s * b.y, a.z + s * b.z};
}

static inline double vec_dot(struct vec a, struct vec b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static inline struct vec vec_cross(struct vec a, struct vec b)
{
    return (struct vec){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

static inline double vec_length(struct vec a)
{
    return sqrt(vec_dot(a, a));
}

/* a / |a|; +y for a vector shorter than 1e-12. */
struct vec vec_unit(struct vec a);
/* A unit vector across the unit vector a, turned about it by turns of a full circle. */
struct vec vec_across(struct vec a, double turns);

/* Sine and cosine of an angle in turns (1 is a full circle); Taylor to the 12th degree on an eighth
 * of a turn, absolute error below 1e-11. */
void grow_sincos(double turns, double *sine, double *cosine);

double random_between(struct random *random, double low, double high);
struct vec random_in_ball(struct random *random); /* uniform in the unit ball */

/* A point of a stem. sides: of the ring there, even, >= 4; from one point to the next it stays or
 * halves. */
struct stem_point {
    struct vec position_m;
    double radius_m;
    double flute; /* relative depth of five lobes: buttresses of a trunk's foot */
    int sides;
};

/* One leaf: a kite, folded along its midrib (fold 0: flat). */
struct leaf_shape {
    struct vec base_m, along, normal; /* unit; normal across along */
    double length_m, width_m;
    double widest; /* where along the midrib the kite is widest, in (0, 1) */
    double fold;   /* the halves' rise over their half width; 0.3 is 17 degrees */
    float tint[3]; /* multiplies the leaf material's albedo */
};

/* A mesh in the making: all tubes first, then all leaves. */
struct grow {
    struct arena *scratch;
    struct random random; /* bark's roughness */
    float (*positions)[3], (*normals)[3], (*colors)[3];
    size_t vertices_count, vertices_capacity;
    uint32_t (*triangles)[3];
    size_t triangles_count, triangles_capacity;
    size_t bark_triangles_count;
    uint32_t *leaf_first;
    size_t leaves_count, leaves_capacity;
};

/* capacities: of triangles and leaves; they grow when needed. scratch dies after grow_mesh. */
void grow_begin(struct grow *grow, struct arena *scratch, uint64_t seed, size_t triangles_capacity,
                size_t leaves_capacity);
/* A tube through count >= 2 points that closes in an apex at the last one and is open at the first,
 * which stands inside its parent. Counter-clockwise from outside; triangles come in pairs. */
void grow_tube(struct grow *grow, const struct stem_point *points, size_t count);
void grow_leaf(struct grow *grow, const struct leaf_shape *leaf); /* two triangles */
/* The finished mesh in arena: one bark part, one leaf part of grow->leaves_count elements. */
struct mesh *grow_mesh(struct grow *grow, struct arena *arena, const float bark_albedo[3],
                       const float leaf_albedo[3]);

#endif
