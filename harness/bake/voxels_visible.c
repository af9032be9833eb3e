/* Voxels whose normals are known by their mean alone. */
#include "bake/voxels_visible.h"

#include "bake/voxels_parts.h"

#include <math.h>
#include <string.h>

/* Entries of a packed matrix: xx, yy, zz, xy, xz, yz. */
static void matrix_times(const float m[6], const float v[3], float product[3])
{
    product[0] = m[0] * v[0] + m[3] * v[1] + m[4] * v[2];
    product[1] = m[3] * v[0] + m[1] * v[1] + m[5] * v[2];
    product[2] = m[4] * v[0] + m[5] * v[1] + m[2] * v[2];
}

/* The direction along which a matrix is greatest, by powers of it, and how great it is there. Of
 * two that are alike any will do, and a few steps tell apart those that differ. */
static float matrix_axis(const float m[6], float axis[3])
{
    enum { STEPS = 24 };
    int start = m[0] > m[1] ? (m[0] > m[2] ? 0 : 2) : (m[1] > m[2] ? 1 : 2);
    float greatest = 0;
    memset(axis, 0, 3 * sizeof *axis);
    axis[start] = 1;
    for (int step = 0; step < STEPS; step++) {
        float next[3];
        matrix_times(m, axis, next);
        greatest = sqrtf(next[0] * next[0] + next[1] * next[1] + next[2] * next[2]);
        for (int i = 0; i < 3 && greatest > 0; i++)
            axis[i] = next[i] / greatest;
    }
    return greatest;
}

static float polynomial(const float terms[VISIBLE_TERMS], float x)
{
    float value = 0;
    for (int k = VISIBLE_TERMS; k-- > 0;)
        value = x * (terms[k] + value);
    return value;
}

/* The spheroid's whose second moments they are. */
void voxel_mean_normal(const struct voxel_optics *optics, float mean[3])
{
    enum { STEPS = 16 };
    float across = 0.5f * (1 - matrix_axis(optics->normals, mean)), low = 0, high = 0.5f;
    for (int step = 0; step < STEPS; step++) {
        float middle = 0.5f * (low + high);
        bool enough = polynomial(visible_across, middle) > across;
        low = enough ? low : middle;
        high = enough ? middle : high;
    }
    for (int i = 0; i < 3; i++)
        mean[i] *= 1 - low;
}

/* The spheroid of a mean, as large as hides along the three axes together what the voxel does. */
static void spheroid_of(const float mean[3], struct voxel_optics *optics)
{
    float square = mean[0] * mean[0] + mean[1] * mean[1] + mean[2] * mean[2];
    float side = polynomial(visible_side, 1 - sqrtf(square)), depth = 0, shown = 0;
    float matrix[6], trace = square + 2 * side, share = (square - side) / square;
    for (int i = 0; i < 3; i++) {
        matrix[i] = side + share * mean[i] * mean[i];
        depth += optics->extinction * sqrtf(fmaxf(optics->shape[i], 0));
        shown += sqrtf(matrix[i]);
    }
    matrix[3] = share * mean[0] * mean[1];
    matrix[4] = share * mean[0] * mean[2];
    matrix[5] = share * mean[1] * mean[2];
    optics->extinction = depth / shown * sqrtf(trace);
    for (int i = 0; i < 6; i++)
        optics->shape[i] = matrix[i] / trace;
}

uint32_t voxel_pack_mean(const float mean[3])
{
    uint32_t bits = 0;
    for (int i = 0; i < 3; i++)
        bits |= (uint32_t)lrintf(VISIBLE_ZERO * (1 + mean[i])) << 10 * i;
    return bits;
}

const struct voxels *voxels_visible(struct arena *arena, const struct voxels *voxels)
{
    struct voxels *copy = ARENA_NEW(arena, struct voxels);
    *copy = *voxels;
    copy->voxels = ARENA_ARRAY(arena, struct voxel, voxels->voxels_count);
    for (uint32_t i = 0; i < voxels->voxels_count; i++) {
        struct voxel_optics optics = voxel_unpack(voxels, i);
        float mean[3];
        voxel_mean_normal(&optics, mean);
        spheroid_of(mean, &optics);
        struct voxel packed = voxel_pack(&optics, voxels->albedo);
        copy->voxels[i] = voxels->voxels[i];
        copy->voxels[i].extinction = packed.extinction;
        copy->voxels[i].shape = packed.shape;
        copy->voxels[i].normals = voxel_pack_mean(mean);
    }
    return copy;
}
