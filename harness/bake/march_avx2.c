/* The ray march's kernel for avx2 lanes. */
#include "bake/march_lanes_avx2.h"

#include "bake/march_kernel.h"

int march_kernel_avx2(const struct march_job *job, const struct march_rect *rect,
                      struct march_rays *rays)
{
    return march_all(job, rect, rays);
}
