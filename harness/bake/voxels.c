/* A plant's voxels: packed, with distances through empty space, cached. */
#include "bake/voxels_parts.h"

#include "base/file.h"
#include "base/hash.h"

#include <math.h>
#include <string.h>

enum { VOXELS_VERSION = 6 };

/* Two-pass chamfer with unit weights is exact for the chessboard distance (Borgefors 1986). */
static void distance_sweep(const uint32_t size[3], uint32_t *cells, bool back)
{
    const long nx = size[0], ny = size[1], nz = size[2], count = nx * ny * nz;
    for (long i = 0; i < count; i++) {
        long at = back ? count - 1 - i : i, x = at % nx, y = at / nx % ny, z = at / (nx * ny);
        uint32_t least = cells[at];
        if (least >= VOXELS_FIRST)
            continue;
        for (long k = 0; k < 13; k++) { /* the neighbours passed before: k of 27 in order */
            long dx = k % 3 - 1, dy = k / 3 % 3 - 1, dz = k / 9 - 1;
            if (back) {
                dx = -dx;
                dy = -dy;
                dz = -dz;
            }
            if (x + dx < 0 || x + dx >= nx || y + dy < 0 || y + dy >= ny || z + dz < 0 ||
                z + dz >= nz)
                continue;
            uint32_t there = cells[at + (dz * ny + dy) * nx + dx];
            uint32_t through = there >= VOXELS_FIRST ? 1 : there + 1;
            least = through < least ? through : least;
        }
        cells[at] = least;
    }
}

void voxel_distances(const uint32_t size[3], uint32_t *cells)
{
    size_t count = (size_t)size[0] * size[1] * size[2];
    for (size_t i = 0; i < count; i++)
        cells[i] = cells[i] ? cells[i] : VOXELS_FIRST - 1;
    distance_sweep(size, cells, false);
    distance_sweep(size, cells, true);
}

static uint32_t bits_of(float value, float steps, uint32_t zero, uint32_t most)
{
    float bits = rintf(value * steps) + (float)zero;
    return bits <= 0 ? 0 : bits >= (float)most ? most : (uint32_t)bits;
}

static uint32_t matrix_pack(const float m[6])
{
    return bits_of(m[0], 63, 0, 63) | bits_of(m[1], 63, 0, 63) << 6 |
           bits_of(m[3], 62, 31, 63) << 12 | bits_of(m[4], 62, 31, 63) << 18 |
           bits_of(m[5], 62, 31, 63) << 24;
}

static void matrix_unpack(uint32_t bits, float m[6])
{
    m[0] = (float)(bits & 63) / 63;
    m[1] = (float)(bits >> 6 & 63) / 63;
    m[2] = 1 - m[0] - m[1];
    for (int i = 0; i < 3; i++)
        m[3 + i] = ((float)(bits >> (12 + 6 * i) & 63) - 31) / 62;
}

struct voxel voxel_pack(const struct voxel_optics *optics, const float albedo[3])
{
    uint32_t color = 0;
    for (int c = 0; c < 3; c++)
        color |= bits_of(albedo[c] > 0 ? optics->albedo[c] / albedo[c] : 0, 255, 0, 255) << 8 * c;
    color |= bits_of(optics->evenness - 0.75f, 60, 0, 15) << 24;
    color |= bits_of(optics->bark, 15, 0, 15) << 28;
    return (struct voxel){optics->extinction, matrix_pack(optics->shape),
                          matrix_pack(optics->normals), color};
}

struct voxel_optics voxel_unpack(const struct voxels *voxels, uint32_t index)
{
    const struct voxel *voxel = &voxels->voxels[index];
    struct voxel_optics optics = {.extinction = voxel->extinction};
    matrix_unpack(voxel->shape, optics.shape);
    matrix_unpack(voxel->normals, optics.normals);
    for (int c = 0; c < 3; c++)
        optics.albedo[c] = (float)(voxel->color >> 8 * c & 255) / 255 * voxels->albedo[c];
    optics.evenness = 0.75f + (float)(voxel->color >> 24 & 15) / 60;
    optics.bark = (float)(voxel->color >> 28) / 15;
    return optics;
}

