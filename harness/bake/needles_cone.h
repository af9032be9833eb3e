/* Needles of one cone: from one point of the twig, all at the angle phi to it. */
#ifndef TREELINE_BAKE_NEEDLES_CONE_H
#define TREELINE_BAKE_NEEDLES_CONE_H

/* A twig's needles, made once by needles_twig_of. */
struct needles_twig {
    real sine, cosine;       /* of phi, in [0, pi] */
    real count;              /* N, of a cone; need not be whole */
    real length_m, radius_m; /* l, r of a needle */
    real spacing_m;          /* dh, from cone to cone */
    real reach_m;            /* R = l sin phi, at least r: the radius of what needles fill */
};

static inline struct needles_twig needles_twig_of(real phi_rad, real count, real length_m,
                                                  real radius_m, real spacing_m)
{
    struct needles_twig twig = {
        real_max(real_sin(phi_rad), 0), real_cos(phi_rad), count, length_m, radius_m, spacing_m, 0};
    twig.reach_m = real_max(length_m * twig.sine, radius_m);
    return twig;
}

/* Bare integrals over the azimuth, of the half of the cone whose needles lean toward the eye [0]
 * and of the other half [1]: of s_v (F), s_v R_d (D), s_v R_s (S); 0..pi each. N r l/pi times them
 * is an area in m2. */
struct needles_sums {
    real seen[2], diffuse[2], specular[2];
};

/* The needle `step` rad of azimuth from where the eye is, or from the opposite. */
static inline void needles_axis(real sine, real cosine, const real eye[3], real step, bool back,
                                real axis[3])
{
    const real flat = real_sqrt(eye[0] * eye[0] + eye[1] * eye[1]);
    const real x = flat > 0 ? eye[0] / flat : 1, y = flat > 0 ? eye[1] / flat : 0;
    const real c = back ? -real_cos(step) : real_cos(step), s = real_sin(step);
    axis[0] = sine * (x * c - y * s);
    axis[1] = sine * (y * c + x * s);
    axis[2] = cosine;
}

/* F alone, (10): 2 nodes a quarter, relative error below 0.01. direction: of an eye or a light. */
static inline void needles_cone_seen(real sine, real cosine, const real direction[3], real seen[2])
{
    const struct needles_nodes nodes = needles_nodes_of(2);
    for (int back = 0; back < 2; back++) {
        seen[back] = 0;
        for (int i = 0; i < 2; i++) {
            real axis[3], across[3];
            needles_axis(sine, cosine, direction, REAL_PI / 2 * nodes.at[i], back, axis);
            needles_cross(axis, direction, across);
            seen[back] += REAL_PI / 2 * real_sqrt(needles_dot(across, across));
        }
    }
}

/* (6), (8) of some nodes on a quarter, as means over [from, to] of it. */
static inline void needles_cone_panel(real sine, real cosine, const struct needles_sight *sight,
                                      int count, real from, real to, struct needles_sums *sums)
{
    const struct needles_nodes nodes = needles_nodes_of(count);
    for (int i = 0; i < 4 * count; i++) {
        const int back = i & 1;
        const real step = REAL_PI / 2 * (from + (to - from) * nodes.at[i / 4]);
        const real weight = REAL_PI / 2 * (to - from) * nodes.weights[i / 4];
        real axis[3];
        needles_axis(sine, cosine, sight->eye, i & 2 ? -step : step, back, axis);
        const struct needles_shine shine = needles_reflect(axis, sight);
        sums->seen[back] += weight * shine.seen;
        sums->diffuse[back] += weight * shine.seen * shine.diffuse;
        sums->specular[back] += weight * shine.seen * shine.specular;
    }
}

/* Mean errors 0.003 of F, 0.007 of D, 0.012 of S. */
static inline struct needles_sums needles_cone_sums(real sine, real cosine,
                                                    const struct needles_sight *sight)
{
    struct needles_sums sums = {{0, 0}, {0, 0}, {0, 0}}, gloss = sums;
    const real wanted = real_ceil(REAL(0.8) * real_sqrt(real_max(sight->exponent, 0)));
    const int count = wanted > 2 ? (int)real_min(wanted, 256) : 2;
    struct needles_sight plain = *sight;
    plain.exponent = count > 2 ? -1 : sight->exponent;
    needles_cone_panel(sine, cosine, &plain, 2, 0, 1, &sums);
    if (count == 2)
        return sums;
    const int panels = (count + 7) / 8;
    for (int i = 0; i < panels; i++)
        needles_cone_panel(sine, cosine, sight, (count + panels - 1) / panels,
                           REAL(i) / REAL(panels), REAL(i + 1) / REAL(panels), &gloss);
    sums.specular[0] = gloss.specular[0];
    sums.specular[1] = gloss.specular[1];
    return sums;
}

/* Mean reflectances of a half; never more than its needles'. */
static inline struct needles_shade needles_half_shade(const struct needles_sums *sums, int half)
{
    const real seen = real_max(sums->seen[half], REAL(1e-12));
    return (struct needles_shade){real_min(sums->diffuse[half] / seen, 1),
                                  real_min(sums->specular[half] / seen, 1), 0};
}

