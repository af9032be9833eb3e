/* Placement: where the trees stand, how they are turned, how large they are, which species they
 * are. */
#ifndef TREELINE_SCENE_PLACE_H
#define TREELINE_SCENE_PLACE_H

#include "scene/description.h"

/* Exactly trees_count instances inside the square of half side *half_m; position_m[1] is 0, species
 * is an index into description->plants. The same seed gives the same forest on every machine: only
 * + - * / sqrt and random.h. STATUS_INVALID when the trees do not fit, with the number that does.
 */
enum status place_trees(struct arena *arena, const struct description *description,
                        size_t trees_count, uint64_t seed, struct instance **instances,
                        double *half_m, struct error *error);

/* Cells of the finest grid that place_poisson may lay: 8 bytes a cell and as much for the list of
 * active cells. */
enum { POISSON_CELLS_MAX = 1 << 26 };

/* Poisson disc points in the square of half side half_m, none nearer than min_distance_m to
 * another, none nearer than clearing_m to the origin: at most wanted points into points (wanted x
 * 2, m); returns how many. The points come in row-major order of a fine grid. At most
 * POISSON_CELLS_MAX cells of side min_distance_m / sqrt(2). Maximal: fewer than wanted means that
 * no further one fits (up to 2^-16 of a grid cell). Ebeida, Mitchell, Patney, Davidson, Owens 2012,
 * doi:10.1111/j.1467-8659.2012.03059.x. */
size_t place_poisson(double half_m, double min_distance_m, double clearing_m, uint64_t seed,
                     size_t wanted, double (*points_m)[2]);

/* The positions file: a row a tree, "x z [rotation_deg [scale [species]]]", separated by blanks,
 * commas or semicolons; '#' begins a comment. species is a plant's name. Missing columns are drawn
 * at random. */
enum status place_file(struct arena *arena, const struct description *description,
                       size_t trees_count, uint64_t seed, struct instance *instances,
                       double *half_m, struct error *error);

/* The random properties of tree number index; trees do not depend on each other. */
void place_tree(const struct description *description, uint64_t seed, size_t index, double x_m,
                double z_m, struct instance *instance);

#endif
