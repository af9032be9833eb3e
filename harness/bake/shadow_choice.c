/* The choice of sun shadows: a map, and what casts into it. */
#include "bake/shadow_choice.h"
#include "bake/shadow_billboards.h"

struct sun_shadows {
    struct shadow_map *map;
    struct triangles *triangles;          /* own; NULL: the method's, or pictures */
    struct shadow_billboards *billboards; /* NULL: triangles cast */
    const struct backdrop *backdrop;
    int taps; /* along a side */
};

unsigned shadow_choice_effects(const struct shadow_choice *choice)
{
    return EFFECTS_ALL & ~(unsigned)(choice->shadow ? 0 : EFFECT_SUN_SHADOWS);
}

struct sun_shadows_request shadow_choice_request(const struct shadow_choice *choice)
{
    return (struct sun_shadows_request){.map = {.size_px = choice->shadow_size,
                                                .cascades = choice->cascades,
                                                .split = 0.9f,
                                                .stable = true,
                                                .linear = true,
                                                .radius = 1,
                                                .bias = SHADOW_BIAS_NORMAL,
                                                .bias_scale = 1,
                                                .depth_bits = 32,
                                                .caster_tx = 1},
                                        .casters = (enum shadow_casters)choice->casters};
}

static enum status prepare_casters(struct workspace *workspace, const struct scene *scene,
                                   const struct sun_shadows_request *request,
                                   struct sun_shadows *shadows)
{
    /* a tolerance asks for pruned leaves to be there; the map's pass chooses among them */
    struct triangles_request triangles = {.trees_room = scene->instances_count,
                                          .tolerance_px =
                                              request->casters == SHADOW_CASTERS_LOW ? 1 : 0};
    if (request->casters == SHADOW_CASTERS_BILLBOARD)
        return shadow_billboards_prepare(workspace, scene, &request->map, &shadows->billboards);
    if (!request->own || scene->instances_count == 0)
        return STATUS_OK;
    return triangles_prepare(workspace, scene, &triangles, &shadows->triangles);
}

enum status sun_shadows_prepare(struct workspace *workspace, const struct scene *scene,
                                const struct sun_shadows_request *request,
                                struct backdrop *backdrop, struct sun_shadows **result)
{
    struct sun_shadows *shadows = *result = ARENA_NEW(workspace->arena, struct sun_shadows);
    struct shadow_options map = request->map;
    if (request->casters == SHADOW_CASTERS_EXACT)
        map.caster_tx = 0;
    shadows->backdrop = backdrop;
    shadows->taps = 2 * map.radius + 1;
    enum status status = shadow_map_prepare(workspace, scene, &map, &shadows->map);
    if (status == STATUS_OK)
        status = backdrop_receive(workspace, backdrop, shadows->map);
    if (status == STATUS_OK)
        status = prepare_casters(workspace, scene, request, shadows);
    return status;
}

enum status shadow_choice_prepare(struct workspace *workspace, const struct scene *scene,
                                  const struct shadow_choice *choice, bool own,
                                  struct backdrop *backdrop, struct sun_shadows **shadows)
{
    struct sun_shadows_request request = shadow_choice_request(choice);
    request.own = own;
    *shadows = NULL;
    if (!choice->shadow || !(workspace->effects & EFFECT_SUN_SHADOWS))
        return STATUS_OK;
    return sun_shadows_prepare(workspace, scene, &request, backdrop, shadows);
}

const struct shadow_map *sun_shadows_map(const struct sun_shadows *shadows)
{
    return shadows ? shadows->map : NULL;
}

void sun_shadows_share(struct sun_shadows *shadows, struct shadow_share share)
{
    shadow_map_share(shadows->map, share);
}

uint64_t sun_shadows_samples(const struct sun_shadows *shadows)
{
    return shadows ? (uint64_t)(shadows->taps * shadows->taps) : 0;
}

enum status sun_shadows_update(struct workspace *workspace, struct sun_shadows *shadows,
                               const struct view *view, struct triangles *drawn)
{
    if (!shadows)
        return STATUS_OK;
    struct shadow_cast_by trees = {.triangles = shadows->triangles ? shadows->triangles : drawn,
                                   .billboards = shadows->billboards};
    return shadow_map_update(workspace, shadows->map, view, &trees, shadows->backdrop);
}
