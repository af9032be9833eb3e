/* Triangles that meet a sample, by the CPU: elements by their spheres, block by block; what they
 * leave, triangle by triangle against samples and their depths. Sources in sift.h. */
#include "bake/sift.h"
#include "bake/sift_parts.h"

#include <math.h>
#include <omp.h>
#include <string.h>

/* One band of rows, the work of one thread; where it stopped when its room was full. */
struct band {
    int low_row, high_row; /* rows [low, high), from the bottom */
    size_t tree, run, element;
    size_t filled[SIFT_STREAMS]; /* triangles */
    bool done;
};

struct sift {
    int threads;
    size_t room; /* triangles of one stream of one band */
    struct band *bands;
    struct sift_screen screen;
    size_t depths_room;
    const struct sift_tree *trees;
    size_t trees_count;
    const struct sift_run *runs;
    struct arena *arena;
};

/* The sphere about a centre, or about the middle of the box, of 3 corners a triangle. */
static void set_sphere(struct sift_set *set, size_t element, const float *center)
{
    const struct sift_vertex *begin = set->vertices + 3 * (size_t)set->first[element];
    size_t corners = 3 * (size_t)(set->first[element + 1] - set->first[element]);
    float low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (size_t c = 0; c < corners; c++)
        for (int axis = 0; axis < 3; axis++) {
            low[axis] = fminf(low[axis], begin[c].position_m[axis]);
            high[axis] = fmaxf(high[axis], begin[c].position_m[axis]);
        }
    float middle[3] = {0, 0, 0}, square = 0;
    for (int axis = 0; axis < 3 && corners; axis++)
        middle[axis] = center ? center[axis] : 0.5f * (low[axis] + high[axis]);
    for (size_t c = 0; c < corners; c++) {
        float sum = 0;
        for (int axis = 0; axis < 3; axis++) {
            float d = begin[c].position_m[axis] - middle[axis];
            sum += d * d;
        }
        square = fmaxf(square, sum);
    }
    set->x[element] = middle[0];
    set->y[element] = middle[1];
    set->z[element] = middle[2];
    set->radius_m[element] = sqrtf(square) * 1.00001f;
}

struct sift_set *sift_set_create(struct arena *arena, struct sift_vertex *vertices, size_t count,
                                 const uint32_t *first, const float (*centers)[3])
{
    struct sift_set *set = ARENA_NEW(arena, struct sift_set);
    set->count = count;
    set->vertices = vertices;
    set->first = ARENA_ARRAY(arena, uint32_t, count + 1);
    set->x = ARENA_ARRAY(arena, float, count);
    set->y = ARENA_ARRAY(arena, float, count);
    set->z = ARENA_ARRAY(arena, float, count);
    set->radius_m = ARENA_ARRAY(arena, float, count);
    for (size_t e = 0; e <= count; e++)
        set->first[e] = first ? first[e] : (uint32_t)e;
    for (size_t e = 0; e < count; e++)
        set_sphere(set, e, centers ? centers[e] : NULL);
    return set;
}

struct sift *sift_create(struct arena *arena, int threads, size_t triangles_room)
{
    struct sift *sift = ARENA_NEW(arena, struct sift);
    sift->arena = arena;
    sift->threads = threads > 0 ? threads : 1;
    sift->room = triangles_room;
    sift->bands = ARENA_ARRAY(arena, struct band, (size_t)sift->threads);
    return sift;
}

/* Rows shared out so that every band has about the same number of elements. */
static void share_rows(struct sift *sift, const struct view *view)
{
    enum { SLOTS = 64 };
    double load[SLOTS] = {0}, all = 0, sum = 0;
    for (size_t t = 0; t < sift->trees_count; t++) {
        const struct sift_tree *tree = &sift->trees[t];
        const float *at = tree->instance->position_m;
        float middle[3] = {at[0],
                           at[1] + 0.5f * tree->instance->scale * tree->instance->stretch *
                                       (tree->low_m + tree->high_m),
                           at[2]};
        float clip[3];
        sift_project(&sift->screen, middle, clip);
        float row = clip[2] > view->near_m ? clip[1] / clip[2] / (float)view->height_px : 0.5f;
        int slot = (int)(fminf(fmaxf(row, 0), 0.999f) * SLOTS);
        double work = 8;
        for (size_t r = 0; r < tree->runs_count; r++)
            work += (double)sift->runs[tree->first_run + r].kept;
        load[slot] += work;
        all += work;
    }
    int slot = 0;
    for (int b = 0; b < sift->threads; b++) {
        sift->bands[b] = (struct band){.low_row = b ? sift->bands[b - 1].high_row : 0};
        double end = all * (b + 1) / sift->threads;
        while (slot < SLOTS && sum + load[slot] <= end)
            sum += load[slot++];
        double row = slot < SLOTS && load[slot] > 0 ? slot + (end - sum) / load[slot] : slot;
        int high = (int)(row / SLOTS * view->height_px);
        sift->bands[b].high_row = b + 1 == sift->threads ? view->height_px : high;
        if (sift->bands[b].high_row < sift->bands[b].low_row)
            sift->bands[b].high_row = sift->bands[b].low_row;
    }
}

