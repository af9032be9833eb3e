/* Instanced drawing of a plant's trees: groups that are drawn alike, and their indirect commands.
 */
#ifndef TREELINE_BAKE_PLANT_DRAWS_H
#define TREELINE_BAKE_PLANT_DRAWS_H

#include "bake/plant_gl.h"

/* Groups of a plant: one a detail level, then LEVELS_RUNS a step of pruning. */
uint32_t plant_groups_count(const struct levels *levels);
/* run: which run of pruned elements is the tree's. */
uint32_t plant_group(const struct levels *levels, const struct levels_choice *choice, uint32_t run);

/* What the shaders need of a tree of a group; taper as in levels_run_of. */
struct plant_gl_placed plant_place(const struct levels *levels, uint32_t group,
                                   const struct instance *instance, const struct levels_seen *seen,
                                   float taper);

struct plant_command { /* DrawElementsIndirectCommand */
    uint32_t count, instances, first_index;
    int32_t base_vertex;
    uint32_t base_instance;
};

/* The commands of one batch (NULL: the pruned elements) for every group that has trees, at most
 * plant_groups_count, and their triangles. first: where each group's trees begin, and their end. */
size_t plant_commands(const struct levels *levels, const struct plant_gl_batch *batch,
                      const uint32_t *first, struct plant_command *commands, uint64_t *triangles);

#endif
