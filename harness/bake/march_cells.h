/* Cells of many trees in the march's picture: each drawn as one thing. */
#ifndef TREELINE_BAKE_MARCH_CELLS_H
#define TREELINE_BAKE_MARCH_CELLS_H

#include "bake/cells.h"
#include "bake/march_job.h"

/* A cell spreads over so many pixels at most; its trees are MARCH_SMALL_PX at most. */
#define MARCH_CELL_PX 2.5f

enum { MARCH_CELL = 254 }; /* a march_seen.level */

/* The middle of its mean tree: x, y in pixels, depth. */
void march_cell_middle(const struct march_view *picture, const struct cells_sums *sums,
                       float middle[3]);
struct march_seen march_cell_see(const struct march_view *picture, const struct cells_sums *sums,
                                 const float middle[3]);
void march_cell_splat(const struct march_view *picture, const struct cells_sums *sums,
                      const float middle[3], const struct march_far *far,
                      struct march_splat *splat);

#endif
