/* Pictures with depth of a plant, ray traced around it: what voxel colouring begins from. */
#ifndef TREELINE_BAKE_COLORING_VIEWS_H
#define TREELINE_BAKE_COLORING_VIEWS_H

#include "base/error.h"
#include "plant/images.h"
#include "plant/plant.h"

/* Direction toward eye `index` of count >= 1, unit: 6 are the axes (003, figure 7a), 12 the
 * vertices of an icosahedron (as in its figure 7b), any other number lies on a spherical Fibonacci
 * lattice (Swinbank and Purser 2006, doi:10.1256/qj.05.227). */
void coloring_direction(size_t count, size_t index, float direction[3]);

/* count (1..COLORING_VIEWS_MAX) orthographic pictures of the plant's albedo and depth, pixels
 * (1..4096) a side, each framing the plant's box, which holds it with
 * a hundredth to spare; capture has no paths. STATUS_UNAVAILABLE without Embree; the plant's
 * errors pass through. */
enum status coloring_trace(struct arena *arena, struct plant *plant, size_t count, int pixels,
                           int threads, struct images *capture, struct error *error);

/* The plant's box coloured from count views, two pixels for each voxel's side. request: box is set
 * here. */
enum status coloring_of_plant(struct arena *arena, struct plant *plant, size_t count,
                              struct coloring_request *request, int threads,
                              struct coloring *coloring, struct error *error);

#endif
