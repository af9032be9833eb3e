/* Rectangles to tiles: counted, then put to their places. */
#include "bake/tiles.h"

#include <string.h>

/* Entries a rectangle, and beside them; from so many entries on, no more than a few a rectangle. */
enum { EACH = 64, BESIDE = 1 << 16, MANY = 1 << 21, EACH_OF_MANY = 4 };

struct tiles *tiles_create(struct arena *arena, size_t rects_count)
{
    struct tiles *tiles = ARENA_NEW(arena, struct tiles);
    size_t wanted = EACH * rects_count + BESIDE, most = EACH_OF_MANY * rects_count;
    most = most < MANY ? MANY : most;
    tiles->capacity = wanted < most ? wanted : most;
    tiles->first = ARENA_ARRAY(arena, uint32_t, TILES_MAX + 1);
    tiles->entries = ARENA_ARRAY(arena, uint32_t, tiles->capacity);
    return tiles;
}

static void cut(struct tiles *tiles, int width_px, int height_px, int side_px)
{
    tiles->side_px = side_px;
    tiles->columns = (width_px + side_px - 1) / side_px;
    tiles->rows = (height_px + side_px - 1) / side_px;
}

static size_t entries_count(const struct tiles *tiles, const struct tiles_rect *rects, size_t count)
{
    size_t sum = 0;
    for (size_t i = 0; i < count; i++) {
        const struct tiles_rect *r = &rects[i];
        if (r->low[0] <= r->high[0] && r->low[1] <= r->high[1])
            sum += (size_t)(r->high[0] / tiles->side_px - r->low[0] / tiles->side_px + 1) *
                   (size_t)(r->high[1] / tiles->side_px - r->low[1] / tiles->side_px + 1);
    }
    return sum;
}

/* Counts into places, or puts the entry to each place. */
static void rect_bin(const struct tiles *tiles, const struct tiles_rect *rect, uint32_t *places,
                     uint32_t *entries, uint32_t entry)
{
    if (rect->low[0] > rect->high[0] || rect->low[1] > rect->high[1])
        return;
    int left = rect->low[0] / tiles->side_px, right = rect->high[0] / tiles->side_px;
    for (int y = rect->low[1] / tiles->side_px; y <= rect->high[1] / tiles->side_px; y++)
        for (int x = left; x <= right; x++) {
            uint32_t place = places[y * tiles->columns + x]++;
            if (entries)
                entries[place] = entry;
        }
}

void tiles_bin(struct tiles *tiles, int width_px, int height_px, const struct tiles_rect *rects,
               size_t count)
{
    cut(tiles, width_px, height_px, TILES_SIDE_LEAST_PX);
    while (tiles->columns * tiles->rows > TILES_MAX ||
           entries_count(tiles, rects, count) > tiles->capacity)
        cut(tiles, width_px, height_px, 2 * tiles->side_px);
    size_t tiles_count = (size_t)(tiles->columns * tiles->rows);
    uint32_t *first = tiles->first;
    memset(first, 0, (tiles_count + 1) * sizeof *first);
    for (size_t i = 0; i < count; i++)
        rect_bin(tiles, &rects[i], first + 1, NULL, 0);
    for (size_t t = 0; t < tiles_count; t++)
        first[t + 1] += first[t];
    for (size_t i = 0; i < count; i++)
        rect_bin(tiles, &rects[i], first, tiles->entries, (uint32_t)i);
    memmove(first + 1, first, tiles_count * sizeof *first); /* each has run to the next one's */
    first[0] = 0;
}
