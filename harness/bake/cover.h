/* How much of its surroundings a plant covers, and a run of its pruned elements: the union of their
 * triangles as seen from far away, on a grid of samples from five sides.
 *
 * Area alone does not keep a crown's look (Cook et al. 2007, 3.2): leaves hang in clumps and hide
 * each other, while few and large ones spread, so that the same area covers more. The size at which
 * a run covers what the plant does is found by trying. */
#ifndef TREELINE_BAKE_COVER_H
#define TREELINE_BAKE_COVER_H

#include "bake/detail.h"
#include "bake/prune.h"

struct cover;

struct cover *cover_create(struct arena *arena, const struct mesh *mesh,
                           const struct detail *detail);

/* From where what follows is looked at: an elevation, 0 level, pi/2 straight down. margin_m: how
 * far beyond the plant its elements may reach. */
void cover_look(struct cover *cover, float elevation_rad, float margin_m);

/* Square metres that all triangles of level 0 cover, the mean of the sides. */
double cover_plant(struct cover *cover);

/* `kept` elements from `begin` on (around the end) as prune.h and triangles.glsl scale them; bark
 * at least as wide as `stout` is drawn whole, at a level, instead of the run's own. */
struct cover_run {
    const struct prune *prune;
    uint32_t begin;
    float kept, growth, taper;
    uint32_t bark;
    uint16_t stout;
};
double cover_of_run(struct cover *cover, const struct cover_run *run);

#endif
