/* Voxels of which coarser levels hide as Noma has it.
 * Noma, Bridging between surface rendering and volume rendering for multi-resolution display, 6th
 * Eurographics Workshop on Rendering 1995; the product form stays within 0..1. */
#include "bake/voxels_parts.h"

#include <math.h>
#include <string.h>

float voxel_noma(const float opacities[8])
{
    float clear = 0;
    for (int pair = 0; pair < 4; pair++)
        clear += 0.25f * (1 - opacities[2 * pair]) * (1 - opacities[2 * pair + 1]);
    return 1 - clear;
}

static void opacities_of(const struct voxels *voxels, uint32_t index, float opacities[3])
{
    struct voxel_optics optics = voxel_unpack(voxels, index);
    for (int axis = 0; axis < 3; axis++)
        opacities[axis] = -expm1f(-optics.extinction * sqrtf(fmaxf(optics.shape[axis], 0)));
}

/* From the eight cells of a coarse one, in pairs along each axis. */
static void opacities_gather(const struct voxels_level *fine, const uint32_t at[3],
                             const float (*known)[3], float opacities[3])
{
    for (int axis = 0; axis < 3; axis++) {
        float children[8] = {0};
        for (uint32_t k = 0; k < 8; k++) {
            uint32_t cell[3];
            cell[axis] = 2 * at[axis] + (k & 1);
            cell[(axis + 1) % 3] = 2 * at[(axis + 1) % 3] + (k >> 1 & 1);
            cell[(axis + 2) % 3] = 2 * at[(axis + 2) % 3] + (k >> 2);
            if (cell[0] >= fine->size[0] || cell[1] >= fine->size[1] || cell[2] >= fine->size[2])
                continue;
            uint32_t child =
                fine->cells[((size_t)cell[2] * fine->size[1] + cell[1]) * fine->size[0] + cell[0]];
            children[k] = child < VOXELS_FIRST ? 0 : known[child - VOXELS_FIRST][axis];
        }
        opacities[axis] = voxel_noma(children);
    }
}

/* The matrix of no correlations between axes. */
static void voxel_hide(struct voxels *voxels, uint32_t index, const float opacities[3])
{
    static const float clear_least = 1e-6f;
    struct voxel_optics optics = voxel_unpack(voxels, index);
    float depths[3], trace = 0;
    for (int i = 0; i < 3; i++) {
        depths[i] = -logf(fmaxf(1 - opacities[i], clear_least));
        trace += depths[i] * depths[i];
    }
    optics.extinction = sqrtf(trace);
    for (int i = 0; i < 3; i++) {
        optics.shape[i] = trace > 0 ? depths[i] * depths[i] / trace : 1.0f / 3;
        optics.shape[3 + i] = 0;
    }
    struct voxel packed = voxel_pack(&optics, voxels->albedo);
    voxels->voxels[index].extinction = packed.extinction;
    voxels->voxels[index].shape = packed.shape;
}

static void level_hide(struct voxels *voxels, uint32_t number, float (*known)[3])
{
    const struct voxels_level *level = &voxels->levels[number];
    const uint32_t *cell = level->cells;
    uint32_t at[3];
    for (at[2] = 0; at[2] < level->size[2]; at[2]++)
        for (at[1] = 0; at[1] < level->size[1]; at[1]++)
            for (at[0] = 0; at[0] < level->size[0]; at[0]++, cell++) {
                if (*cell < VOXELS_FIRST)
                    continue;
                uint32_t index = *cell - VOXELS_FIRST;
                if (number)
                    opacities_gather(&voxels->levels[number - 1], at, (const float(*)[3])known,
                                     known[index]);
                else
                    opacities_of(voxels, index, known[index]);
                voxel_hide(voxels, index, known[index]);
            }
}

const struct voxels *voxels_noma(struct arena *arena, const struct voxels *voxels)
{
    struct arena *passing = arena_create(0);
    struct voxels *copy = ARENA_NEW(arena, struct voxels);
    float(*known)[3] = arena_alloc(passing, voxels->voxels_count, sizeof *known);
    *copy = *voxels;
    copy->voxels = ARENA_ARRAY(arena, struct voxel, voxels->voxels_count);
    memcpy(copy->voxels, voxels->voxels, voxels->voxels_count * sizeof *voxels->voxels);
    for (uint32_t number = 0; number < voxels->levels_count; number++)
        level_hide(copy, number, known);
    arena_destroy(passing);
    return copy;
}
