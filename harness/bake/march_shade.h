/* What voxels hide and shine in the ray march's kernels, over lanes (march_lanes_*.h, included
 * before). */
#ifndef TREELINE_BAKE_MARCH_SHADE_H
#define TREELINE_BAKE_MARCH_SHADE_H

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
    lanes value = lanes_fma(part, lanes_all(0.0096760370f), lanes_all(0.055922036f));
    value = lanes_fma(part, value, lanes_all(0.24022107f));
    value = lanes_fma(part, value, lanes_all(0.69312103f));
    value = lanes_fma(part, value, lanes_all(1));
    lanes_int scale = (lanes_truncate(whole) + 127) << 23;
    lanes factor;
    memcpy(&factor, &scale, sizeof factor);
    return value * factor;
}

static inline lanes form_value(const struct march_form *form, const lanes entries[5])
{
    lanes value = lanes_all(form->factors[0]);
    for (int i = 0; i < 5; i++)
        value = lanes_fma(entries[i], lanes_all(form->factors[i + 1]), value);
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
    lanes value = lanes_fma(x2, lanes_all(0.066520270f), lanes_all(-0.0092389264f));
    value = lanes_fma(x2, value, lanes_all(0.51276042f));
    return lanes_fma(x2, value, lanes_all(0.99953635f));
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

/* Optical depth of voxels' sides along the ray. words: of struct voxel. */
static inline lanes voxels_depth(const struct march_job *job, const lanes_int words[4],
                                 const bool by_mean)
{
    lanes extinction, entries[5];
    memcpy(&extinction, &words[0], sizeof extinction);
    if (by_mean) {
        const struct lanes_mean mean = mean_of(job, words[2]);
        return extinction * lanes_sqrt(mean.shown / (mean.square + 2 * mean.side));
    }
    matrix_entries(words[1], entries);
    return extinction * lanes_sqrt(lanes_max(form_value(&job->hidden, entries), lanes_all(0)));
}

/* What voxels' normals give of what is seen: the mean |N.L|, and the mean N.L for N toward the
 * eye; both divided by the voxel's evenness. */
struct lanes_facing {
    lanes even, toward;
    lanes upright; /* of a stretched tree, the mean square of the normals' y in the plant */
};

/* The closures of voxels.h. */
static inline struct lanes_facing facing_by_moments(const struct march_job *job, lanes_int normals,
                                                    lanes_int color)
{
    struct lanes_facing facing;
    lanes entries[5];
    matrix_entries(normals, entries);
    lanes seen = lanes_max(form_value(&job->seen, entries), lanes_all(lanes_least));
    lanes lit = lanes_max(form_value(&job->lit, entries), lanes_all(lanes_least));
    lanes evenness = lanes_fma(lanes_of(color >> 24 & 15), lanes_all(1.0f / 60), lanes_all(0.75f));
    /* one quotient in place of three: by both roots, and by evenness */
    lanes root = lanes_sqrt(lit), roots = root * lanes_sqrt(seen), per = 1 / (roots * evenness);
    lanes cosine = form_value(&job->both, entries) * (per * evenness);
    lanes scale = root * (per * roots);
    facing.toward = cosine * scale;
    facing.even = 0.63661977f * scale * arc_value(lanes_min(cosine * cosine, lanes_all(1)));
    facing.upright = job->raise != 0 ? form_value(&job->upright, entries) : lanes_all(0);
    return facing;
}

/* Those of voxels_visible.h. */
static inline struct lanes_facing facing_by_mean(const struct march_job *job, lanes_int normals)
{
    const float *sun = job->toward_sun;
    const struct lanes_mean mean = mean_of(job, normals);
    struct lanes_facing facing;
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
static inline lanes pair_value(const uint8_t *bytes, lanes_int at, lanes share)
{
    lanes_int pair = lanes_gather_pair(bytes, at);
    lanes first = lanes_of(pair & 255);
    return first + share * (lanes_of(pair >> 8 & 255) - first);
}

/* Share of the sun's light at places in the level's voxels. bark: its share of what is there. */
static inline lanes sun_share(const struct march_sun *light, const lanes place[3], lanes bark)
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
    lanes pass = pair_value(light->passes, column, cells[2] - lanes_of(whole[2]));
    lanes_int low = corner[1] * light->side + corner[0];
    lanes below = pair_value(light->gains, low, share[0]);
    lanes above = pair_value(light->gains, low + light->side, share[0]);
    return pass * (below + share[1] * (above - below)) * (1.0f / (255 * 255));
}

/* Radiance toward the eye, without fog. place: in the level's voxels, where the sun has shadows;
 * else NULL. */
static inline __attribute__((always_inline)) void voxels_shine(const struct march_job *job,
                                                               lanes_int normals, lanes_int color,
                                                               const bool by_mean,
                                                               const lanes *place, lanes rgb[3])
{
    const struct lanes_facing facing =
        by_mean ? facing_by_mean(job, normals) : facing_by_moments(job, normals, color);
    lanes bark = lanes_of(color >> 28 & 15) * (1.0f / 15);
    lanes one_sided = lanes_max(bark, lanes_all(job->one_sided));
    lanes diffuse = lanes_max(lanes_fma(0.5f * one_sided, facing.toward - facing.even, facing.even),
                              lanes_all(0));
    if (job->raise != 0)
        diffuse /= lanes_sqrt(lanes_max(1 + job->raise * facing.upright, lanes_all(lanes_least)));
    if (place)
        diffuse *= sun_share(&job->light, place, bark);
    for (int c = 0; c < 3; c++)
        rgb[c] = lanes_of(color >> (8 * c) & 255) *
                 lanes_fma(diffuse, lanes_all(job->sun[c]), lanes_all(job->shade[c]));
}

#endif
