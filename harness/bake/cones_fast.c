/* All cones of a picture together: trees front to back in batches, each descended once to strips,
 * strips sorted by depth and binned to tiles, tiles composed by all threads. Trees behind tiles
 * that are closed are left out. */
#include "bake/cone_emit_parts.h"
#include "bake/cones_parts.h"
#include "bake/march_shadow_parts.h"

#include <math.h>
#include <string.h>

enum {
    STRIPS = 1 << 18, /* of a batch, at most; one twig more */
    JOBS = 1 << 15,
    TREES = 1 << 13,
    ITEMS = 64,  /* twigs or pieces of bark of a job */
    CHECK = 256, /* strips after which a tile asks whether it is closed */
};

/* Some items of a tree. */
struct job {
    uint32_t tree, first, last; /* items: twigs, then barks */
    size_t place;               /* of its strips */
    uint32_t count;
};

struct rect {
    int16_t low[2], high[2]; /* pixels, both included */
};

struct cones_fast {
    size_t strips_capacity;
    struct cone_strip *strips;
    struct rect *rects;
    struct job *jobs;
    struct cone_tree *trees;
    float *keys, *scratch_keys;
    uint32_t *order, *scratch_order;
    uint32_t *first, *entries; /* of tiles: threads + 1 runs; strips */
    size_t first_capacity, entries_capacity;
};

struct cones_fast *cones_fast_create(struct arena *arena, const struct cones *cones)
{
    struct cones_fast *fast = ARENA_NEW(arena, struct cones_fast);
    size_t most = 0;
    for (size_t s = 0; s < cones->scene->species_count; s++)
        for (size_t i = 0; i < cones->plants[s]->twigs_count; i++) {
            const struct conifer_twig *twig = cones->plants[s]->twigs[i].twig;
            size_t count = 2 + (size_t)twig->cones_count * (2 + (size_t)twig->needles_count);
            most = count > most ? count : most;
        }
    fast->strips_capacity = STRIPS + most;
    fast->strips = ARENA_ARRAY(arena, struct cone_strip, fast->strips_capacity);
    fast->rects = ARENA_ARRAY(arena, struct rect, fast->strips_capacity);
    fast->jobs = ARENA_ARRAY(arena, struct job, JOBS);
    fast->trees = ARENA_ARRAY(arena, struct cone_tree, TREES);
    fast->keys = ARENA_ARRAY(arena, float, 2 * fast->strips_capacity);
    fast->scratch_keys = fast->keys + fast->strips_capacity;
    fast->order = ARENA_ARRAY(arena, uint32_t, 2 * fast->strips_capacity);
    fast->scratch_order = fast->order + fast->strips_capacity;
    return fast;
}

/* Whether a tree may be seen through tiles that are not closed. */
static bool tree_is_open(const struct cone_picture *picture, const struct cone_tree *tree)
{
    float middle_m[3];
    cone_to_camera(tree, tree->plant->center_m, middle_m);
    return cone_picture_sees(picture, middle_m, tree->scale * tree->plant->radius_m);
}

/* Where the next batch begins: a tree of the list and one of its items. */
struct place {
    size_t tree, item;
};

/* The most strips that an item can become. */
static size_t item_most(const struct cone_picture *picture, const struct cone_tree *tree,
                        size_t item, size_t twigs, float depth_m)
{
    return item < twigs ? cone_twig_most(picture, tree, &tree->plant->twigs[item], depth_m) : 1;
}

