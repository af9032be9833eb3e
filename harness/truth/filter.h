/* Separable convolution of single planes, in double precision: what is compared with SSIM and FLIP
 * is often a small difference of sums, or the square root of one. */
#ifndef TREELINE_TRUTH_FILTER_H
#define TREELINE_TRUTH_FILTER_H

#include <stddef.h>

struct extent {
    int width_px, height_px;
};

/* What stands outside a plane: the nearest pixel, or the plane mirrored with its edge pixel
 * repeated. */
enum border { BORDER_REPLICATE, BORDER_MIRROR };

struct kernel {
    int radius_px;
    const double *weights; /* 2 radius_px + 1 */
    enum border border;
};

static inline size_t extent_count(struct extent extent)
{
    return (size_t)extent.width_px * (size_t)extent.height_px;
}

/* out(x, y) = sum over k of weights[k] in(x + k - radius, y); columns: the same along y. in, out:
 * height x width, not the same memory. Deterministic, whatever the number of threads. */
void filter_rows(const double *in, struct extent extent, const struct kernel *kernel, double *out);
void filter_columns(const double *in, struct extent extent, const struct kernel *kernel,
                    double *out);

#endif
