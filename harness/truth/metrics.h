/* Image metrics: each defined once, with its domain, its noise correction and its source. */
#ifndef TREELINE_TRUTH_METRICS_H
#define TREELINE_TRUTH_METRICS_H

#include "truth/frame.h"

/* X(field, word, better, domain, doc): the order of `treeline diff` and of the results columns.
 * better: -1 lower, +1 higher. domain: "linear" or "display" (sRGB, clamped to [0, 1]). */
#define METRIC_LIST(X)                                                                             \
    X(rmse, "rmse", -1, "linear", "root mean square error over RGB")                               \
    X(mae, "mae", -1, "linear", "mean absolute error over RGB")                                    \
    X(relmse, "relmse", -1, "linear", "relative mean square error, (a-b)^2 / (b^2 + 0.01)")        \
    X(psnr_db, "psnr", +1, "display", "peak signal to noise ratio, peak 1, dB")                    \
    X(ssim, "ssim", +1, "display", "structural similarity of luma, Gaussian 11 x 11, sigma 1.5")   \
    X(flip, "flip", -1, "display", "FLIP, mean of the error map, 67 pixels a degree")              \
    X(hdr_flip, "hdr-flip", -1, "linear", "HDR-FLIP, mean of the error map over exposures")        \
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

/* value: corrected for the noise of both pictures where a correction is known (squared errors: the mean
 * variance is subtracted and the result kept at >= 0); raw: as measured; floor: what two perfect pictures with this
 * noise would give (the value expected of pure noise). */
struct comparison {
    struct metrics value, raw, floor;
};

/* test against reference, both linear RGB. STATUS_INVALID unless of one size. NaN in a picture gives
 * STATUS_BAD_PICTURE. flip_map: height x width, FLIP in [0, 1]; NULL: not wanted. */
enum status metrics_compare(struct arena *arena, const struct frame *test,
                            const struct frame *reference, struct comparison *comparison,
                            float **flip_map, struct error *error);

/* Flicker of a path: frames a[0..n), reference b[0..n). Error of the frame-to-frame change, RMSE over RGB and
 * pairs of ((a[k+1]-a[k]) - (b[k+1]-b[k])), its largest pair (popping), noise corrected. n < 2 gives zeros. */
struct flicker {
    double mean, peak, floor;
    size_t peak_frame; /* the later frame of the worst pair */
};
enum status metrics_flicker(struct arena *arena, const struct frame *const *frames,
                            const struct frame *const *references, size_t count,
                            struct flicker *flicker, struct error *error);

/* Linear to display and back, sRGB (IEC 61966-2-1), clamped. */
float srgb_encode(float linear);
float srgb_decode(float display);

#endif