/* Items of a tree from *item on as jobs, while there is room. */
static size_t tree_cut(const struct cones *cones, const struct cone_picture *picture,
                       uint32_t number, size_t *item, size_t *jobs, size_t strips)
{
    struct cones_fast *fast = cones->fast;
    const struct cone_tree *tree = &fast->trees[number];
    const size_t twigs = (size_t)ceilf(tree->twigs), items = twigs + (size_t)ceilf(tree->barks);
    const float *c = tree->plant->center_m;
    float depth_m = tree->foot_m[2] + tree->to_camera[2][0] * c[0] + tree->to_camera[2][1] * c[1] +
                    tree->to_camera[2][2] * c[2] - tree->scale * tree->plant->radius_m;
    while (*item < items && *jobs < JOBS && strips < STRIPS) {
        struct job *job = &fast->jobs[(*jobs)++];
        *job = (struct job){.tree = number, .first = (uint32_t)*item, .place = strips};
        while (*item < items && *item - job->first < ITEMS && strips < STRIPS)
            strips += item_most(picture, tree, (*item)++, twigs, depth_m);
        job->last = (uint32_t)*item;
    }
    return strips;
}

/* Jobs of a batch; returns how many. */
static size_t batch_cut(struct cones *cones, const struct cone_picture *picture,
                        const struct cull_list *list, struct place *at)
{
    struct cones_fast *fast = cones->fast;
    size_t jobs = 0, strips = 0;
    uint32_t trees = 0;
    while (at->tree < list->count && jobs < JOBS && strips < STRIPS && trees < TREES) {
        struct cone_tree *tree = &fast->trees[trees];
        cone_tree_of(picture, list->instances[at->tree], tree);
        if (tree_is_open(picture, tree)) {
            strips = tree_cut(cones, picture, trees++, &at->item, &jobs, strips);
            size_t items = (size_t)ceilf(tree->twigs) + (size_t)ceilf(tree->barks);
            if (at->item < items)
                break;
        }
        at->tree++;
        at->item = 0;
    }
    return jobs;
}

/* False: touches no pixel. */
static bool rect_of(const struct cone_canvas *canvas, const struct cone_strip *strip,
                    struct rect *rect)
{
    const int sizes[2] = {canvas->width_px, canvas->height_px};
    float low[2], high[2];
    cone_strip_rect(strip, low, high);
    for (int i = 0; i < 2; i++) {
        float first = fmaxf(ceilf(low[i]), 0), last = fminf(floorf(high[i]), (float)(sizes[i] - 1));
        if (!(first <= last))
            return false;
        rect->low[i] = (int16_t)first;
        rect->high[i] = (int16_t)last;
    }
    return strip->opacity > 0;
}

static void job_emit(const struct cones *cones, const struct cone_picture *picture, struct job *job)
{
    struct cones_fast *fast = cones->fast;
    const struct cone_tree *tree = &fast->trees[job->tree];
    const size_t twigs = (size_t)ceilf(tree->twigs);
    size_t to = job->place;
    for (size_t item = job->first; item < job->last;) {
        const size_t end = job->last < twigs ? job->last : twigs;
        size_t count = 1, ends[CONE_LANES], from = to;
        if (item < twigs) {
            count = end - item < CONE_LANES ? end - item : CONE_LANES;
            cone_twigs_emit(picture, tree, item, count, &fast->strips[from], ends);
        } else {
            ends[0] = cone_bark_emit(picture, tree, item - twigs, &fast->strips[from]);
        }
        for (const size_t after = from + ends[count - 1]; from < after; from++)
            if (rect_of(cones->canvas, &fast->strips[from], &fast->rects[to])) {
                if (to != from)
                    fast->strips[to] = fast->strips[from];
                to++;
            }
        item += count;
    }
    job->count = (uint32_t)(to - job->place);
}

/* Calls for each tile that a strip touches: counts, or puts the entry to its place. */
static void strip_bin(const struct cone_canvas *canvas, const struct rect *rect, uint32_t *places,
                      uint32_t *entries, uint32_t entry)
{
    for (int y = rect->low[1] / CONE_TILE; y <= rect->high[1] / CONE_TILE; y++)
        for (int x = rect->low[0] / CONE_TILE; x <= rect->high[0] / CONE_TILE; x++) {
            const size_t tile = (size_t)y * (size_t)canvas->across + (size_t)x;
            if (!canvas->open[tile])
                continue;
            uint32_t place = places[tile]++;
            if (entries)
                entries[place] = entry;
        }
}

