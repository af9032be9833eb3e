/* How much of the sun reaches a place through all trees of a forest and its terrain. */
#ifndef TREELINE_BAKE_SHADOW_LIGHT_H
#define TREELINE_BAKE_SHADOW_LIGHT_H

#include "bake/march_shadow_parts.h"

struct shadow_light {
    const struct terrain *terrain;
    float *terrain_m;      /* NULL: no terrain, or flat */
    float least_m, most_m; /* heights of the terrain's lowest and highest sample */
    float sun_direction[3];
    struct shadow_axes frame;
    struct shadow_map map; /* of the trees, filled by who knows them */
};

void shadow_light_create(struct arena *arena, const struct terrain *terrain,
                         struct shadow_light *light);
/* False: the sun stands as at the last call. Else the frame and the terrain are of now; the map
 * waits to be filled. */
bool shadow_light_turn(struct shadow_light *light, const float sun_direction[3]);

/* A place of the world along the light's axes, m. */
void shadow_along(const struct shadow_axes *frame, const float world_m[3], float place_m[3]);
/* Share of the sun that reaches a place in the world, m. */
float shadow_light_at(const struct shadow_light *light, const float world_m[3]);
/* Means of the light that reaches a tree's side of the sun, weighted by what the tree hides. Where
 * trees stand close, the parts of one that the others leave in the light are also those that the
 * others leave in sight: tops. */
struct shadow_means {
    float all;  /* of the whole tree */
    float seen; /* of what is seen through the others from as high as the sun stands */
};
/* Light that reaches a tree's side of the sun, side x side shares 0..255 over its volume. */
struct shadow_means shadow_light_gains(const struct shadow_light *light,
                                       const struct shadow_caster *caster, int side,
                                       uint8_t *gains);

#endif
