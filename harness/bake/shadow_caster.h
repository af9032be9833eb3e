/* What casts shadow volumes: a mesh's triangles with their neighbours, and the boundary of the
 * volume that the sun's rays leave dark behind them.
 *
 * The volume behind a triangle is bounded by the triangle itself, the cap, and by a wall from each
 * edge to that edge's end, away from the sun: at infinity, where all ends are one point and no far
 * cap is needed, or where nobody sees that it is open. Edges that two triangles of one volume share
 * are bounded by both, in opposite directions, and cancel: what is left is the silhouette (Crow
 * 1977; for any mesh, with multiplicity, Bergeron 1986 and Aldridge, Woods 2004). */
#ifndef TREELINE_BAKE_SHADOW_CASTER_H
#define TREELINE_BAKE_SHADOW_CASTER_H

#include "base/arena.h"
#include "plant/mesh.h"

/* SOLID: bark and needles whose pieces are closed and outward, and ground: the side away from the
 * sun casts, so that a lit surface is nowhere at its own volume's cap, and what faces away is
 * within. OPEN: other bark, other needles. LEAF: thin, lit on both sides. Of both each triangle
 * casts, turned to the sun. */
enum shadow_kind { SHADOW_SOLID, SHADOW_OPEN, SHADOW_LEAF };

struct shadow_caster {
    size_t points_count;
    float (*points)[3]; /* points_count x 3, m, of the mesh; no two are equal */
    size_t triangles_count;
    uint32_t (*triangles)[3];
    float (*normals)[3]; /* a triangle, not unit */
    uint8_t *kinds;      /* enum shadow_kind, a triangle */
    uint8_t *halves;     /* a triangle: 0 or 1, alike in what is connected, else at random */
    size_t edges_count;
    uint32_t (*edges)[2]; /* lower point first */
    uint32_t *first_side; /* edges_count + 1 */
    uint32_t *sides;      /* 2 x triangle, + 1 where it runs from the higher point to the lower */
    int8_t *weights;      /* a triangle: +1 casts as it is wound, -1 turned around, 0 not */
};

/* ground: a height field. Points at one place are one; triangles that have fewer than 3 are left
 * out. */
void shadow_caster_build(struct arena *arena, const struct mesh *mesh, bool ground,
                         struct shadow_caster *caster);

/* Triangles of a boundary as indices, counter-clockwise from without; the caller's room: see
 * shadow_caster_room. Caps of leaves apart. */
struct shadow_boundary {
    uint32_t *walls, *caps, *leaf_caps;
    size_t walls_count, caps_count, leaf_caps_count; /* indices so far */
};
/* Indices that walls may get; caps and leaf_caps may get a sixth of it each. */
size_t shadow_caster_room(const struct shadow_caster *caster);

struct shadow_extrusion {
    float toward[3];     /* to the sun, in the mesh's space, any length */
    bool silhouette;     /* else each triangle has a volume of its own, with three walls */
    int half;            /* of the triangles: those cast */
    uint32_t base, ends; /* the point i becomes base + i, and its end base + i + ends */
};
/* Adds to a boundary. A wall is two triangles, of which the second has no area where ends are one
 * point. */
void shadow_caster_extrude(const struct shadow_caster *caster,
                           const struct shadow_extrusion *extrusion,
                           struct shadow_boundary *boundary);

#endif
