/* The march prepared, and its frame: trees sorted and binned to tiles, tiles drawn front to back by
 * all threads. */
#include "bake/march_frame.h"

#include <string.h>

static march_kernel *kernel_named(const char *name)
{
    struct march_isa isas[4];
    size_t count = march_isas(isas), chosen = name ? 0 : count - 1;
    for (size_t i = 0; i < count && name; i++)
        chosen = strcmp(isas[i].name, name) ? chosen : i;
    return isas[chosen].kernel;
}

static enum status species_prepare(struct workspace *workspace, struct plant *plant,
                                   const struct march_options *options,
                                   struct march_species *species, struct cull_bound *bound)
{
    const struct mesh *mesh;
    const struct voxels *voxels;
    enum status status =
        voxels_of_plant(workspace->arena, plant, options->resolution, &voxels, workspace->error);
    if (!status)
        status = plant_mesh(plant, &mesh, workspace->error);
    if (status)
        return status;
    if (options->model == MARCH_NOMA)
        voxels = voxels_noma(workspace->arena, voxels);
    if (options->model == MARCH_VISIBLE)
        voxels = voxels_visible(workspace->arena, voxels);
    *bound = cull_bound_of(mesh);
    march_species_fill(workspace->arena, voxels, mesh, species);
    return STATUS_OK;
}

enum status march_prepare(struct workspace *workspace, const struct scene *scene,
                          const struct march_options *options, struct march **result)
{
    struct march *march = *result = ARENA_NEW(workspace->arena, struct march);
    march->scene = scene;
    march->options = *options;
    march->options.far_px = options->slab > 0 ? 0 : options->far_px;
    march->kernel = kernel_named(options->isa);
    enum status status = backdrop_cpu_prepare(workspace, scene, &march->backdrop);
    march->species = ARENA_ARRAY(workspace->arena, struct march_species, scene->species_count);
    struct cull_bound *bounds =
        ARENA_ARRAY(workspace->arena, struct cull_bound, scene->species_count);
    for (size_t i = 0; i < scene->species_count && !status; i++)
        status = species_prepare(workspace, scene->species[i].plant, options, &march->species[i],
                                 &bounds[i]);
    if (status)
        return status;
    march->trees = ARENA_ARRAY(workspace->arena, struct march_tree, scene->instances_count);
    march_trees_fill(scene, march->trees);
    march->fars = march_fars_create(workspace->arena, scene, march->trees, workspace->threads);
    if (options->cells && !scene_is_stretched(scene)) /* cells know one shape of a species */
        march->cells = cells_create(workspace->arena, scene, bounds);
    else
        march->cull = cull_create(workspace->arena, scene, bounds);
    size_t most = scene->instances_count + (march->cells ? cells_count(march->cells) : 0);
    march->seen = ARENA_ARRAY(workspace->arena, struct march_seen, most);
    if (options->slab > 0)
        march->spans = ARENA_ARRAY(workspace->arena, struct march_span, most);
    if (workspace->effects & EFFECT_SUN_SHADOWS)
        return march_shadows_create(workspace, scene, options, march->species, march->trees,
                                    march->cells, &march->shadows);
    return STATUS_OK;
}

/* What is in view, front to back: by cells, or tree by tree. */
static struct cells_list list_of(struct march *march, const struct view *view, int threads)
{
    const struct cells_limits limits = {MARCH_CELL_PX, MARCH_SMALL_PX, march->options.smooth};
    if (march->cells)
        return cells_view(march->cells, view, &limits, threads);
    struct cull_list list = cull_view(march->cull, view, CULL_FRONT_TO_BACK);
    return (struct cells_list){list.count, list.instances, list.depths_m, NULL};
}

enum status march_draw(struct workspace *workspace, struct march *march, const struct view *view,
                       struct target *target)
{
    const struct march_view picture = {
        .view = view,
        .scene = march->scene,
        .rays = backdrop_rays_of(view),
        .focal_px = cull_focal_px(view),
        .effects = workspace->effects,
        .options = march->options,
        .species = march->species,
        .shadows = march->shadows,
    };
    if (march->shadows)
        march_shadows_light(march->shadows, view->sun_direction, workspace->threads);
    const struct march_tiles tiles = march_tiles_of(march, view);
    backdrop_cpu_begin(workspace, march->backdrop, view);
    march_fars_begin(march->fars);
    struct cells_list list = list_of(march, view, workspace->threads);
    march_bin(workspace, march, &picture, &tiles, &list);
    march_fars_make(march->fars, &picture, march->kernel);
    uint64_t lookups = 0;
#pragma omp parallel num_threads(workspace->threads) reduction(+ : lookups)
    {
        struct canvas canvas;
        canvas.backdrop = march->backdrop;
        canvas.kernel = march->kernel;
#pragma omp for schedule(dynamic, 1)
        for (size_t tile = 0; tile < tiles.count; tile++)
            lookups +=
                march_tile_draw(march, &picture, &tiles, &list, tile, &canvas, target->pixels);
    }
    workspace->tally.lookups += lookups;
    size_t spheres = march->cull ? march->scene->instances_count : 0;
    workspace->tally.bytes += spheres * 4 * sizeof(float) + list.count * sizeof *march->trees;
    return STATUS_OK;
}
