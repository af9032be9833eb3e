/* How much of the screen voxels hide: measured on the plant, kept at every level. */
#include "bake/voxels_parts.h"

#include <math.h>
#include <string.h>

float voxel_depth(float cover, float power)
{
    float depth = -logf(fmaxf(1 - cover, 0.5f / (VOXEL_RAYS * VOXEL_RAYS)));
    return cover > 0 ? depth * powf(cover, power) : 0;
}

/* The column along the axis that a cell belongs to, and how many there are. */
static size_t column_of(const struct voxel_grid *grid, size_t cell, int axis)
{
    int b = (axis + 1) % 3, c = (axis + 2) % 3;
    size_t at[3] = {cell % grid->size[0], cell / grid->size[0] % grid->size[1],
                    cell / grid->size[0] / grid->size[1]};
    return at[c] * grid->size[b] + at[b];
}

static size_t cells_count(const struct voxel_grid *grid)
{
    return (size_t)grid->size[0] * grid->size[1] * grid->size[2];
}

static size_t columns_count(const struct voxel_grid *grid, int axis)
{
    return cells_count(grid) / grid->size[axis];
}

void voxel_grid_hidden(struct arena *arena, const struct voxel_grid *finest, double areas[3])
{
    for (int axis = 0; axis < 3; axis++) {
        size_t columns = columns_count(finest, axis);
        uint64_t *rays = ARENA_ARRAY(arena, uint64_t, columns);
        for (size_t cell = 0; cell < cells_count(finest); cell++)
            if (finest->cells[cell])
                rays[column_of(finest, cell, axis)] |=
                    finest->masses[finest->cells[cell] - 1].rays[axis];
        areas[axis] = 0;
        for (size_t column = 0; column < columns; column++)
            areas[axis] += __builtin_popcountll(rays[column]) / (double)(VOXEL_RAYS * VOXEL_RAYS);
    }
}

/* Optical depths along each column, summed into depths; the area that they hide. */
static double hidden_by(const struct voxel_grid *grid, int axis, float power, float *depths)
{
    double area = 0;
    size_t columns = columns_count(grid, axis);
    memset(depths, 0, columns * sizeof *depths);
    for (size_t cell = 0; cell < cells_count(grid); cell++)
        if (grid->cells[cell])
            depths[column_of(grid, cell, axis)] +=
                voxel_depth(grid->masses[grid->cells[cell] - 1].cover[axis], power);
    for (size_t i = 0; i < columns; i++)
        area += depths[i] > 0 ? -expm1(-depths[i]) : 0;
    return area;
}

void voxel_grid_temper(struct arena *arena, const struct voxel_grid *grid, const double areas[3],
                       float powers[3])
{
    for (int axis = 0; axis < 3; axis++) {
        float *depths = ARENA_ARRAY(arena, float, columns_count(grid, axis));
        float low = -0.5f, high = 3;
        for (int step = 0; step < 12; step++) {
            float middle = 0.5f * (low + high);
            bool enough = hidden_by(grid, axis, middle, depths) > areas[axis];
            low = enough ? middle : low;
            high = enough ? high : middle;
        }
        powers[axis] = areas[axis] > 0 ? 0.5f * (low + high) : 0;
    }
}
