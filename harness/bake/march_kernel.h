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

struct lanes_sample {
    lanes depth;  /* optical, of a voxel's side */
    lanes rgb[3]; /* radiance toward the eye */
};

/* What voxels' normals give: how much hides, and of what is seen the mean |N.L|, and the mean N.L
 * for N toward the eye. */
struct lanes_facing {
    lanes depth, even, toward;
    lanes upright; /* of a stretched tree, the mean square of the normals' y in the plant */
};

static const float lanes_least = 1e-4f;

/* The closures of voxels.h. */
static inline struct lanes_facing facing_by_moments(const struct march_job *job,
                                                    const lanes_int words[3])
{
    struct lanes_facing facing;
    lanes entries[5], extinction;
    memcpy(&extinction, &words[0], sizeof extinction);
    matrix_entries(words[1], entries);
    facing.depth =
        extinction * lanes_sqrt(lanes_max(form_value(&job->hidden, entries), lanes_all(0)));
    matrix_entries(words[2], entries);
    lanes seen = lanes_max(form_value(&job->seen, entries), lanes_all(lanes_least));
    lanes lit = lanes_max(form_value(&job->lit, entries), lanes_all(lanes_least));
    facing.toward = form_value(&job->both, entries) / lanes_sqrt(seen);
    facing.even = 0.63661977f * lanes_sqrt(lit) *
                  arc_value(lanes_min(facing.toward * facing.toward / lit, lanes_all(1)));
    facing.upright = job->raise != 0 ? form_value(&job->upright, entries) : lanes_all(0);
    return facing;
}

static inline lanes terms_value(const float terms[VISIBLE_TERMS], lanes x)
{
    lanes value = x * terms[VISIBLE_TERMS - 1];
    for (int k = VISIBLE_TERMS - 1; k-- > 0;)
        value = x * (terms[k] + value);
    return value;
}

