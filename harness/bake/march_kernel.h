/* The ray march's kernel, written once over lanes (march_lanes_*.h, included before); every kernel
 * does the same operations in the same order on each ray, so all give the same bits. */
#ifndef TREELINE_BAKE_MARCH_KERNEL_H
#define TREELINE_BAKE_MARCH_KERNEL_H

#include "bake/march_parts.h"
#include "bake/voxels_visible.h"

#include <string.h>

static inline lanes lanes_load(const float *from)
{
    lanes loaded;
    memcpy(&loaded, from, sizeof loaded);
    return loaded;
}

static inline void lanes_store(float *to, lanes value)
{
    memcpy(to, &value, sizeof value);
}

static inline lanes lanes_all(float value)
{
    return value - (lanes){0};
}

static inline lanes lanes_clamp(lanes value, float low, float high)
{
    return lanes_min(lanes_max(value, lanes_all(low)), lanes_all(high));
}

/* exp(-x), x >= 0; relative error 4e-6. Splits x log2(e) into a whole number and at most a half. */
static inline lanes lanes_fade(lanes x)
{
    const float round = 12582912; /* 1.5 x 2^23 */
    lanes power = lanes_max(-1.44269504f * x, lanes_all(-126));
    lanes whole = (power + round) - round, part = power - whole;
    lanes value = 1 + part * (0.69312103f +
                              part * (0.24022107f + part * (0.055922036f + part * 0.0096760370f)));
    lanes_int scale = (lanes_truncate(whole) + 127) << 23;
    lanes factor;
    memcpy(&factor, &scale, sizeof factor);
    return value * factor;
}

static inline lanes form_value(const struct march_form *form, const lanes entries[5])
{
    lanes value = form->factors[0] + entries[0] * form->factors[1];
    for (int i = 1; i < 5; i++)
        value += entries[i] * form->factors[i + 1];
    return value;
}

static inline void matrix_entries(lanes_int bits, lanes entries[5])
{
    for (int i = 0; i < 5; i++)
        entries[i] = lanes_of(bits >> (6 * i) & 63);
}

/* sqrt(1 - x x) + x asin(x) of x squared, 0..1; absolute error 1.2e-3. */
static inline lanes arc_value(lanes x2)
{
    return 0.99953635f + x2 * (0.51276042f + x2 * (-0.0092389264f + x2 * 0.066520270f));
}

static const float lanes_least = 1e-4f;

static inline lanes terms_value(const float terms[VISIBLE_TERMS], lanes x)
{
    lanes value = x * terms[VISIBLE_TERMS - 1];
    for (int k = VISIBLE_TERMS - 1; k-- > 0;)
        value = x * (terms[k] + value);
    return value;
}

/* How much of the normals' mean lies along and across it (voxels_visible.h). */
struct lanes_mean {
    lanes n[3], square, side, to_eye, shown;
};

static inline struct lanes_mean mean_of(const struct march_job *job, lanes_int normals)
{
    const float *eye = job->toward_eye;
    struct lanes_mean mean;
    for (int i = 0; i < 3; i++)
        mean.n[i] = lanes_of(normals >> (10 * i) & 1023) * (1.0f / VISIBLE_ZERO) - 1;
    const lanes *n = mean.n;
    mean.square = n[0] * n[0] + n[1] * n[1] + n[2] * n[2];
    mean.to_eye = n[0] * eye[0] + n[1] * eye[1] + n[2] * eye[2];
    mean.side = terms_value(visible_side, 1 - lanes_sqrt(mean.square));
    lanes along = (mean.square - mean.side) * (1 / mean.square);
    mean.shown = lanes_max(mean.side + along * mean.to_eye * mean.to_eye, lanes_all(lanes_least));
    return mean;
}

/* Optical depth of a voxel's side along the ray. */
static inline lanes voxels_depth(const struct march_job *job, lanes_int at, lanes_mask mask)
{
    lanes_int words[4];
    lanes extinction, entries[5];
    if (job->by_mean) {
        lanes_gather_four(job->voxels, at, mask, words);
        struct lanes_mean mean = mean_of(job, words[2]);
        memcpy(&extinction, &words[0], sizeof extinction);
        return extinction * lanes_sqrt(mean.shown / (mean.square + 2 * mean.side));
    }
    lanes_gather_two(job->voxels, at, mask, words);
    memcpy(&extinction, &words[0], sizeof extinction);
    matrix_entries(words[1], entries);
    return extinction * lanes_sqrt(lanes_max(form_value(&job->hidden, entries), lanes_all(0)));
}

