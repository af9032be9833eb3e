/* A terrain by levels of detail: square chunks of the grid, each at a stride of 1, 2, 4, ...
 * samples, as coarse as a bound in pixels allows (geometrical mipmapping, de Boer 2000). Neighbours
 * differ by one level at most, and the finer one's border vertices move onto the coarser one's:
 * both have the same border, vertex for vertex, so that no crack can open and no skirt is needed.
 */
#ifndef TREELINE_BAKE_TERRAIN_LEVELS_H
#define TREELINE_BAKE_TERRAIN_LEVELS_H

#include "scene/scene.h"

enum { LEVELS_CHUNK = 32, LEVELS_COUNT = 6 }; /* quads a side; strides 1 to 32 */

struct terrain_levels;

/* Measures every chunk at every level against the full surface, in all the ways that it may meet
 * its neighbours: 18 s with the textures at 8,193 x 8,193 samples on two busy
 * cores. Memory: 40 bytes a chunk and 3
 * MB. The terrain must stay alive. */
struct terrain_levels *terrain_levels_create(struct arena *arena, const struct terrain *terrain,
                                             int threads);

/* The triangles of a view: those chunks that it may see, each at the coarsest level whose error is
 * at most bound_px pixels in the picture. indices: into samples_z x samples_x vertices, three a
 * triangle, counter-clockwise from above, valid until the next call; returns how many. bound_px 0:
 * every triangle of those chunks. */
size_t terrain_levels_view(struct terrain_levels *levels, const struct view *view, float bound_px,
                           const uint32_t **indices);

/* The triangles of the same levels of all chunks, seen or not: what casts into the view. False: the
 * levels are those of the last call, whose triangles they are still, and nothing is filled in. */
bool terrain_levels_cast(struct terrain_levels *levels, const struct view *view, float bound_px,
                         const uint32_t **indices, size_t *count);

#endif
