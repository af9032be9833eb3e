/* The ray march's kernel for avx512 lanes. */
#include "bake/march_lanes_avx512.h"

#include "bake/march_kernel.h"

bool march_block_avx512(const struct march_job *job, struct march_rays *rays)
{
    return march_all(job, rays);
}
