/* The lanes of twigs' shaders on a machine without lanes of its own: plain C. */
#include "bake/cone_lanes.h"

size_t cone_isas(struct cone_isa isas[2])
{
    isas[0] = (struct cone_isa){"plain", cone_shade_plain};
    return 1;
}
