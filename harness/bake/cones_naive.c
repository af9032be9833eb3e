/* The straightforward way, a cone a pixel as the paper has it: down the hierarchy of trees, in each
 * down that of its twigs and bark, everything that is met computed there and then; all met of a
 * pixel is sorted by depth and composed. */
#include "bake/cone_bvh.h"
#include "bake/cones_parts.h"

#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>

struct work;
struct cones_naive {
    struct arena *arena;
    struct cone_bvh *trees;
    struct cone_bvh **items; /* of a species: twigs, then barks */
    size_t items_most, strips_most;
    struct work *works; /* a thread */
    int works_count;
};

/* What a thread needs. Fragments of a pixel: of strips that hide some of it. */
struct work {
    uint32_t *trees, *items;
    struct cone_strip *strips, *fragments;
    uint32_t *order;
    size_t fragments_capacity, count;
    uint64_t met;
};

static struct cone_ball *balls_of(struct arena *arena, const struct cone_plant *plant)
{
    struct cone_ball *balls =
        ARENA_ARRAY(arena, struct cone_ball, plant->twigs_count + plant->barks_count + 1);
    for (size_t i = 0; i < plant->twigs_count; i++) /* a cone's outline is drawn as a trapezium */
        balls[i].radius_m = 1.5f * cone_twig_reach(&plant->twigs[i], balls[i].center_m);
    for (size_t i = 0; i < plant->barks_count; i++) {
        const struct cone_bark *bark = &plant->barks[i];
        struct cone_ball *ball = &balls[plant->twigs_count + i];
        float square = 0;
        for (int k = 0; k < 3; k++) {
            float half = 0.5f * (bark->to_m[k] - bark->from_m[k]);
            ball->center_m[k] = bark->from_m[k] + half;
            square += half * half;
        }
        ball->radius_m = 1.5f * (sqrtf(square) + fmaxf(bark->radius_m[0], bark->radius_m[1]));
    }
    return balls;
}

struct cones_naive *cones_naive_create(struct arena *arena, const struct cones *cones)
{
    const struct scene *scene = cones->scene;
    struct cones_naive *naive = ARENA_NEW(arena, struct cones_naive);
    naive->arena = arena;
    struct cone_ball *trees = ARENA_ARRAY(arena, struct cone_ball, scene->instances_count + 1);
    naive->items = ARENA_ARRAY(arena, struct cone_bvh *, scene->species_count + 1);
    for (size_t s = 0; s < scene->species_count; s++) {
        const struct cone_plant *plant = cones->plants[s];
        size_t items = plant->twigs_count + plant->barks_count;
        naive->items_most = items > naive->items_most ? items : naive->items_most;
        naive->items[s] = cone_bvh_create(arena, balls_of(arena, plant), items);
        for (size_t i = 0; i < plant->twigs_count; i++) {
            const struct conifer_twig *twig = plant->twigs[i].twig;
            size_t most = 2 + (size_t)twig->cones_count * (2 + (size_t)twig->needles_count);
            naive->strips_most = most > naive->strips_most ? most : naive->strips_most;
        }
    }
    for (size_t i = 0; i < scene->instances_count; i++) {
        const struct instance *instance = &scene->instances[i];
        const struct cone_plant *plant = cones->plants[instance->species];
        float c = cosf(instance->rotation_rad), s = sinf(instance->rotation_rad);
        const float *m = plant->center_m;
        float turned[3] = {m[0] * c + m[2] * s, m[1], m[2] * c - m[0] * s};
        for (int k = 0; k < 3; k++)
            trees[i].center_m[k] = instance->position_m[k] + instance->scale * turned[k];
        trees[i].radius_m = 1.1f * instance->scale * plant->radius_m;
    }
    naive->trees = cone_bvh_create(arena, trees, scene->instances_count);
    return naive;
}

/* The cone of a pixel, as wide as what the footprint of a strip reaches beyond the pixel. */
static struct cone_beam beam_of(const struct cone_picture *picture, const float ray[3])
{
    static const float reach_px = 1.6f;
    struct cone_beam beam;
    float length = sqrtf(ray[0] * ray[0] + ray[1] * ray[1] + ray[2] * ray[2]);
    for (int i = 0; i < 3; i++) {
        beam.origin_m[i] = picture->view->eye_m[i];
        beam.direction[i] = ray[i] / length;
    }
    beam.wide_m = 0;
    beam.spread = reach_px / picture->focal_px;
    return beam;
}

/* The same in a tree's axes, at scale 1. */
static struct cone_beam beam_in(const struct cone_picture *picture, const struct cone_tree *tree,
                                float x_px, float y_px, const struct cone_beam *world)
{
    struct cone_beam beam = *world;
    const float camera[3] = {
        (x_px - 0.5f * (float)(picture->view->width_px - 1)) / picture->focal_px,
        (0.5f * (float)(picture->view->height_px - 1) - y_px) / picture->focal_px, 1};
    float length = sqrtf(camera[0] * camera[0] + camera[1] * camera[1] + 1);
    for (int i = 0; i < 3; i++) {
        beam.origin_m[i] = tree->eye_m[i];
        beam.direction[i] = 0;
        for (int k = 0; k < 3; k++)
            beam.direction[i] += tree->to_camera[k][i] * camera[k] / (tree->scale * length);
    }
    return beam;
}

