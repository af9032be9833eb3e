/* What is requested of stacks along the three axes. */
#include "bake/stack_axes.h"

struct stack_request stack_axes_request(const struct stack_axes *axes)
{
    bool fast = axes->path == STACK_FAST;
    return (struct stack_request){
        .bake = {.directions_count = 3,
                 .directions = slices_axes,
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