void sift_begin(struct sift *sift, const struct view *view, const struct sampling_places *places,
                const struct sift_tree *trees, size_t trees_count, const struct sift_run *runs)
{
    struct sift_screen *screen = &sift->screen;
    size_t samples = (size_t)view->width_px * (size_t)view->height_px * (size_t)places->count;
    if (samples > sift->depths_room) {
        screen->depths_m = ARENA_ARRAY(sift->arena, float, samples);
        sift->depths_room = samples;
    }
    sift_screen_set(screen, view, places);
    sift->trees = trees;
    sift->trees_count = trees_count;
    sift->runs = runs;
    share_rows(sift, view);
#pragma omp parallel for num_threads(sift->threads)
    for (size_t i = 0; i < samples; i++)
        screen->depths_m[i] = INFINITY;
}

/* Goes on with one run from where the band stopped; false when the room is full. */
static bool sift_one_run(const struct sift *sift, struct band *band, struct sift_work *work,
                         const struct sift_run *run)
{
    const struct sift_set *set = run->set;
    size_t length = (size_t)ceilf(run->kept);
    length = length < set->count ? length : set->count;
    work->stream = set->stream;
    while (band->element < length) {
        if (work->filled[set->stream] + SIFT_BLOCK * SIFT_TRIANGLES > sift->room)
            return false;
        size_t at = (run->begin + band->element) % set->count;
        size_t count = length - band->element;
        count = count < SIFT_BLOCK ? count : SIFT_BLOCK;
        count = count < set->count - at ? count : set->count - at;
        sift_block(work, run, at, band->element, count);
        band->element += count;
    }
    band->element = 0;
    return true;
}

static bool tree_is_large(const struct sift *sift, const struct sift_tree *tree)
{
    float elements = 0;
    for (size_t r = 0; r < tree->runs_count; r++)
        elements += sift->runs[tree->first_run + r].kept;
    return elements > SIFT_BLOCK;
}

static void fill_band(const struct sift *sift, struct band *band, struct sift_vertex *vertices)
{
    struct sift_work work = {.screen = &sift->screen,
                             .low_row = (float)band->low_row,
                             .high_row = (float)band->high_row};
    for (int s = 0; s < SIFT_STREAMS; s++)
        work.out[s] = vertices + 3 * sift->room * (size_t)s;
    for (; band->tree < sift->trees_count; band->tree++) {
        const struct sift_tree *tree = &sift->trees[band->tree];
        bool begun = band->run > 0 || band->element > 0;
        if (!begun && !sift_tree_seen(&work, tree, tree_is_large(sift, tree)))
            continue;
        sift_tree_set(&work, tree);
        for (; band->run < tree->runs_count; band->run++)
            if (!sift_one_run(sift, band, &work, &sift->runs[tree->first_run + band->run])) {
                memcpy(band->filled, work.filled, sizeof band->filled);
                return;
            }
        band->run = 0;
    }
    memcpy(band->filled, work.filled, sizeof band->filled);
    band->done = true;
}

bool sift_fill(struct sift *sift, struct sift_vertex *vertices)
{
    bool left = false;
    for (int b = 0; b < sift->threads; b++)
        left |= !sift->bands[b].done;
    if (!left)
        return false;
#pragma omp parallel for num_threads(sift->threads) schedule(static, 1)
    for (int b = 0; b < sift->threads; b++) {
        struct band *band = &sift->bands[b];
        memset(band->filled, 0, sizeof band->filled);
        if (!band->done)
            fill_band(sift, band, vertices + 3 * sift->room * SIFT_STREAMS * (size_t)b);
    }
    return true;
}

size_t sift_vertices_count(const struct sift *sift)
{
    return 3 * sift->room * SIFT_STREAMS * (size_t)sift->threads;
}

int sift_threads(const struct sift *sift)
{
    return sift->threads;
}

struct sift_span sift_left(const struct sift *sift, int stream, int thread)
{
    size_t region = (size_t)thread * SIFT_STREAMS + (size_t)stream;
    return (struct sift_span){3 * sift->room * region, 3 * sift->bands[thread].filled[stream]};
}
