/* A share of what hides what is behind it. */
#ifndef TREELINE_BAKE_SHARE_H
#define TREELINE_BAKE_SHARE_H

#include <math.h>

/* hides: 0..1 of what is behind. What the share hides, so that it and the rest, one over the other,
 * hide as the whole: transmittances multiply, and the share is of their exponent (Porter and Duff
 * 1984: two halves of a tree over each other, each of half its coverage, would hide less). What
 * hides all is taken as hiding 1 - 1/256, so that it can fade, too, as in stack.glsl. */
static inline float share_hides(float hides, float share)
{
    return 1 - powf(1 - (hides < 255.0f / 256 ? hides : 255.0f / 256), share);
}

#endif
