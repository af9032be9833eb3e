/* The shaders of needles as Hattab, Babahenini and Djedi print them, clamped to what is physical: a
 * half shows 0..pi of needles, diffuse at most pi/4 of that, specular at most all of it.
 *
 * Two departures, without which nothing can be evaluated: a cone's integrals get the factor R/(2
 * S_pix) that turns their metres into a share of the pixel, and the root below (7) takes the angle
 * between light and eye around the cone, since that of a needle has no meaning there. Eye and light
 * are in polar angles from the axis, as the paper defines them. */
#ifndef TREELINE_BAKE_NEEDLES_PAPER_H
#define TREELINE_BAKE_NEEDLES_PAPER_H

static inline real needles_clamp(real value, real most)
{
    return value > 0 ? real_min(value, most) : 0;
}

/* (2), and (4): s_h^n/2 cos(D_v) sqrt(2 pi/n). */
static inline struct needles_shine needles_paper_reflect(const real axis[3],
                                                         const struct needles_sight *sight)
{
    struct needles_sight plain = *sight;
    plain.exponent = -1;
    struct needles_shine shine = needles_reflect(axis, &plain);
    const real n = sight->exponent, along = needles_dot(axis, sight->half);
    const real sine = real_sqrt(real_max(1 - along * along, 0));
    if (n < 0 || !(sine > 0) || !(shine.seen > 0) || !(sight->half_dot > 0))
        return shine;
    const real cosine =
        (sight->half_dot - along * needles_dot(axis, sight->eye)) / (sine * shine.seen);
    shine.specular = needles_clamp(needles_sine_power(along, n) / 2 * cosine *
                                       real_sqrt(2 * REAL_PI / real_max(n, REAL(1e-6))),
                                   1);
    return shine;
}

/* (7): D of both halves, before they are clamped. phi, light, eye: polar angles; turn_cosine: of
 * the angle between light and eye around the cone. */
static inline void needles_paper_diffuse(real phi, real light, real eye, real turn_cosine,
                                         real light_eye, real diffuse[2])
{
    const real bl = real_min(light, phi), bv = real_min(eye, phi);
    const real a = real_max(light, phi) + real_max(eye, phi), b = bl + bv;
    const real most = real_cos(a - b), least = real_cos(a + b), l1 = (least - most) / 2;
    const real l2 = a - b < REAL_PI && REAL_PI < a + b ? l1 * b / (4 * (2 * REAL_PI - a)) : 0;
    const real l0 = (least + most) / 2 - l2;
    const real root = real_sqrt(real_max(bl * bl + bv * bv + 2 * bl * bv * turn_cosine, 0));
    const real turn = root > 0 ? (bl * turn_cosine + bv) / root : 1;
    diffuse[0] = (REAL_PI * (light_eye - l0) - 2 * l1 * turn) / 4;
    diffuse[1] = (REAL_PI * (light_eye - l0) + 2 * l1 * turn) / 4;
}

/* epsilon of (9): how many needles of each half are square to H. */
static inline void needles_paper_lines(real sine, real cosine, const struct needles_sight *sight,
                                       int lines[2])
{
    const real *h = sight->half, *v = sight->eye;
    const real flat = real_sqrt(h[0] * h[0] + h[1] * h[1]);
    const real across = sine * flat, along = -cosine * h[2];
    lines[0] = lines[1] = 0;
    if (!(across > 0) || real_abs(along) > across)
        return;
    const real step = real_atan2(real_sqrt((across - along) * (across + along)), along);
    const real from = real_atan2(h[1], h[0]) - real_atan2(v[1], v[0]);
    for (int sign = -1; sign <= 1; sign += 2)
        lines[real_cos(from + REAL(sign) * step) > 0 ? 0 : 1]++;
}

/* (11), (7), (9) without their l A. */
static inline struct needles_sums needles_paper_sums(real sine, real cosine,
                                                     const struct needles_sight *sight)
{
    const real *v = sight->eye, *l = sight->light;
    const real flat_v = real_sqrt(v[0] * v[0] + v[1] * v[1]);
    const real flat_l = real_sqrt(l[0] * l[0] + l[1] * l[1]);
    const real turn = flat_v * flat_l > 0 ? (v[0] * l[0] + v[1] * l[1]) / (flat_v * flat_l) : 1;
    struct needles_sums sums = {{0, 0}, {0, 0}, {0, 0}};
    int lines[2];
    needles_paper_lines(sine, cosine, sight, lines);
    needles_paper_diffuse(real_atan2(sine, cosine), real_atan2(flat_l, l[2]),
                          real_atan2(flat_v, v[2]), needles_clamp(1 + turn, 2) - 1,
                          needles_dot(l, v), sums.diffuse);
    for (int half = 0; half < 2; half++) {
        const real swing = 2 * sine * flat_v;
        sums.seen[half] = needles_clamp(REAL_PI * cosine * v[2] + (half ? swing : -swing), REAL_PI);
        sums.diffuse[half] = needles_clamp(sums.diffuse[half], REAL_PI / 4 * sums.seen[half]);
        if (sight->exponent >= 0)
            sums.specular[half] = needles_clamp(REAL_PI / real_max(sight->exponent, REAL(1e-6)) *
                                                    sight->half_dot * REAL(lines[half]),
                                                sums.seen[half]);
    }
    return sums;
}