/* What a cone covers, in units of l^2, where needles hide one another. The outline of a cone is
 * that of two sheets, the near one inside of the far one: their limit is at the azimuth `limit_rad`
 * from the eye's. */
struct needles_cover {
    real limit_rad;
    real footprint[2]; /* of the smaller sheet, of the larger one */
    real area[2];      /* sections of the needles of each */
    real random;       /* covered where azimuths are random */
    real regular;      /* where they are 2 pi/N apart */
};

static inline real needles_mean_sine(const struct needles_twig *twig, const real eye[3], real from,
                                     real to)
{
    const struct needles_nodes nodes = needles_nodes_of(6);
    real sum = 0;
    for (int i = 0; i < 6; i++) {
        real axis[3], across[3];
        needles_axis(twig->sine, twig->cosine, eye, from + (to - from) * nodes.at[i], false, axis);
        needles_cross(axis, eye, across);
        sum += nodes.weights[i] * real_sqrt(needles_dot(across, across));
    }
    return sum;
}

/* Footprints of the nearer sheet and the farther one; returns the azimuth of their limit. */
static inline real needles_cone_sheets(const struct needles_twig *twig, const real eye[3],
                                       real footprints[2])
{
    const real flat = real_sqrt(eye[0] * eye[0] + eye[1] * eye[1]);
    const real p = real_abs(twig->cosine) * flat;
    const real k = (twig->cosine < 0 ? -twig->sine : twig->sine) * eye[2];
    const real square = (p - k) * (p + k), height = square > 0 ? real_sqrt(square) : 0;
    /* sin e - e cos e, of e the limit or pi less it, times p where that is not all of a circle. */
    footprints[0] =
        twig->sine * (height > 0 ? p * needles_lune(height / p, k / p) : real_max(-k, 0) * REAL_PI);
    footprints[1] =
        twig->sine * (height > 0 ? p * needles_lune(height / p, -k / p) : real_max(k, 0) * REAL_PI);
    return real_atan2(height, k);
}

static inline struct needles_cover needles_cone_cover(const struct needles_twig *twig,
                                                      const real eye[3])
{
    real footprints[2];
    const real limit = needles_cone_sheets(twig, eye, footprints);
    const real q = twig->count * twig->radius_m / (REAL_PI * real_max(twig->length_m, REAL(1e-12)));
    struct needles_cover cover = {.limit_rad = limit};
    const real to_limit = 2 * q * limit * needles_mean_sine(twig, eye, 0, limit);
    const real past = 2 * q * (REAL_PI - limit) * needles_mean_sine(twig, eye, limit, REAL_PI);
    const real areas[2] = {to_limit, past};
    const int small = footprints[0] > footprints[1];
    for (int i = 0; i < 2; i++) {
        cover.footprint[i] = footprints[i ^ small];
        cover.area[i] = areas[i ^ small];
    }
    const real s1 = cover.footprint[0], s2 = cover.footprint[1];
    if (!(s2 > REAL(1e-12)))
        return cover;
    const real outer = cover.area[1] / s2;
    const real inner = s1 > REAL(1e-12) ? cover.area[0] / s1 + outer : 0;
    cover.random = s1 * needles_sheet_opacity(inner) + (s2 - s1) * needles_sheet_opacity(outer);
    cover.regular = -s2 * real_expm1(-(cover.area[0] + cover.area[1]) / s2);
    return cover;
}

/* A cone in a pixel that holds it. section_m2: the pixel's section there, above 0. Halves are as
 * bright as their needles and as opaque as these without overlap (11); all has the opacity of
 * needles that hide one another. */
struct needles_cone_shade {
    struct needles_shade halves[2], all;
};

static inline struct needles_cone_shade needles_cone_shade(const struct needles_twig *twig,
                                                           const struct needles_sight *sight,
                                                           bool regular, real section_m2)
{
    const struct needles_sums sums = needles_cone_sums(twig->sine, twig->cosine, sight);
    const struct needles_cover cover = needles_cone_cover(twig, sight->eye);
    const real l2 = twig->length_m * twig->length_m;
    struct needles_cone_shade shade = {{{0, 0, 0}, {0, 0, 0}}, {0, 0, 0}};
    const real all = real_max(sums.seen[0] + sums.seen[1], REAL(1e-12));
    for (int half = 0; half < 2; half++) {
        shade.halves[half] = needles_half_shade(&sums, half);
        shade.halves[half].opacity = real_min(twig->count * twig->radius_m * twig->length_m /
                                                  REAL_PI * sums.seen[half] / section_m2,
                                              1);
    }
    shade.all.diffuse = real_min((sums.diffuse[0] + sums.diffuse[1]) / all, 1);
    shade.all.specular = real_min((sums.specular[0] + sums.specular[1]) / all, 1);
    shade.all.opacity = real_min(l2 * (regular ? cover.regular : cover.random) / section_m2, 1);
    return shade;
}

#endif
