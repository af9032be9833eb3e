/* The ray march's kernels on x86: chosen by what the processor says. */
#include "bake/march_parts.h"

size_t march_isas(struct march_isa isas[4])
{
    size_t count = 0;
    isas[count++] = (struct march_isa){"plain", march_kernel_plain};
    if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"))
        isas[count++] = (struct march_isa){"avx2", march_kernel_avx2};
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
        __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl"))
        isas[count++] = (struct march_isa){"avx512", march_kernel_avx512};
    return count;
}
