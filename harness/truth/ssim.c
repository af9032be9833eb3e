/* Structural similarity. Wang et al. 2004, doi:10.1109/TIP.2003.819861, equation 13. */
#include "truth/ssim.h"

#include <math.h>

enum { RADIUS = 5, WEIGHTS = 2 * RADIUS + 1 };
#define SIGMA_PX 1.5
#define C1 (0.01 * 0.01)
#define C2 (0.03 * 0.03)

static void blur(const double *in, struct extent extent, double *out)
{
    double weights[WEIGHTS], sum = 0;
    for (int k = -RADIUS; k <= RADIUS; k++)
        sum += weights[k + RADIUS] = exp(-k * k / (2 * SIGMA_PX * SIGMA_PX));
    for (int k = 0; k < WEIGHTS; k++)
        weights[k] /= sum;
    struct kernel kernel = {RADIUS, weights, BORDER_MIRROR};
    struct arena *scratch = arena_create(0);
    double *rows = ARENA_ARRAY(scratch, double, extent_count(extent));
    filter_rows(in, extent, &kernel, rows);
    filter_columns(rows, extent, &kernel, out);
    arena_destroy(scratch);
}

/* Local mean of a b; of a where b is NULL. */
static void blur_product(const float *a, const float *b, struct extent extent, double *out)
{
    struct arena *scratch = arena_create(0);
    size_t count = extent_count(extent);
    double *product = ARENA_ARRAY(scratch, double, count);
    for (size_t i = 0; i < count; i++)
        product[i] = (double)a[i] * (b ? (double)b[i] : 1);
    blur(product, extent, out);
    arena_destroy(scratch);
}

struct ssim_features ssim_features(struct arena *arena, const float *luma, struct extent extent)
{
    size_t count = extent_count(extent);
    struct ssim_features features = {luma, ARENA_ARRAY(arena, double, count),
                                     ARENA_ARRAY(arena, double, count)};
    blur_product(luma, NULL, extent, features.mean);
    blur_product(luma, luma, extent, features.square);
    return features;
}

static double similarity(double mean_a, double mean_b, double square_a, double square_b,
                         double product)
{
    double variance_a = square_a - mean_a * mean_a, variance_b = square_b - mean_b * mean_b;
    double covariance = product - mean_a * mean_b;
    return (2 * mean_a * mean_b + C1) * (2 * covariance + C2) /
           ((mean_a * mean_a + mean_b * mean_b + C1) * (variance_a + variance_b + C2));
}

double ssim_mean(const struct ssim_features *a, const struct ssim_features *b, struct extent extent)
{
    struct arena *scratch = arena_create(0);
    double *product = ARENA_ARRAY(scratch, double, extent_count(extent));
    blur_product(a->luma, b->luma, extent, product);
    int margin = extent.width_px > 2 * RADIUS && extent.height_px > 2 * RADIUS ? RADIUS : 0;
    double sum = 0;
    for (int y = margin; y < extent.height_px - margin; y++)
        for (int x = margin; x < extent.width_px - margin; x++) {
            size_t i = (size_t)y * (size_t)extent.width_px + (size_t)x;
            sum += similarity(a->mean[i], b->mean[i], a->square[i], b->square[i], product[i]);
        }
    arena_destroy(scratch);
    return sum / ((double)(extent.width_px - 2 * margin) * (extent.height_px - 2 * margin));
}
