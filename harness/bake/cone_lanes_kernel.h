/* The shaders of twigs over lanes, after march_lanes_*.h: what needles_cone_sums, needles_disc_lit
 * and (2) of the axis give (bake/needles.h), at the same nodes. */
#ifndef TREELINE_BAKE_CONE_LANES_KERNEL_H
#define TREELINE_BAKE_CONE_LANES_KERNEL_H

#include "bake/cone_lanes.h"
#include "bake/cone_lanes_math.h"
#include "bake/needles.h"

#include <math.h>
#include <string.h>

/* Twigs around their axes turned so that the eye is at the azimuth 0. */
struct cone_lanes_sight {
    lanes sine, cosine; /* of phi */
    lanes eye[2];       /* across, along */
    lanes light[3];
    lanes cross[3];          /* light x eye */
    lanes half[3], half_dot; /* as in needles_sight */
    float exponent, lobe, lobe_k;
};

struct cone_lanes_shine {
    lanes seen, diffuse, specular;
};

static inline lanes lanes_load(const float *from)
{
    lanes to;
    memcpy(&to, from, sizeof to);
    return to;
}

static inline void lanes_store(lanes from, float *to)
{
    memcpy(to, &from, sizeof from);
}

static inline lanes lanes_clamp(lanes a)
{
    return lanes_max(lanes_min(a, lanes_even(1)), lanes_even(0));
}

static inline struct cone_lanes_sight cone_lanes_sight(const struct cone_lanes_job *job, int first)
{
    struct cone_lanes_sight sight = {.sine = lanes_load(job->sine + first),
                                     .cosine = lanes_load(job->cosine + first),
                                     .exponent = job->exponent};
    const lanes x = lanes_load(job->eye[0] + first), y = lanes_load(job->eye[1] + first);
    const lanes lx = lanes_load(job->light[0] + first), ly = lanes_load(job->light[1] + first);
    const lanes flat = lanes_sqrt(x * x + y * y), tiny = lanes_even(1e-20f);
    const lanes_mask turned = lanes_less(tiny, flat);
    const lanes ex = lanes_pick(turned, x / lanes_max(flat, tiny), lanes_even(1));
    const lanes ey = lanes_pick(turned, y / lanes_max(flat, tiny), lanes_even(0));
    const lanes *l = sight.light, *e = sight.eye;
    sight.eye[0] = flat;
    sight.eye[1] = lanes_load(job->eye[2] + first);
    sight.light[0] = lx * ex + ly * ey;
    sight.light[1] = ly * ex - lx * ey;
    sight.light[2] = lanes_load(job->light[2] + first);
    sight.cross[0] = l[1] * e[1];
    sight.cross[1] = l[2] * e[0] - l[0] * e[1];
    sight.cross[2] = -l[1] * e[0];
    sight.half[0] = l[0] + e[0];
    sight.half[1] = l[1];
    sight.half[2] = l[2] + e[1];
    const lanes *h = sight.half;
    const lanes square = h[0] * h[0] + h[1] * h[1] + h[2] * h[2];
    const lanes length = lanes_sqrt(lanes_max(square, lanes_even(1e-12f)));
    const lanes_mask known = lanes_less(lanes_even(1e-12f), square);
    for (int i = 0; i < 3; i++)
        sight.half[i] = lanes_pick(known, sight.half[i] / length, lanes_even(0));
    sight.half_dot = lanes_pick(known, 0.5f * length, lanes_even(0));
    sight.lobe_k = sqrtf((fmaxf(job->exponent, 0) + 1.5f) / 2);
    sight.lobe = 1.25331414f / (sqrtf(fmaxf(job->exponent, 0) + 1.5f) * erff(sight.lobe_k));
    return sight;
}

static inline lanes cone_lanes_power(lanes cosine, float power)
{
    return lanes_exp(0.5f * power * lanes_log(1 - cosine * cosine));
}

/* f of (2) times the sine of the light: of a sine and a cosine times any length. */
static inline lanes cone_lanes_lune(lanes sine, lanes cosine)
{
    const lanes length = lanes_sqrt(sine * sine + cosine * cosine), tiny = lanes_even(1e-20f);
    const lanes s = lanes_min(sine / lanes_max(length, tiny), lanes_even(1));
    const lanes c =
        lanes_max(lanes_min(cosine / lanes_max(length, tiny), lanes_even(1)), lanes_even(-1));
    const lanes lune = lanes_max(s + lanes_turn(s, c) * c, lanes_even(0));
    return lanes_pick(lanes_less(tiny, length), lune, lanes_even(4 / LANES_PI));
}

