/* Groups of trees that are drawn alike, and their indirect commands. */
#include "bake/plant_draws.h"

#include <math.h>
#include <string.h>

uint32_t plant_groups_count(const struct levels *levels)
{
    return (uint32_t)levels->levels_count + levels->steps_count * LEVELS_RUNS;
}

uint32_t plant_group(const struct levels *levels, const struct levels_choice *choice, uint32_t run)
{
    if (choice->step < 0)
        return choice->level;
    return (uint32_t)levels->levels_count + (uint32_t)choice->step * LEVELS_RUNS + run;
}

struct plant_gl_placed plant_place(const struct levels *levels, uint32_t group,
                                   const struct instance *instance, const struct levels_seen *seen,
                                   float taper)
{
    struct plant_gl_placed placed = {
        .scale = instance->scale,
        .turn = {cosf(instance->rotation_rad), sinf(instance->rotation_rad)},
        .stretch = instance->stretch,
    };
    memcpy(placed.foot_m, instance->position_m, sizeof instance->position_m);
    if (group < levels->levels_count)
        return placed;
    uint32_t pruned = group - (uint32_t)levels->levels_count;
    int step = (int)(pruned / LEVELS_RUNS);
    struct levels_run run = levels_run_of(levels, step, seen, taper);
    placed.kept = run.kept;
    placed.growth = run.growth;
    placed.begin = (float)levels_begin(levels, pruned % LEVELS_RUNS);
    placed.stout = ((float)levels->step_stout[step] - 0.5f) / 65535;
    return placed;
}

/* What a batch (NULL: the pruned elements) draws for the trees of a group; nothing: a count of 0.
 */
static struct detail_range group_range(const struct levels *levels,
                                       const struct plant_gl_batch *batch, uint32_t group)
{
    struct detail_range none = {0, 0};
    uint32_t count = (uint32_t)levels->levels_count;
    if (group < count)
        return batch ? batch->levels[group] : none;
    uint32_t step = (group - count) / LEVELS_RUNS, run = (group - count) % LEVELS_RUNS;
    if (batch)
        return batch->kind == MATERIAL_BARK ? batch->stout[step] : none;
    return (struct detail_range){3 * levels_begin(levels, run), 3 * levels->step_elements[step]};
}

size_t plant_commands(const struct levels *levels, const struct plant_gl_batch *batch,
                      const uint32_t *first, struct plant_command *commands, uint64_t *triangles)
{
    uint32_t groups = plant_groups_count(levels);
    size_t count = 0;
    *triangles = 0;
    for (uint32_t g = 0; g < groups; g++) {
        uint32_t base = first[g], trees = first[g + 1] - base;
        struct detail_range range = group_range(levels, batch, g);
        if (trees == 0 || range.indices_count == 0)
            continue;
        commands[count] = (struct plant_command){.count = range.indices_count,
                                                 .instances = trees,
                                                 .first_index = range.first_index,
                                                 .base_instance = base};
        count++;
        *triangles += (uint64_t)range.indices_count / 3 * trees;
    }
    return count;
}
