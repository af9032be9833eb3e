/* Conifers' frame: plants, light, canvas, and one of the two ways over them. */
#include "bake/cones.h"
#include "bake/cones_parts.h"

#include <math.h>
#include <string.h>

static void (*shade_of(const char *isa))(struct cone_lanes_job *job)
{
    struct cone_isa isas[2];
    size_t count = cone_isas(isas), chosen = isa ? 0 : count - 1;
    for (size_t i = 0; i < count && isa; i++)
        chosen = strcmp(isas[i].name, isa) ? chosen : i;
    return isas[chosen].shade;
}

enum status cones_prepare(struct workspace *workspace, const struct scene *scene,
                          const struct cones_options *options, struct cones **result)
{
    struct arena *arena = workspace->arena;
    struct cones *cones = *result = ARENA_NEW(arena, struct cones);
    struct cull_bound *bounds = ARENA_ARRAY(arena, struct cull_bound, scene->species_count);
    enum status status = STATUS_OK;
    *cones = (struct cones){.arena = arena, .scene = scene, .options = *options};
    cones->plants = ARENA_ARRAY(arena, struct cone_plant *, scene->species_count);
    for (size_t i = 0; i < scene->species_count; i++) {
        const struct conifer *conifer;
        status = plant_conifer(scene->species[i].plant, &conifer, workspace->error);
        if (status)
            return status;
        struct cone_plant *plant = cones->plants[i] = cone_plant_create(arena, conifer);
        cone_outline_measure(scene, options->shaders, &options->choice, workspace->threads, plant);
        float x = plant->center_m[0], z = plant->center_m[2];
        bounds[i] = (struct cull_bound){plant->center_m[1], plant->radius_m + sqrtf(x * x + z * z)};
    }
    if (options->shadows && workspace->effects & EFFECT_SUN_SHADOWS)
        cones->lights = cone_lights_create(arena, scene, cones->plants);
    cones->canvas = cone_canvas_create(workspace, scene, cones->lights, options->edges, &status);
    if (status)
        return status;
    cones->cull = cull_create(arena, scene, bounds);
    if (!options->is_naive && options->shaders == CONE_EXACT)
        cones->shade = shade_of(options->isa);
    if (options->is_naive)
        cones->naive = cones_naive_create(arena, cones);
    else
        cones->fast = cones_fast_create(arena, cones);
    return STATUS_OK;
}

static struct cone_picture picture_of(const struct workspace *workspace, const struct cones *cones,
                                      const struct view *view)
{
    const struct scene *scene = cones->scene;
    const unsigned effects = workspace->effects;
    struct cone_picture picture = {
        .view = view,
        .scene = scene,
        .effects = effects,
        .focal_px = cull_focal_px(view),
        .fog_density_per_m = effects & EFFECT_FOG ? scene->fog.density_per_m : 0,
        .choice = cones->options.choice,
        .shaders = cones->options.shaders,
        .shade = cones->shade,
        .plants = cones->plants,
        .lights = cones->lights,
        .canvas = cones->naive ? NULL : cones->canvas,
    };
    memcpy(picture.sun, scene->sun.radiance, sizeof picture.sun);
    if (effects & EFFECT_AMBIENT)
        memcpy(picture.ambient, scene->ambient, sizeof picture.ambient);
    return picture;
}

enum status cones_draw(struct workspace *workspace, struct cones *cones, const struct view *view,
                       struct target *target)
{
    const struct cone_picture picture = picture_of(workspace, cones, view);
    if (cones->lights)
        cone_lights_turn(cones->lights, view->sun_direction, workspace->threads);
    float bark[3];
    if (cones_within(cones, &picture, bark)) {
        for (size_t i = 0; i < (size_t)view->width_px * (size_t)view->height_px; i++) {
            memcpy(target->pixels + 4 * i, bark, sizeof bark);
            target->pixels[4 * i + 3] = 1;
        }
        return STATUS_OK;
    }
    cone_canvas_begin(workspace, cones->canvas, view);
    workspace->tally.lookups += cones->naive ? cones_naive_draw(workspace, cones, &picture)
                                             : cones_fast_draw(workspace, cones, &picture);
    cone_canvas_end(workspace, cones->canvas, cones->options.stop, target->pixels);
    return STATUS_OK;
}
