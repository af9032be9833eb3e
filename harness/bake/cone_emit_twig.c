/* A twig: what it is in a view, its level, and the strip of all of it. */
#include "bake/cone_emit.h"
#include "bake/cone_emit_parts.h"

#include <math.h>
#include <string.h>

#define PI 3.14159265f

static float dot3(const float a[3], const float b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* 0 up to low, 1 from high on, smooth. */
static float ramp(float at, float low, float high)
{
    float share = (at - low) / (high - low);
    share = share > 0 ? share < 1 ? share : 1 : 0;
    return share * share * (3 - 2 * share);
}

struct cone_mix cone_mix_of(const struct cone_choice *choice, float needle_px, float distance_m)
{
    /* A level turns into the next over a quarter of an octave to each side, or a tenth of a
     * distance. */
    static const float wide = 1.1892071f, wide_limit = 1.1f;
    struct cone_mix mix = {{0, 0, 0}};
    float finer[2];
    if (choice->forced >= 0) {
        mix.shares[choice->forced] = 1;
        return mix;
    }
    for (int k = 0; k < 2; k++) {
        float size = k == 0 ? choice->needle_px : choice->twig_px, limit = choice->limits_m[k];
        if (limit > 0)
            finer[k] = 1 - ramp(distance_m, limit / wide_limit, limit * wide_limit);
        else
            finer[k] = ramp(needle_px, size / wide, size * wide);
    }
    mix.shares[CONE_NEEDLE] = finer[0];
    mix.shares[CONE_CONE] = fmaxf(finer[1] - finer[0], 0);
    mix.shares[CONE_TWIG] = 1 - mix.shares[CONE_NEEDLE] - mix.shares[CONE_CONE];
    return mix;
}

static struct cone_mix mix_at(const struct cone_picture *picture, const struct cone_tree *tree,
                              const struct cone_twig *twig, float depth_m, float distance_m)
{
    float px = picture->focal_px / fmaxf(depth_m, picture->view->near_m);
    return cone_mix_of(&picture->choice, px * tree->scale * twig->twig->needle_length_m,
                       distance_m);
}

size_t cone_twig_most(const struct cone_picture *picture, const struct cone_tree *tree,
                      const struct cone_twig *twig, float depth_m)
{
    /* size falls as distance grows: nothing finer than at the nearest place */
    struct cone_mix near = mix_at(picture, tree, twig, depth_m, depth_m);
    size_t count = 2, cones = twig->twig->cones_count;
    if (near.shares[CONE_NEEDLE] > 0)
        count += cones * twig->twig->needles_count;
    if (near.shares[CONE_NEEDLE] < 1)
        count += 2 * cones;
    return count;
}

float cone_light_of(const struct cone_tree *tree, const struct cone_twig_view *seen, uint32_t cone)
{
    return tree->light.cones
               ? seen->gain * (float)tree->light.cones[seen->twig->first_cone + cone] / 255
               : 1;
}

float cone_sphere_of(const struct cone_twig *twig, uint32_t cone, float apex_m[3],
                     float center_m[3])
{
    const struct conifer_twig *from = twig->twig;
    float along = twig->cone_0_m + (float)cone * from->spacing_m;
    float rise = 0.5f * from->needle_length_m * twig->cosine;
    for (int i = 0; i < 3; i++) {
        apex_m[i] = twig->base_m[i] + along * twig->axis[i];
        center_m[i] = apex_m[i] + rise * twig->axis[i];
    }
    return sqrtf(rise * rise + twig->radius_m * twig->radius_m) + from->needle_radius_m;
}

/* Optical depths over a radius that replace all needles of a twig by a cylinder of even density,
 * closed by discs: its outline is 2 R (L s + pi / 2 R |c|). */
static void depths_of(const struct cone_twig *twig, float needles_m2, const float direction[3],
                      const float shares[2], float depths[2])
{
    float flat = sqrtf(direction[0] * direction[0] + direction[1] * direction[1]);
    float outline_m2 = 2 * twig->radius_m *
                       (twig->length_m * flat + 0.5f * PI * twig->radius_m * fabsf(direction[2]));
    float depth = 4 / PI * needles_m2 / fmaxf(outline_m2, 1e-20f);
    float sum = fmaxf(shares[0] + shares[1], 1e-9f);
    depths[0] = depth * shares[0] / sum;
    depths[1] = depth * shares[1] / sum;
}

/* All needles of a cone, as large as they look at a mean sine. */
static float needles_of(const struct conifer_twig *twig, const float seen[2])
{
    return (float)twig->needles_count * 2 * twig->needle_radius_m * twig->needle_length_m * 0.5f *
           (seen[0] + seen[1]);
}

/* The disc of a twig, and what of it is seen and lit. */

static void view_disc(const struct cone_picture *picture, const struct cone_tree *tree,
                      struct cone_twig_view *seen)
{
    const struct cone_twig *twig = seen->twig;
    const struct needles_sight *sight = &seen->sight;
    const struct needles_twig shape = cone_twig_shape(twig);
    const float cones = (float)twig->twig->cones_count;
    const bool shaded = tree->light.cones;
    float c = sight->light[0] * sight->eye[0] + sight->light[1] * sight->eye[1];
    float s = fabsf(sight->cross[2]), length = sqrtf(c * c + s * s);
    seen->needles_m2 = needles_of(twig->twig, seen->halves.seen);
    seen->disc = (struct needles_disc){.cosine = length > 1e-9f ? c / length : 1,
                                       .sine = length > 1e-9f ? s / length : 0};
    if (picture->shaders == CONE_PAPER) {
        cone_paper_disc(&shape, sight, &seen->disc);
    } else {
        depths_of(twig, cones * seen->needles_m2, sight->eye, seen->halves.seen, seen->disc.eye);
        if (shaded) {
            float lit[2];
            needles_cone_seen(twig->sine, twig->cosine, sight->light, lit);
            lit[0] /= PI;
            lit[1] /= PI;
            depths_of(twig, cones * needles_of(twig->twig, lit), sight->light, lit,
                      seen->disc.light);
        }
    }
    seen->lit = cone_disc_lit(picture->shaders, &seen->disc, shaded);
}

/* False: not drawn. */
static bool view_of(const struct cone_picture *picture, const struct cone_tree *tree, size_t index,
                    struct cone_twig_view *seen)
{
    const struct cone_twig *twig = seen->twig = &tree->plant->twigs[index];
    const struct conifer *conifer = tree->plant->conifer;
    float middle_m[3], camera_m[3];
    float reach_m = cone_twig_reach(twig, middle_m);
    cone_to_camera(tree, middle_m, camera_m);
    if (camera_m[2] + tree->scale * reach_m <= picture->view->near_m)
        return false;
    seen->grown = tree->twigs_grown * fminf(tree->twigs - (float)index, 1);
    if (!cone_picture_sees(picture, camera_m, tree->scale * reach_m * sqrtf(fmaxf(seen->grown, 1))))
        return false;
    for (int i = 0; i < 3; i++)
        seen->eye[i] = tree->eye_m[i] - middle_m[i];
    float away = fmaxf(sqrtf(dot3(seen->eye, seen->eye)), 1e-20f);
    for (int i = 0; i < 3; i++)
        seen->eye[i] /= away;
    for (int i = 0; i < 3; i++) {
        const float *axis = i == 0 ? twig->across : i == 1 ? twig->along : twig->axis;
        seen->sight.eye[i] = dot3(axis, seen->eye);
        seen->sight.light[i] = dot3(axis, tree->sun);
    }
    seen->sight.exponent = picture->effects & EFFECT_SPECULAR && conifer->needle_specular > 0
                               ? conifer->needle_exponent
                               : -1;
    seen->gain = tree->light.cones ? cone_tree_light_gain(&tree->light, middle_m) : 1;
    seen->mix = mix_at(picture, tree, twig, camera_m[2], tree->scale * away);
    seen->part =
        tree->fill * cone_outline_part(&tree->plant->outline, middle_m, twig->radius_m, seen->eye,
                                       tree->scale * picture->focal_px /
                                           fmaxf(camera_m[2], picture->view->near_m));
    return true;
}

/* The bark of a twig's axis by itself. */
static size_t axis_emit(const struct cone_picture *picture, const struct cone_tree *tree,
                        const struct cone_twig_view *seen, float share, struct cone_strip *strip)
{
    const struct conifer_twig *from = seen->twig->twig;
    struct cone_rod rod = {.radius_m = {from->axis_radius_m, from->axis_radius_m}};
    if (!(from->axis_radius_m > 0))
        return 0;
    for (int i = 0; i < 3; i++) {
        rod.ends_m[0][i] = from->base_m[i];
        rod.ends_m[1][i] = from->base_m[i] + from->length_m * from->axis[i];
    }
    rod.radius_m[0] *= seen->grown;
    rod.radius_m[1] *= seen->grown;
    if (!cone_strip_place(picture, tree, &rod, strip))
        return 0;
    const struct cone_material material = {tree->plant->conifer->bark_albedo, 0};
    const struct needles_shade white = {1, 0, 1};
    cone_strip_color(picture, &material, &white, strip);
    cone_strip_round(tree, &rod, seen->axis_shine, strip);
    strip->opacity = cone_opacity_part(1, share);
    if (tree->light.cones && from->cones_count) {
        float own = expf(-needles_disc_shadow(&seen->disc, 0, 0));
        strip->lit[0] = own * cone_light_of(tree, seen, 0);
        strip->lit[1] = own * cone_light_of(tree, seen, from->cones_count - 1);
    } else {
        strip->lit[0] = strip->lit[1] = seen->gain;
    }
    return 1;
}

/* Light of the first and second half of a twig's cones, and what of it the twig leaves to what is
 * seen: needles of both halves of the disc and, between them, the bark. */
static void twig_light(const struct cone_picture *picture, const struct cone_tree *tree,
                       const struct cone_twig_view *seen, struct cone_strip *strip)
{
    const struct conifer_twig *from = seen->twig->twig;
    const struct conifer *conifer = tree->plant->conifer;
    const float *shares = seen->lit.seen;
    const struct cone_material needles = {conifer->needle_albedo, conifer->needle_specular};
    const struct cone_material bark = {conifer->bark_albedo, 0};
    float band = fminf(from->axis_radius_m / seen->twig->radius_m, 1);
    float behind = shares[1] * (1 - band);
    float axis = band * expf(-seen->disc.eye[0]), sum = shares[0] + behind + axis;
    struct cone_strip other = *strip;
    struct needles_shade shade = {0, 0, 1}, axis_shade = {seen->axis_shine, 0, 1};
    for (int back = 0; back < 2; back++) {
        float lit = seen->lit.lit[back] * (back ? 1 - band : 1) / fmaxf(sum, 1e-9f);
        shade.diffuse += lit * seen->halves.shade[back].diffuse;
        shade.specular += lit * seen->halves.shade[back].specular;
    }
    cone_strip_color(picture, &needles, &shade, strip);
    cone_strip_color(picture, &bark, &axis_shade, &other);
    float share = axis / fmaxf(sum, 1e-9f), own = expf(-needles_disc_shadow(&seen->disc, 0, 0));
    for (int c = 0; c < 3; c++) {
        strip->shade[c] += share * (other.shade[c] - strip->shade[c]);
        strip->sun[c] += share * own * other.sun[c];
    }
    strip->opacity = cone_opacity_part(fminf(sum, 1), seen->mix.shares[CONE_TWIG]);
    uint32_t half = (from->cones_count + 1) / 2;
    for (int end = 0; end < 2 && tree->light.cones; end++) {
        uint32_t first = end ? from->cones_count - half : 0;
        float light = 0;
        for (uint32_t k = 0; k < half; k++)
            light += cone_light_of(tree, seen, first + k);
        strip->lit[end] = light / (float)half;
    }
}

static size_t whole_emit(const struct cone_picture *picture, const struct cone_tree *tree,
                         const struct cone_twig_view *seen, struct cone_strip *strip)
{
    const struct cone_twig *twig = seen->twig;
    const float grown = sqrtf(fmaxf(seen->grown, 0));
    const float from_m = 0.5f * twig->twig->needle_length_m * twig->cosine;
    const float longer_m = 0.5f * (grown - 1) * twig->length_m;
    struct cone_rod rod = {.radius_m = {grown * twig->radius_m, grown * twig->radius_m}};
    for (int i = 0; i < 3; i++) {
        rod.ends_m[0][i] = twig->base_m[i] + (from_m - longer_m) * twig->axis[i];
        rod.ends_m[1][i] = twig->base_m[i] + (from_m + twig->length_m + longer_m) * twig->axis[i];
    }
    if (!cone_strip_place(picture, tree, &rod, strip))
        return 0;
    twig_light(picture, tree, seen, strip);
    return 1;
}

/* By bake/needles.h. */
static void shade(const struct cone_picture *picture, const struct cone_tree *tree,
                  struct cone_twig_view *seen)
{
    static const float axis[3] = {0, 0, 1};
    const struct needles_twig shape = cone_twig_shape(seen->twig);
    /* needles are solid: two-sided leaves are others */
    struct needles_sight *sight = &seen->sight;
    const struct needles_sight plain = needles_sight_of(sight->light, sight->eye, -1, false);
    seen->axis_shine = needles_reflect(axis, &plain).diffuse;
    seen->disc = (struct needles_disc){.cosine = 1};
    if (!seen->twig->twig->cones_count)
        return;
    *sight = needles_sight_of(sight->light, sight->eye, sight->exponent, false);
    seen->halves = cone_halves_of(picture->shaders, &shape, sight);
    view_disc(picture, tree, seen);
}

static void lane_fill(const struct cone_twig_view *seen, size_t lane, struct cone_lanes_job *job)
{
    const struct cone_twig *twig = seen->twig;
    const struct conifer_twig *from = twig->twig;
    job->sine[lane] = twig->sine;
    job->cosine[lane] = twig->cosine;
    job->area_m2[lane] = (float)from->cones_count * (float)from->needles_count *
                         from->needle_radius_m * from->needle_length_m;
    job->radius_m[lane] = twig->radius_m;
    job->length_m[lane] = twig->length_m;
    for (int i = 0; i < 3; i++) {
        job->light[i][lane] = seen->sight.light[i];
        job->eye[i][lane] = seen->sight.eye[i];
    }
}

static void lane_take(const struct cone_lanes_job *job, size_t lane, struct cone_twig_view *seen)
{
    for (int half = 0; half < 2; half++) {
        seen->halves.seen[half] = job->seen[half][lane];
        seen->halves.shade[half] =
            (struct needles_shade){job->diffuse[half][lane], job->specular[half][lane], 0};
        seen->disc.eye[half] = job->depths[half][lane];
        seen->disc.light[half] = job->light_depths[half][lane];
        seen->lit.seen[half] = job->disc_seen[half][lane];
        seen->lit.lit[half] = job->disc_lit[half][lane];
    }
    seen->disc.cosine = job->disc_cosine[lane];
    seen->disc.sine = job->disc_sine[lane];
    seen->axis_shine = job->axis_diffuse[lane];
    seen->needles_m2 = needles_of(seen->twig->twig, seen->halves.seen);
}

static size_t strips_of(const struct cone_picture *picture, const struct cone_tree *tree,
                        const struct cone_twig_view *seen, const struct cone_beam *beam,
                        struct cone_strip *strips)
{
    size_t count = 0;
    if (!seen->twig->twig->cones_count) {
        count = axis_emit(picture, tree, seen, 1, strips);
    } else {
        if (seen->mix.shares[CONE_TWIG] > 0)
            count += whole_emit(picture, tree, seen, strips);
        if (seen->mix.shares[CONE_TWIG] < 1)
            count +=
                axis_emit(picture, tree, seen, 1 - seen->mix.shares[CONE_TWIG], strips + count);
        if (seen->mix.shares[CONE_CONE] > 0)
            count += cone_cones_emit(picture, tree, seen, beam, strips + count);
        if (seen->mix.shares[CONE_NEEDLE] > 0)
            count += cone_needles_emit(picture, tree, seen, beam, strips + count);
    }
    for (size_t k = 0; k < count && seen->part != 1; k++)
        strips[k].opacity = fminf(seen->part * strips[k].opacity, 1);
    return count;
}

size_t cone_twig_emit(const struct cone_picture *picture, const struct cone_tree *tree,
                      size_t index, const struct cone_beam *beam, struct cone_strip *strips)
{
    struct cone_twig_view seen;
    if (!view_of(picture, tree, index, &seen))
        return 0;
    shade(picture, tree, &seen);
    return strips_of(picture, tree, &seen, beam, strips);
}

void cone_twigs_emit(const struct cone_picture *picture, const struct cone_tree *tree, size_t first,
                     size_t count, struct cone_strip *strips, size_t ends[CONE_LANES])
{
    struct cone_twig_view seen[CONE_LANES];
    bool drawn[CONE_LANES];
    struct cone_lanes_job job;
    size_t end = 0, lanes = 0;
    for (size_t k = 0; k < count; k++) {
        drawn[k] = view_of(picture, tree, first + k, &seen[k]);
        if (drawn[k] && picture->shade)
            lane_fill(&seen[k], lanes++, &job);
        else if (drawn[k])
            shade(picture, tree, &seen[k]);
    }
    if (lanes > 0) {
        const struct cone_twig_view *last = &seen[0];
        for (size_t k = 0; k < count; k++)
            last = drawn[k] ? &seen[k] : last;
        for (size_t lane = lanes; lane < CONE_LANES; lane++)
            lane_fill(last, lane, &job);
        job.exponent = last->sight.exponent;
        job.shaded = tree->light.cones;
        picture->shade(&job);
    }
    lanes = 0;
    for (size_t k = 0; k < count; k++) {
        if (drawn[k] && picture->shade)
            lane_take(&job, lanes++, &seen[k]);
        if (drawn[k])
            end += strips_of(picture, tree, &seen[k], NULL, strips + end);
        ends[k] = end;
    }
}
