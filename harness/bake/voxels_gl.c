/* Voxels of all species, made or read from the cache, into OpenGL's buffers. */
#include "bake/voxels_gl.h"

#include <string.h>

enum { OCTANTS = 8, FAR = 15 };

static uint8_t least(uint8_t a, uint8_t b)
{
    return a < b ? a : b;
}

/* Adds an octant's distances to cells. A cell's is the side, up to FAR, of the largest cube of
 * empty cells that has it in a corner and lies on from it along the octant's axes: one more than
 * the least of its neighbours' there. sides: room for the grid, from its far corner on, and a
 * border before it that is FAR. */
static void add_octant(const struct voxels_level *level, unsigned octant, uint8_t *sides,
                       uint32_t *cells)
{
    const int size[3] = {(int)level->size[0], (int)level->size[1], (int)level->size[2]};
    const int row = size[0] + 1, plane = row * (size[1] + 1);
    for (int z = 1; z <= size[2]; z++)
        for (int y = 1; y <= size[1]; y++) {
            const int line = (octant >> 2 & 1 ? z - 1 : size[2] - z) * size[1] +
                             (octant >> 1 & 1 ? y - 1 : size[1] - y);
            uint8_t *side = sides + z * plane + y * row;
            for (int x = 1; x <= size[0]; x++) {
                const int at = line * size[0] + (octant & 1 ? x - 1 : size[0] - x);
                const uint8_t *next = ++side - 1, *above = side - row, *behind = side - plane;
                uint8_t both = least(least(next[0], above[0]), least(above[-1], behind[0]));
                uint8_t all = least(least(both, behind[-1]), least(behind[-row], behind[-row - 1]));
                *side = level->cells[at] >= VOXELS_FIRST ? 0 : least(FAR - 1, all) + 1;
                cells[at] |= (uint32_t)*side << 4 * octant;
            }
        }
}

void voxels_gl_cells(const struct voxels_level *level, uint32_t first, uint32_t *cells)
{
    const size_t count = (size_t)level->size[0] * level->size[1] * level->size[2];
    const size_t bordered =
        (size_t)(level->size[0] + 1) * (level->size[1] + 1) * (level->size[2] + 1);
    struct arena *scratch = arena_create(0);
    uint8_t *sides = ARENA_ARRAY(scratch, uint8_t, bordered);
    memset(sides, FAR, bordered);
    memset(cells, 0, count * sizeof *cells);
    for (unsigned octant = 0; octant < OCTANTS; octant++)
        add_octant(level, octant, sides, cells);
    for (size_t at = 0; at < count; at++)
        if (level->cells[at] >= VOXELS_FIRST)
            cells[at] = level->cells[at] - VOXELS_FIRST + first;
    arena_destroy(scratch);
}

/* Voxels of all species in one row; cells name them. */
static void upload(struct gl *gl, struct voxels_gl *all)
{
    const size_t species_count = all->species_count;
    struct arena *scratch = arena_create(0);
    size_t cells_count = 0, voxels_count = 0;
    for (size_t i = 0; i < species_count; i++) {
        const struct voxels *volume = all->volumes[i];
        voxels_count += volume->voxels_count;
        for (uint32_t k = 0; k < volume->levels_count; k++) {
            const uint32_t *size = volume->levels[k].size;
            all->first_cells[i][k] = (uint32_t)cells_count;
            cells_count += (size_t)size[0] * size[1] * size[2];
        }
    }
    uint32_t *cells = ARENA_ARRAY(scratch, uint32_t, cells_count), first = 0;
    struct voxel *voxels = ARENA_ARRAY(scratch, struct voxel, voxels_count);
    for (size_t i = 0; i < species_count; i++) {
        const struct voxels *volume = all->volumes[i];
        memcpy(voxels + first, volume->voxels, volume->voxels_count * sizeof *voxels);
        for (uint32_t v = 0; v < volume->voxels_count && mesh_is_solid(all->meshes[i]); v++)
            voxels[first + v].color |= 15u << 28; /* needles are lit as bark is */
        for (uint32_t k = 0; k < volume->levels_count; k++) {
            const struct voxels_level *level = &volume->levels[k];
            voxels_gl_cells(level, first, cells + all->first_cells[i][k]);
        }
        first += volume->voxels_count;
    }
    all->cells = gl_buffer(gl, (GLsizeiptr)(cells_count * sizeof *cells), cells, 0);
    all->voxels = gl_buffer(gl, (GLsizeiptr)(voxels_count * sizeof *voxels), voxels, 0);
    arena_destroy(scratch);
}

enum status voxels_gl_prepare(struct workspace *workspace, const struct scene *scene,
                              int resolution, struct voxels_gl **voxels)
{
    const size_t count = scene->species_count;
    struct arena *arena = workspace->arena;
    struct voxels_gl *all = *voxels = ARENA_NEW(arena, struct voxels_gl);
    /* the level of detail is the volumes' resolution */
    int divisor = workspace->lod == LOD_LOW ? 4 : workspace->lod == LOD_INTERMEDIATE ? 2 : 1;
    resolution = (resolution + divisor - 1) / divisor;
    all->species_count = count;
    all->bounds = ARENA_ARRAY(arena, struct cull_bound, count);
    all->volumes = ARENA_ARRAY(arena, const struct voxels *, count);
    all->meshes = ARENA_ARRAY(arena, const struct mesh *, count);
    all->hulls = arena_alloc(arena, count, sizeof *all->hulls);
    all->first_cells = arena_alloc(arena, count, sizeof *all->first_cells);
    for (size_t i = 0; i < count; i++) {
        struct plant *plant = scene->species[i].plant;
        enum status status =
            voxels_of_plant(arena, plant, resolution, &all->volumes[i], workspace->error);
        if (!status)
            status = plant_mesh(plant, &all->meshes[i], workspace->error);
        if (status)
            return status;
        for (uint32_t k = 0; k < all->volumes[i]->levels_count; k++)
            hull_of_level(&all->volumes[i]->levels[k], &all->hulls[i][k]);
        all->bounds[i] = cull_bound_of(all->meshes[i]);
    }
    upload(workspace->gl, all);
    return STATUS_OK;
}