/* needles_specular. */
static inline lanes cone_lanes_specular(const struct cone_lanes_sight *sight, const lanes axis[3],
                                        const lanes by_light[3], const lanes by_eye[3], lanes lit,
                                        lanes seen)
{
    const lanes *h = sight->half, dot = sight->half_dot;
    const lanes by_half[3] = {axis[1] * h[2] - axis[2] * h[1], axis[2] * h[0] - axis[0] * h[2],
                              axis[0] * h[1] - axis[1] * h[0]};
    const lanes zero = lanes_even(0), tiny = lanes_even(1e-20f);
    const lanes square =
        by_half[0] * by_half[0] + by_half[1] * by_half[1] + by_half[2] * by_half[2];
    const lanes cross =
        axis[0] * sight->cross[0] + axis[1] * sight->cross[1] + axis[2] * sight->cross[2];
    const lanes sine = lanes_abs(cross) / lanes_max(2 * dot, tiny);
    const lanes cosines[2] = {
        by_eye[0] * by_half[0] + by_eye[1] * by_half[1] + by_eye[2] * by_half[2],
        by_light[0] * by_half[0] + by_light[1] * by_half[1] + by_light[2] * by_half[2]};
    lanes cosine[2], power[2], sine_eye = zero;
    for (int i = 0; i < 2; i++) {
        const lanes length = lanes_sqrt(sine * sine + cosines[i] * cosines[i]);
        cosine[i] = cosines[i] / lanes_max(length, tiny);
        sine_eye = i ? sine_eye : sine / lanes_max(length, tiny);
        power[i] = cone_lanes_power(cosine[i], sight->exponent + 1);
    }
    const float k = sight->lobe_k;
    const lanes lobe =
        cosine[0] * sight->lobe * (lanes_erf(k * cosine[0]) + lanes_erf(k * cosine[1])) +
        sine_eye * (power[0] - power[1]) / (sight->exponent + 1);
    const lanes_mask there = lanes_both(lanes_both(lanes_less(zero, dot), lanes_less(zero, seen)),
                                        lanes_less(zero, lit));
    const lanes all =
        lanes_clamp(0.5f * lobe * lanes_exp(0.5f * sight->exponent * lanes_log(square)));
    return lanes_pick(lanes_both(there, lanes_less(lanes_even(1e-24f), square)), all, zero);
}

/* needles_reflect; shines: the specular part too. */
static inline struct cone_lanes_shine cone_lanes_reflect(const struct cone_lanes_sight *sight,
                                                         const lanes axis[3], bool shines)
{
    const lanes *l = sight->light, *e = sight->eye;
    const lanes by_eye[3] = {axis[1] * e[1], axis[2] * e[0] - axis[0] * e[1], -axis[1] * e[0]};
    const lanes by_light[3] = {axis[1] * l[2] - axis[2] * l[1], axis[2] * l[0] - axis[0] * l[2],
                               axis[0] * l[1] - axis[1] * l[0]};
    const lanes cross =
        axis[0] * sight->cross[0] + axis[1] * sight->cross[1] + axis[2] * sight->cross[2];
    const lanes lit = lanes_sqrt(by_light[0] * by_light[0] + by_light[1] * by_light[1] +
                                 by_light[2] * by_light[2]);
    const lanes cosine =
        by_eye[0] * by_light[0] + by_eye[1] * by_light[1] + by_eye[2] * by_light[2];
    struct cone_lanes_shine shine = {
        .seen = lanes_sqrt(by_eye[0] * by_eye[0] + by_eye[1] * by_eye[1] + by_eye[2] * by_eye[2]),
        .specular = lanes_even(0)};
    shine.diffuse = 0.25f * lit * cone_lanes_lune(lanes_abs(cross), cosine);
    if (shines)
        shine.specular = cone_lanes_specular(sight, axis, by_light, by_eye, lit, shine.seen);
    return shine;
}

struct cone_lanes_sums {
    lanes seen[2], diffuse[2], specular[2];
};

