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

struct coloring_shots {
    size_t count; /* 1..COLORING_VIEWS_MAX */
    int pixels;   /* a side, 1..4096; two for each voxel's side are enough */
    float spare;  /* how far the box that the pictures frame reaches beyond the plant's on each
                     side, relative to that; above 0 */
};

/* Orthographic pictures of the plant's albedo and depth; capture has no paths. STATUS_UNAVAILABLE
 * without Embree; the plant's errors pass through. */
enum status coloring_trace(struct arena *arena, struct plant *plant,
                           const struct coloring_shots *shots, int threads, struct images *capture,
                           struct error *error);

/* The box of the shots coloured, whatever request's is, or taken from the disk cache. */
enum status coloring_of_plant(struct arena *arena, struct plant *plant,
                              const struct coloring_shots *shots,
                              const struct coloring_request *request, int threads,
                              struct coloring *coloring, struct error *error);

#endif
