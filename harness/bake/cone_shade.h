/* Needles, cones of needles and twigs as strips want them, by the shaders of bake/needles.h: exact,
 * or as the paper prints them, clamped to what is physical. Directions are unit; z is along a twig.
 */
#ifndef TREELINE_BAKE_CONE_SHADE_H
#define TREELINE_BAKE_CONE_SHADE_H

#include "bake/needles.h"

enum cone_shaders { CONE_EXACT, CONE_PAPER };

/* (2) and (4), of a needle along a unit axis. */
struct needles_shine cone_needle_shine(enum cone_shaders shaders, const float axis[3],
                                       const struct needles_sight *sight);

/* (6) to (11), of a cone's needles: means over the half nearer to the eye and the other one. */
struct cone_halves {
    float seen[2];                 /* mean of the sine between needle and eye, of each half */
    struct needles_shade shade[2]; /* of what is seen of each */
};
struct cone_halves cone_halves_of(enum cone_shaders shaders, const struct needles_twig *twig,
                                  const struct needles_sight *sight);

/* Share of its outline that a sheet of needles covers, of their area over the outline's. */
float cone_sheet_opacity(enum cone_shaders shaders, float depth);

/* (14) to (21): shares of a twig's width that are seen and lit. The disc's depths by the paper are
 * those of (19), and what it says of a light is left out where nothing shades. */
void cone_paper_disc(const struct needles_twig *twig, const struct needles_sight *sight,
                     struct needles_disc *disc);
struct needles_lit cone_disc_lit(enum cone_shaders shaders, const struct needles_disc *disc,
                                 bool shaded);

#endif
