/* Light and opacity of needles, cones and twigs in single precision: Hattab, Babahenini and Djedi,
 * after Meyer and Neyret 2000, with the paper's integrals mended where its closed forms fail (the
 * numbers of equations are the paper's). Directions are unit, in the twig's axes: z along it. */
#ifndef TREELINE_BAKE_CONE_SHADE_H
#define TREELINE_BAKE_CONE_SHADE_H

#include <stdbool.h>

/* Of what is seen: the mean over its area of N.L where lit, and of (N.H)^n there. */
struct cone_shine {
    float diffuse, gloss;
};

/* What lights and looks. */
struct cone_sight {
    float sun[3], eye[3];
    bool two_sided; /* |N.L| */
    float exponent; /* of the gloss; 0: none wanted */
};

/* Eq 2 and 4, of a needle along a unit axis. Its angle to the eye may be 0. */
struct cone_shine cone_needle_shine(const float axis[3], const struct cone_sight *sight);

/* Needles around the axis at an angle, as they are seen (Eq 6 to 11) by means over the half nearer
 * to the eye and the other one. */
struct cone_halves {
    float seen[2];              /* mean of the sine between needle and eye, of each half */
    struct cone_shine shine[2]; /* of what is seen of each */
};
struct cone_halves cone_halves_of(float sine, float cosine, const struct cone_sight *sight);

/* Eq 14 on a disc of radius 1: optical depths over a radius, of the half nearer to the eye and of
 * the other one, toward the eye and, each half that is nearer to the sun or not, toward the sun;
 * and the angle between both around the axis. */
struct cone_depths {
    float eye[2], sun[2], cosine, sine;
};
/* Shares of the disc's width that are seen of each half and lit; their sum without shadow. */
struct cone_disc {
    float lit[2], opacity, opacity_front;
};
struct cone_disc cone_disc_of(const struct cone_depths *depths);
/* Optical depth toward the sun from a place in the disc: along the sun's direction and across. */
float cone_disc_depth(const float sun[2], float toward, float aside);

#endif