/* needles_cone_panel, as a mean. */
static inline void cone_lanes_panel(const struct cone_lanes_sight *sight, int count, float from,
                                    float to, bool shines, struct cone_lanes_sums *sums)
{
    const struct needles_nodes nodes = needles_nodes_of(count);
    for (int i = 0; i < 4 * count; i++) {
        const int back = i & 1;
        const float step = 0.5f * LANES_PI * (from + (to - from) * nodes.at[i / 4]);
        const float weight = 0.5f * (to - from) * nodes.weights[i / 4];
        const float c = back ? -cosf(step) : cosf(step), s = i & 2 ? -sinf(step) : sinf(step);
        const lanes axis[3] = {sight->sine * c, sight->sine * s, sight->cosine};
        const struct cone_lanes_shine shine = cone_lanes_reflect(sight, axis, shines);
        sums->seen[back] += weight * shine.seen;
        sums->diffuse[back] += weight * shine.seen * shine.diffuse;
        sums->specular[back] += weight * shine.seen * shine.specular;
    }
}

static inline void cone_lanes_sums(const struct cone_lanes_sight *sight, struct cone_lanes_job *job,
                                   int first)
{
    const float wanted = ceilf(0.8f * sqrtf(fmaxf(job->exponent, 0)));
    const int count = wanted > 2 ? (int)fminf(wanted, 256) : 2, panels = (count + 7) / 8;
    const lanes none = lanes_even(0);
    struct cone_lanes_sums sums = {{none, none}, {none, none}, {none, none}}, gloss = sums;
    cone_lanes_panel(sight, 2, 0, 1, job->exponent >= 0 && count == 2, &sums);
    for (int i = 0; i < panels && count > 2; i++)
        cone_lanes_panel(sight, (count + panels - 1) / panels, (float)i / (float)panels,
                         (float)(i + 1) / (float)panels, true, &gloss);
    for (int half = 0; half < 2; half++) {
        const lanes seen = lanes_max(sums.seen[half], lanes_even(1e-12f));
        lanes_store(sums.seen[half], job->seen[half] + first);
        lanes_store(lanes_clamp(sums.diffuse[half] / seen), job->diffuse[half] + first);
        lanes_store(lanes_clamp((count > 2 ? gloss.specular[half] : sums.specular[half]) / seen),
                    job->specular[half] + first);
    }
}

/* Depths of the disc for the halves of needles that are seen from a direction. */
static inline void cone_lanes_depths(const struct cone_lanes_job *job, int first, lanes flat,
                                     lanes along, const lanes seen[2], lanes depths[2])
{
    const lanes radius = lanes_load(job->radius_m + first);
    const lanes outline =
        2 * radius *
        (lanes_load(job->length_m + first) * flat + 0.5f * LANES_PI * radius * lanes_abs(along));
    const lanes depth =
        4 / LANES_PI * lanes_load(job->area_m2 + first) / lanes_max(outline, lanes_even(1e-20f));
    for (int half = 0; half < 2; half++)
        depths[half] = depth * seen[half];
}

/* needles_cone_seen over pi, of the light. */
static inline void cone_lanes_seen(const struct cone_lanes_sight *sight, lanes flat, lanes along,
                                   lanes seen[2])
{
    const struct needles_nodes nodes = needles_nodes_of(2);
    for (int back = 0; back < 2; back++) {
        seen[back] = lanes_even(0);
        for (int i = 0; i < 2; i++) {
            const float step = 0.5f * LANES_PI * nodes.at[i], c = back ? -cosf(step) : cosf(step);
            const lanes x = sight->sine * c, y = sight->sine * sinf(step), z = sight->cosine;
            const lanes by[3] = {y * along, z * flat - x * along, -y * flat};
            seen[back] += 0.5f * lanes_sqrt(by[0] * by[0] + by[1] * by[1] + by[2] * by[2]);
        }
    }
}

struct cone_lanes_disc {
    lanes eye[2], light[2], cosine, sine;
};

