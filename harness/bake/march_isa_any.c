/* The ray march's kernels on a machine without kernels of its own: plain C. */
#include "bake/march_parts.h"

size_t march_isas(struct march_isa isas[4])
{
    isas[0] = (struct march_isa){"plain", march_kernel_plain};
    return 1;
}
