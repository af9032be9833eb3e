/* The ray march's kernel for avx512 lanes. */
#include "bake/march_lanes_avx512.h"

#include "bake/march_kernel.h"

int march_kernel_avx512(const struct march_job *job, const struct march_rect *rect,
                        struct march_rays *rays)
{
    return march_all(job, rect, rays);
}
