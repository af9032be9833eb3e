/* HDR-FLIP: exposures and tone mapping. Andersson et al. 2021, doi:10.2312/egs.20211015. */
#include "truth/flip.h"

#include <math.h>

#define DARKEST_MEDIAN 0x1p-16 /* of the brightest pixel */
#define TARGET .85 /* tone-mapped luminance of the brightest, then of the median pixel */

/* Narkowicz's fit of ACES, (a x^2 + b x) / (c x^2 + d x + e), with x scaled by .6 to undo its
 * exposure. */
static const double aces_a = .36 * 2.51, aces_b = .6 * .03, aces_c = .36 * 2.43, aces_d = .6 * .59,
                    aces_e = .14;

/* The input that the curve maps to TARGET: the positive root of a quadratic. */
static double curve_inverse(void)
{
    double a = aces_a - TARGET * aces_c, b = aces_b - TARGET * aces_d, c = -TARGET * aces_e;
    return (-b + sqrt(b * b - 4 * a * c)) / (2 * a);
}

/* The value that would stand at index rank if values were sorted (Hoare 1961). values is reordered.
 */
static float select_rank(float *values, size_t count, size_t rank)
{
    size_t low = 0, high = count - 1;
    while (low < high) {
        float pivot = values[low + (high - low) / 2];
        size_t i = low, j = high;
        for (;;) {
            while (values[i] < pivot)
                i++;
            while (values[j] > pivot)
                j--;
            if (i >= j)
                break;
            float swap = values[i];
            values[i++] = values[j];
            values[j--] = swap;
        }
        /* values[low..j] <= pivot <= values[j + 1..high] */
        if (rank <= j)
            high = j;
        else
            low = j + 1;
    }
    return values[rank];
}

struct exposures hdr_flip_exposures(const struct rgb_planes *reference, struct extent extent)
{
    struct arena *scratch = arena_create(0);
    size_t count = extent_count(extent);
    float *luminance = ARENA_ARRAY(scratch, float, count);
    float *const *rgb = reference->channels;
    double brightest = 0;
    for (size_t i = 0; i < count; i++) {
        luminance[i] = 0.2126f * rgb[0][i] + 0.7152f * rgb[1][i] + 0.0722f * rgb[2][i];
        brightest = fmax(brightest, (double)luminance[i]);
    }
    double median =
        fmax((double)select_rank(luminance, count, count / 2), DARKEST_MEDIAN * brightest);
    arena_destroy(scratch);
    if (!(brightest > 0x1p-100)) /* black */
        return (struct exposures){0, 0, 1};
    double mapped = curve_inverse();
    struct exposures exposures = {log2(mapped / brightest), log2(mapped / median), 1};
    if (exposures.last > exposures.first)
        exposures.count = (int)fmax(2, ceil(exposures.last - exposures.first));
    return exposures;
}

void hdr_flip_expose(const struct rgb_planes *picture, struct extent extent, double stops,
                     const struct rgb_planes *out)
{
    double scale = exp2(stops);
    for (int c = 0; c < 3; c++) {
        const float *in = picture->channels[c];
        float *mapped = out->channels[c];
#pragma omp parallel for
        for (size_t i = 0; i < extent_count(extent); i++) {
            double x = in[i] > 0 ? (double)in[i] * scale : 0;
            x = x < 1e9 ? x : 1e9;
            double value = (aces_a * x * x + aces_b * x) / (aces_c * x * x + aces_d * x + aces_e);
            mapped[i] = value < 1 ? (float)value : 1.0f;
        }
    }
}
