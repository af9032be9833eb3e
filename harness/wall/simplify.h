/* meshoptimizer: fewer triangles within an error, and a better order of the same ones. */
#ifndef TREELINE_WALL_SIMPLIFY_H
#define TREELINE_WALL_SIMPLIFY_H

#include <stddef.h>
#include <stdint.h>

/* Collapses edges while the surface moves by at most error_m; topology is kept, so thin tubes stay
 * tubes. Garland and Heckbert 1997, doi:10.1145/258734.258849. positions: vertices_count x 3, m;
 * simplified: room for indices_count. Returns the number of indices left; *reached_m is the error
 * of the result. */
size_t simplify_indices(const float (*positions)[3], size_t vertices_count, const uint32_t *indices,
                        size_t indices_count, float error_m, uint32_t *simplified,
                        float *reached_m);

/* Reorders triangles in place for the post-transform vertex cache. */
void simplify_order(uint32_t *indices, size_t indices_count, size_t vertices_count);

/* welded: vertices_count numbers, equal where positions are bitwise equal, dense from 0. */
void simplify_weld(const float (*positions)[3], size_t vertices_count, uint32_t *welded);

#endif
