/* The shaders of twigs in plain C's lanes. */
#include "bake/march_lanes_plain.h"

#include "bake/cone_lanes_kernel.h"

void cone_shade_plain(struct cone_lanes_job *job)
{
    cone_lanes_all(job);
}
