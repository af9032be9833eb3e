/* The shaders of twigs in AVX2's lanes. */
#include "bake/march_lanes_avx2.h"

#include "bake/cone_lanes_kernel.h"

void cone_shade_avx2(struct cone_lanes_job *job)
{
    cone_lanes_all(job);
}
