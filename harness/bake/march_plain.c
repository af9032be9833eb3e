/* The ray march's kernel for plain lanes. */
#include "bake/march_lanes_plain.h"

#include "bake/march_kernel.h"

bool march_block_plain(const struct march_job *job, struct march_rays *rays)
{
    return march_all(job, rays);
}
