/* How a texel that holds many leaves answers to the sun: moments of its normals, packed into four
 * channels.
 *
 * The diffuse term of a texel is the mean over what it shows of w |N.L| + u N.L, N turned to the
 * eye, where (w, u) is (1, 0) for a leaf lit on both sides and (1/2, 1/2) for bark and one-sided
 * leaves, because max(0, x) = (|x| + x) / 2. |N.L| is expanded in Legendre polynomials up to degree
 * 2, |x| ~ 1/2 + 5/8 P2(x) = 3/16 + 15/16 x^2 (the clamped cosine's series, Ramamoorthi and
 * Hanrahan 2001, doi:10.1145/383259.383317, made even); so
 *
 *     D(L) = 3/16 tr M + 15/16 L'ML + 1/2 n.L,   M = mean of w N N',  n = mean of 2 u N
 *
 * is linear in nine moments (M: xx yy zz xy xz yz; n: x y z): filtering them is exact, and one
 * normal alone errs by at most 3/16. The nine are then replaced by their mean and their four
 * principal components over the plant, in the metric "mean square of D over all L", which is what a
 * texel stores. All vectors are in the picture's own axes (right, up, toward the eye). */
#ifndef TREELINE_BAKE_ATLAS_LIGHT_H
#define TREELINE_BAKE_ATLAS_LIGHT_H

#include <stddef.h>

enum { LIGHT_MOMENTS = 9, LIGHT_CHANNELS = 4, LIGHT_TERMS = 10 };

/* Sums over texels, for the mean and the covariance of the moments. Start from zeros. */
struct light_sums {
    double weight, first[LIGHT_MOMENTS], second[LIGHT_MOMENTS][LIGHT_MOMENTS];
};

struct light_basis {
    /* channel k of a texel = 1/2 + encode[k] . (moments - mean), clamped to [0, 1] */
    float mean[LIGHT_MOMENTS];
    float encode[LIGHT_CHANNELS][LIGHT_MOMENTS];
    /* D(L) = row[0] . q + sum over k of channel k * (row[k + 1] . q),
     * q = (1, xx, yy, zz, xy, xz, yz, x, y, z) of L; two zeros of padding */
    float row[1 + LIGHT_CHANNELS][12];
};

/* Adds w N N' and 2 u N of one unit normal, times weight, to moments. one_sided: 0 or 1. */
void light_moments_add(float moments[LIGHT_MOMENTS], const float normal[3], int one_sided,
                       float weight);
void light_sums_add(struct light_sums *sums, const float moments[LIGHT_MOMENTS], double weight);
/* Sums of weight 0 give a basis that answers D = 0. */
void light_basis_fit(const struct light_sums *sums, struct light_basis *basis);
void light_encode(const struct light_basis *basis, const float moments[LIGHT_MOMENTS],
                  float channels[LIGHT_CHANNELS]);

#endif
