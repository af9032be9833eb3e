/* The error of a method's shadows alone: its shadow mask against the ray-traced one. */
#ifndef TREELINE_TRUTH_MASK_H
#define TREELINE_TRUTH_MASK_H

#include "truth/metrics.h"

/* Masks are pictures as scene/effects.h defines them: a pixel's red over its green is v, the sun's
 * mean visibility on what the pixel sees. A pixel is judged where both see a
 * surface: where either green is at least 1/2. N pixels are judged; d = v_test - v_truth, in [-1,
 * 1].
 *
 * - wrong: mean |d|: the share of the surface that is in the wrong state. Of two states alone it is
 *   the fraction of wrong pixels.
 * - leak, acne: means of max(0, d) and max(0, -d); their sum is wrong. Light that leaks under a
 *   caster (a detached shadow, "Peter Pan") is leak; a lit surface that shades itself is acne.
 * - stray: sum of |d| over pixels that are more than 2 px from the truth's nearest edge, over N.
 *   What a coarse map blurs or steps is near an edge; what a wrong bias does is not.
 * - edge_px: mean of the distance to the truth's nearest edge, weighted by |d|; NaN where nothing
 *   is wrong or the truth has no edge. An edge lies halfway between neighbours whose v is on either
 *   side of 1/2, and in a pixel whose v is within 0.05..0.95. Exact Euclidean (Felzenszwalb and
 *   Huttenlocher 2012, doi:10.4086/toc.2012.v008a019).
 * - floor: what a perfect mask would have as wrong by the truth's noise: mean sqrt(2 V / pi), V the
 *   variance of the truth's red.
 * - judged: N over the number of pixels whose green is at least 1/2 in the truth.
 * - dark: mean of 1 - v_truth.
 * - shimmer: of two frames of a path, mean |(v' - v)_test - (v' - v)_truth| over pixels judged in
 *   both; NaN without a second frame. A mask that stands still on what it falls on has none. */
/* X(field, word, better, unit, doc): the order of the results' columns. */
#define MASK_LIST(X)                                                                               \
    X(wrong, "mask-wrong", -1, "", "share of the surface whose shadow is wrong")                   \
    X(leak, "mask-leak", -1, "", "the part that is lit and should be dark")                        \
    X(acne, "mask-acne", -1, "", "the part that is dark and should be lit")                        \
    X(stray, "mask-stray", -1, "", "the part more than 2 px from every true edge of a shadow")     \
    X(edge_px, "mask-edge", -1, "px", "mean distance of what is wrong to the true edge, px")       \
    X(floor, "mask-floor", -1, "", "wrong share that the reference's noise alone would give")      \
    X(judged, "mask-judged", +1, "", "share of the reference's surface that was compared")         \
    X(dark, "mask-dark", 0, "", "the truth's share of shadow")                                     \
    X(shimmer, "mask-shimmer", -1, "", "wrong change of the mask from frame to frame")

struct mask_error {
#define MASK_FIELD(field, word, better, unit, doc) double field;
    MASK_LIST(MASK_FIELD)
#undef MASK_FIELD
};
extern const struct metric_info mask_table[]; /* ends with a NULL field */
double mask_of(const struct mask_error *mask, const struct metric_info *info);

/* All but shimmer, which becomes NaN; all NaN but judged where no pixel can be judged.
 * STATUS_INVALID unless of one size; STATUS_BAD_PICTURE where frame_check refuses one. */
enum status mask_compare(const struct frame *test, const struct frame *truth,
                         struct mask_error *mask, struct error *error);

/* shimmer of two successive frames: of the test, of the truth. Errors as of mask_compare. */
enum status mask_shimmer(const struct frame *const tests[2], const struct frame *const truths[2],
                         double *shimmer, struct error *error);

#endif
