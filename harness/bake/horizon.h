/* The horizon: where a flat terrain ends against the sky, a pixel is both by their shares of it.
 * One sample a pixel would tear it into steps that are an error of every method. */
#ifndef TREELINE_BAKE_HORIZON_H
#define TREELINE_BAKE_HORIZON_H

#include "method/method.h"

struct horizon;

enum status horizon_prepare(struct workspace *workspace, const struct scene *scene,
                            struct horizon **horizon);
/* After terrain and sky, before anything else: mixes their border anew. Nothing to do for a bent
 * terrain, from below or without, and where the target is multisampled: that is smooth by itself.
 * Leaves the depth test on. */
void horizon_draw(struct workspace *workspace, const struct horizon *horizon,
                  const struct view *view);

#endif
