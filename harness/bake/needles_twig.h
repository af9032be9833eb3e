/* Many cones one after the other: a cylinder of needles that hide and shadow one another. */
#ifndef TREELINE_BAKE_NEEDLES_TWIG_H
#define TREELINE_BAKE_NEEDLES_TWIG_H

/* Optical depths over a radius of the disc that a twig is in section: of the half where needles
 * lean toward a direction [0] and of the other one [1]; (A R/dh) K, where K is F/(pi sin phi sin
 * phi_V) in place of the paper's |cot phi -+ cot phi_V|, which is 0 for needles that are seen.
 * direction: of an eye or a light; along the twig the depths become as large as at 1e-4 rad from
 * it. */
static inline void needles_twig_depths(const struct needles_twig *twig, const real direction[3],
                                       real depths[2])
{
    const real flat = real_sqrt(direction[0] * direction[0] + direction[1] * direction[1]);
    needles_cone_seen(twig->sine, twig->cosine, direction, depths);
    for (int half = 0; half < 2; half++)
        depths[half] *=
            2 * twig->count * twig->radius_m * twig->length_m /
            (REAL_PI * REAL_PI * twig->spacing_m * twig->reach_m * real_max(flat, REAL(1e-4)));
}

/* A disc of radius 1 between an eye and a light, all seen along the twig. */
struct needles_disc {
    real eye[2], light[2]; /* depths of the halves nearer to each [0] and farther [1] */
    real cosine, sine;     /* of the angle between eye and light around the twig */
};

static inline struct needles_disc needles_disc_of(const struct needles_twig *twig,
                                                  const struct needles_sight *sight)
{
    struct needles_disc disc = {{0, 0}, {0, 0}, 1, 0};
    needles_twig_depths(twig, sight->eye, disc.eye);
    needles_twig_depths(twig, sight->light, disc.light);
    const real sine = real_abs(sight->cross[2]);
    const real cosine = sight->light[0] * sight->eye[0] + sight->light[1] * sight->eye[1];
    const real length = real_sqrt(sine * sine + cosine * cosine);
    if (length > 0) {
        disc.cosine = cosine / length;
        disc.sine = sine / length;
    }
    return disc;
}

/* Optical depth toward the light from a place in the disc: along the light's direction and across;
 * both within the disc. */
static inline real needles_disc_shadow(const struct needles_disc *disc, real along, real across)
{
    const real edge = real_sqrt(real_max(1 - across * across, 0));
    const real depth = along >= 0 ? disc->light[0] * (edge - along)
                                  : disc->light[0] * edge - disc->light[1] * along;
    return real_max(depth, 0);
}

/* Shares of the disc's width: of needles that are seen, and of needles that are seen and lit, in
 * the half nearer to the eye [0] and in the other one [1]. lit <= seen, seen[0] + seen[1] <= 1. */
struct needles_lit {
    real seen[2], lit[2];
};

/* Of one half along one line of sight at `aside`, `edge` = sqrt(1 - aside^2): share of `all`, what
 * the line sees there, that is lit. Nodes are even in what is seen of them. */
static inline real needles_line_lit(const struct needles_disc *disc, real aside, real edge,
                                    bool back, real all)
{
    const struct needles_nodes nodes = needles_nodes_of(3);
    const real depth = disc->eye[back];
    real sum = 0;
    for (int i = 0; i < 3; i++) {
        const real behind = depth * edge > REAL(1e-5)
                                ? real_min(-real_log1p(-all * nodes.at[i]) / depth, edge)
                                : edge * nodes.at[i];
        const real toward = back ? -behind : edge - behind;
        sum += nodes.weights[i] *
               real_exp(-needles_disc_shadow(disc, toward * disc->cosine + aside * disc->sine,
                                             aside * disc->cosine - toward * disc->sine));
    }
    return real_min(sum, 1);
}

