/* The ray march's rays over lanes (march_lanes_*.h, included before): what marches them keeps,
 * those to come, and how they take the lanes of those that are done. */
#ifndef TREELINE_BAKE_MARCH_FRESH_H
#define TREELINE_BAKE_MARCH_FRESH_H

#include "bake/march_shade.h"

enum { SETS = 4, TURNS = 2, FRESH_MAX = 64, MET_MAX = 256, MANY = 32 };

/* Rays to come. LANES of room on both sides. */
struct lanes_fresh {
    int first, last;                     /* in the arrays */
    int column, row;                     /* of the next to be looked at */
    int32_t keys[FRESH_MAX + 2 * LANES]; /* of pixels: row x stride + column */
    float at_m[FRESH_MAX + 2 * LANES], end_m[FRESH_MAX + 2 * LANES];
};

/* Voxels that rays have met. */
struct lanes_met {
    int first, last;                                      /* in the arrays */
    int32_t keys[MET_MAX + MANY], places[MET_MAX + MANY]; /* of their words */
    float lengths_m[MET_MAX + MANY];
    float middles_m[MET_MAX + MANY]; /* where the sun has shadows */
};

/* MANY of them, while they hide and shine. */
struct lanes_many {
    float befores[MANY], pass[MANY]; /* of what is seen before one the share that it lets through */
    lanes shares[MANY / LANES];      /* that they hide */
    lanes_int normals[MANY / LANES], colors[MANY / LANES];
};

/* LANES rays under way: from at to end along the view, m. */
struct lanes_rays {
    lanes ray[3], at, end, stride;
    lanes_int key, way; /* where the bits of the way that it goes begin in a cell */
};

struct lanes_march {
    /* The job's, in all lanes. leap: along no ray a voxel's side is shorter. */
    lanes eye[3], most[3], step_m, first_m, leap_m; /* first: a step from empty space on */
    lanes_int size[2];
    struct lanes_rays on[SETS];
    const struct march_job *job;
    const struct march_rect *rect;
    struct march_rays *rays;
    void (*take)(struct lanes_march *march, int sets); /* the first sets of LANES voxels of met */
    float row_per_key;
    int closed;
    struct lanes_fresh fresh;
    struct lanes_met met;
};

static inline lanes_int lanes_numbers(void)
{
    lanes_int numbers;
    static const int32_t all[16] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};
    memcpy(&numbers, all, sizeof numbers);
    return numbers;
}

static inline lanes_int lanes_int_load(const int32_t *from)
{
    lanes_int loaded;
    memcpy(&loaded, from, sizeof loaded);
    return loaded;
}

static inline void lanes_int_store(int32_t *to, lanes_int value)
{
    memcpy(to, &value, sizeof value);
}

static inline void rays_of(const struct march_job *job, lanes column, lanes row, lanes ray[3])
{
    for (int i = 0; i < 3; i++)
        ray[i] = job->first[i] + row * job->down[i] + column * job->right[i];
}

/* Those of pixels. */
static inline void rays_of_keys(const struct lanes_march *march, lanes_int keys, lanes ray[3])
{
    lanes key = lanes_of(keys), row = lanes_of(lanes_truncate((key + 0.5f) * march->row_per_key));
    rays_of(march->job, key - row * (float)march->rays->stride, row, ray);
}

/* Where the bits of a ray's way begin in a cell. */
static inline lanes_int ways_of(const lanes ray[3])
{
    lanes_int way = {0};
    for (int i = 0; i < 3; i++) {
        lanes_int bits;
        memcpy(&bits, &ray[i], sizeof bits);
        way |= (bits >> 31) & (MARCH_WAY_BITS << i);
    }
    return way;
}

/* Where rays enter and leave the level's box. */
static inline void box_cut(const struct march_job *job, const lanes ray[3], lanes *from, lanes *to)
{
    for (int i = 0; i < 3; i++) {
        lanes slow =
            lanes_pick(lanes_less(ray[i] * ray[i], lanes_all(1e-20f)), lanes_all(1e-10f), ray[i]);
        lanes per = 1 / slow, low = per * -job->eye[i];
        lanes high = per * ((float)job->size[i] - job->eye[i]);
        *from = lanes_max(*from, lanes_min(low, high));
        *to = lanes_min(*to, lanes_max(low, high));
    }
}

