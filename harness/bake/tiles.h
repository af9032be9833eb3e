/* Trees binned to square tiles of the picture, each tile's in the order in which they came. */
#ifndef TREELINE_BAKE_TILES_H
#define TREELINE_BAKE_TILES_H

#include "base/arena.h"

/* Pixels, both ends included; low above high: nothing. */
struct tiles_rect {
    int16_t low[2], high[2];
};

enum { TILES_MAX = 1 << 15, TILES_SIDE_LEAST_PX = 8 };

struct tiles {
    int side_px, columns, rows;
    size_t capacity;
    uint32_t *first; /* columns x rows + 1, room for TILES_MAX + 1: where a tile's entries begin */
    uint32_t *entries; /* numbers of rectangles, room for capacity */
};

/* Room for up to rects_count rectangles; they fit always, into larger tiles if need be. */
struct tiles *tiles_create(struct arena *arena, size_t rects_count);
/* Sorts rectangles [0, count) within a picture into the smallest tiles, of TILES_SIDE_LEAST_PX
 * times a power of two, that TILES_MAX and the capacity allow. */
void tiles_bin(struct tiles *tiles, int width_px, int height_px, const struct tiles_rect *rects,
               size_t count);

#endif
