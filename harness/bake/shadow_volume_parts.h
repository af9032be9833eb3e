/* Inside shadow volumes: the boundaries that shadow_volume.c makes and shadow_volume_count.c
 * counts. */
#ifndef TREELINE_BAKE_SHADOW_VOLUME_PARTS_H
#define TREELINE_BAKE_SHADOW_VOLUME_PARTS_H

#include "bake/shadow_caster.h"
#include "bake/shadow_floor.h"
#include "bake/shadow_trees.h"
#include "bake/shadow_volume.h"

#include <string.h>

/* Walls, caps, caps of leaves: each a stretch of the index buffer, by caster. */
enum stretch { WALLS, CAPS, LEAF_CAPS, STRETCHES };
enum { HALVES = 2 }; /* of what casts: shadow_caster.halves */

/* One tree, or the terrain. */
struct shadow_piece {
    const struct shadow_caster *caster;
    const struct instance *instance; /* NULL: the terrain */
    uint32_t base;                   /* its first point */
    float center_m[3], radius_m;     /* of a sphere that holds it */
    float floor_m;                   /* its walls end there; NaN: at infinity */
    bool extruded;                   /* has boundaries for the sun as it stands */
    size_t first[HALVES][STRETCHES], count[HALVES][STRETCHES]; /* indices */
};

struct shadow_volume {
    struct shadow_volume_request request;
    size_t pieces_count, points_count;
    struct shadow_piece *pieces;
    struct shadow_floor *ground;
    float (*places_m)[3]; /* of points, in the world */
    float behind_m;       /* volumes begin so far behind what casts, at least; 0: at it */
    GLuint program, whole_program, vertices, points, indices; /* whole: all of the picture */
    size_t room[STRETCHES], offset[STRETCHES]; /* indices that may come; begin in the buffer */
    size_t indices_room;                       /* of the buffer */
    uint32_t *lists[STRETCHES];
    float sun[3]; /* 0: none yet */
};

#endif