/* LANES more pixels of a row: those that are open and meet the box. */
static inline void fresh_run(struct lanes_march *march)
{
    const struct march_job *job = march->job;
    struct lanes_fresh *fresh = &march->fresh;
    const int key = fresh->row * march->rays->stride + fresh->column;
    lanes_int numbers = lanes_numbers(), columns = numbers + fresh->column;
    lanes_mask open =
        lanes_both(lanes_int_less(columns, (lanes_int){0} + (march->rect->high[0] + 1)),
                   lanes_less(lanes_all(job->stop), lanes_load(march->rays->left + key)));
    if (lanes_any(open)) {
        lanes ray[3], at = lanes_all(job->near_m);
        lanes end = lanes_min(lanes_load(march->rays->depths_m + key), lanes_all(job->far_m));
        rays_of(job, lanes_of(columns), lanes_all((float)fresh->row), ray);
        box_cut(job, ray, &at, &end);
        lanes_mask meets = lanes_both(lanes_less(at, end), open);
        lanes_order order = lanes_order_of(meets);
        lanes_int_store(fresh->keys + fresh->last, lanes_int_squeeze(numbers + key, order));
        lanes_store(fresh->at_m + fresh->last, lanes_squeeze(at, order));
        lanes_store(fresh->end_m + fresh->last, lanes_squeeze(end, order));
        fresh->last += lanes_count(meets);
    }
    fresh->column += LANES;
    if (fresh->column > march->rect->high[0]) {
        fresh->column = march->rect->low[0];
        fresh->row++;
    }
}

/* Until there are many, or no more. What follows them never begins. */
static inline void fresh_fill(struct lanes_march *march)
{
    struct lanes_fresh *fresh = &march->fresh;
    const int rest = fresh->last - fresh->first;
    lanes_int_store(fresh->keys + LANES, lanes_int_load(fresh->keys + fresh->first));
    lanes_store(fresh->at_m + LANES, lanes_load(fresh->at_m + fresh->first));
    lanes_store(fresh->end_m + LANES, lanes_load(fresh->end_m + fresh->first));
    fresh->first = LANES;
    fresh->last = LANES + rest;
    while (fresh->row <= march->rect->high[1] && fresh->last <= FRESH_MAX)
        fresh_run(march);
    lanes_int_store(fresh->keys + fresh->last, (lanes_int){0});
    lanes_store(fresh->at_m + fresh->last, lanes_all(0));
    lanes_store(fresh->end_m + fresh->last, lanes_all(-1));
}

static inline bool fresh_any(const struct lanes_march *march)
{
    return march->fresh.first < march->fresh.last || march->fresh.row <= march->rect->high[1];
}

/* Lanes whose rays are done get new ones, as far as there are some. */
static inline void rays_refill(struct lanes_march *march, struct lanes_rays *on)
{
    struct lanes_fresh *fresh = &march->fresh;
    if (fresh->last - fresh->first < LANES && fresh->row <= march->rect->high[1])
        fresh_fill(march);
    lanes_mask alive = lanes_less(on->at, on->end);
    const int kept = lanes_count(alive), from = fresh->first - kept;
    const int left = fresh->last - fresh->first;
    lanes_order order = lanes_order_of(alive);
    lanes_mask is_kept = lanes_int_less(lanes_numbers(), (lanes_int){0} + kept);
    on->key = lanes_int_pick(is_kept, lanes_int_squeeze(on->key, order),
                             lanes_int_load(fresh->keys + from));
    on->at = lanes_pick(is_kept, lanes_squeeze(on->at, order), lanes_load(fresh->at_m + from));
    on->end = lanes_pick(is_kept, lanes_squeeze(on->end, order), lanes_load(fresh->end_m + from));
    on->stride = lanes_pick(is_kept, lanes_squeeze(on->stride, order), march->first_m);
    fresh->first += left < LANES - kept ? left : LANES - kept;
    rays_of_keys(march, on->key, on->ray);
    on->way = ways_of(on->ray);
}

#endif
