/* The lanes of twigs' shaders on x86: chosen by what the processor says. */
#include "bake/cone_lanes.h"

size_t cone_isas(struct cone_isa isas[2])
{
    size_t count = 0;
    isas[count++] = (struct cone_isa){"plain", cone_shade_plain};
    if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"))
        isas[count++] = (struct cone_isa){"avx2", cone_shade_avx2};
    return count;
}