/* (6) to (11); regular as in needles_cone_shade has no meaning: opacities are added. */
static inline struct needles_cone_shade needles_paper_cone_shade(const struct needles_twig *twig,
                                                                 const struct needles_sight *sight,
                                                                 real section_m2)
{
    const struct needles_sums sums = needles_paper_sums(twig->sine, twig->cosine, sight);
    const real area = twig->count * twig->radius_m * twig->length_m / REAL_PI / section_m2;
    const real all = real_max(sums.seen[0] + sums.seen[1], REAL(1e-12));
    struct needles_cone_shade shade = {{{0, 0, 0}, {0, 0, 0}}, {0, 0, 0}};
    for (int half = 0; half < 2; half++) {
        shade.halves[half] = needles_half_shade(&sums, half);
        shade.halves[half].opacity = real_min(area * sums.seen[half], 1);
    }
    shade.all.diffuse = (sums.diffuse[0] + sums.diffuse[1]) / all;
    shade.all.specular = (sums.specular[0] + sums.specular[1]) / all;
    shade.all.opacity = real_min(area * all, 1);
    return shade;
}

/* (19): alpha = a K, a = A R pi/(4 dh), K and K of pi - phi; 0..1. */
static inline void needles_paper_opacities(const struct needles_twig *twig, const real direction[3],
                                           real alpha[2])
{
    const real flat = real_sqrt(direction[0] * direction[0] + direction[1] * direction[1]);
    const real a = twig->count * twig->radius_m / (2 * twig->spacing_m);
    const real cot = twig->cosine / real_max(twig->sine, REAL(1e-4));
    const real cot_direction = direction[2] / real_max(flat, REAL(1e-4));
    alpha[0] = needles_clamp(a * real_abs(cot - cot_direction), 1);
    alpha[1] = needles_clamp(a * real_abs(cot + cot_direction), 1);
}

/* (20), (21): shares of the disc, of alphas 0..1; linear, not clamped: below 0 where they are
 * large. */
static inline void needles_paper_lit(const real eye[2], const real light[2], real angle_cosine,
                                     real lit[2])
{
    const real k = 8 / (3 * REAL_PI * REAL_PI), c = angle_cosine;
    lit[0] = eye[0] * (1 - k * (2 * eye[0] + (1 - c) * light[1] + (3 - c) * light[0]));
    lit[1] = eye[1] * (1 - k * (4 * eye[0] + 2 * eye[1] + (1 + c) * light[1] + (3 + c) * light[0]));
}

/* (12) to (21). */
static inline struct needles_twig_shade needles_paper_twig_shade(const struct needles_twig *twig,
                                                                 const struct needles_sight *sight)
{
    const struct needles_sums sums = needles_paper_sums(twig->sine, twig->cosine, sight);
    const real sine = sight->cross[2];
    const real cosine = sight->light[0] * sight->eye[0] + sight->light[1] * sight->eye[1];
    const real length = real_sqrt(sine * sine + cosine * cosine);
    real eye[2], light[2], lit[2];
    needles_paper_opacities(twig, sight->eye, eye);
    needles_paper_opacities(twig, sight->light, light);
    needles_paper_lit(eye, light, length > 0 ? cosine / length : 1, lit);
    const real all = real_max(eye[0] + eye[1], REAL(1e-30));
    struct needles_twig_shade shade = {{{0, 0, 0}, {0, 0, 0}}, {0, 0, 0}};
    shade.all.opacity = real_min(all, 1);
    for (int half = 0; half < 2; half++) {
        struct needles_shade *of = &shade.halves[half];
        *of = needles_half_shade(&sums, half);
        const real share = needles_clamp(lit[half] / real_max(eye[half], REAL(1e-30)), 1);
        of->diffuse *= share;
        of->specular *= share;
        of->opacity = shade.all.opacity * eye[half] / all;
        shade.all.diffuse += of->diffuse * eye[half] / all;
        shade.all.specular += of->specular * eye[half] / all;
    }
    return shade;
}

#endif
