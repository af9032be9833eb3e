/* Sun shadows of the march: how much of the sun's light reaches a place.
 *
 * Each species, as it is turned, keeps a volume of what it lets through from the sun down to each
 * place in it: Kajiya and Kay 1989 (doi:10.1145/74334.74361), swept along the light. All trees
 * together are laid into one map seen from the sun, in which a texel holds the boxes of matter that
 * its rays pass, as deep shadow maps do (Lokovic and Veach 2000, doi:10.1145/344779.344958). From
 * it every tree gets the light that falls on its side of the sun through all other trees, and the
 * ground its own. Bent terrain adds the height below which it takes the sun. All is built anew when
 * the sun has moved. */
#ifndef TREELINE_BAKE_MARCH_SHADOW_H
#define TREELINE_BAKE_MARCH_SHADOW_H

#include "bake/cells.h"
#include "bake/march_job.h"

struct march_shadows;
struct shadow_pixel;

/* trees: one an instance of the scene; cells: of them, or NULL; all stay. */
enum status march_shadows_create(struct workspace *workspace, const struct scene *scene,
                                 const struct march_options *options,
                                 const struct march_species *species,
                                 const struct march_tree *trees, const struct cells *cells,
                                 struct march_shadows **shadows);
/* False, and nothing happens, where the sun stands as at the last call. */
bool march_shadows_light(struct march_shadows *shadows, const float sun_direction[3], int threads);
/* What of a picture's job is the sun's: of the scene's trees (their own shadows and the others')
 * and of trees that stand alone. */
void march_shadows_fill(const struct march_shadows *shadows, const struct march_tree *tree,
                        uint32_t level, struct march_job *job);
/* Share of the sun that reaches, through all others, what is seen of a tree of the scene, or of
 * those of a cell, from an eye, whose way there rises by a sine. */
float march_shadows_of_tree(const struct march_shadows *shadows, uint32_t tree, float rise);
float march_shadows_of_cell(const struct march_shadows *shadows, uint32_t cell, float rise);
/* Takes from the ground under a pixel the sun that trees and terrain keep from it. sun: the share
 * of the sun that it has by its slope and through fog. */
void march_shadows_shade_ground(const struct march_shadows *shadows,
                                const struct shadow_pixel *pixel, float sun, float rgb[3]);

#endif
