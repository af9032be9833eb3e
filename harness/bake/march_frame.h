/* The march's frame: what its steps share. */
#ifndef TREELINE_BAKE_MARCH_FRAME_H
#define TREELINE_BAKE_MARCH_FRAME_H

#include "bake/march_canvas.h"
#include "bake/march_cells.h"
#include "bake/march_fars.h"
#include "bake/march_shadow.h"

struct march {
    const struct scene *scene;
    struct march_options options;
    march_kernel *kernel;
    struct march_species *species;
    struct march_tree *trees; /* one an instance */
    struct cull *cull;        /* NULL: there are cells */
    struct cells *cells;      /* NULL: trees are culled one by one, and drawn so */
    struct backdrop_cpu *backdrop;
    struct march_fars *fars;
    struct march_seen *seen;       /* of what is in view, in its order */
    struct march_span *spans;      /* the same; NULL: trees are drawn whole */
    struct march_shadows *shadows; /* NULL: not wanted */
    size_t tiles_capacity, entries_capacity;
    uint32_t *tile_first; /* threads + 1 runs of tiles + 1 */
    uint32_t *entries;    /* numbers of the list, tile by tile */
};

/* The picture cut into tiles. */
struct march_tiles {
    int side_px, across, down;
    size_t count;
};

struct march_tiles march_tiles_of(const struct march *march, const struct view *view);

/* Sees each entry of the list, and puts it to the tiles that it touches, in the list's order. */
void march_bin(struct workspace *workspace, struct march *march, const struct march_view *picture,
               const struct march_tiles *tiles, const struct cells_list *list);
/* Draws a tile; returns the lookups of its rays. */
uint64_t march_tile_draw(const struct march *march, const struct march_view *picture,
                         const struct march_tiles *tiles, const struct cells_list *list,
                         size_t tile, struct canvas *canvas, float *pixels);

/* Drawn from far pictures, not marched. */
static inline bool march_is_splat(const struct march_seen *seen)
{
    return seen->level == MARCH_SPLAT || seen->level == MARCH_CELL || seen->level == MARCH_SPRITE;
}

static inline bool march_is_cell(const struct march *march, uint32_t entry)
{
    return entry >= march->scene->instances_count;
}

/* Entries come by depth, not by place in memory: what will be needed soon is asked for early. */
enum { MARCH_SOON = 8 };
static inline void march_entry_fetch(const struct march *march, const struct cells_list *list,
                                     size_t k)
{
    uint32_t entry = k < list->count ? list->entries[k] : 0;
    if (march_is_cell(march, entry))
        __builtin_prefetch(
            cells_sums(march->cells, entry - (uint32_t)march->scene->instances_count));
    else
        __builtin_prefetch(&march->trees[entry]);
}

#endif