/* The arena serves one thread at a time. */
static void fragments_grow(struct arena *arena, struct work *work)
{
    const size_t capacity = 2 * work->fragments_capacity + 64;
    struct cone_strip *more;
#pragma omp critical(cones_naive_arena)
    more = ARENA_ARRAY(arena, struct cone_strip, capacity);
    if (work->count > 0)
        memcpy(more, work->fragments, work->count * sizeof *more);
    work->fragments = more;
    work->fragments_capacity = capacity;
}

static void gather(struct arena *arena, struct work *work, const struct cone_strip *strips,
                   size_t count, float x_px, float y_px)
{
    struct cone_place place;
    for (size_t k = 0; k < count; k++) {
        if (!(cone_strip_hides(&strips[k], x_px, y_px, &place) > 0))
            continue;
        if (work->count == work->fragments_capacity)
            fragments_grow(arena, work);
        work->fragments[work->count++] = strips[k];
    }
}

static void tree_meet(const struct cones *cones, const struct cone_picture *picture,
                      struct work *work, size_t instance, float x_px, float y_px,
                      const struct cone_beam *world)
{
    struct cone_tree tree;
    cone_tree_of(picture, instance, &tree);
    const struct cone_beam beam = beam_in(picture, &tree, x_px, y_px, world);
    const size_t twigs = tree.plant->twigs_count;
    size_t found = 0;
    if (tree.trunk_step > 1) /* pieces of it are drawn as one: small, so that all may be met */
        for (; found < twigs + tree.plant->barks_count; found++)
            work->items[found] = (uint32_t)found;
    else
        found = cone_bvh_find(cones->naive->items[cones->scene->instances[instance].species], &beam,
                              work->items, cones->naive->items_most, &work->met);
    for (size_t k = 0; k < found; k++) {
        size_t item = work->items[k], count = 0;
        if (item < twigs && (float)item < tree.twigs)
            count = cone_twig_emit(picture, &tree, item, &beam, work->strips);
        else if (item >= twigs && (float)(item - twigs) < tree.barks)
            count = cone_bark_emit(picture, &tree, item - twigs, work->strips);
        gather(cones->naive->arena, work, work->strips, count, x_px, y_px);
    }
}

static int by_depth(const void *a, const void *b)
{
    const struct cone_strip *x = a, *y = b;
    return x->depth_m < y->depth_m ? -1 : x->depth_m > y->depth_m;
}

static void pixel_draw(struct cones *cones, const struct cone_picture *picture, struct work *work,
                       size_t pixel)
{
    struct cone_canvas *canvas = cones->canvas;
    const float x = (float)(pixel % (size_t)canvas->width_px);
    const float y = (float)(pixel / (size_t)canvas->width_px);
    float ray[3];
    for (int i = 0; i < 3; i++)
        ray[i] = canvas->rays.first[i] + x * canvas->rays.right[i] + y * canvas->rays.down[i];
    const struct cone_beam beam = beam_of(picture, ray);
    size_t found = cone_bvh_find(cones->naive->trees, &beam, work->trees,
                                 cones->scene->instances_count, &work->met);
    work->count = 0;
    for (size_t k = 0; k < found; k++)
        tree_meet(cones, picture, work, work->trees[k], x, y, &beam);
    if (work->count > 0)
        qsort(work->fragments, work->count, sizeof *work->fragments, by_depth);
    for (size_t k = 0; k < work->count; k++) {
        struct cone_place place;
        float w = cone_strip_hides(&work->fragments[k], x, y, &place);
        cone_canvas_put(canvas, pixel, &work->fragments[k], &place, w);
        if (canvas->left[pixel] * canvas->share[pixel] <= cones->options.stop)
            break;
    }
}

static void works_create(const struct cones *cones, int threads)
{
    struct cones_naive *naive = cones->naive;
    if (threads <= naive->works_count)
        return;
    naive->works_count = threads;
    naive->works = ARENA_ARRAY(naive->arena, struct work, threads);
    for (int k = 0; k < threads; k++) {
        struct work *work = &naive->works[k];
        work->trees = ARENA_ARRAY(naive->arena, uint32_t, cones->scene->instances_count + 1);
        work->items = ARENA_ARRAY(naive->arena, uint32_t, naive->items_most + 1);
        work->strips = ARENA_ARRAY(naive->arena, struct cone_strip, naive->strips_most + 2);
    }
}

uint64_t cones_naive_draw(struct workspace *workspace, struct cones *cones,
                          const struct cone_picture *picture)
{
    struct cones_naive *naive = cones->naive;
    const size_t pixels = (size_t)cones->canvas->width_px * (size_t)cones->canvas->height_px;
    uint64_t met = 0;
    works_create(cones, workspace->threads);
#pragma omp parallel num_threads(workspace->threads) reduction(+ : met)
    {
        struct work *work = &naive->works[omp_get_thread_num()];
        work->met = 0;
#pragma omp for schedule(dynamic, 64)
        for (size_t pixel = 0; pixel < pixels; pixel++)
            pixel_draw(cones, picture, work, pixel);
        met += work->met;
    }
    return met;
}
