/* The ray march's kernel for avx2 lanes. */
#include "bake/march_lanes_avx2.h"

#include "bake/march_kernel.h"

bool march_block_avx2(const struct march_job *job, struct march_rays *rays)
{
    return march_all(job, rays);
}
