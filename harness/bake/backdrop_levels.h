/* A large terrain under GL methods: drawn by levels of detail (bake/terrain_levels.h). */
#ifndef TREELINE_BAKE_BACKDROP_LEVELS_H
#define TREELINE_BAKE_BACKDROP_LEVELS_H

#include "bake/shadow_map.h"
#include "bake/sun_receiver.h"

struct backdrop_levels;

/* Device memory: 15 bytes a sample (a height, and normals with their pyramid), 20 with colours.
 * STATUS_UNSUPPORTED where the driver has no texture of the terrain's size. */
enum status backdrop_levels_prepare(struct workspace *workspace, const struct scene *scene,
                                    struct backdrop_levels **levels);
/* Into the bound framebuffer with its depth. above: the eye is above the terrain, within its
 * borders.
 */
void backdrop_levels_draw(struct workspace *workspace, struct backdrop_levels *levels,
                          const struct view *view, bool above);
/* Receives shadows from now on. */
enum status backdrop_levels_receive(struct workspace *workspace, struct backdrop_levels *levels,
                                    const struct sun_receiver *receiver);
/* What casts into a view: every chunk at the level that the view draws it at, or would. True where
 * that is not what cast before. */
bool backdrop_levels_cast_view(struct workspace *workspace, struct backdrop_levels *levels,
                               const struct view *view);
void backdrop_levels_cast(struct workspace *workspace, const struct backdrop_levels *levels,
                          const struct shadow_pass *pass);

#endif