/* needles_line_lit. */
static inline lanes cone_lanes_line(const struct cone_lanes_disc *disc, float aside, float edge,
                                    int back, lanes all)
{
    const struct needles_nodes nodes = needles_nodes_of(3);
    const lanes depth = disc->eye[back], zero = lanes_even(0), tiny = lanes_even(1e-20f);
    lanes sum = zero;
    for (int i = 0; i < 3; i++) {
        const lanes warped =
            lanes_min(-lanes_log(1 - all * nodes.at[i]) / lanes_max(depth, tiny), lanes_even(edge));
        const lanes behind = lanes_pick(lanes_less(lanes_even(1e-3f), depth * edge), warped,
                                        lanes_even(edge * nodes.at[i]));
        const lanes toward = back ? -behind : edge - behind;
        const lanes along = toward * disc->cosine + aside * disc->sine;
        const lanes across = aside * disc->cosine - toward * disc->sine;
        const lanes rim = lanes_sqrt(lanes_max(1 - across * across, zero));
        const lanes shadow =
            lanes_pick(lanes_less(along, zero), disc->light[0] * rim - disc->light[1] * along,
                       disc->light[0] * (rim - along));
        sum += nodes.weights[i] * lanes_exp(-lanes_max(shadow, zero));
    }
    return lanes_min(sum, lanes_even(1));
}

/* needles_disc_lit. */
static inline void cone_lanes_lit(const struct cone_lanes_disc *disc, struct cone_lanes_job *job,
                                  int first)
{
    const struct needles_nodes nodes = needles_nodes_of(6);
    const lanes none = lanes_even(0);
    lanes seen[2] = {none, none}, lit[2] = {none, none};
    for (int i = 0; i < 6; i++) {
        const float t = LANES_PI * (nodes.at[i] - 0.5f), aside = sinf(t), edge = cosf(t);
        const float weight = 0.5f * LANES_PI * nodes.weights[i] * edge;
        const lanes past = lanes_exp(-disc->eye[0] * edge), front = 1 - past;
        const lanes back = 1 - lanes_exp(-disc->eye[1] * edge);
        seen[0] += weight * front;
        seen[1] += weight * past * back;
        if (!job->shaded)
            continue;
        lit[0] += weight * front * cone_lanes_line(disc, aside, edge, 0, front);
        lit[1] += weight * past * back * cone_lanes_line(disc, aside, edge, 1, back);
    }
    for (int half = 0; half < 2; half++) {
        lanes_store(seen[half], job->disc_seen[half] + first);
        lanes_store(job->shaded ? lit[half] : seen[half], job->disc_lit[half] + first);
    }
}

static inline void cone_lanes_some(struct cone_lanes_job *job, int first)
{
    const struct cone_lanes_sight sight = cone_lanes_sight(job, first);
    const lanes *l = sight.light, zero = lanes_even(0), tiny = lanes_even(1e-20f);
    const lanes flat = lanes_sqrt(l[0] * l[0] + l[1] * l[1]);
    struct cone_lanes_disc disc = {.light = {zero, zero}};
    cone_lanes_sums(&sight, job, first);
    const lanes seen[2] = {lanes_load(job->seen[0] + first), lanes_load(job->seen[1] + first)};
    cone_lanes_depths(job, first, sight.eye[0], sight.eye[1], seen, disc.eye);
    if (job->shaded) {
        lanes lit[2];
        cone_lanes_seen(&sight, flat, l[2], lit);
        cone_lanes_depths(job, first, flat, l[2], lit, disc.light);
    }
    const lanes_mask known = lanes_less(lanes_even(1e-9f), flat);
    disc.cosine = lanes_pick(known, l[0] / lanes_max(flat, tiny), lanes_even(1));
    disc.sine = lanes_pick(known, lanes_abs(l[1]) / lanes_max(flat, tiny), zero);
    cone_lanes_lit(&disc, job, first);
    for (int half = 0; half < 2; half++) {
        lanes_store(disc.eye[half], job->depths[half] + first);
        lanes_store(disc.light[half], job->light_depths[half] + first);
    }
    lanes_store(disc.cosine, job->disc_cosine + first);
    lanes_store(disc.sine, job->disc_sine + first);
    const lanes lune = cone_lanes_lune(lanes_abs(sight.cross[2]), l[0] * sight.eye[0]);
    lanes_store(0.25f * flat * lune, job->axis_diffuse + first);
}

static inline void cone_lanes_all(struct cone_lanes_job *job)
{
    for (int first = 0; first < CONE_LANES; first += LANES)
        cone_lanes_some(job, first);
}

#endif
