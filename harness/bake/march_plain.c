/* The ray march's kernel for plain lanes. */
#include "bake/march_lanes_plain.h"

#include "bake/march_kernel.h"

int march_kernel_plain(const struct march_job *job, const struct march_rect *rect,
                       struct march_rays *rays)
{
    return march_all(job, rect, rays);
}
