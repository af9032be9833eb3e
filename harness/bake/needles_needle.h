/* One needle: a long cylinder, lit by one direction and seen from another. */
#ifndef TREELINE_BAKE_NEEDLES_NEEDLE_H
#define TREELINE_BAKE_NEEDLES_NEEDLE_H

/* A light and an eye, made once by needles_sight_of. */
struct needles_sight {
    real light[3], eye[3];
    real exponent;  /* of (N.H), 0..10,000; below 0: no specular wanted, it is 0 */
    bool two_sided; /* the diffuse part is |N.L|, not max(N.L, 0): leaves that let light through */
    real cross[3];  /* light x eye */
    real half[3];   /* H, unit; 0 where the light is opposite to the eye */
    real half_dot;  /* H.V = H.L */
    real lobe;      /* sqrt(2 pi / (n + 1.5)) / (2 erf k) */
    real lobe_k;    /* k = sqrt((n + 1.5) / 2) */
};

/* What is seen of a needle: means over its visible area. */
struct needles_shine {
    real seen;     /* sine between needle and eye: its area is 2 r l of it */
    real diffuse;  /* of N.L, 0..pi/4 */
    real specular; /* of (N.H)^n where N.L > 0, 0..1 */
};

/* What a pixel gets of something: its mean reflectances and the share of the pixel that it covers.
 */
struct needles_shade {
    real diffuse, specular, opacity;
};

