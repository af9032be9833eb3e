/* The two finer levels of a twig: its cones, each two sheets of needles, and its needles. */
#include "bake/cone_emit.h"
#include "bake/cone_emit_parts.h"

#include <math.h>

#define PI 3.14159265f

/* Light along a needle, at its base and its tip: what the twig leaves on the way to the sun.
 * azimuth: of the needle, cosine and sine, in the twig's axes. */
static void needle_light(const struct cone_twig_view *seen, const float azimuth[2], float light,
                         float lit[2])
{
    static const float at[2] = {0.15f, 0.9f};
    const float *sun = seen->sight.light;
    float flat = fmaxf(sqrtf(sun[0] * sun[0] + sun[1] * sun[1]), 1e-9f);
    float toward = (azimuth[0] * sun[0] + azimuth[1] * sun[1]) / flat;
    float aside = (azimuth[1] * sun[0] - azimuth[0] * sun[1]) / flat;
    for (int end = 0; end < 2; end++)
        lit[end] =
            light * expf(-needles_disc_shadow(&seen->disc, at[end] * toward, at[end] * aside));
}

static size_t needle_emit(const struct cone_picture *picture, const struct cone_tree *tree,
                          const struct cone_twig_view *seen, const struct needles_sight *sight,
                          const float apex_m[3], const float azimuth[2], struct cone_strip *strip)
{
    const struct cone_twig *twig = seen->twig;
    const struct conifer_twig *from = twig->twig;
    const struct conifer *conifer = tree->plant->conifer;
    const float radius_m = seen->grown * from->needle_radius_m;
    struct cone_rod rod = {.radius_m = {radius_m, radius_m}};
    float axis[3];
    for (int i = 0; i < 3; i++) {
        axis[i] = twig->sine * (azimuth[0] * twig->across[i] + azimuth[1] * twig->along[i]) +
                  twig->cosine * twig->axis[i];
        rod.ends_m[0][i] = apex_m[i];
        rod.ends_m[1][i] = apex_m[i] + from->needle_length_m * axis[i];
    }
    if (!cone_strip_place(picture, tree, &rod, strip))
        return 0;
    const struct cone_material material = {conifer->needle_albedo, conifer->needle_specular};
    const struct needles_shine shine = cone_needle_shine(picture->shaders, axis, sight);
    const float diffuse = fmaxf(shine.diffuse, 1e-4f);
    const struct needles_shade shade = {1, shine.specular / diffuse, 1};
    strip->opacity = cone_opacity_part(1, seen->mix.shares[CONE_NEEDLE]);
    cone_strip_color(picture, &material, &shade, strip);
    cone_strip_round(tree, &rod, diffuse, strip);
    return 1;
}

size_t cone_needles_emit(const struct cone_picture *picture, const struct cone_tree *tree,
                         const struct cone_twig_view *seen, const struct cone_beam *beam,
                         struct cone_strip *strips)
{
    const struct conifer_twig *from = seen->twig->twig;
    const struct needles_sight sight =
        needles_sight_of(tree->sun, seen->eye, seen->sight.exponent, false);
    const float step_rad = 2 * PI / (float)from->needles_count;
    const float step[2] = {cosf(step_rad), sinf(step_rad)};
    size_t count = 0;
    for (uint32_t k = 0; k < from->cones_count; k++) {
        float apex_m[3], center_m[3];
        float reach_m = cone_sphere_of(seen->twig, k, apex_m, center_m);
        if (beam && !cone_beam_meets(beam, center_m, reach_m))
            continue;
        float turn_rad = from->azimuth_rad + (float)k * from->azimuth_step_rad;
        float azimuth[2] = {cosf(turn_rad), sinf(turn_rad)}, light = cone_light_of(tree, seen, k);
        for (uint32_t needle = 0; needle < from->needles_count; needle++) {
            size_t more = needle_emit(picture, tree, seen, &sight, apex_m, azimuth, strips + count);
            if (more && tree->light.cones)
                needle_light(seen, azimuth, light, strips[count].lit);
            count += more;
            float x = azimuth[0] * step[0] - azimuth[1] * step[1];
            azimuth[1] = azimuth[0] * step[1] + azimuth[1] * step[0];
            azimuth[0] = x;
        }
    }
    return count;
}

