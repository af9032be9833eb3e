/* meshoptimizer: fewer triangles within an error, and a better order of the same ones. */
#include "wall/simplify.h"

#include <meshoptimizer.h>

size_t simplify_indices(const float (*positions)[3], size_t vertices_count, const uint32_t *indices,
                        size_t indices_count, float error_m, uint32_t *simplified, float *reached_m)
{
    *reached_m = 0;
    if (indices_count == 0)
        return 0;
    float scale_m = meshopt_simplifyScale(positions[0], vertices_count, sizeof *positions);
    float reached = 0, wanted = scale_m > 0 ? error_m / scale_m : 0;
    size_t left = meshopt_simplify(simplified, indices, indices_count, positions[0], vertices_count,
                                   sizeof *positions, 0, wanted, 0, &reached);
    *reached_m = reached * scale_m;
    return left;
}

void simplify_order(uint32_t *indices, size_t indices_count, size_t vertices_count)
{
    if (indices_count > 0)
        meshopt_optimizeVertexCache(indices, indices, indices_count, vertices_count);
}

void simplify_weld(const float (*positions)[3], size_t vertices_count, uint32_t *welded)
{
    if (vertices_count > 0)
        meshopt_generateVertexRemap(welded, NULL, vertices_count, positions, vertices_count,
                                    sizeof *positions);
}
