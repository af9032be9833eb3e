/* Distances through empty voxels, one for each way that rays go: from a cell to the nearest full
 * one among those that a ray of the way can come to, in the chessboard's measure. */
#include "bake/march_free.h"

#include <string.h>

/* A level seen along a way: x, y and z count the way the rays go. */
struct way {
    const struct voxels_level *level;
    uint32_t number, far;  /* distances go up to far */
    uint8_t *ahead, *here; /* slices z + 1 and z: y, x, each with one more that is empty */
    uint8_t *next;         /* of a row: the least among the rows ahead */
};

static size_t way_place(const struct way *way, uint32_t x, uint32_t y, uint32_t z)
{
    const uint32_t *size = way->level->size;
    x = way->number & 1 ? size[0] - 1 - x : x;
    y = way->number & 2 ? size[1] - 1 - y : y;
    z = way->number & 4 ? size[2] - 1 - z : z;
    return ((size_t)z * size[1] + y) * size[0] + x;
}

static uint8_t least(uint8_t a, uint8_t b)
{
    return a < b ? a : b;
}

/* One more than the least of the seven cells ahead. */
static void way_row(const struct way *way, uint32_t y, uint32_t z, uint32_t *cells)
{
    const uint32_t across = way->level->size[0], width = across + 1;
    uint8_t *here = way->here + (size_t)y * width;
    const uint8_t *ahead = way->ahead + (size_t)y * width;
    for (uint32_t x = 0; x < width; x++)
        way->next[x] = least(least(here[width + x], ahead[x]), ahead[width + x]);
    const size_t first = way_place(way, 0, y, z);
    for (uint32_t x = across; x-- > 0;) {
        uint32_t *cell = &cells[way->number & 1 ? first - x : first + x];
        uint32_t before = least(least(way->next[x], way->next[x + 1]), here[x + 1]);
        uint32_t distance = before < way->far ? before + 1 : way->far;
        bool full = *cell & MARCH_FULL;
        here[x] = full ? 0 : (uint8_t)distance;
        *cell |= full ? 0 : (distance - 1) << (MARCH_WAY_BITS * way->number);
    }
}

static void way_fill(struct way *way, uint32_t *cells)
{
    const uint32_t *size = way->level->size;
    const size_t slice = ((size_t)size[0] + 1) * (size[1] + 1);
    memset(way->ahead, (int)way->far, slice);
    memset(way->here, (int)way->far, slice);
    for (uint32_t z = size[2]; z-- > 0;) {
        for (uint32_t y = size[1]; y-- > 0;)
            way_row(way, y, z, cells);
        uint8_t *done = way->here;
        way->here = way->ahead;
        way->ahead = done;
    }
}

uint32_t *march_free_cells(struct arena *arena, const struct voxels_level *level)
{
    const uint32_t *size = level->size;
    const size_t count = (size_t)size[0] * size[1] * size[2];
    const size_t slice = ((size_t)size[0] + 1) * (size[1] + 1);
    uint32_t *cells = ARENA_ARRAY(arena, uint32_t, count);
    for (size_t i = 0; i < count; i++)
        cells[i] =
            level->cells[i] < VOXELS_FIRST ? 0 : MARCH_FULL | (level->cells[i] - VOXELS_FIRST);
    struct way way = {.level = level,
                      .ahead = ARENA_ARRAY(arena, uint8_t, slice),
                      .here = ARENA_ARRAY(arena, uint8_t, slice),
                      .next = ARENA_ARRAY(arena, uint8_t, (size_t)size[0] + 1)};
    for (way.number = 0; way.number < 8; way.number++) {
        way.far = way.number == 7 ? MARCH_WAY_MASK / 2 + 1 : MARCH_WAY_MASK + 1;
        way_fill(&way, cells);
    }
    return cells;
}
