/* How much of the sun reaches the bark, the twigs and their cones of needles, and the ground.
 *
 * In each plant, as it is turned, one sweep away from the sun: a twig takes the light that the
 * twigs and the bark before it have left over, then leaves less. What twigs do to themselves is
 * their shader's. All trees together are laid into a map seen from the sun that holds what its rays
 * pass (march_shadow_parts.h, Lokovic and Veach 2000); from it every tree gets the light on its
 * side of the sun. */
#ifndef TREELINE_BAKE_CONE_LIGHT_H
#define TREELINE_BAKE_CONE_LIGHT_H

#include "bake/cone_plant.h"
#include "bake/shadow_ground.h"
#include "method/method.h"

struct cone_lights;

/* plants: one a species; all stay. */
struct cone_lights *cone_lights_create(struct arena *arena, const struct scene *scene,
                                       struct cone_plant *const *plants);
/* Nothing happens where the sun stands as at the last call. */
void cone_lights_turn(struct cone_lights *lights, const float sun_direction[3], int threads);

/* A tree's: shares 0..255 of what falls on its side of the sun. */
struct cone_tree_light {
    const uint8_t *cones, *barks; /* as the plant's, twigs' cones one after the other */
    const uint8_t *gains;         /* side x side, up of right: what falls on its side of the sun */
    float to_gains[2][4];         /* of places in the plant's axes at scale 1 */
    int side;
};
void cone_lights_of_tree(const struct cone_lights *lights, size_t instance,
                         struct cone_tree_light *light);
float cone_tree_light_gain(const struct cone_tree_light *light, const float place_m[3]);
/* Takes from the ground that a pixel sees the sun that trees and terrain keep from it. sun: the
 * share of the sun that it has by its slope and through fog. */
void cone_lights_shade_ground(const struct cone_lights *lights, const struct shadow_pixel *pixel,
                              float sun, float rgb[3]);

#endif