/* (14) with its exponentials: 6 lines of sight with 3 places in each half. Mean errors 0.002 to
 * depths of 1, 0.003 to 2, 0.016 to 5. */
static inline struct needles_lit needles_disc_lit(const struct needles_disc *disc)
{
    const struct needles_nodes nodes = needles_nodes_of(6);
    struct needles_lit lit = {{0, 0}, {0, 0}};
    for (int i = 0; i < 6; i++) {
        const real t = REAL_PI * (nodes.at[i] - REAL(0.5));
        const real aside = real_sin(t), edge = real_cos(t);
        const real weight = REAL_PI / 2 * nodes.weights[i] * edge;
        const real front = -real_expm1(-disc->eye[0] * edge);
        const real back = -real_expm1(-disc->eye[1] * edge), past = real_exp(-disc->eye[0] * edge);
        lit.seen[0] += weight * front;
        lit.seen[1] += weight * past * back;
        lit.lit[0] += weight * front * needles_line_lit(disc, aside, edge, false, front);
        lit.lit[1] += weight * past * back * needles_line_lit(disc, aside, edge, true, back);
    }
    return lit;
}

/* Share of the twig's width that its needles cover. regular: cones that are all turned alike cover
 * as an even disc does (a_I), and no more than each of them alone; else, at random azimuths and
 * places, as the density of needles is, which falls from the axis (a_rho). depths: of the eye. */
static inline real needles_twig_opacity(const struct needles_twig *twig, const real eye[3],
                                        const real depths[2], bool regular)
{
    if (!regular)
        return real_min(needles_radial_opacity(depths[0] + depths[1]), 1);
    const real even = real_min(needles_disc_opacity(depths[0] + depths[1]), 1);
    const real flat = real_sqrt(eye[0] * eye[0] + eye[1] * eye[1]);
    const real width = 2 * twig->reach_m * twig->spacing_m * real_max(flat, REAL(1e-4));
    const real alone = twig->length_m * twig->length_m * needles_cone_cover(twig, eye).regular;
    return alone > 0 ? real_min(even, alone / width) : even;
}

/* What a pixel gets of a twig wherever it covers it: a mean over the twig's width 2 R. Reflectances
 * are those of the needles that are seen, with their shadows. halves: nearer to the eye, farther;
 * in the order that the eye meets them, so that what the second one covers is behind the first:
 * opacities add up to that of all. regular: cones that are all turned alike cover as an even disc
 * does (a_I); else, at random azimuths and places, as the density of needles is, which falls from
 * the axis (a_rho). */
struct needles_twig_shade {
    struct needles_shade halves[2], all;
};

static inline struct needles_twig_shade
needles_twig_shade(const struct needles_twig *twig, const struct needles_sight *sight, bool regular)
{
    const struct needles_sums sums = needles_cone_sums(twig->sine, twig->cosine, sight);
    const struct needles_disc disc = needles_disc_of(twig, sight);
    const struct needles_lit lit = needles_disc_lit(&disc);
    const real opacity = needles_twig_opacity(twig, sight->eye, disc.eye, regular);
    const real seen = real_max(lit.seen[0] + lit.seen[1], REAL(1e-30));
    struct needles_twig_shade shade = {{{0, 0, 0}, {0, 0, 0}}, {0, 0, 0}};
    shade.all.opacity = real_min(opacity, 1);
    for (int half = 0; half < 2; half++) {
        struct needles_shade *of = &shade.halves[half];
        *of = needles_half_shade(&sums, half);
        const real lit_share = lit.lit[half] / real_max(lit.seen[half], REAL(1e-30));
        of->diffuse *= lit_share;
        of->specular *= lit_share;
        of->opacity = shade.all.opacity * lit.seen[half] / seen;
        shade.all.diffuse += of->diffuse * lit.seen[half] / seen;
        shade.all.specular += of->specular * lit.seen[half] / seen;
    }
    return shade;
}

#endif
