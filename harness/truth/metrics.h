/* Image metrics: each defined once, with its domain, its noise correction and its source. */
#ifndef TREELINE_TRUTH_METRICS_H
#define TREELINE_TRUTH_METRICS_H

#include "base/color.h"
#include "truth/frame.h"

/* a: the test, b: the reference, both linear RGB with the background in it, N pixels; means and
 * sums are over R, G, B and pixels. "linear" metrics take values of any range as they are,
 * "display" metrics sRGB-encoded values clamped to [0, 1], a' and b' (FLIP: clamped, then in its
 * own space). V is the known variance of a - b at a value: that of both pictures, 0 where a picture
 * has none. raw is the formula; value takes the noise out where that is known, else it is raw;
 * floor is what two perfect pictures with this noise would give.
 *
 * - rmse: sqrt(mean (a-b)^2). value: sqrt(max(0, raw^2 - mean V)); floor: sqrt(mean V).
 * - mae: mean |a-b|. floor: mean sqrt(2 V / pi), as of Gaussian noise.
 * - relmse: mean (a-b)^2 / (b^2 + .01). floor: mean V / (b^2 + .01); value: max(0, raw - floor).
 * - psnr: -10 log10(mean (a'-b')^2), 100 at most (identical pictures). V' is each picture's
 * variance times its squared slope of the sRGB curve, to first order, 0 where it is clipped. value:
 * mean V' subtracted; floor: -10 log10(mean V').
 * - ssim: mean structural similarity of luma .2126 R' + .7152 G' + .0722 B'; see truth/ssim.h.
 * - flip, hdr-flip: the mean of the map; see truth/flip.h.
 * - coverage: mean |A_a - A_b| over pixels. floor: mean sqrt(2 V / pi).
 * - coverage-bias: mean A_a - A_b; above 0 the test covers more. floor: sqrt(sum V) / N, its
 *   standard deviation (its expectation is 0).
 * - mean-color: length of the RGB vector mean a - mean b. floor: sqrt(sum V) / N; value:
 *   sqrt(max(0, raw^2 - floor^2)).
 * - rmse-2, -4, -8: rmse of the means over boxes of 2 x 2, 4 x 4, 8 x 8 pixels, from the top left
 *   corner; a box that the border cuts is the mean of what it has and counts by its pixels. Noise
 * as for rmse, with the variance of the boxes' means.
 *
 * ssim, flip and hdr-flip know no correction; their floor compares the reference with itself plus a
 * seeded normal deviate a pixel, the same for R, G and B (a ray tracer's noise is mostly one of
 * brightness), times sqrt(V). Noise of different pixels is taken as independent. */
/* X(field, word, better, domain, doc): the order of `treeline diff` and of the results columns.
 * better: -1 lower, +1 higher, 0 nearer to zero. domain: "linear" or "display". */
#define METRIC_LIST(X)                                                                             \
    X(rmse, "rmse", -1, "linear", "root mean square error over RGB")                               \
    X(mae, "mae", -1, "linear", "mean absolute error over RGB")                                    \
    X(relmse, "relmse", -1, "linear", "relative mean square error, (a-b)^2 / (b^2 + 0.01)")        \
    X(psnr_db, "psnr", +1, "display", "peak signal to noise ratio, peak 1, dB, at most 100")       \
    X(ssim, "ssim", +1, "display", "structural similarity of luma, Gaussian 11 x 11, sigma 1.5")   \
    X(flip, "flip", -1, "display", "FLIP, mean of the error map, 67 pixels a degree")              \
    X(hdr_flip, "hdr-flip", -1, "linear", "HDR-FLIP, mean of the map's maximum over exposures")    \
    X(coverage, "coverage", -1, "linear", "mean absolute error of the plants' coverage (alpha)")   \
    X(coverage_bias, "coverage-bias", 0, "linear", "mean signed error of the plants' coverage")    \
    X(mean_color, "mean-color", -1, "linear", "length of the difference of the two mean colours")  \
    X(rmse_box2, "rmse-2", -1, "linear", "rmse after averaging over 2 x 2 pixels")                 \
    X(rmse_box4, "rmse-4", -1, "linear", "rmse after averaging over 4 x 4 pixels")                 \
    X(rmse_box8, "rmse-8", -1, "linear", "rmse after averaging over 8 x 8 pixels")

struct metrics {
#define METRIC_FIELD(field, word, better, domain, doc) double field;
    METRIC_LIST(METRIC_FIELD)
#undef METRIC_FIELD
};

struct metric_info {
    const char *field, *word, *domain, *doc;
    int better;
    size_t offset; /* in struct metrics */
};
extern const struct metric_info metric_table[]; /* ends with a NULL field */
double metric_of(const struct metrics *metrics, const struct metric_info *info);

/* All metrics of a pair; of exact pictures value is raw and floor is 0 (psnr 100, ssim 1). */
struct comparison {
    struct metrics value, raw, floor;
};

/* test against reference, both linear RGB. STATUS_INVALID unless of one size; STATUS_BAD_PICTURE,
 * naming the picture, the pixel and the value, where frame_check refuses one. flip_map: height x
 * width in the arena, FLIP in [0, 1]; NULL: not wanted. The result does not depend on the number of
 * threads. */
enum status metrics_compare(struct arena *arena, const struct frame *test,
                            const struct frame *reference, struct comparison *comparison,
                            float **flip_map, struct error *error);

/* Flicker of a path: frames a[0..n), references b[0..n), linear RGB. The error of the
 * frame-to-frame change is d = (a[k+1] - a[k]) - (b[k+1] - b[k]). mean: RMS of d over RGB, pixels
 * and pairs; peak: the largest RMS of one pair (popping); both with the mean variance of d, the sum
 * of its four pictures', subtracted before the root (noise of successive frames taken as
 * independent). floor: the root of that mean variance. n < 2 gives zeros. Errors as of
 * metrics_compare, with the frame's number. */
struct flicker {
    double mean, peak, floor;
    size_t peak_frame; /* the later frame of the worst pair */
};
extern const struct metric_info flicker_table[]; /* ends with a NULL field */
enum status metrics_flicker(struct arena *arena, const struct frame *const *frames,
                            const struct frame *const *references, size_t count,
                            struct flicker *flicker, struct error *error);

#endif
