/* The horizon: where a flat terrain ends against the sky, a pixel is both by their shares of it.
 * One sample a pixel would tear it into steps that are an error of every method. */
#ifndef TREELINE_BAKE_HORIZON_H
#define TREELINE_BAKE_HORIZON_H

#include "method/method.h"

struct horizon;

/* Every height, normal and colour is the same: its borders are all that it shows of a horizon. */
bool horizon_is_flat(const struct terrain *terrain);

/* The borders of a flat terrain that are before an eye above it. Returns how many. ends: two of
 * each, cut to what is before the eye; inward: across it on the screen, unit, y up. */
int horizon_borders(const struct terrain *terrain, const struct view *view, float ends[8][3],
                    float inward[4][2]);
/* x, y in pixels from the lower left corner, and the depth along the view. */
void horizon_screen(const struct view *view, const float world_m[3], float screen[3]);

enum status horizon_prepare(struct workspace *workspace, const struct scene *scene,
                            struct horizon **horizon);
/* After terrain and sky, before anything else: mixes their border anew. Nothing to do for a bent
 * terrain, from below or without, and where the target is multisampled: that is smooth by itself.
 * Leaves the depth test on. */
void horizon_draw(struct workspace *workspace, const struct horizon *horizon,
                  const struct view *view);

#endif
