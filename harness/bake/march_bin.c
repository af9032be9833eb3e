/* The march's frame: where trees and cells are seen, and which tiles they touch. */
#include "bake/march_frame.h"

#include <math.h>
#include <string.h>

struct march_tiles march_tiles_of(const struct march *march, const struct view *view)
{
    struct march_tiles tiles = {.side_px = march->options.tile_px};
    tiles.across = (view->width_px + tiles.side_px - 1) / tiles.side_px;
    tiles.down = (view->height_px + tiles.side_px - 1) / tiles.side_px;
    tiles.count = (size_t)tiles.across * (size_t)tiles.down;
    return tiles;
}

/* Calls for each tile that a tree touches: counts, or puts the entry to its place. */
static void tree_bin(const struct march_tiles *tiles, const struct march_seen *seen,
                     uint32_t *places, uint32_t *entries, uint32_t entry)
{
    if (seen->low[0] > seen->high[0] || seen->low[1] > seen->high[1])
        return;
    for (int y = seen->low[1] / tiles->side_px; y <= seen->high[1] / tiles->side_px; y++)
        for (int x = seen->low[0] / tiles->side_px; x <= seen->high[0] / tiles->side_px; x++) {
            uint32_t place = places[(size_t)y * (size_t)tiles->across + (size_t)x]++;
            if (entries)
                entries[place] = entry;
        }
}

/* Counts in each thread's run become the places of its first entries; returns how many in all. */
static size_t places_of(uint32_t *first, const struct march_tiles *tiles, int threads)
{
    size_t sum = 0, run = tiles->count + 1;
    for (size_t tile = 0; tile <= tiles->count; tile++) {
        first[tile] = (uint32_t)sum;
        for (int thread = 0; thread < threads && tile < tiles->count; thread++) {
            uint32_t *place = &first[(size_t)(thread + 1) * run + tile];
            uint32_t count = *place;
            *place = (uint32_t)sum;
            sum += count;
        }
    }
    return sum;
}

/* Where entry k of the list is seen; of a tree or cell below a pixel, what it is seen as is asked
 * for. */
static void entry_see(struct march *march, const struct march_view *picture, int thread,
                      const struct cells_list *list, size_t k)
{
    const uint32_t entry = list->entries[k];
    const uint8_t gone = list->shares ? 255 - list->shares[k] : 0;
    struct march_seen *seen = &march->seen[k];
    float middle[3];
    if (march_is_cell(march, entry)) {
        uint32_t cell = entry - (uint32_t)march->scene->instances_count;
        const struct cells_sums *sums = cells_sums(march->cells, cell);
        march_cell_middle(picture, sums, middle);
        *seen = march_cell_see(picture, sums, middle);
        seen->gone = gone;
        if (march->spans)
            march->spans[k] = (struct march_span){.near_m = middle[2], .far_m = middle[2]};
        march_fars_ask(march->fars, thread, picture->view, sums->species, MARCH_TURNS, middle);
        return;
    }
    const struct march_tree *tree = &march->trees[entry];
    *seen = march_see(picture, tree, list->depths_m[k]);
    seen->gone = gone;
    if (march->spans)
        march->spans[k] = march_span_of(picture, tree, seen->level + (seen->next > 0));
    if (march_is_splat(seen) || seen->far > 0) {
        march_middle(picture, tree, middle);
        march_fars_ask(march->fars, thread, picture->view, tree->species, tree->turn, middle);
    }
}

/* Threads take runs of the sorted list, so that each tile's entries keep the list's order. */
void march_bin(struct workspace *workspace, struct march *march, const struct march_view *picture,
               const struct march_tiles *tiles, const struct cells_list *list)
{
    const int threads = workspace->threads;
    const size_t run = tiles->count + 1, size = run * ((size_t)threads + 1);
    if (size > march->tiles_capacity) {
        march->tile_first = ARENA_ARRAY(workspace->arena, uint32_t, size);
        march->tiles_capacity = size;
    }
    memset(march->tile_first, 0, size * sizeof *march->tile_first);
#pragma omp parallel for num_threads(threads) schedule(static, 1)
    for (int thread = 0; thread < threads; thread++) {
        size_t end = list->count * ((size_t)thread + 1) / (size_t)threads;
        for (size_t k = list->count * (size_t)thread / (size_t)threads; k < end; k++) {
            march_entry_fetch(march, list, k + MARCH_SOON);
            entry_see(march, picture, thread, list, k);
            tree_bin(tiles, &march->seen[k], march->tile_first + run * ((size_t)thread + 1), NULL,
                     0);
        }
    }
    for (size_t k = march->spans ? list->count : 0; k-- > 0;) {
        struct march_span *span = &march->spans[k];
        span->rest_m = k + 1 < list->count ? fminf(span->near_m, span[1].rest_m) : span->near_m;
    }
    size_t count = places_of(march->tile_first, tiles, threads);
    if (count > march->entries_capacity) {
        march->entries_capacity = count + count / 2;
        march->entries = ARENA_ARRAY(workspace->arena, uint32_t, march->entries_capacity);
    }
#pragma omp parallel for num_threads(threads) schedule(static, 1)
    for (int thread = 0; thread < threads; thread++) {
        size_t end = list->count * ((size_t)thread + 1) / (size_t)threads;
        for (size_t k = list->count * (size_t)thread / (size_t)threads; k < end; k++)
            tree_bin(tiles, &march->seen[k], march->tile_first + run * ((size_t)thread + 1),
                     march->entries, (uint32_t)k);
    }
}