/* Counts in each thread's run become the places of its first entries; returns how many in all. */
static size_t places_of(uint32_t *first, size_t tiles, int threads)
{
    size_t sum = 0, run = tiles + 1;
    for (size_t tile = 0; tile <= tiles; tile++) {
        first[tile] = (uint32_t)sum;
        for (int thread = 0; thread < threads && tile < tiles; thread++) {
            uint32_t *place = &first[(size_t)(thread + 1) * run + tile];
            uint32_t count = *place;
            *place = (uint32_t)sum;
            sum += count;
        }
    }
    return sum;
}

/* Threads take runs of the sorted list, so that each tile's entries keep the list's order. */
static void bin(struct workspace *workspace, struct cones *cones, size_t count)
{
    struct cones_fast *fast = cones->fast;
    const struct cone_canvas *canvas = cones->canvas;
    const int threads = workspace->threads;
    const size_t tiles = (size_t)canvas->across * (size_t)canvas->down, run = tiles + 1;
    const size_t size = run * ((size_t)threads + 1);
    fast->first =
        shadow_room(cones->arena, fast->first, size, &fast->first_capacity, sizeof *fast->first);
    memset(fast->first, 0, size * sizeof *fast->first);
    for (int pass = 0; pass < 2; pass++) {
#pragma omp parallel for num_threads(threads) schedule(static, 1)
        for (int thread = 0; thread < threads; thread++) {
            size_t end = count * ((size_t)thread + 1) / (size_t)threads;
            for (size_t k = count * (size_t)thread / (size_t)threads; k < end; k++)
                strip_bin(canvas, &fast->rects[fast->order[k]],
                          fast->first + run * ((size_t)thread + 1), pass ? fast->entries : NULL,
                          fast->order[k]);
        }
        if (pass == 0) {
            size_t entries = places_of(fast->first, tiles, threads);
            fast->entries = shadow_room(cones->arena, fast->entries, entries,
                                        &fast->entries_capacity, sizeof *fast->entries);
        }
    }
}

/* The pixels of a row that a strip's band may touch. */
static void row_cut(const struct cone_strip *strip, float half, float y, int *first, int *last)
{
    const float ax = strip->along[0], ay = strip->along[1], v = y - strip->from_px[1];
    float low = (float)*first, high = (float)*last;
    if (fabsf(ay) > 1e-3f) {
        float middle = strip->from_px[0] + v * ax / ay, reach = (half + 0.5f) / fabsf(ay);
        low = fmaxf(low, middle - reach);
        high = fminf(high, middle + reach);
    }
    if (fabsf(ax) > 1e-3f) {
        float a = strip->from_px[0] + (-strip->beyond_px[0] - 0.5f - v * ay) / ax;
        float b = strip->from_px[0] + (strip->length_px + strip->beyond_px[1] + 0.5f - v * ay) / ax;
        low = fmaxf(low, fminf(a, b));
        high = fminf(high, fmaxf(a, b));
    }
    *first = (int)ceilf(low);
    *last = (int)floorf(high);
}

/* Returns how many pixels were asked. */
static uint64_t strip_draw(struct cone_canvas *canvas, const struct cone_strip *strip,
                           const struct rect *rect, const int tile[2])
{
    const float half = fmaxf(strip->half_px[0], strip->half_px[1]);
    int low[2], high[2];
    uint64_t pixels = 0;
    for (int i = 0; i < 2; i++) {
        low[i] = rect->low[i] > tile[i] ? rect->low[i] : tile[i];
        high[i] = rect->high[i] < tile[i] + CONE_TILE - 1 ? rect->high[i] : tile[i] + CONE_TILE - 1;
    }
    for (int y = low[1]; y <= high[1]; y++) {
        int first = low[0], last = high[0];
        row_cut(strip, half, (float)y, &first, &last);
        size_t row = (size_t)y * (size_t)canvas->width_px;
        pixels += last >= first ? (uint64_t)(last - first + 1) : 0;
        for (int x = first; x <= last; x++) {
            struct cone_place place;
            float w = cone_strip_hides(strip, (float)x, (float)y, &place);
            if (w > 0)
                cone_canvas_put(canvas, row + (size_t)x, strip, &place, w);
        }
    }
    return pixels;
}