static inline real needles_dot(const real a[3], const real b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline void needles_cross(const real a[3], const real b[3], real cross[3])
{
    cross[0] = a[1] * b[2] - a[2] * b[1];
    cross[1] = a[2] * b[0] - a[0] * b[2];
    cross[2] = a[0] * b[1] - a[1] * b[0];
}

static inline struct needles_sight needles_sight_of(const real light[3], const real eye[3],
                                                    real exponent, bool two_sided)
{
    struct needles_sight sight = {.exponent = exponent, .two_sided = two_sided};
    real square = 0;
    for (int i = 0; i < 3; i++) {
        sight.light[i] = light[i];
        sight.eye[i] = eye[i];
        sight.half[i] = light[i] + eye[i];
        square += sight.half[i] * sight.half[i];
    }
    needles_cross(light, eye, sight.cross);
    const real length = real_sqrt(square);
    for (int i = 0; i < 3; i++)
        sight.half[i] = square < REAL(1e-12) ? 0 : sight.half[i] / length;
    sight.half_dot = square < REAL(1e-12) ? 0 : length / 2;
    sight.lobe_k = real_sqrt((real_max(exponent, 0) + REAL(1.5)) / 2);
    sight.lobe = REAL(1.25331413731550025) /
                 (real_sqrt(real_max(exponent, 0) + REAL(1.5)) * real_erf(sight.lobe_k));
    return sight;
}

/* sin e - e cos e for e in [0, pi], of any multiple of its sine (>= 0) and cosine: f of (2) where e
 * is pi less the angle between light and eye. 0 and 0 give the mean over all angles. */
static inline real needles_lune(real sine, real cosine)
{
    const real length = real_sqrt(sine * sine + cosine * cosine);
    if (!(length > 0))
        return 4 / REAL_PI;
    const real e = real_atan2(sine, cosine), e2 = e * e;
    if (e < REAL(0.5))
        return e * e2 *
               (1 / REAL(3) -
                e2 * (1 / REAL(30) -
                      e2 * (1 / REAL(840) - e2 * (1 / REAL(45360) - e2 / REAL(3991680)))));
    return (sine - e * cosine) / length;
}

/* (2): s_l/4 f(D). across_light, across_eye: the axis x light, x eye. */
static inline real needles_diffuse(const real axis[3], const struct needles_sight *sight,
                                   const real across_light[3], const real across_eye[3])
{
    const real lit = real_sqrt(needles_dot(across_light, across_light));
    const real sine = real_abs(needles_dot(axis, sight->cross));
    const real cosine = needles_dot(across_light, across_eye);
    const real front = needles_lune(sine, -cosine);
    return lit / 4 * (sight->two_sided ? front + needles_lune(sine, cosine) : front);
}

/* sin^power of an angle of a small cosine. */
static inline real needles_sine_power(real cosine, real power)
{
    const real square = cosine * cosine;
    return square < 1 ? real_exp(power / 2 * real_log1p(-square)) : 0;
}

/* (3) on the lit side, N.L > 0 and N.V > 0: s_h^n J / 2. J is exact but for the incomplete beta
 * functions, which are error functions here (error of R_s at most 0.026 at n = 1, 0.0055 at 20).
 * across_light, across_eye: the axis x light, x eye. */
static inline real needles_specular(const real axis[3], const struct needles_sight *sight,
                                    const real across_light[3], const real across_eye[3])
{
    const real n = sight->exponent, along = needles_dot(axis, sight->half);
    real across[3];
    needles_cross(axis, sight->half, across);
    const real sh2 = needles_dot(across, across), dot = sight->half_dot;
    if (!(sh2 > REAL(1e-24)) || !(needles_dot(across_eye, across_eye) > 0) ||
        !(needles_dot(across_light, across_light) > 0))
        return 0;
    /* Angles of the projections of eye and light to that of H, by what both sines have in common.
     */
    const real sine = real_abs(needles_dot(axis, sight->cross)) / (2 * dot);
    const real cosines[2] = {needles_dot(across_eye, across), needles_dot(across_light, across)};
    real cosine[2], power[2], sine_eye = 1;
    for (int i = 0; i < 2; i++) {
        const real length = real_sqrt(sine * sine + cosines[i] * cosines[i]);
        cosine[i] = length > 0 ? cosines[i] / length : 0;
        sine_eye = i == 0 && length > 0 ? sine / length : sine_eye;
        power[i] = needles_sine_power(cosine[i], n + 1);
    }
    const real k = sight->lobe_k;
    const real lobe =
        cosine[0] * sight->lobe * (real_erf(k * cosine[0]) + real_erf(k * cosine[1])) +
        sine_eye * (power[0] - power[1]) / (n + 1);
    const real glare =
        along * along < REAL(0.5) ? needles_sine_power(along, n) : real_exp(n / 2 * real_log(sh2));
    return real_min(real_max(lobe, 0) / 2 * glare, 1);
}

/* axis: unit. */
static inline struct needles_shine needles_reflect(const real axis[3],
                                                   const struct needles_sight *sight)
{
    real across_light[3], across_eye[3];
    needles_cross(axis, sight->light, across_light);
    needles_cross(axis, sight->eye, across_eye);
    struct needles_shine shine = {.seen = real_sqrt(needles_dot(across_eye, across_eye))};
    shine.diffuse = needles_diffuse(axis, sight, across_light, across_eye);
    if (sight->exponent >= 0)
        shine.specular = needles_specular(axis, sight, across_light, across_eye);
    return shine;
}

/* A capped needle in a pixel that holds it. section_m2: the pixel's section there, above 0. (5)
 * and, of a needle seen along its axis, its end, which has no highlight. */
static inline struct needles_shade needles_needle_shade(const real axis[3], real length_m,
                                                        real radius_m,
                                                        const struct needles_sight *sight,
                                                        real section_m2)
{
    const struct needles_shine shine = needles_reflect(axis, sight);
    const real eye = needles_dot(axis, sight->eye), light = needles_dot(axis, sight->light);
    const real side = 2 * radius_m * length_m * shine.seen;
    const real end = REAL_PI * radius_m * radius_m * real_abs(eye);
    const real facing = eye < 0 ? -light : light;
    const real area = real_max(side + end, REAL(1e-30));
    return (struct needles_shade){
        .diffuse = (side * shine.diffuse +
                    end * (sight->two_sided ? real_abs(light) : real_max(facing, 0))) /
                   area,
        .specular = side * shine.specular / area,
        .opacity = real_min((side + end) / section_m2, 1),
    };
}

#endif
