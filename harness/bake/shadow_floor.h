/* How far down a shadow can be seen: where the ground ends it. */
#ifndef TREELINE_BAKE_SHADOW_FLOOR_H
#define TREELINE_BAKE_SHADOW_FLOOR_H

#include "scene/scene.h"

struct shadow_floor;

/* Keeps the lowest heights of 64 x 64 pieces of the terrain; nothing of the terrain itself. */
struct shadow_floor *shadow_floor_create(struct arena *arena, const struct terrain *terrain);

/* A height, m, at which every ray of the sun that has come through the sphere is in the ground:
 * nothing that is lit on its way there, and nothing that is seen from above the ground, lies lower
 * in the sphere's shadow. NaN where there is none: a sun that does not rise, shadows that leave the
 * terrain, a surface that is drawn by levels of detail. The largest of its kind for 64 x 64 pieces,
 * but for a fiftieth of the radius. */
float shadow_floor_of(const struct shadow_floor *ground, const float center_m[3], float radius_m,
                      const float sun[3]);

/* Whether an eye is above the ground by more than its near plane. */
bool shadow_floor_is_below(const struct shadow_floor *ground, const struct view *view);

#endif
