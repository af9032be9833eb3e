/* The effects a scene may ask for and a method may model. Light transport is defined here, once.
 *
 * Radiance toward the eye of a surface point of albedo a (linear RGB), unit normal N, unit
 * directions L to the sun and V to the eye:
 *
 *     C = a * (sun * D * S + ambient * O) + sun * G * S
 *
 * sun:     scene.sun.radiance, the radiance of a white Lambert surface that faces the sun
 * (irradiance / pi). ambient: scene.ambient, the radiance of a white Lambert surface under the open
 * sky (irradiance / pi); only with EFFECT_AMBIENT, else 0. D:       bark, terrain: max(0, N.L), N
 * turned to the eye's side (N.V >= 0). leaf with EFFECT_TWO_SIDED: |N.L| (Senegas 2001, 5.5:
 * max(N.L, -N.L)). leaf without, and a conifer's needle, which is solid: max(0, N.L), N turned to
 * the eye's side. The geometric normal decides which side the eye is on; the shading normal is
 * turned with it. S:       1, or with EFFECT_SUN_SHADOWS the visibility of the sun (a point light
 * at infinity), 0 or 1. O:       1, or with EFFECT_SKY_OCCLUSION the cosine-weighted visible part
 * of the hemisphere around N. G:       0, or with EFFECT_SPECULAR of a conifer's needle s (N.H)^n
 * where N.L > 0: its specular and exponent (plant/conifer.h), H the unit vector between L and V.
 * Fog (EFFECT_FOG): f C + (1 - f) fog.color, f = exp(-fog.density_per_m * distance to the eye); the
 * sky is not fogged. Sky: sky_radiance() in scene.h.
 *
 * The shadow mask is a picture of its own, for the error of shadows alone: a surface is (lit, 1,
 * 0), lit 1 where the sun's light arrives (D > 0 and S = 1) and 0 elsewhere; the sky is (0, 0, 0).
 * So a pixel's red over its green is the sun's mean visibility there. Alpha as ever.
 *
 * A pixel is the mean over its square (box filter, 1 px). Alpha is the fraction of the pixel where
 * a plant is the first thing seen. Everything is linear RGB; alpha-tested texels are opaque from
 * 0.5 on. */
#ifndef TREELINE_SCENE_EFFECTS_H
#define TREELINE_SCENE_EFFECTS_H

/* X(NAME, bit, word, meaning) */
#define EFFECT_LIST(X)                                                                             \
    X(EFFECT_TWO_SIDED, 1u << 0, "two-sided", "leaves are lit the same on both sides, |N.L|")      \
    X(EFFECT_AMBIENT, 1u << 1, "ambient", "constant light of the sky")                             \
    X(EFFECT_SUN_SHADOWS, 1u << 2, "sun-shadows", "plants and terrain shade the sun")              \
    X(EFFECT_SKY_OCCLUSION, 1u << 3, "sky-occlusion", "plants and terrain hide the sky's light")   \
    X(EFFECT_FOG, 1u << 4, "fog", "homogeneous fog, Beer-Lambert")                                 \
    X(EFFECT_SPECULAR, 1u << 5, "specular", "needles shine by Blinn's lobe")

enum {
#define EFFECT_ENUM(name, bit, word, meaning) name = bit,
    EFFECT_LIST(EFFECT_ENUM)
#undef EFFECT_ENUM
        EFFECTS_ALL = (1u << 6) - 1
};

#endif
