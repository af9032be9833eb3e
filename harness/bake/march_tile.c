/* The march's frame: a tile drawn, front to back. */
#include "bake/march_frame.h"

#include <math.h>

/* Leaves a share of the sun's light. */
static void far_darken(struct march_far *far, float share)
{
    for (int c = 0; c < 3; c++)
        far->rgb[c] -= (1 - share) * far->sun_rgb[c];
}

/* The sine by which the way from the eye to a place rises. */
static float rise_of(const struct march_view *picture, const float place_m[3])
{
    const float *eye_m = picture->view->eye_m;
    float away[3] = {place_m[0] - eye_m[0], place_m[1] - eye_m[1], place_m[2] - eye_m[2]};
    return away[1] / sqrtf(away[0] * away[0] + away[1] * away[1] + away[2] * away[2]);
}

/* share: of its optical depth. */
static void entry_splat(const struct march *march, const struct march_view *picture, uint32_t entry,
                        bool is_sprite, float share, struct canvas *canvas)
{
    struct march_splat splat;
    struct march_far far;
    float middle[3];
    if (march_is_cell(march, entry)) {
        uint32_t cell = entry - (uint32_t)march->scene->instances_count;
        const struct cells_sums *sums = cells_sums(march->cells, cell);
        march_cell_middle(picture, sums, middle);
        far = march_fars_at(march->fars, picture->view, sums->species, MARCH_TURNS, middle);
        if (picture->shadows)
            far_darken(&far, march_shadows_of_cell(picture->shadows, cell,
                                                   rise_of(picture, sums->foot_m)));
        march_cell_splat(picture, sums, middle, &far, &splat);
    } else {
        const struct march_tree *tree = &march->trees[entry];
        march_middle(picture, tree, middle);
        far = march_fars_at(march->fars, picture->view, tree->species, tree->turn, middle);
        if (picture->shadows)
            far_darken(&far, march_shadows_of_tree(picture->shadows, entry,
                                                   rise_of(picture, tree->position_m)));
        if (is_sprite) {
            const struct march_far *its;
            const struct march_sprite *sprite = march_fars_sprite(
                march->fars, picture->view, tree->species, tree->turn, middle, &its);
            canvas_sprite(canvas, picture, tree, sprite, its, &far, share);
            return;
        }
        march_splat_of(picture, tree, &far, &splat);
    }
    splat.share = share;
    canvas_splat(canvas, &splat, &picture->rays);
}

/* What is not marched of entry k: all of a splat, the far share of others. */
static void entry_far(const struct march *march, const struct march_view *picture,
                      const struct cells_list *list, uint32_t k, struct canvas *canvas)
{
    const struct march_seen *seen = &march->seen[k];
    const float kept = 1 - (float)seen->gone / 255, far = (float)seen->far / 255;
    if (march_is_splat(seen))
        entry_splat(march, picture, list->entries[k], seen->level == MARCH_SPRITE, (1 - far) * kept,
                    canvas);
    bool is_sprite = !march_is_splat(seen) && march->options.far_px > MARCH_SMALL_PX;
    if (seen->far > 0)
        entry_splat(march, picture, list->entries[k], is_sprite, far * kept, canvas);
}

/* The end of the run of entries that reach into each other's depths. */
static uint32_t interlocked_end(const struct march *march, uint32_t at, uint32_t end)
{
    float far_m = march->spans[march->entries[at++]].far_m;
    for (; at < end && march->spans[march->entries[at]].rest_m < far_m; at++) {
        if (march_is_splat(&march->seen[march->entries[at]]))
            break;
        far_m = fmaxf(far_m, march->spans[march->entries[at]].far_m);
    }
    return at;
}

/* The depth to which a slab from a depth on goes: to the next tree's box; where several trees are,
 * some voxels at most. */
static float slab_end(const struct march *march, uint32_t first, uint32_t last, float from_m)
{
    float voxel_m = INFINITY, next_m = INFINITY;
    int trees = 0;
    for (uint32_t at = first; at < last; at++) {
        const struct march_span *span = &march->spans[march->entries[at]];
        if (span->far_m <= from_m)
            continue;
        if (span->near_m > from_m) {
            next_m = fminf(next_m, span->near_m);
            continue;
        }
        voxel_m = fminf(voxel_m, span->voxel_m);
        trees++;
    }
    float deep_m = trees > 1 ? fmaxf(march->options.slab * voxel_m, 1e-5f * from_m) : INFINITY;
    return fminf(next_m, from_m + deep_m);
}

/* Trees that stand in each other, slab by slab: as thin slabs, the sum of their densities, each
 * with its own colour. Chiba, Muraoka, Doi and Hosokawa 1997, with each tree's own normals. */
static void interlocked_draw(const struct march *march, const struct march_view *picture,
                             const struct cells_list *list, uint32_t first, uint32_t last,
                             struct canvas *canvas)
{
    float from_m = picture->view->near_m, far_m = from_m;
    for (uint32_t at = first; at < last; at++)
        far_m = fmaxf(far_m, march->spans[march->entries[at]].far_m);
    while (from_m < far_m && canvas->open_count) {
        float to_m = slab_end(march, first, last, from_m);
        for (uint32_t at = first; at < last; at++) {
            uint32_t k = march->entries[at];
            if (march->spans[k].near_m < to_m && march->spans[k].far_m > from_m)
                canvas_march(canvas, picture, &march->trees[list->entries[k]], &march->seen[k],
                             from_m, to_m);
        }
        from_m = to_m;
    }
    for (uint32_t at = first; at < last; at++)
        entry_far(march, picture, list, march->entries[at], canvas);
}

uint64_t march_tile_draw(const struct march *march, const struct march_view *picture,
                         const struct march_tiles *tiles, const struct cells_list *list,
                         size_t tile, struct canvas *canvas, float *pixels)
{
    const int side = tiles->side_px;
    canvas_begin(canvas, picture, (int)(tile % (size_t)tiles->across) * side,
                 (int)(tile / (size_t)tiles->across) * side, side);
    const uint32_t end = march->tile_first[tile + 1];
    if (march->tile_first[tile] == end && !picture->shadows) {
        canvas_end_clear(canvas, picture->view, pixels);
        return 0;
    }
    canvas_open(canvas, picture);
    for (uint32_t at = march->tile_first[tile]; at < end && canvas->open_count; at++) {
        uint32_t k = march->entries[at];
        march_entry_fetch(march, list, at + MARCH_SOON < end ? march->entries[at + MARCH_SOON] : k);
        if (march_is_splat(&march->seen[k])) {
            entry_far(march, picture, list, k, canvas);
        } else if (march->spans) {
            uint32_t last = interlocked_end(march, at, end);
            interlocked_draw(march, picture, list, at, last, canvas);
            at = last - 1;
        } else {
            canvas_march(canvas, picture, &march->trees[list->entries[k]], &march->seen[k], 0,
                         INFINITY);
            entry_far(march, picture, list, k, canvas);
        }
    }
    if (picture->shadows)
        canvas_shade(canvas, picture);
    canvas_end(canvas, picture->view, pixels);
    return canvas->lookups + canvas->rays.lookups;
}