/* Those of voxels_visible.h: words[1] is not read. */
static inline struct lanes_facing facing_by_mean(const struct march_job *job,
                                                 const lanes_int words[3])
{
    const float *eye = job->toward_eye, *sun = job->toward_sun;
    struct lanes_facing facing;
    lanes extinction, n[3], square, to_eye, to_sun;
    memcpy(&extinction, &words[0], sizeof extinction);
    for (int i = 0; i < 3; i++)
        n[i] = lanes_of(words[2] >> (10 * i) & 1023) * (1.0f / VISIBLE_ZERO) - 1;
    square = n[0] * n[0] + n[1] * n[1] + n[2] * n[2];
    to_eye = n[0] * eye[0] + n[1] * eye[1] + n[2] * eye[2];
    to_sun = n[0] * sun[0] + n[1] * sun[1] + n[2] * sun[2];
    lanes rest = 1 - lanes_sqrt(square), per = 1 / square;
    lanes side = terms_value(visible_side, rest), across = terms_value(visible_across, rest);
    lanes least = lanes_all(lanes_least), along = (1 - 3 * across) * per;
    lanes shown = lanes_max(side + (square - side) * per * to_eye * to_eye, least);
    facing.depth = extinction * lanes_sqrt(shown / (square + 2 * side));
    lanes seen = lanes_max(across + along * to_eye * to_eye, least);
    lanes lit = lanes_max(across * job->sun_square + along * to_sun * to_sun, least);
    lanes both = across * job->cosine + along * to_eye * to_sun, product = seen * lit;
    facing.toward = both / lanes_sqrt(shown);
    facing.even = 0.63661977f * lanes_sqrt(product / shown) *
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

/* place: in the level's voxels; shaded: the sun has shadows. */
static inline struct lanes_sample sample_voxels(const struct march_job *job, lanes_int at,
                                                const lanes place[3], lanes_mask mask,
                                                const bool shaded)
{
    struct lanes_sample sample;
    struct lanes_facing facing;
    lanes_int words[4];
    lanes_gather_four(job->voxels, at, mask, words);
    lanes_int color = words[3];
    lanes evenness = lanes_all(1);
    if (job->by_mean) {
        facing = facing_by_mean(job, words);
    } else {
        facing = facing_by_moments(job, words);
        evenness = 0.75f + lanes_of(color >> 24 & 15) * (1.0f / 60);
    }
    sample.depth = facing.depth;
    lanes bark = lanes_of(color >> 28 & 15) * (1.0f / 15);
    lanes one_sided = lanes_max(bark, lanes_all(job->one_sided));
    lanes diffuse = lanes_max(
        (facing.even + 0.5f * one_sided * (facing.toward - facing.even)) / evenness, lanes_all(0));
    if (job->raise != 0)
        diffuse /= lanes_sqrt(lanes_max(1 + job->raise * facing.upright, lanes_all(lanes_least)));
    if (shaded)
        diffuse *= sun_share(&job->light, place, bark, mask);
    for (int c = 0; c < 3; c++)
        sample.rgb[c] = lanes_of(color >> (8 * c) & 255) * (job->shade[c] + job->sun[c] * diffuse);
    return sample;
}

/* Where rays enter and leave the level's box. */
static inline void box_cut(const struct march_job *job, const lanes ray[3], lanes *from, lanes *to)
{
    for (int i = 0; i < 3; i++) {
        lanes slow =
            lanes_pick(lanes_less(ray[i] * ray[i], lanes_all(1e-20f)), lanes_all(1e-10f), ray[i]);
        lanes low = -job->eye[i] / slow, high = ((float)job->size[i] - job->eye[i]) / slow;
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

/* True when something may still be seen through one of the rays. shaded: the sun has shadows. */
static inline __attribute__((always_inline)) bool
march_lanes(const struct march_job *job, struct march_rays *rays, int first, const bool shaded)
{
    static const float columns[MARCH_RAYS] = {0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3};
    static const float rows[MARCH_RAYS] = {0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3};
    lanes stop = lanes_all(job->stop), left = lanes_load(rays->left + first);
    lanes_mask open = lanes_less(stop, left);
    if (!lanes_any(open))
        return false;
    lanes ray[3], column = lanes_load(columns + first), row = lanes_load(rows + first);
    lanes steepest = lanes_all(1e-10f);
    for (int i = 0; i < 3; i++) {
        ray[i] = job->first[i] + column * job->right[i] + row * job->down[i];
        steepest = lanes_max(steepest, lanes_max(ray[i], -ray[i]));
    }
    lanes at = lanes_all(job->near_m), end = lanes_load(rays->depths_m + first);
    end = lanes_min(end, lanes_all(job->far_m));
    box_cut(job, ray, &at, &end);
    lanes_mask alive = lanes_both(lanes_less(at, end), open);
    if (!lanes_any(alive))
        return true;
    lanes leap = 1 / steepest, step = lanes_all(job->step / job->speed);
    lanes rgb[3];
    for (int c = 0; c < 3; c++)
        rgb[c] = lanes_load(rays->rgb[c] + first);
    const float depth_per = job->speed * (1 - job->thinned);
    int lookups = 0;
    do {
        lanes length = lanes_min(step, end - at), middle = at + 0.5f * length;
        lanes_int cell = cells_at(job, ray, middle, alive);
        lanes_int behind = cell - VOXELS_FIRST;
        lanes_mask full = lanes_both(lanes_int_less((lanes_int){0} - 1, behind), alive);
        lookups += lanes_count(alive) + (shaded ? 5 : 2) * lanes_count(full);
        if (lanes_any(full)) {
            const lanes place[3] = {job->eye[0] + middle * ray[0], job->eye[1] + middle * ray[1],
                                    job->eye[2] + middle * ray[2]};
            struct lanes_sample sample = sample_voxels(job, behind << 2, place, full, shaded);
            lanes pass = lanes_fade(sample.depth * length * depth_per);
            lanes share = lanes_pick(full, left - left * pass, lanes_all(0));
            left -= share;
            for (int c = 0; c < 3; c++)
                rgb[c] += share * (job->fog[c] + job->clear * sample.rgb[c]);
        }
        lanes far = middle + lanes_of(cell - 1) * leap;
        at = lanes_pick(full, at + step, lanes_max(at + step, far));
        alive = lanes_both(lanes_both(lanes_less(at, end), lanes_less(stop, left)), alive);
    } while (lanes_any(alive));
    rays->lookups += (uint64_t)lookups;
    lanes_store(rays->left + first, left);
    for (int c = 0; c < 3; c++)
        lanes_store(rays->rgb[c] + first, rgb[c]);
    return lanes_any(lanes_less(stop, left));
}

static inline bool march_all(const struct march_job *job, struct march_rays *rays)
{
    bool open = false;
    if (job->light.passes) {
        for (int first = 0; first < MARCH_RAYS; first += LANES)
            open |= march_lanes(job, rays, first, true);
        return open;
    }
    for (int first = 0; first < MARCH_RAYS; first += LANES)
        open |= march_lanes(job, rays, first, false);
    return open;
}

#endif
