/* Trees that cast into shadow maps as pictures: a quad a tree that faces the sun, of the picture of
 * the plant that was taken from nearest to there (bake/atlas.h), alpha-tested, with the picture's
 * own depths. */
#ifndef TREELINE_BAKE_SHADOW_BILLBOARDS_H
#define TREELINE_BAKE_SHADOW_BILLBOARDS_H

#include "bake/shadow_map.h"

struct shadow_billboards;

/* Bakes the pictures of the scene's plants. */
enum status shadow_billboards_prepare(struct workspace *workspace, const struct scene *scene,
                                      const struct shadow_options *options,
                                      struct shadow_billboards **billboards);
/* Whether a tree's picture is fine enough for a pass: none of its texels is larger than the map's.
 * A picture was taken from up to 15 degrees beside the sun, so what a tree shades close behind
 * itself is displaced by some of its texels; seen from nearer it would be. */
bool shadow_billboards_suit(const struct shadow_billboards *billboards,
                            const struct shadow_pass *pass, const struct instance *tree);
/* Draws those trees that may shade a map's pass and whose pictures suit it into what is bound. */
void shadow_billboards_cast(struct workspace *workspace, const struct shadow_billboards *billboards,
                            const struct shadow_pass *pass);

#endif
