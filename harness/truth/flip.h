/* FLIP and HDR-FLIP: the difference that a person sees who flips between two pictures.
 *
 * Andersson, Nilsson, Akenine-Moller, Oskarsson, Astrom, Fairchild: FLIP: A Difference Evaluator
 * for Alternating Images, HPG 2020, doi:10.1145/3406183. Andersson, Nilsson, Shirley,
 * Akenine-Moller: Visualizing Errors in Rendered High Dynamic Range Images, Eurographics 2021,
 * doi:10.2312/egs.20211015. Conventions of the authors' version 1.6: 67 pixels a degree, borders
 * replicated, D65 white, constants q_c .7, p_c .4, p_t .95, w .082 degrees, q_f .5. */
#ifndef TREELINE_TRUTH_FLIP_H
#define TREELINE_TRUTH_FLIP_H

#include "base/arena.h"
#include "truth/filter.h"

/* Linear RGB by planes, each height x width. */
struct rgb_planes {
    float *channels[3];
};
struct rgb_planes rgb_planes_create(struct arena *arena, struct extent extent);

/* What FLIP compares of one picture; made once for each picture, however many it is compared with.
 */
struct flip_features {
    float *lab[3]; /* filtered by the contrast sensitivity of the eye, CIELab, Hunt-adjusted */
    float *edges, *points; /* magnitudes of the first and second derivatives of luminance */
};
/* picture: linear RGB in [0, 1]. */
struct flip_features flip_features(struct arena *arena, const struct rgb_planes *picture,
                                   struct extent extent);
/* The map, height x width in [0, 1]; symmetric in a and b. */
void flip_map(const struct flip_features *a, const struct flip_features *b, struct extent extent,
              float *map);

/* Exposures of HDR-FLIP, in stops: count of them evenly from first to last. */
struct exposures {
    double first, last;
    int count;
};
/* From the reference (linear RGB, any range): the brightest pixel's luminance, then the median's,
 * is tone-mapped to .85; one exposure a stop, at least 2. Departures: the median counts as at least
 * 2^-16 of the brightest (a mostly black picture would need endless exposures); a black picture
 * gets exposure 0; equal ends are one exposure. */
struct exposures hdr_flip_exposures(const struct rgb_planes *reference, struct extent extent);
/* One exposure of a picture through the ACES curve (Narkowicz's fit, without its pre-exposure),
 * clamped to [0, 1]; negative values count as 0. */
void hdr_flip_expose(const struct rgb_planes *picture, struct extent extent, double stops,
                     const struct rgb_planes *out);

#endif