/* Whether more can be seen through a tile. */
static bool is_open(const struct cone_canvas *canvas, const int tile[2], float stop)
{
    const int right =
        tile[0] + CONE_TILE < canvas->width_px ? tile[0] + CONE_TILE : canvas->width_px;
    const int bottom =
        tile[1] + CONE_TILE < canvas->height_px ? tile[1] + CONE_TILE : canvas->height_px;
    for (int y = tile[1]; y < bottom; y++) {
        const size_t row = (size_t)y * (size_t)canvas->width_px;
        float most = 0;
        for (int x = tile[0]; x < right; x++) {
            float open = canvas->left[row + (size_t)x] * canvas->share[row + (size_t)x];
            most = open > most ? open : most;
        }
        if (most > stop)
            return true;
    }
    return false;
}

static uint64_t tile_draw(struct cones *cones, size_t index)
{
    const struct cones_fast *fast = cones->fast;
    struct cone_canvas *canvas = cones->canvas;
    const int tile[2] = {(int)(index % (size_t)canvas->across) * CONE_TILE,
                         (int)(index / (size_t)canvas->across) * CONE_TILE};
    const uint32_t begin = fast->first[index], end = fast->first[index + 1];
    uint64_t pixels = 0;
    for (uint32_t at = begin; at < end && canvas->open[index]; at++) {
        const uint32_t entry = fast->entries[at];
        pixels += strip_draw(canvas, &fast->strips[entry], &fast->rects[entry], tile);
        if ((at - begin) % CHECK == CHECK - 1 || at + 1 == end)
            canvas->open[index] = is_open(canvas, tile, cones->options.stop);
    }
    return pixels;
}

static size_t batch_sort(struct cones_fast *fast, size_t jobs)
{
    size_t count = 0;
    for (size_t j = 0; j < jobs; j++)
        for (uint32_t k = 0; k < fast->jobs[j].count; k++, count++) {
            fast->order[count] = (uint32_t)fast->jobs[j].place + k;
            fast->keys[count] = fast->strips[fast->order[count]].depth_m;
        }
    cull_sort(fast->keys, fast->order, fast->scratch_keys, fast->scratch_order, count, false);
    return count;
}

uint64_t cones_fast_draw(struct workspace *workspace, struct cones *cones,
                         const struct cone_picture *picture)
{
    struct cones_fast *fast = cones->fast;
    struct cull_list list = cull_view(cones->cull, picture->view, CULL_FRONT_TO_BACK);
    const size_t tiles = (size_t)cones->canvas->across * (size_t)cones->canvas->down;
    struct place at = {0, 0};
    uint64_t met = 0;
    while (at.tree < list.count) {
        size_t jobs = batch_cut(cones, picture, &list, &at);
#pragma omp parallel for num_threads(workspace->threads) schedule(dynamic, 4)
        for (size_t j = 0; j < jobs; j++)
            job_emit(cones, picture, &fast->jobs[j]);
        size_t count = batch_sort(fast, jobs);
        bin(workspace, cones, count);
#pragma omp parallel for num_threads(workspace->threads) schedule(dynamic, 1) reduction(+ : met)
        for (size_t tile = 0; tile < tiles; tile++)
            if (cones->canvas->open[tile])
                met += tile_draw(cones, tile);
        met += count;
    }
    return met;
}
