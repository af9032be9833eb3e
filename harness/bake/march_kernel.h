/* The ray march's kernel, written once over lanes (march_lanes_*.h, included before); every kernel
 * does the same operations in the same order on each ray, so all give the same bits.
 *
 * Rays that meet the tree's box are taken from a queue as lanes get free, so that lanes stay busy
 * though rays end at different steps. Steps only find voxels; these wait in a second queue until
 * they fill all lanes, and only then it is known how much they hide. A ray may so go on for a few
 * steps behind what closes it: what it finds there hides nothing. */
#ifndef TREELINE_BAKE_MARCH_KERNEL_H
#define TREELINE_BAKE_MARCH_KERNEL_H

#include "bake/march_shade.h"

enum { SETS = 3, FRESH_MAX = 64, MET_MAX = 256 };

/* Rays to come. LANES of room on both sides. */
struct lanes_fresh {
    int first, last;                     /* in the arrays */
    int column, row;                     /* of the next to be looked at */
    int32_t keys[FRESH_MAX + 2 * LANES]; /* of pixels: row x stride + column */
    float at_m[FRESH_MAX + 2 * LANES], end_m[FRESH_MAX + 2 * LANES];
};

/* Voxels that rays have met. */
struct lanes_met {
    int first, last; /* in the arrays */
    int32_t keys[MET_MAX + LANES], voxels[MET_MAX + LANES];
    float lengths_m[MET_MAX + LANES];
    float middles_m[MET_MAX + LANES]; /* where the sun has shadows */
};

/* LANES rays under way: from at to end along the view, m. */
struct lanes_rays {
    lanes ray[3], at, end;
    lanes_int key;
};

struct lanes_march {
    const struct march_job *job;
    const struct march_rect *rect;
    struct march_rays *rays;
    /* The job's, in all lanes. leap: along no ray a voxel's side is shorter. */
    lanes eye[3], most[3], step_m, leap_m;
    lanes_int size[2];
    float row_per_key;
    int closed;
    void (*take)(struct lanes_march *march, int first); /* LANES voxels of met */
    struct lanes_fresh fresh;
    struct lanes_met met;
    struct lanes_rays on[SETS];
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
    fresh->first += left < LANES - kept ? left : LANES - kept;
    rays_of_keys(march, on->key, on->ray);
}

static inline lanes_int cells_at(const struct lanes_march *march, const lanes ray[3], lanes middle,
                                 lanes_mask alive)
{
    lanes_int at[3];
    for (int i = 0; i < 3; i++) {
        lanes place = lanes_max(march->eye[i] + middle * ray[i], lanes_all(0));
        at[i] = lanes_truncate(lanes_min(place, march->most[i]));
    }
    lanes_int index = (at[2] * march->size[1] + at[1]) * march->size[0] + at[0];
    return lanes_gather(march->job->cells, index, alive);
}

/* One voxel, or a jump over empty ones. Returns how many voxels were met. */
static inline __attribute__((always_inline)) int
rays_step(struct lanes_march *march, struct lanes_rays *on, lanes_mask alive, const bool shaded)
{
    struct lanes_met *met = &march->met;
    const int last = met->last;
    const lanes step = march->step_m;
    lanes length = lanes_min(step, on->end - on->at), middle = on->at + 0.5f * length;
    lanes_int cell = cells_at(march, on->ray, middle, alive);
    lanes_int voxel = cell - VOXELS_FIRST;
    lanes_mask full = lanes_both(lanes_int_less((lanes_int){0} - 1, voxel), alive);
    lanes_order order = lanes_order_of(full);
    lanes_int_store(met->keys + last, lanes_int_squeeze(on->key, order));
    lanes_int_store(met->voxels + last, lanes_int_squeeze(voxel, order));
    lanes_store(met->lengths_m + last, lanes_squeeze(length, order));
    if (shaded)
        lanes_store(met->middles_m + last, lanes_squeeze(middle, order));
    const int count = lanes_count(full);
    met->last = last + count;
    lanes next = on->at + step;
    lanes far = lanes_max(next, (middle - march->leap_m) + lanes_of(cell) * march->leap_m);
    on->at = lanes_pick(full, next, far);
    return count;
}

/* The shares that voxels hide of what their rays see, one after the other: none where nothing is
 * seen any more. Rays that they close are done. */
static inline void rays_hide(struct lanes_march *march, const int32_t *keys, const float *pass,
                             float *shares)
{
    const float stop = march->job->stop;
    float *left = march->rays->left;
    int32_t closed[LANES + 1];
    int count = 0;
    for (int i = 0; i < LANES; i++) {
        const float before = left[keys[i]];
        const float share = before > stop ? before - before * pass[i] : 0;
        const float after = before - share;
        left[keys[i]] = after;
        shares[i] = share;
        closed[count] = keys[i];
        count += (before > stop) & !(after > stop);
    }
    march->closed += count;
    for (int i = 0; i < count; i++)
        for (int set = 0; set < SETS; set++) {
            struct lanes_rays *on = &march->on[set];
            on->end = lanes_pick(lanes_int_same(on->key, (lanes_int){0} + closed[i]), lanes_all(-1),
                                 on->end);
        }
}

