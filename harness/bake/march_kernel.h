/* The ray march's kernel, written once over lanes (march_lanes_*.h, included before); every kernel
 * does the same operations in the same order on each ray, so all give the same bits.
 *
 * Rays that meet the tree's box are taken from a queue as lanes get free, so that lanes stay busy
 * though rays end at different steps. Steps only find voxels; these wait in a second queue until
 * there are many, and only then it is known how much they hide. A ray may so go on for a few steps
 * behind what closes it: what it finds there hides nothing. */
#ifndef TREELINE_BAKE_MARCH_KERNEL_H
#define TREELINE_BAKE_MARCH_KERNEL_H

#include "bake/march_fresh.h"

static inline lanes_int cells_at(const struct lanes_march *march, const lanes ray[3], lanes middle,
                                 lanes_mask alive)
{
    lanes_int at[3];
    for (int i = 0; i < 3; i++) {
        lanes place = lanes_fma(middle, ray[i], march->eye[i]);
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
    lanes length = lanes_min(on->stride, on->end - on->at),
          middle = lanes_fma(length, lanes_all(0.5f), on->at);
    lanes_int cell = cells_at(march, on->ray, middle, alive);
    lanes_mask full = lanes_int_less(cell, (lanes_int){0}); /* MARCH_FULL */
    lanes_order order = lanes_order_of(full);
    lanes_int_store(met->keys + last, lanes_int_squeeze(on->key, order));
    lanes_int_store(met->places + last, lanes_int_squeeze(cell << 2, order));
    lanes_store(met->lengths_m + last, lanes_squeeze(length, order));
    if (shaded)
        lanes_store(met->middles_m + last, lanes_squeeze(middle, order));
    const int count = lanes_count(full);
    met->last = last + count;
    lanes next = on->at + on->stride;
    lanes free = lanes_of(cell >> on->way & MARCH_WAY_MASK);
    lanes far = lanes_max(next, lanes_fma(free, march->leap_m, middle));
    on->at = lanes_pick(full, next, far);
    on->stride = lanes_pick(full, march->step_m, march->first_m);
    return count;
}

/* The rays of some keys are done. */
static inline void rays_close(struct lanes_march *march, const int32_t *keys, int count)
{
    march->closed += count;
    for (int i = 0; i < count; i++)
        for (int set = 0; set < SETS; set++) {
            struct lanes_rays *on = &march->on[set];
            on->end = lanes_pick(lanes_int_same(on->key, (lanes_int){0} + keys[i]), lanes_all(-1),
                                 on->end);
        }
}

/* What is seen before each of the voxels: one after the other, as a ray may have met some of them.
 */
static inline void many_hide(struct lanes_march *march, const int32_t *keys, int count,
                             struct lanes_many *many)
{
    const float stop = march->job->stop;
    float *left = march->rays->left;
    for (int i = 0; i < count; i++) {
        const float before = left[keys[i]];
        many->befores[i] = before;
        left[keys[i]] = before > stop ? before * many->pass[i] : before;
    }
}

/* The shares that voxels hide: none where nothing is seen any more. Rays that they close are done.
 */
static inline void many_share(struct lanes_march *march, const int32_t *keys, int sets,
                              struct lanes_many *many)
{
    const lanes stop = lanes_all(march->job->stop);
    int32_t closed[MANY + LANES];
    int count = 0;
    for (int set = 0, at = 0; set < sets; set++, at += LANES) {
        lanes before = lanes_load(many->befores + at);
        lanes after = before * lanes_load(many->pass + at);
        lanes_mask open = lanes_less(stop, before),
                   closes = lanes_but(open, lanes_less(stop, after));
        many->shares[set] = lanes_pick(open, before - after, lanes_all(0));
        lanes_int_store(closed + count,
                        lanes_int_squeeze(lanes_int_load(keys + at), lanes_order_of(closes)));
        count += lanes_count(closes);
    }
    rays_close(march, closed, count);
}

/* Voxels hide and shine, set by set of lanes. What one set computes does not wait for another,
 * so that the processor does several at a time. */
static inline __attribute__((always_inline)) void many_take(struct lanes_march *march, int sets,
                                                            const bool shaded, const bool by_mean)
{
    const struct march_job *job = march->job;
    const struct lanes_met *met = &march->met;
    const int32_t *keys = met->keys + met->first;
    const float depth_per = job->speed * (1 - job->thinned);
    struct lanes_many many;
    for (int set = 0, at = met->first; set < sets; set++, at += LANES) {
        lanes_int words[4];
        lanes_gather_four(job->voxels, met->places + at, words);
        many.normals[set] = words[2];
        many.colors[set] = words[3];
        lanes depth = voxels_depth(job, words, by_mean);
        lanes_store(many.pass + set * LANES,
                    lanes_fade(depth * lanes_load(met->lengths_m + at) * depth_per));
    }
    many_hide(march, keys, sets * LANES, &many);
    many_share(march, keys, sets, &many);
    for (int set = 0, at = 0; set < sets; set++, at += LANES) {
        lanes place[3], rgb[3];
        if (shaded) {
            rays_of_keys(march, lanes_int_load(keys + at), place);
            for (int i = 0; i < 3; i++)
                place[i] = job->eye[i] + lanes_load(met->middles_m + met->first + at) * place[i];
        }
        voxels_shine(job, many.normals[set], many.colors[set], by_mean, shaded ? place : NULL, rgb);
        for (int c = 0; c < 3; c++)
            rgb[c] =
                many.shares[set] * lanes_fma(rgb[c], lanes_all(job->clear), lanes_all(job->fog[c]));
        lanes_scatter(march->rays->rgb, keys + at, rgb);
    }
}

/* Functions of their own: inlined, they have their constants loaded for each step, used or not. */
static __attribute__((noinline)) void take_moments(struct lanes_march *march, int sets)
{
    many_take(march, sets, false, false);
}
static __attribute__((noinline)) void take_moments_shaded(struct lanes_march *march, int sets)
{
    many_take(march, sets, true, false);
}
static __attribute__((noinline)) void take_mean(struct lanes_march *march, int sets)
{
    many_take(march, sets, false, true);
}
static __attribute__((noinline)) void take_mean_shaded(struct lanes_march *march, int sets)
{
    many_take(march, sets, true, true);
}

/* To the arrays' begin. */
static inline void met_move(struct lanes_met *met)
{
    for (int at = 0; at < MANY; at += LANES) {
        lanes_int_store(met->keys + at, lanes_int_load(met->keys + met->first + at));
        lanes_int_store(met->places + at, lanes_int_load(met->places + met->first + at));
        lanes_store(met->lengths_m + at, lanes_load(met->lengths_m + met->first + at));
        lanes_store(met->middles_m + at, lanes_load(met->middles_m + met->first + at));
    }
    met->last -= met->first;
    met->first = 0;
}

/* The rest, filled up with what hides nothing. */
static inline void met_fill(struct lanes_met *met)
{
    lanes_int_store(met->keys + met->last, (lanes_int){0} + met->keys[met->first]);
    lanes_int_store(met->places + met->last, (lanes_int){0} + met->places[met->first]);
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
 * After some turns all get new rays: whether it is worth it for one set, which the processor would
 * have to guess, is not asked. shaded: the sun has shadows. */
static inline __attribute__((always_inline)) int march_rays_of(const struct march_job *job,
                                                               const struct march_rect *rect,
                                                               struct march_rays *rays,
                                                               const bool shaded)
{
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
    march.first_m = lanes_min(march.step_m, lanes_all(1 / job->speed));
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
        march.on[set].at = march.on[set].end = march.on[set].stride = lanes_all(0);
        march.on[set].key = (lanes_int){0};
        rays_refill(&march, &march.on[set]);
    }
    bool any;
    do {
        any = false;
        for (int set = 0; set < SETS && fresh_any(&march); set++)
            rays_refill(&march, &march.on[set]);
        for (int turn = 0; turn < TURNS * SETS; turn++) {
            struct lanes_rays *on = &march.on[turn % SETS];
            lanes_mask alive = lanes_less(on->at, on->end);
            if (!lanes_any(alive))
                continue;
            lookups += (unsigned)lanes_count(alive);
            lookups += (shaded ? 5u : 2u) * (unsigned)rays_step(&march, on, alive, shaded);
            any = true;
        }
        for (; march.met.last - march.met.first >= MANY; march.met.first += MANY)
            march.take(&march, MANY / LANES);
        if (march.met.last > MET_MAX - TURNS * SETS * LANES)
            met_move(&march.met);
    } while (any);
    if (march.met.first < march.met.last) {
        met_fill(&march.met);
        march.take(&march, (march.met.last - march.met.first + LANES - 1) / LANES);
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
