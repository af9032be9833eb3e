/* The normals of a voxel known by their mean alone.
 *
 * Leaves have two sides, so normals are turned to one side of their principal axis before they are
 * averaged: the mean n lies along it, and its length m is the area that they show along it, per
 * area. By Cauchy's theorem m is in 1/2 (turned everywhere alike) .. 1 (parallel).
 *
 * Of all distributions with that mean we take the normals of the flattened spheroid that shows m
 * along n. It shows sqrt(e2 + (m2 - e2) c2) of its area in a direction that makes the cosine c with
 * n (SGGX, Heitz et al. 2015, doi:10.1145/2766988), e2 being what it shows from the side, squared:
 * Cauchy's mean of 1/2 gives m + e2 / d asinh(d / e) = 1, d2 = m2 - e2. The second moment across n,
 * (E 1 - c2) / 2, follows by quadrature; with it the light of what is seen is voxels.h's. */
#ifndef TREELINE_BAKE_VOXELS_VISIBLE_H
#define TREELINE_BAKE_VOXELS_VISIBLE_H

#include "bake/voxels.h"

/* A voxel's normals, as the march takes them with this model: three times 10 bits from bit 0 on, a
 * coordinate of n is bits / VISIBLE_ZERO - 1. */
enum { VISIBLE_ZERO = 511 };
uint32_t voxel_pack_mean(const float mean[3]);
/* The mean of a voxel's normals from their second moments. */
void voxel_mean_normal(const struct voxel_optics *optics, float mean[3]);

/* Polynomials of 1 - m without a constant term, fitted to the above by least squares over m; they
 * are within .0007 and .0004. */
enum { VISIBLE_TERMS = 4 };
static const float visible_side[VISIBLE_TERMS] = {0.31410408f, 1.05913764f, -2.09424219f,
                                                  1.44762713f};
static const float visible_across[VISIBLE_TERMS] = {0.84429335f, -0.60276692f, 0.85263542f,
                                                    -0.71909882f};

#endif
