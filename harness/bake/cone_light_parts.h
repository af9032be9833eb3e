/* The two steps of the conifers' light: within a plant, and between trees. */
#ifndef TREELINE_BAKE_CONE_LIGHT_PARTS_H
#define TREELINE_BAKE_CONE_LIGHT_PARTS_H

#include "bake/cone_light.h"
#include "bake/march_shadow_parts.h"

/* A plant of a scene in one of some turns. */
struct cone_kind {
    uint32_t species, trees;
    double turn_rad;
    struct shadow_volume volume; /* plates alone */
    uint8_t *cones, *barks;
    float *passes, *firsts_m, *lasts_m; /* a texel: what the sweep has left; where matter is */
    float *taken;                       /* a texel: what the item at hand takes of it */
    float *keys, *scratch_keys;         /* twigs, then barks */
    uint32_t *order, *scratch_order;
    size_t texels_capacity;
};

/* Lays the texels for the sun along the frame's third axis, in the plant's axes. */
void cone_kind_lay(struct arena *arena, const struct cone_plant *plant,
                   const struct shadow_axes *frame, struct cone_kind *kind);
/* Fills cones, barks and plates. */
void cone_kind_sweep(const struct cone_plant *plant, struct cone_kind *kind);

#endif
