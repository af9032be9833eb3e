/* What one cone of a pixel meets of needles, cones, twigs and bark, as all of them are on the
 * screen: strips, each with a share of what it covers that it hides, and light that changes along
 * it. The footprint of a pixel is a square of 1 px turned to the strip: a strip that crosses a
 * pixel hides its width of it times its opacity, however thin it is. */
#ifndef TREELINE_BAKE_CONE_STRIP_H
#define TREELINE_BAKE_CONE_STRIP_H

#include <math.h>
#include <stdbool.h>

/* Pixels from the first pixel's centre, y down; depths along the view. */
struct cone_strip {
    float from_px[2];
    float along[2]; /* unit, on the screen */
    float length_px;
    float beyond_px[2];   /* longer at both ends, as wide as there: joints */
    float half_px[2];     /* half widths at both ends */
    float depths_m[2];    /* at both ends */
    float depth_m;        /* of all of it, in the order front to back */
    float opacity;        /* of what it covers */
    float shade[3];       /* radiance: by the sky, and fog's */
    float sun[3];         /* by the sun, times lit */
    float lit[2];         /* at both ends */
    float across, toward; /* of a wide cylinder: the sun's direction across the strip (along[]
                             turned by +90 degrees) and toward the eye */
    float round;          /* 0: even across it, mean times the sun; 1: a cylinder's light */
    float mean;
};

/* Overlap of [at - 1/2, at + 1/2] with [low, high]. */
static inline float cone_overlap(float at, float low, float high)
{
    float from = at - 0.5f > low ? at - 0.5f : low, to = at + 0.5f < high ? at + 0.5f : high;
    return to > from ? to - from : 0;
}

/* Where a pixel is on the strip: the share of its length, in 0..1, and across it, px. */
struct cone_place {
    float share, across_px;
};

/* The share of a pixel that the strip hides, in 0..1. */
static inline float cone_strip_hides(const struct cone_strip *strip, float x_px, float y_px,
                                     struct cone_place *place)
{
    float x = x_px - strip->from_px[0], y = y_px - strip->from_px[1];
    float s = x * strip->along[0] + y * strip->along[1];
    float t = y * strip->along[0] - x * strip->along[1];
    float share = strip->length_px > 0 ? s / strip->length_px : 0.5f;
    share = share > 0 ? share < 1 ? share : 1 : 0;
    float half = strip->half_px[0] + share * (strip->half_px[1] - strip->half_px[0]);
    place->share = share;
    place->across_px = t;
    return strip->opacity * cone_overlap(t, -half, half) *
           cone_overlap(s, -strip->beyond_px[0], strip->length_px + strip->beyond_px[1]);
}

/* Sun's light relative to that of a lit white surface that faces it. */
static inline float cone_strip_lit(const struct cone_strip *strip, const struct cone_place *place)
{
    float lit = strip->lit[0] + place->share * (strip->lit[1] - strip->lit[0]);
    if (strip->round <= 0)
        return lit * strip->mean;
    float half = strip->half_px[0] + place->share * (strip->half_px[1] - strip->half_px[0]);
    float u = place->across_px / (half + 1e-6f);
    u = u > -0.97f ? u < 0.97f ? u : 0.97f : -0.97f;
    float facing = u * strip->across + sqrtf(1 - u * u) * strip->toward;
    facing = facing > 0 ? facing : 0;
    return lit * (strip->mean + strip->round * (facing - strip->mean));
}

/* The pixels whose centres it may touch; low above high: none. */
static inline void cone_strip_rect(const struct cone_strip *strip, float low[2], float high[2])
{
    float half = strip->half_px[0] > strip->half_px[1] ? strip->half_px[0] : strip->half_px[1];
    for (int i = 0; i < 2; i++) {
        float d = strip->along[i], across = fabsf(strip->along[1 - i]);
        float a = strip->from_px[i] - d * strip->beyond_px[0];
        float b = strip->from_px[i] + d * (strip->length_px + strip->beyond_px[1]);
        float reach = 0.5f * fabsf(d) + (half + 0.5f) * across;
        low[i] = (a < b ? a : b) - reach;
        high[i] = (a > b ? a : b) + reach;
    }
}

#endif
