/* Slices of a plant from pictures around it: what voxel colouring sees, one layer of voxels a
 * slice. */
#ifndef TREELINE_BAKE_SLICES_COLORING_H
#define TREELINE_BAKE_SLICES_COLORING_H

#include "bake/slices.h"

/* Bakes request->views pictures of a plant (Babahenini and Djedi 2006) into slices along the
 * request's directions, which must be axes, count x count texels each. A voxel that no view sees
 * takes the colour of the nearest that one does and is opaque. STATUS_INVALID where a direction is
 * no axis, or where the sides and the count are not the same or not in 2..COLORING_GRID_MAX; the
 * plant's errors pass through. */
enum status slices_coloring(struct arena *arena, struct plant *plant,
                            const struct slices_request *request, int threads,
                            struct slices *slices, struct error *error);

#endif