/* What voxels' normals give of what is seen: the mean |N.L|, and the mean N.L for N toward the
 * eye. */
struct lanes_facing {
    lanes even, toward;
    lanes upright; /* of a stretched tree, the mean square of the normals' y in the plant */
};

/* The closures of voxels.h. */
static inline struct lanes_facing facing_by_moments(const struct march_job *job, lanes_int normals)
{
    struct lanes_facing facing;
    lanes entries[5];
    matrix_entries(normals, entries);
    lanes seen = lanes_max(form_value(&job->seen, entries), lanes_all(lanes_least));
    lanes lit = lanes_max(form_value(&job->lit, entries), lanes_all(lanes_least));
    facing.toward = form_value(&job->both, entries) / lanes_sqrt(seen);
    facing.even = 0.63661977f * lanes_sqrt(lit) *
                  arc_value(lanes_min(facing.toward * facing.toward / lit, lanes_all(1)));
    facing.upright = job->raise != 0 ? form_value(&job->upright, entries) : lanes_all(0);
    return facing;
}

/* Those of voxels_visible.h. */
static inline struct lanes_facing facing_by_mean(const struct march_job *job, lanes_int normals)
{
    const float *sun = job->toward_sun;
    struct lanes_facing facing;
    const struct lanes_mean mean = mean_of(job, normals);
    const lanes *n = mean.n, least = lanes_all(lanes_least);
    lanes to_sun = n[0] * sun[0] + n[1] * sun[1] + n[2] * sun[2];
    lanes across = terms_value(visible_across, 1 - lanes_sqrt(mean.square));
    lanes along = (1 - 3 * across) * (1 / mean.square);
    lanes seen = lanes_max(across + along * mean.to_eye * mean.to_eye, least);
    lanes lit = lanes_max(across * job->sun_square + along * to_sun * to_sun, least);
    lanes both = across * job->cosine + along * mean.to_eye * to_sun, product = seen * lit;
    facing.toward = both / lanes_sqrt(mean.shown);
    facing.even = 0.63661977f * lanes_sqrt(product / mean.shown) *
                  arc_value(lanes_min(both * both / product, lanes_all(1)));
    facing.upright = across + along * n[1] * n[1];
    return facing;
}

/* Two neighbouring bytes, one after the other, mixed: 0..255. */
static inline lanes pair_value(const uint8_t *bytes, lanes_int at, lanes share, lanes_mask mask)
{
    lanes_int pair = lanes_gather_pair(bytes, at, mask);
    lanes first = lanes_of(pair & 255);
    return first + share * (lanes_of(pair >> 8 & 255) - first);
}

/* Share of the sun's light at places in the level's voxels. bark: its share of what is there. */
static inline lanes sun_share(const struct march_sun *light, const lanes place[3], lanes bark,
                              lanes_mask mask)
{
    lanes cells[3];
    lanes_int whole[3], corner[2];
    lanes share[2];
    for (int k = 0; k < 3; k++) {
        const float *to = light->to_cells[k];
        cells[k] = to[0] * place[0] + to[1] * place[1] + to[2] * place[2] + to[3];
        if (k == 2)
            cells[k] -= lanes_max(4 * bark - 3, lanes_all(0)) * light->bark_cells;
        cells[k] = lanes_clamp(cells[k], 0, (float)light->size[k] - (k == 2 ? 1.001f : 0.001f));
        whole[k] = lanes_truncate(cells[k]);
    }
    for (int k = 0; k < 2; k++) {
        lanes at = lanes_min(cells[k] * light->to_gains[k], lanes_all((float)light->side - 1.001f));
        corner[k] = lanes_truncate(at);
        share[k] = at - lanes_of(corner[k]);
    }
    lanes_int column = (whole[1] * light->size[0] + whole[0]) * light->size[2] + whole[2];
    lanes pass = pair_value(light->passes, column, cells[2] - lanes_of(whole[2]), mask);
    lanes_int low = corner[1] * light->side + corner[0];
    lanes below = pair_value(light->gains, low, share[0], mask);
    lanes above = pair_value(light->gains, low + light->side, share[0], mask);
    return pass * (below + share[1] * (above - below)) * (1.0f / (255 * 255));
}

/* Samples that hide some of what is seen through a ray, whose colours wait until there are enough
 * of them to fill all lanes: rays end at different steps, and most steps meet voxels in a few. */
