/* Between metrics.c and the two families of metrics. */
#ifndef TREELINE_TRUTH_COMPARE_H
#define TREELINE_TRUTH_COMPARE_H

#include "truth/metrics.h"

/* Variance of the difference of value i of two pictures of one size. */
static inline double compare_variance(const struct frame *a, const struct frame *b, size_t i)
{
    return (a->variance ? (double)a->variance[i] : 0) + (b->variance ? (double)b->variance[i] : 0);
}

/* rmse, mae, relmse, coverage, coverage-bias, mean-color, rmse-2, -4, -8: value, raw and floor. */
void compare_pixels(const struct frame *test, const struct frame *reference,
                    struct comparison *comparison);

/* psnr, ssim, flip, hdr-flip: value, raw and floor. map: height x width, or NULL. */
void compare_display(const struct frame *test, const struct frame *reference,
                     struct comparison *comparison, float *map);

#endif
