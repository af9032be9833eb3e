/* What is requested of stacks along the three axes, and more directions. */
#include "bake/stack_axes.h"

#define SPACE 0.57735027f /* of a cube's diagonal, along each axis */
#define FACE 0.70710678f  /* of that of a face */

/* No direction is farther from one of them than 54.8, 36.3 and 27.6 degrees. */
static const float directions[13][3] = {{0, 0, 1},
                                        {1, 0, 0},
                                        {0, 1, 0},
                                        {SPACE, SPACE, SPACE},
                                        {-SPACE, SPACE, SPACE},
                                        {SPACE, SPACE, -SPACE},
                                        {-SPACE, SPACE, -SPACE},
                                        {0, FACE, FACE},
                                        {0, FACE, -FACE},
                                        {FACE, FACE, 0},
                                        {-FACE, FACE, 0},
                                        {FACE, 0, FACE},
                                        {-FACE, 0, FACE}};
static const size_t counts[] = {3, 7, 13};

struct stack_request stack_axes_request(const struct stack_axes *axes)
{
    bool fast = axes->path == STACK_FAST;
    return (struct stack_request){
        .bake = {.directions_count = counts[axes->directions],
                 .directions = directions,
                 .count = axes->slices,
                 .samples = axes->samples,
                 .cut = axes->cut ? SLICES_CENTROID : SLICES_CLIP,
                 .parts = SLICES_BARK | SLICES_LEAVES},
        .resolution_px = axes->resolution,
        .square = !fast,
        .trilinear = !fast || axes->filter == 0,
        .rectangles = fast,
        .near_radii = fast ? axes->near : 0,
        .near_octaves = axes->smooth ? STACK_NEAR_OCTAVES : 0,
        .each = !fast,
        .oblique = fast && axes->oblique,
        .interpolate = axes->interpolate,
        .smooth = axes->smooth,
        .texel_px = axes->texel,
        .distant_px = fast ? axes->distant : 0,
        .sun = axes->sun,
    };
}