enum { QUEUE_MAX = 8 * MARCH_RAYS };
struct lanes_queue {
    int count;
    int32_t keys[QUEUE_MAX + MARCH_RAYS]; /* voxel x MARCH_RAYS + ray */
    float shares[QUEUE_MAX + MARCH_RAYS]; /* of what the ray sees */
    float middles_m[QUEUE_MAX + MARCH_RAYS];
};

/* The colours of LANES samples, added to their rays' in the samples' order. */
static inline __attribute__((always_inline)) void shade(const struct march_job *job,
                                                        struct march_rays *rays,
                                                        const struct lanes_queue *queue, int first,
                                                        const bool shaded)
{
    lanes_int keys, words[2], all = (lanes_int){0};
    memcpy(&keys, queue->keys + first, sizeof keys);
    lanes share = lanes_load(queue->shares + first);
    lanes_mask mask = lanes_int_less(all - 1, keys);
    lanes_gather_two(job->voxels + 2, (keys >> 4) << 2, mask, words);
    lanes_int color = words[1];
    lanes evenness = lanes_all(1);
    struct lanes_facing facing;
    if (job->by_mean) {
        facing = facing_by_mean(job, words[0]);
    } else {
        facing = facing_by_moments(job, words[0]);
        evenness = 0.75f + lanes_of(color >> 24 & 15) * (1.0f / 60);
    }
    lanes bark = lanes_of(color >> 28 & 15) * (1.0f / 15);
    lanes one_sided = lanes_max(bark, lanes_all(job->one_sided));
    lanes diffuse = lanes_max(
        (facing.even + 0.5f * one_sided * (facing.toward - facing.even)) / evenness, lanes_all(0));
    if (job->raise != 0)
        diffuse /= lanes_sqrt(lanes_max(1 + job->raise * facing.upright, lanes_all(lanes_least)));
    if (shaded) {
        lanes column = lanes_of(keys & 3), row = lanes_of(keys >> 2 & 3), place[3];
        lanes middle = lanes_load(queue->middles_m + first);
        for (int i = 0; i < 3; i++)
            place[i] = job->eye[i] +
                       middle * (job->first[i] + column * job->right[i] + row * job->down[i]);
        diffuse *= sun_share(&job->light, place, bark, mask);
    }
    lanes rgb[3];
    for (int c = 0; c < 3; c++) {
        lanes own = lanes_of(color >> (8 * c) & 255) * (job->shade[c] + job->sun[c] * diffuse);
        rgb[c] = share * (job->fog[c] + job->clear * own);
    }
    lanes_scatter(rays->rgb, queue->keys + first, rgb);
}

/* All whole sets of lanes; the rest stays. */
static inline void queue_shade(const struct march_job *job, struct march_rays *rays,
                               struct lanes_queue *queue, const bool shaded)
{
    int at = 0;
    for (; at + LANES <= queue->count; at += LANES)
        shade(job, rays, queue, at, shaded);
    queue->count -= at;
    memcpy(queue->keys, queue->keys + at, LANES * sizeof *queue->keys);
    memcpy(queue->shares, queue->shares + at, LANES * sizeof *queue->shares);
    memcpy(queue->middles_m, queue->middles_m + at, LANES * sizeof *queue->middles_m);
}

