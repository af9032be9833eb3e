/* Voxels of all species, made or read from the cache, into OpenGL's buffers. */
#include "bake/voxels_gl.h"
#include "bake/march_free.h"

#include <string.h>

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
            const uint32_t *own = march_free_cells(scratch, level);
            uint32_t *row = cells + all->first_cells[i][k];
            for (size_t at = (size_t)level->size[0] * level->size[1] * level->size[2]; at-- > 0;)
                row[at] = own[at] + (own[at] & MARCH_FULL ? first : 0);
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
    all->resolution = resolution;
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
