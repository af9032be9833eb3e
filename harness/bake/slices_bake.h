/* Inside of the slices: from a mesh to texels. */
#ifndef TREELINE_BAKE_SLICES_BAKE_H
#define TREELINE_BAKE_SLICES_BAKE_H

#include "bake/slices.h"

/* Bakes a mesh; the request must be valid. Memory that outlives the call is taken from arena. */
void slices_bake(struct arena *arena, const struct mesh *mesh, const struct slices_request *request,
                 int threads, struct slices *slices);

#endif