/* The rest, too: filled up with what hides nothing. */
static inline void queue_end(const struct march_job *job, struct march_rays *rays,
                             struct lanes_queue *queue, const bool shaded)
{
    for (int i = 0; i < LANES; i++) {
        queue->keys[queue->count + i] = 0;
        queue->shares[queue->count + i] = queue->middles_m[queue->count + i] = 0;
    }
    for (int at = 0; at < queue->count; at += LANES)
        shade(job, rays, queue, at, shaded);
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

static inline lanes_int cells_at(const struct march_job *job, const lanes ray[3], lanes middle,
                                 lanes_mask alive)
{
    lanes_int at[3];
    for (int i = 0; i < 3; i++)
        at[i] = lanes_truncate(
            lanes_clamp(job->eye[i] + middle * ray[i], 0, (float)job->size[i] - 0.5f));
    lanes_int index = (at[2] * job->size[1] + at[1]) * job->size[0] + at[0];
    return lanes_gather(job->cells, index, alive);
}

/* LANES rays under way. */
struct lanes_rays {
    lanes ray[3], at, end, left, leap;
    lanes_int key; /* numbers of the rays */
    lanes_mask alive;
};

/* False where nothing can be seen through any of them. */
static inline bool rays_begin(const struct march_job *job, const struct march_rays *rays, int first,
                              struct lanes_rays *on)
{
    static const float columns[MARCH_RAYS] = {0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3};
    static const float rows[MARCH_RAYS] = {0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3};
    on->left = lanes_load(rays->left + first);
    lanes_mask open = lanes_less(lanes_all(job->stop), on->left);
    lanes column = lanes_load(columns + first), row = lanes_load(rows + first);
    lanes steepest = lanes_all(1e-10f);
    on->key = lanes_truncate(column + 4 * row);
    for (int i = 0; i < 3; i++) {
        on->ray[i] = job->first[i] + column * job->right[i] + row * job->down[i];
        steepest = lanes_max(steepest, lanes_max(on->ray[i], -on->ray[i]));
    }
    on->at = lanes_all(job->near_m);
    on->end = lanes_min(lanes_load(rays->depths_m + first), lanes_all(job->far_m));
    box_cut(job, on->ray, &on->at, &on->end);
    on->leap = 1 / steepest;
    on->alive = lanes_both(lanes_less(on->at, on->end), open);
    return lanes_any(open);
}

/* One voxel, or a jump over empty ones. Returns its lookups. */
static inline __attribute__((always_inline)) int rays_step(const struct march_job *job,
                                                           struct lanes_rays *on,
                                                           struct lanes_queue *queue,
                                                           float depth_per, const bool shaded)
{
    const lanes step = lanes_all(job->step / job->speed);
    lanes length = lanes_min(step, on->end - on->at), middle = on->at + 0.5f * length;
    lanes_int cell = cells_at(job, on->ray, middle, on->alive);
    lanes_int behind = cell - VOXELS_FIRST;
    lanes_mask full = lanes_both(lanes_int_less((lanes_int){0} - 1, behind), on->alive);
    const int samples = lanes_count(full), lookups = lanes_count(on->alive);
    if (samples) {
        lanes pass = lanes_fade(voxels_depth(job, behind << 2, full) * length * depth_per);
        lanes share = lanes_pick(full, on->left - on->left * pass, lanes_all(0));
        on->left -= share;
        lanes_pack(queue->keys + queue->count, queue->shares + queue->count,
                   (behind << 4) + on->key, share, full);
        if (shaded)
            lanes_pack(queue->keys + queue->count, queue->middles_m + queue->count,
                       (behind << 4) + on->key, middle, full);
        queue->count += samples;
    }
    lanes far = middle + lanes_of(cell - 1) * on->leap;
    on->at = lanes_pick(full, on->at + step, lanes_max(on->at + step, far));
    on->alive = lanes_both(
        lanes_both(lanes_less(on->at, on->end), lanes_less(lanes_all(job->stop), on->left)),
        on->alive);
    return lookups + (shaded ? 5 : 2) * samples;
}

enum { SETS = MARCH_RAYS / LANES };

/* True when something may still be seen through one of the rays. All sets of lanes take a step by
 * turns, so that one computes while another waits for its voxels. shaded: the sun has shadows. */
static inline __attribute__((always_inline)) bool
march_block_rays(const struct march_job *job, struct march_rays *rays, const bool shaded)
{
    struct lanes_rays on[SETS];
    struct lanes_queue queue;
    bool open = false, alive = false;
    const float depth_per = job->speed * (1 - job->thinned);
    int lookups = 0;
    for (int set = 0; set < SETS; set++) {
        open |= rays_begin(job, rays, set * LANES, &on[set]);
        alive |= lanes_any(on[set].alive);
    }
    if (!alive)
        return open;
    queue.count = 0;
    do {
        alive = false;
        for (int set = 0; set < SETS; set++) {
            if (!lanes_any(on[set].alive))
                continue;
            lookups += rays_step(job, &on[set], &queue, depth_per, shaded);
            alive |= lanes_any(on[set].alive);
        }
        if (queue.count > QUEUE_MAX - MARCH_RAYS)
            queue_shade(job, rays, &queue, shaded);
    } while (alive);
    queue_end(job, rays, &queue, shaded);
    rays->lookups += (uint64_t)lookups;
    open = false;
    for (int set = 0; set < SETS; set++) {
        lanes_store(rays->left + set * LANES, on[set].left);
        open |= lanes_any(lanes_less(lanes_all(job->stop), on[set].left));
    }
    return open;
}

static inline bool march_all(const struct march_job *job, struct march_rays *rays)
{
    return job->light.passes ? march_block_rays(job, rays, true)
                             : march_block_rays(job, rays, false);
}

#endif
