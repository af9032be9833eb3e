/* Structural similarity of two planes. Wang, Bovik, Sheikh, Simoncelli 2004,
 * doi:10.1109/TIP.2003.819861. */
#ifndef TREELINE_TRUTH_SSIM_H
#define TREELINE_TRUTH_SSIM_H

#include "base/arena.h"
#include "truth/filter.h"

/* What SSIM needs of one picture: luma in [0, 1], its local mean and mean square. */
struct ssim_features {
    const float *luma;
    double *mean, *square;
};
/* luma: height x width, borrowed. */
struct ssim_features ssim_features(struct arena *arena, const float *luma, struct extent extent);

/* Mean SSIM in [-1, 1], 1 for identical pictures. Windows are 11 x 11 Gaussians of sigma 1.5 px,
 * weighted population covariance, K1 .01, K2 .03, range 1. Pictures are mirrored at the border
 * (edge pixel repeated); as in scikit-image, the mean leaves out the 5 pixels whose windows reach
 * over it, unless nothing would be left. */
double ssim_mean(const struct ssim_features *a, const struct ssim_features *b,
                 struct extent extent);

#endif