/* LANES voxels hide and shine. */
static inline __attribute__((always_inline)) void met_take(struct lanes_march *march, int first,
                                                           const bool shaded, const bool by_mean)
{
    const struct march_job *job = march->job;
    const struct lanes_met *met = &march->met;
    const struct lanes_voxels voxels = voxels_at(job, lanes_int_load(met->voxels + first), by_mean);
    const float depth_per = job->speed * (1 - job->thinned);
    float pass[LANES], shares[LANES];
    lanes_store(pass, lanes_fade(voxels_depth(job, &voxels, by_mean) *
                                 lanes_load(met->lengths_m + first) * depth_per));
    rays_hide(march, met->keys + first, pass, shares);
    lanes place[3], rgb[3];
    if (shaded) {
        rays_of_keys(march, lanes_int_load(met->keys + first), place);
        for (int i = 0; i < 3; i++)
            place[i] = job->eye[i] + lanes_load(met->middles_m + first) * place[i];
    }
    voxels_shine(job, &voxels, by_mean, shaded ? place : NULL, rgb);
    lanes share = lanes_load(shares);
    for (int c = 0; c < 3; c++)
        rgb[c] = share * (job->fog[c] + job->clear * rgb[c]);
    lanes_scatter(march->rays->rgb, met->keys + first, rgb);
}

/* Functions of their own: inlined, they have their constants loaded for each step, used or not. */
static __attribute__((noinline)) void take_moments(struct lanes_march *march, int first)
{
    met_take(march, first, false, false);
}
static __attribute__((noinline)) void take_moments_shaded(struct lanes_march *march, int first)
{
    met_take(march, first, true, false);
}
static __attribute__((noinline)) void take_mean(struct lanes_march *march, int first)
{
    met_take(march, first, false, true);
}
static __attribute__((noinline)) void take_mean_shaded(struct lanes_march *march, int first)
{
    met_take(march, first, true, true);
}

/* To the arrays' begin. */
static inline void met_move(struct lanes_met *met)
{
    lanes_int_store(met->keys, lanes_int_load(met->keys + met->first));
    lanes_int_store(met->voxels, lanes_int_load(met->voxels + met->first));
    lanes_store(met->lengths_m, lanes_load(met->lengths_m + met->first));
    lanes_store(met->middles_m, lanes_load(met->middles_m + met->first));
    met->last -= met->first;
    met->first = 0;
}

/* The rest, filled up with what hides nothing. */
static inline void met_fill(struct lanes_met *met)
{
    lanes_int_store(met->keys + met->last, (lanes_int){0} + met->keys[met->first]);
    lanes_int_store(met->voxels + met->last, (lanes_int){0} + met->voxels[met->first]);
    lanes_store(met->lengths_m + met->last, lanes_all(0));
    lanes_store(met->middles_m + met->last, lanes_all(met->middles_m[met->first]));
}

/* Along no ray of the rectangle a voxel's side is shorter: slopes are greatest at its corners. */
static inline float leap_of(const struct march_job *job, const struct march_rect *rect)
{
    float steepest = 1e-10f;
    for (int corner = 0; corner < 4; corner++) {
        float column = (float)(corner & 1 ? rect->high[0] : rect->low[0]);
        float row = (float)(corner & 2 ? rect->high[1] : rect->low[1]);
        for (int i = 0; i < 3; i++) {
            float slope = job->first[i] + row * job->down[i] + column * job->right[i];
            slope = slope < 0 ? -slope : slope;
            steepest = slope > steepest ? slope : steepest;
        }
    }
    return 1 / steepest;
}

/* All sets of lanes take a step by turns, so that one computes while another waits for its voxels.
 * shaded: the sun has shadows. */
static inline __attribute__((always_inline)) int march_rays_of(const struct march_job *job,
                                                               const struct march_rect *rect,
                                                               struct march_rays *rays,
                                                               const bool shaded)
{
    enum { FEW = LANES - LANES / 4 };
    struct lanes_march march;
    march.job = job;
    march.rect = rect;
    march.rays = rays;
    for (int i = 0; i < 3; i++) {
        march.eye[i] = lanes_all(job->eye[i]);
        march.most[i] = lanes_all((float)job->size[i] - 0.5f);
    }
    for (int i = 0; i < 2; i++)
        march.size[i] = (lanes_int){0} + job->size[i];
    march.step_m = lanes_all(job->step / job->speed);
    march.leap_m = lanes_all(leap_of(job, rect));
    march.row_per_key = 1.0f / (float)rays->stride;
    march.closed = 0;
    if (job->by_mean)
        march.take = shaded ? take_mean_shaded : take_mean;
    else
        march.take = shaded ? take_moments_shaded : take_moments;
    march.fresh.first = march.fresh.last = LANES;
    march.fresh.column = rect->low[0];
    march.fresh.row = rect->low[1];
    march.met.first = march.met.last = 0;
    uint64_t lookups = 0;
    for (int set = 0; set < SETS; set++) {
        march.on[set].at = march.on[set].end = lanes_all(0);
        march.on[set].key = (lanes_int){0};
        rays_refill(&march, &march.on[set]);
    }
    bool any;
    do {
        any = false;
        for (int set = 0; set < SETS; set++) {
            struct lanes_rays *on = &march.on[set];
            lanes_mask alive = lanes_less(on->at, on->end);
            if (lanes_count(alive) <= FEW && fresh_any(&march)) {
                rays_refill(&march, on);
                alive = lanes_less(on->at, on->end);
            }
            if (!lanes_any(alive))
                continue;
            lookups += (unsigned)lanes_count(alive);
            lookups += (shaded ? 5u : 2u) * (unsigned)rays_step(&march, on, alive, shaded);
            any = true;
        }
        for (; march.met.last - march.met.first >= LANES; march.met.first += LANES)
            march.take(&march, march.met.first);
        if (march.met.last > MET_MAX - SETS * LANES)
            met_move(&march.met);
    } while (any);
    if (march.met.first < march.met.last) {
        met_fill(&march.met);
        march.take(&march, march.met.first);
    }
    rays->lookups += lookups;
    return march.closed;
}

static inline int march_all(const struct march_job *job, const struct march_rect *rect,
                            struct march_rays *rays)
{
    return job->light.passes ? march_rays_of(job, rect, rays, true)
                             : march_rays_of(job, rect, rays, false);
}

#endif
