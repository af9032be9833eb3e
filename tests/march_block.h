/* For tests of the march's kernels: 4 x 4 rays. */
#ifndef TREELINE_TESTS_MARCH_BLOCK_H
#define TREELINE_TESTS_MARCH_BLOCK_H

#include "bake/march_parts.h"

#include <math.h>
#include <string.h>

enum { BLOCK = 4, BLOCK_RAYS = BLOCK * BLOCK };

struct block {
    float left[BLOCK_RAYS + MARCH_ROOM], depths_m[BLOCK_RAYS + MARCH_ROOM], rgb[BLOCK_RAYS][4];
};

/* Nothing before them, nothing behind. */
static inline void block_open(struct block *block)
{
    memset(block, 0, sizeof *block);
    for (int i = 0; i < BLOCK_RAYS; i++) {
        block->left[i] = 1;
        block->depths_m[i] = INFINITY;
    }
}

/* Returns how many rays closed. */
static inline int block_march(const struct march_isa *isa, const struct march_job *job,
                              struct block *block)
{
    const struct march_rect rect = {{0, 0}, {BLOCK - 1, BLOCK - 1}};
    struct march_rays rays = {BLOCK, block->left, block->rgb, block->depths_m, 0};
    return isa->kernel(job, &rect, &rays);
}

#endif