static struct voxel_optics optics_of(const struct voxel_mass *mass, const float powers[3])
{
    struct voxel_optics optics = {.bark = mass->bark / mass->area};
    float depth[3], trace = 0, facing = 0, even = 0;
    for (int i = 0; i < 3; i++) {
        depth[i] = voxel_depth(mass->cover[i], powers[i]);
        trace += depth[i] * depth[i];
        facing += mass->facing[i];
        even += sqrtf(mass->moments[i] * mass->area);
        optics.albedo[i] = mass->albedo[i] / mass->area;
    }
    optics.extinction = sqrtf(trace);
    optics.evenness = even > 0 ? facing / even : 1;
    for (int i = 0; i < 6; i++)
        optics.normals[i] = mass->moments[i] / mass->area;
    static const int pairs[3][2] = {{0, 1}, {0, 2}, {1, 2}};
    for (int i = 0; i < 3; i++) {
        int a = pairs[i][0], b = pairs[i][1];
        float spread = sqrtf(mass->moments[a] * mass->moments[b]);
        optics.shape[i] = depth[i] * depth[i] / trace;
        optics.shape[3 + i] =
            spread > 0 ? mass->moments[3 + i] / spread * depth[a] * depth[b] / trace : 0;
    }
    return optics;
}

/* Cells and voxels of a level; the grid's cells are used up. */
static void level_store(struct voxel_grid *grid, const float powers[3], float voxel_m,
                        struct voxels *voxels, struct voxels_level *level)
{
    size_t cells = (size_t)grid->size[0] * grid->size[1] * grid->size[2];
    memcpy(level->size, grid->size, sizeof level->size);
    level->voxel_m = voxel_m;
    for (size_t i = 0; i < cells; i++)
        if (grid->cells[i])
            grid->cells[i] += VOXELS_FIRST - 1 + voxels->voxels_count;
    memcpy(level->cells, grid->cells, cells * sizeof *level->cells);
    voxel_distances(level->size, level->cells);
    for (size_t i = 0; i < grid->count; i++) {
        struct voxel_optics optics = optics_of(&grid->masses[i], powers);
        voxels->voxels[voxels->voxels_count++] = voxel_pack(&optics, voxels->albedo);
    }
}

static void greatest_albedo(const struct voxel_grid *grid, float albedo[3])
{
    for (size_t i = 0; i < grid->count; i++)
        for (int c = 0; c < 3; c++)
            albedo[c] = fmaxf(albedo[c], grid->masses[i].albedo[c] / grid->masses[i].area);
}

/* The head of the bytes in the cache; levels' cells and voxels follow. */
struct stored {
    struct voxels voxels;
    size_t cells;
};

/* Points the head's arrays into its bytes; false when they are not of one size. */
static bool stored_open(void *data, size_t size, const struct voxels **voxels)
{
    struct stored *stored = data;
    if (size < sizeof *stored || stored->voxels.levels_count > VOXELS_LEVELS_MAX ||
        size != sizeof *stored + stored->cells * sizeof(uint32_t) +
                    stored->voxels.voxels_count * sizeof(struct voxel))
        return false;
    stored->voxels.voxels = (struct voxel *)(stored + 1);
    uint32_t *cells = (uint32_t *)(stored->voxels.voxels + stored->voxels.voxels_count);
    for (uint32_t i = 0; i < stored->voxels.levels_count; i++) {
        struct voxels_level *level = &stored->voxels.levels[i];
        level->cells = cells;
        cells += (size_t)level->size[0] * level->size[1] * level->size[2];
    }
    *voxels = &stored->voxels;
    return true;
}

