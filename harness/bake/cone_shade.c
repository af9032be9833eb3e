/* Which of the two shaders a strip is drawn by. */
#include "bake/cone_shade.h"

#define PI 3.14159265f

struct needles_shine cone_needle_shine(enum cone_shaders shaders, const float axis[3],
                                       const struct needles_sight *sight)
{
    return shaders == CONE_PAPER ? needles_paper_reflect(axis, sight)
                                 : needles_reflect(axis, sight);
}

struct cone_halves cone_halves_of(enum cone_shaders shaders, const struct needles_twig *twig,
                                  const struct needles_sight *sight)
{
    const struct needles_sums sums = shaders == CONE_PAPER
                                         ? needles_paper_sums(twig->sine, twig->cosine, sight)
                                         : needles_cone_sums(twig->sine, twig->cosine, sight);
    struct cone_halves halves;
    for (int half = 0; half < 2; half++) {
        halves.seen[half] = sums.seen[half] / PI;
        halves.shade[half] = needles_half_shade(&sums, half);
    }
    return halves;
}

float cone_sheet_opacity(enum cone_shaders shaders, float depth)
{
    return shaders == CONE_PAPER ? fminf(depth, 1) : -expm1f(-depth);
}

void cone_paper_disc(const struct needles_twig *twig, const struct needles_sight *sight,
                     struct needles_disc *disc)
{
    needles_paper_opacities(twig, sight->eye, disc->eye);
    needles_paper_opacities(twig, sight->light, disc->light);
    for (int half = 0; half < 2; half++) {
        disc->eye[half] *= 4 / PI;
        disc->light[half] *= 4 / PI;
    }
}

struct needles_lit cone_disc_lit(enum cone_shaders shaders, const struct needles_disc *disc,
                                 bool shaded)
{
    struct needles_disc open = *disc;
    if (!shaded)
        open.light[0] = open.light[1] = 0;
    if (shaders != CONE_PAPER)
        return needles_disc_lit(&open);
    struct needles_lit lit;
    float eye[2], light[2], sum = 0;
    for (int half = 0; half < 2; half++) {
        eye[half] = PI / 4 * disc->eye[half];
        light[half] = PI / 4 * open.light[half];
        sum += eye[half];
    }
    needles_paper_lit(eye, light, disc->cosine, lit.lit);
    for (int half = 0; half < 2; half++) {
        const float share = shaded ? needles_clamp(lit.lit[half] / fmaxf(eye[half], 1e-30f), 1) : 1;
        lit.seen[half] = fminf(sum, 1) * eye[half] / fmaxf(sum, 1e-30f);
        lit.lit[half] = share * lit.seen[half];
    }
    return lit;
}
