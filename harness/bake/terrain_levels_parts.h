/* What building and choosing levels of a terrain share. */
#ifndef TREELINE_BAKE_TERRAIN_LEVELS_PARTS_H
#define TREELINE_BAKE_TERRAIN_LEVELS_PARTS_H

#include "bake/terrain_levels.h"

/* Sides that meet a coarser neighbour, as bits: toward -x, +x, -z, +z. */
enum { SIDE_WEST = 1, SIDE_EAST = 2, SIDE_NORTH = 4, SIDE_SOUTH = 8, SIDES_COUNT = 16 };

/* Corners as x and z within a chunk, in quads. */
struct corner {
    uint16_t x, z;
};
struct pattern {
    size_t count; /* of triangles */
    struct corner (*triangles)[3];
};

/* Chunks of one size: the last ones of a row or column are smaller. */
struct chunk_kind {
    uint32_t width, height; /* quads */
    struct pattern patterns[LEVELS_COUNT][SIDES_COUNT];
    struct pattern all[LEVELS_COUNT]; /* each triangle that any of the sixteen has, once, but for
                                         those that are the full surface's own */
};

void chunk_kind_build(struct arena *arena, struct chunk_kind *kind, uint32_t width,
                      uint32_t height);

/* The largest vertical distance between a triangle and the full surface, m; exactly: both are flat
 * but where a sample or an edge of one crosses an edge of the other. x, z: the chunk's first
 * sample.
 */
float triangle_error(const struct terrain *terrain, uint32_t x, uint32_t z,
                     const struct corner triangle[3]);

#endif