/* The area of a cone's outline, m^2: the larger of the footprints of its nearer and its farther
 * sheet. */
static float outline_of(const struct cone_twig_view *seen)
{
    const struct needles_twig shape = cone_twig_shape(seen->twig);
    float footprints[2];
    needles_cone_sheets(&shape, seen->sight.eye, footprints);
    return shape.length_m * shape.length_m * fmaxf(footprints[0], footprints[1]);
}

/* A trapezium as wide as the rim and as large as the outline. */
static bool sheet_place(const struct cone_picture *picture, const struct cone_tree *tree,
                        const struct cone_twig_view *seen, const float apex_m[3], float outline_m2,
                        struct cone_strip *strip)
{
    const struct cone_twig *twig = seen->twig;
    const float grown = sqrtf(fmaxf(seen->grown, 0));
    float flat =
        sqrtf(seen->sight.eye[0] * seen->sight.eye[0] + seen->sight.eye[1] * seen->sight.eye[1]);
    float rim_m = grown * twig->radius_m, begin_m = rim_m * fmaxf(1 - flat, 0.1f);
    struct cone_rod rod = {.radius_m = {begin_m, rim_m}};
    float rise_m = twig->twig->needle_length_m * twig->cosine;
    for (int i = 0; i < 3; i++) {
        rod.ends_m[0][i] = apex_m[i];
        rod.ends_m[1][i] = apex_m[i] + rise_m * twig->axis[i];
    }
    if (!cone_strip_place(picture, tree, &rod, strip))
        return false;
    float px = tree->scale * picture->focal_px / strip->depth_m;
    float wanted_px =
        grown * grown * px * px * outline_m2 / fmaxf(strip->half_px[0] + strip->half_px[1], 1e-9f);
    strip->beyond_px[0] = strip->beyond_px[1] = 0;
    for (int i = 0; i < 2; i++)
        strip->from_px[i] += 0.5f * (strip->length_px - wanted_px) * strip->along[i];
    strip->length_px = wanted_px;
    return true;
}

size_t cone_cones_emit(const struct cone_picture *picture, const struct cone_tree *tree,
                       const struct cone_twig_view *seen, const struct cone_beam *beam,
                       struct cone_strip *strips)
{
    const struct conifer_twig *from = seen->twig->twig;
    const struct conifer *conifer = tree->plant->conifer;
    const struct cone_material material = {conifer->needle_albedo, conifer->needle_specular};
    const float outline_m2 = fmaxf(outline_of(seen), 1e-20f);
    const float both = fmaxf(seen->halves.seen[0] + seen->halves.seen[1], 1e-9f);
    const float flat_m = tree->scale * sqrtf(seen->sight.eye[0] * seen->sight.eye[0] +
                                             seen->sight.eye[1] * seen->sight.eye[1]);
    size_t count = 0;
    for (uint32_t k = 0; k < from->cones_count; k++) {
        float apex_m[3], center_m[3];
        float reach_m = cone_sphere_of(seen->twig, k, apex_m, center_m);
        if (beam && !cone_beam_meets(beam, center_m, 1.5f * reach_m))
            continue;
        for (int back = 0; back < 2; back++) {
            struct cone_strip *strip = &strips[count];
            if (!sheet_place(picture, tree, seen, apex_m, outline_m2, strip))
                break;
            count++;
            float depth = seen->needles_m2 / outline_m2 * seen->halves.seen[back] / both;
            strip->opacity = cone_opacity_part(cone_sheet_opacity(picture->shaders, depth),
                                               seen->mix.shares[CONE_CONE]);
            strip->depth_m += (back ? 0.4f : -0.4f) * flat_m * seen->twig->radius_m;
            cone_strip_color(picture, &material, &seen->halves.shade[back], strip);
            float own =
                seen->lit.seen[back] > 1e-6f ? seen->lit.lit[back] / seen->lit.seen[back] : 1;
            strip->lit[0] = strip->lit[1] = own * cone_light_of(tree, seen, k);
        }
    }
    return count;
}