/* Grids of all levels, from the triangles up; returns how many. */
static enum status grids_fill(struct arena *arena, const struct mesh *mesh, int resolution,
                              struct voxels *voxels, struct voxel_grid *grids, float *voxel_m,
                              struct error *error)
{
    float extent = 0;
    for (int i = 0; i < 3; i++)
        extent = fmaxf(extent, mesh->maximum_m[i] - mesh->minimum_m[i]);
    *voxel_m = extent > 0 ? extent / (float)resolution : 1;
    for (int i = 0; i < 3; i++) {
        float side = mesh->maximum_m[i] - mesh->minimum_m[i];
        float size = ceilf(side / *voxel_m - 1e-3f);
        grids[0].size[i] = size < 1 ? 1 : (uint32_t)size;
        voxels->origin_m[i] =
            mesh->minimum_m[i] + 0.5f * (side - (float)grids[0].size[i] * *voxel_m);
    }
    enum status status = voxel_grid_fill(arena, mesh, voxels->origin_m, *voxel_m, &grids[0], error);
    uint32_t last = 0;
    while (!status &&
           (grids[last].size[0] > 1 || grids[last].size[1] > 1 || grids[last].size[2] > 1)) {
        voxel_grid_halve(arena, &grids[last], &grids[last + 1]);
        last++;
    }
    voxels->levels_count = last + 1;
    return status;
}

static enum status voxels_build(struct arena *arena, const struct mesh *mesh, int resolution,
                                void **data, size_t *size, struct error *error)
{
    struct arena *passing = arena_create(0);
    struct voxel_grid grids[VOXELS_LEVELS_MAX] = {0};
    struct stored head = {0};
    const struct voxels *unused;
    float voxel_m;
    enum status status =
        grids_fill(passing, mesh, resolution, &head.voxels, grids, &voxel_m, error);
    uint32_t count = 0;
    for (uint32_t i = 0; i < head.voxels.levels_count; i++) {
        head.cells += (size_t)grids[i].size[0] * grids[i].size[1] * grids[i].size[2];
        count += (uint32_t)grids[i].count;
        memcpy(head.voxels.levels[i].size, grids[i].size, sizeof grids[i].size);
        greatest_albedo(&grids[i], head.voxels.albedo);
    }
    if (!status) {
        *size = sizeof head + head.cells * sizeof(uint32_t) + count * sizeof(struct voxel);
        struct stored *stored = *data = arena_alloc(arena, 1, *size);
        head.voxels.voxels_count = count;
        *stored = head;
        stored_open(stored, *size, &unused);
        stored->voxels.voxels_count = 0;
        double areas[3];
        voxel_grid_hidden(passing, &grids[0], areas);
        for (uint32_t i = 0; i < head.voxels.levels_count; i++) {
            float powers[3];
            voxel_grid_temper(passing, &grids[i], areas, powers);
            level_store(&grids[i], powers, voxel_m * (float)(1u << i), &stored->voxels,
                        &stored->voxels.levels[i]);
            for (int axis = 0; axis < 3; axis++)
                areas[axis] /= 4;
        }
    }
    arena_destroy(passing);
    return status;
}

enum status voxels_of_plant(struct arena *arena, struct plant *plant, int resolution,
                            const struct voxels **voxels, struct error *error)
{
    const struct mesh *mesh;
    uint64_t hash;
    size_t size;
    void *data;
    enum status status = plant_hash(plant, &hash, error);
    if (status)
        return status;
    hash = hash_u64(hash_u64(hash, VOXELS_VERSION), (uint64_t)resolution);
    if (cache_get(arena, "voxels", hash, &data, &size) && stored_open(data, size, voxels))
        return STATUS_OK;
    if ((status = plant_mesh(plant, &mesh, error)) ||
        (status = voxels_build(arena, mesh, resolution, &data, &size, error)))
        return status;
    stored_open(data, size, voxels);
    cache_put("voxels", hash, data, size);
    return STATUS_OK;
}
