/* The march's frame: trees sorted and binned to tiles, tiles drawn front to back by all threads. */
#include "bake/march_canvas.h"
#include "bake/march_cells.h"
#include "bake/march_fars.h"
#include "bake/march_shadow.h"

#include <math.h>
#include <string.h>

struct march {
    const struct scene *scene;
    struct march_options options;
    march_block *block;
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

static march_block *block_named(const char *name)
{
    struct march_isa isas[4];
    size_t count = march_isas(isas), chosen = name ? 0 : count - 1;
    for (size_t i = 0; i < count && name; i++)
        chosen = strcmp(isas[i].name, name) ? chosen : i;
    return isas[chosen].block;
}

static enum status species_fill(struct workspace *workspace, struct plant *plant,
                                const struct march_options *options, struct march_species *species,
                                struct cull_bound *bound)
{
    const struct mesh *mesh;
    enum status status = voxels_of_plant(workspace->arena, plant, options->resolution,
                                         &species->voxels, workspace->error);
    if (!status)
        status = plant_mesh(plant, &mesh, workspace->error);
    if (status)
        return status;
    if (options->model == MARCH_NOMA)
        species->voxels = voxels_noma(workspace->arena, species->voxels);
    if (options->model == MARCH_VISIBLE)
        species->voxels = voxels_visible(workspace->arena, species->voxels);
    *bound = cull_bound_of(mesh);
    species->mesh = mesh;
    species->is_solid = mesh_is_solid(mesh);
    float square = 0;
    for (int i = 0; i < 3; i++) {
        float half = 0.5f * (mesh->maximum_m[i] - mesh->minimum_m[i]);
        species->center_m[i] = mesh->minimum_m[i] + half;
        species->half_m[i] = half;
        square += half * half;
    }
    species->radius_m = sqrtf(square);
    return STATUS_OK;
}

enum status march_prepare(struct workspace *workspace, const struct scene *scene,
                          const struct march_options *options, struct march **result)
{
    struct march *march = *result = ARENA_NEW(workspace->arena, struct march);
    march->scene = scene;
    march->options = *options;
    march->options.far_px = options->slab > 0 ? 0 : options->far_px;
    march->block = block_named(options->isa);
    enum status status = backdrop_cpu_prepare(workspace, scene, &march->backdrop);
    march->species = ARENA_ARRAY(workspace->arena, struct march_species, scene->species_count);
    struct cull_bound *bounds =
        ARENA_ARRAY(workspace->arena, struct cull_bound, scene->species_count);
    for (size_t i = 0; i < scene->species_count && !status; i++)
        status = species_fill(workspace, scene->species[i].plant, options, &march->species[i],
                              &bounds[i]);
    if (status)
        return status;
    march->trees = ARENA_ARRAY(workspace->arena, struct march_tree, scene->instances_count);
    march_trees_fill(scene, march->trees);
    march->fars = march_fars_create(workspace->arena, scene, march->trees, workspace->threads);
    if (options->cells && !scene_is_stretched(scene)) /* cells know one shape of a species */
        march->cells = cells_create(workspace->arena, scene, bounds);
    else
        march->cull = cull_create(workspace->arena, scene, bounds);
    size_t most = scene->instances_count + (march->cells ? cells_count(march->cells) : 0);
    march->seen = ARENA_ARRAY(workspace->arena, struct march_seen, most);
    if (options->slab > 0)
        march->spans = ARENA_ARRAY(workspace->arena, struct march_span, most);
    if (workspace->effects & EFFECT_SUN_SHADOWS)
        return march_shadows_create(workspace, scene, options, march->species, march->trees,
                                    march->cells, &march->shadows);
    return STATUS_OK;
}

/* The picture cut into tiles. */
struct tiles {
    int side_px, across, down;
    size_t count;
};

static struct tiles tiles_of(const struct march *march, const struct view *view)
{
    struct tiles tiles = {.side_px = march->options.tile_px / MARCH_BLOCK * MARCH_BLOCK};
    tiles.across = (view->width_px + tiles.side_px - 1) / tiles.side_px;
    tiles.down = (view->height_px + tiles.side_px - 1) / tiles.side_px;
    tiles.count = (size_t)tiles.across * (size_t)tiles.down;
    return tiles;
}

/* Calls for each tile that a tree touches: counts, or puts the entry to its place. */
static void tree_bin(const struct tiles *tiles, const struct march_seen *seen, uint32_t *places,
                     uint32_t *entries, uint32_t entry)
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
static size_t places_of(uint32_t *first, const struct tiles *tiles, int threads)
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

/* Drawn from far pictures, not marched. */
static bool is_splat(const struct march_seen *seen)
{
    return seen->level == MARCH_SPLAT || seen->level == MARCH_CELL || seen->level == MARCH_SPRITE;
}

static bool is_cell(const struct march *march, uint32_t entry)
{
    return entry >= march->scene->instances_count;
}

/* Entries come by depth, not by place in memory: what will be needed soon is asked for early. */
enum { SOON = 8 };
static void entry_fetch(const struct march *march, const struct cells_list *list, size_t k)
{
    uint32_t entry = k < list->count ? list->entries[k] : 0;
    if (is_cell(march, entry))
        __builtin_prefetch(
            cells_sums(march->cells, entry - (uint32_t)march->scene->instances_count));
    else
        __builtin_prefetch(&march->trees[entry]);
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
    if (is_cell(march, entry)) {
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
    if (is_splat(seen) || seen->far > 0) {
        march_middle(picture, tree, middle);
        march_fars_ask(march->fars, thread, picture->view, tree->species, tree->turn, middle);
    }
}

/* Threads take runs of the sorted list, so that each tile's entries keep the list's order. */
static void bin(struct workspace *workspace, struct march *march, const struct march_view *picture,
                const struct tiles *tiles, const struct cells_list *list)
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
            entry_fetch(march, list, k + SOON);
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
    if (is_cell(march, entry)) {
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
    if (is_splat(seen))
        entry_splat(march, picture, list->entries[k], seen->level == MARCH_SPRITE, (1 - far) * kept,
                    canvas);
    bool is_sprite = !is_splat(seen) && march->options.far_px > MARCH_SMALL_PX;
    if (seen->far > 0)
        entry_splat(march, picture, list->entries[k], is_sprite, far * kept, canvas);
}

/* The end of the run of entries that reach into each other's depths. */
static uint32_t interlocked_end(const struct march *march, uint32_t at, uint32_t end)
{
    float far_m = march->spans[march->entries[at++]].far_m;
    for (; at < end && march->spans[march->entries[at]].rest_m < far_m; at++) {
        if (is_splat(&march->seen[march->entries[at]]))
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

/* Returns the lookups of its rays. */
static uint64_t tile_draw(const struct march *march, const struct march_view *picture,
                          const struct tiles *tiles, const struct cells_list *list, size_t tile,
                          struct canvas *canvas, float *pixels)
{
    const int side = tiles->side_px;
    canvas_begin(canvas, picture, (int)(tile % (size_t)tiles->across) * side,
                 (int)(tile / (size_t)tiles->across) * side, side);
    const uint32_t end = march->tile_first[tile + 1];
    for (uint32_t at = march->tile_first[tile]; at < end && canvas->open_count; at++) {
        uint32_t k = march->entries[at];
        entry_fetch(march, list, at + SOON < end ? march->entries[at + SOON] : k);
        if (is_splat(&march->seen[k])) {
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
    canvas_end(canvas, march->options.stop, picture->view, pixels);
    uint64_t lookups = canvas->lookups;
    for (int block = 0; block < canvas->blocks_count; block++)
        lookups += canvas->blocks[block].lookups;
    return lookups;
}

/* What is in view, front to back: by cells, or tree by tree. */
static struct cells_list list_of(struct march *march, const struct view *view, int threads)
{
    const struct cells_limits limits = {MARCH_CELL_PX, MARCH_SMALL_PX, march->options.smooth};
    if (march->cells)
        return cells_view(march->cells, view, &limits, threads);
    struct cull_list list = cull_view(march->cull, view, CULL_FRONT_TO_BACK);
    return (struct cells_list){list.count, list.instances, list.depths_m, NULL};
}

enum status march_draw(struct workspace *workspace, struct march *march, const struct view *view,
                       struct target *target)
{
    const struct march_view picture = {
        .view = view,
        .scene = march->scene,
        .rays = backdrop_rays_of(view),
        .focal_px = cull_focal_px(view),
        .effects = workspace->effects,
        .options = march->options,
        .species = march->species,
        .shadows = march->shadows,
    };
    if (march->shadows)
        march_shadows_light(march->shadows, view->sun_direction, workspace->threads);
    const struct tiles tiles = tiles_of(march, view);
    backdrop_cpu_begin(workspace, march->backdrop, view);
    march_fars_begin(march->fars);
    struct cells_list list = list_of(march, view, workspace->threads);
    bin(workspace, march, &picture, &tiles, &list);
    march_fars_make(march->fars, &picture, march->block);
    uint64_t lookups = 0;
#pragma omp parallel num_threads(workspace->threads) reduction(+ : lookups)
    {
        struct canvas canvas;
        canvas.backdrop = march->backdrop;
        canvas.block = march->block;
#pragma omp for schedule(dynamic, 1)
        for (size_t tile = 0; tile < tiles.count; tile++)
            lookups += tile_draw(march, &picture, &tiles, &list, tile, &canvas, target->pixels);
    }
    workspace->tally.lookups += lookups;
    size_t spheres = march->cull ? march->scene->instances_count : 0;
    workspace->tally.bytes += spheres * 4 * sizeof(float) + list.count * sizeof *march->trees;
    return STATUS_OK;
}
