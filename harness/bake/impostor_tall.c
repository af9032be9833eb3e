/* Scenes of stretched trees as scenes of stretched plants. */
#include "bake/impostor_tall.h"

#include <math.h>

enum { STEPS = 25, MIDDLE = STEPS / 2 }; /* a quarter of an octave each, 1/8 to 8 */

static size_t step_of(const struct instance *tree)
{
    long step = lroundf(4 * log2f(tree->stretch)) + MIDDLE;
    return (size_t)(step < 0 ? 0 : step >= STEPS ? STEPS - 1 : step);
}

static float stretch_of(size_t step)
{
    return exp2f(0.25f * ((float)step - MIDDLE));
}

/* A normal N of a plant is D N in one that is stretched, D = diag(1, 1 / stretch, 1), made unit. */
static struct mesh *mesh_stretch(struct arena *arena, const struct mesh *mesh, float stretch)
{
    struct mesh *tall = ARENA_NEW(arena, struct mesh);
    *tall = *mesh;
    tall->positions = arena_alloc(arena, mesh->vertices_count, sizeof *tall->positions);
    tall->normals = arena_alloc(arena, mesh->vertices_count, sizeof *tall->normals);
    for (size_t k = 0; k < mesh->vertices_count; k++) {
        const float *n = mesh->normals[k];
        float y = n[1] / stretch, length = sqrtf(n[0] * n[0] + y * y + n[2] * n[2]);
        float per = length > 0 ? 1 / length : 0;
        for (int i = 0; i < 3; i++) {
            tall->positions[k][i] = mesh->positions[k][i] * (i == 1 ? stretch : 1);
            tall->normals[k][i] = per * (i == 1 ? y : n[i]);
        }
    }
    tall->minimum_m[1] *= stretch;
    tall->maximum_m[1] *= stretch;
    return tall;
}

static enum status species_stretch(struct workspace *workspace, const struct species *species,
                                   float stretch, struct species *tall)
{
    const struct mesh *mesh;
    enum status status = plant_mesh(species->plant, &mesh, workspace->error);
    if (status != STATUS_OK)
        return status;
    *tall = *species;
    if (stretch != 1)
        tall->plant = plant_from_mesh(workspace->arena, plant_name(species->plant),
                                      mesh_stretch(workspace->arena, mesh, stretch));
    return STATUS_OK;
}

enum status impostor_tall(struct workspace *workspace, const struct scene *scene,
                          const struct scene **result)
{
    *result = scene;
    if (!scene_is_stretched(scene))
        return STATUS_OK;
    struct arena *arena = workspace->arena;
    struct scene *tall = ARENA_NEW(arena, struct scene);
    enum status status = STATUS_OK;
    uint32_t *numbers = ARENA_ARRAY(arena, uint32_t, scene->species_count * STEPS); /* 0: none */
    *tall = *scene;
    tall->species_count = 0;
    tall->species = ARENA_ARRAY(arena, struct species, scene->species_count * STEPS);
    tall->instances = ARENA_ARRAY(arena, struct instance, scene->instances_count);
    for (size_t i = 0; i < scene->instances_count && status == STATUS_OK; i++) {
        const struct instance *tree = &scene->instances[i];
        const size_t step = step_of(tree);
        uint32_t *number = &numbers[tree->species * STEPS + step];
        if (*number == 0) {
            status = species_stretch(workspace, &scene->species[tree->species], stretch_of(step),
                                     &tall->species[tall->species_count]);
            *number = (uint32_t)++tall->species_count;
        }
        tall->instances[i] = *tree;
        tall->instances[i].species = *number - 1;
        tall->instances[i].stretch = tree->stretch / stretch_of(step);
    }
    *result = tall;
    return status;
}
