/* The choice of sun shadows: maps and what casts into them, volumes, and the passes that volumes
 * want. */
#include "bake/shadow_choice.h"
#include "bake/shadow_billboards.h"
#include "bake/shadow_trees.h"

struct sun_shadows {
    struct sun_shadows_request request;
    struct shadow_map *map;               /* that receivers know; of volumes alone, none at all */
    struct triangles *triangles;          /* own; NULL: the method's */
    struct shadow_billboards *billboards; /* cast where they suit; NULL: triangles do */
    struct shadow_volume *volume;         /* NULL: nothing casts one */
    const struct backdrop *backdrop;
};

unsigned shadow_choice_effects(const struct shadow_choice *choice)
{
    return EFFECTS_ALL & ~(unsigned)(choice->shadow ? 0 : EFFECT_SUN_SHADOWS);
}

struct sun_shadows_request shadow_choice_request(const struct shadow_choice *choice)
{
    return (struct sun_shadows_request){.technique = (enum shadow_technique)choice->shadow,
                                        .map = {.size_px = choice->shadow_size,
                                                .cascades = choice->cascades,
                                                .split = 0.9f,
                                                .stable = true,
                                                .linear = true,
                                                .radius = 1,
                                                .bias = SHADOW_BIAS_NORMAL,
                                                .bias_scale = 1,
                                                .depth_bits = 32,
                                                .caster_tx = 1},
                                        .casters = (enum shadow_casters)choice->casters,
                                        .volume = {.behind_px = 1.0f / 32},
                                        .triangles_most = choice->triangles,
                                        .texel_px = 1,
                                        .blend = 0.2f};
}

static enum status prepare_casters(struct workspace *workspace, const struct scene *scene,
                                   struct sun_shadows *shadows)
{
    const struct sun_shadows_request *request = &shadows->request;
    /* a tolerance asks for pruned leaves to be there; the map's pass chooses among them */
    struct triangles_request triangles = {.trees_room = scene->instances_count,
                                          .tolerance_px = request->casters != SHADOW_CASTERS_EXACT};
    enum status status = STATUS_OK;
    if (request->technique == SHADOW_BY_VOLUME || scene->instances_count == 0)
        return STATUS_OK;
    if (request->casters == SHADOW_CASTERS_BILLBOARD)
        status = shadow_billboards_prepare(workspace, scene, &request->map, &shadows->billboards);
    if (status != STATUS_OK || !request->own)
        return status;
    return triangles_prepare(workspace, scene, &triangles, &shadows->triangles);
}

/* Triangles of a relief that casts volumes, at most: neighbours of each are kept. */
enum { RELIEF_MOST = 1 << 22 };

/* A volume stands behind the very triangles of the relief: no levels of detail. */
static enum status check_relief(struct workspace *workspace, const struct terrain *terrain)
{
    double triangles = 2.0 * (terrain->samples_x - 1) * (terrain->samples_z - 1);
    if (terrain->detail_px > 0)
        return error_set(workspace->error, STATUS_UNSUPPORTED,
                         "terrain.detail_px: %g; allowed by shadow volumes: 0, every triangle is "
                         "drawn and casts",
                         (double)terrain->detail_px);
    if (triangles > RELIEF_MOST)
        return error_set(workspace->error, STATUS_UNSUPPORTED,
                         "terrain: %.0f triangles; allowed by shadow volumes: %d", triangles,
                         RELIEF_MOST);
    return STATUS_OK;
}

static enum status prepare_volume(struct workspace *workspace, const struct scene *scene,
                                  struct sun_shadows *shadows)
{
    const struct sun_shadows_request *request = &shadows->request;
    bool relief = scene->terrain.samples_x > 1 && !request->volume.trees_alone;
    if (request->technique < SHADOW_BY_VOLUME)
        return STATUS_OK;
    enum status status = shadow_trees_check(workspace, scene, request->triangles_most);
    if (status == STATUS_OK && relief)
        status = check_relief(workspace, &scene->terrain);
    if (status != STATUS_OK || !(scene->instances_count || relief))
        return status;
    return shadow_volume_prepare(workspace, scene, &request->volume, &shadows->volume);
}

enum status sun_shadows_prepare(struct workspace *workspace, const struct scene *scene,
                                const struct sun_shadows_request *request,
                                struct backdrop *backdrop, struct sun_shadows **result)
{
    struct sun_shadows *shadows = *result = ARENA_NEW(workspace->arena, struct sun_shadows);
    struct shadow_options *map = &shadows->request.map;
    shadows->request = *request;
    shadows->backdrop = backdrop;
    if (request->casters == SHADOW_CASTERS_EXACT)
        map->caster_tx = 0;
    if (request->technique == SHADOW_BY_VOLUME)
        map->cascades = 0;
    map->shared = request->technique == SHADOW_BY_HYBRID;
    enum status status = shadow_map_prepare(workspace, scene, map, &shadows->map);
    if (status == STATUS_OK)
        status = backdrop_receive(workspace, backdrop, shadows->map);
    if (status == STATUS_OK)
        status = prepare_casters(workspace, scene, shadows);
    return status == STATUS_OK ? prepare_volume(workspace, scene, shadows) : status;
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

bool sun_shadows_count(const struct sun_shadows *shadows)
{
    return shadows && shadows->volume;
}

uint64_t sun_shadows_samples(const struct sun_shadows *shadows)
{
    if (!shadows || shadows->request.technique == SHADOW_BY_VOLUME)
        return 0;
    int taps = 2 * shadows->request.map.radius + 1; /* along a side */
    return (uint64_t)(taps * taps);
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

/* To which depth volumes shade, m; 0: they need not be drawn. */
static float depth_of_volumes(const struct sun_shadows *shadows, const struct view *view)
{
    const struct sun_shadows_request *request = &shadows->request;
    float deep_m = request->near_m;
    if (!shadows->volume)
        return 0;
    if (request->technique == SHADOW_BY_VOLUME)
        return INFINITY;
    if (!(deep_m > 0))
        deep_m = shadow_map_fine_m(shadows->map, view, request->texel_px);
    return deep_m > view->near_m ? deep_m : 0;
}

/* lit: what is drawn next is where no volume is, else in one. */
static void share(struct sun_shadows *shadows, float deep_m, bool lit)
{
    static const float step = 1e-4f; /* of the depth, that a blend takes at least */
    shadow_map_share(shadows->map,
                     (struct shadow_share){deep_m * (1 - fmaxf(shadows->request.blend, step)),
                                           deep_m > 0 ? deep_m : 1e-30f, lit});
}

enum status sun_shadows_draw(struct workspace *workspace, struct sun_shadows *shadows,
                             const struct view *view, const struct view *drawn,
                             sun_shadows_surfaces *surfaces, void *state)
{
    /* volumes are counted a little beyond their depth, which the middle of a pixel's triangle may
     * be before and its samples behind */
    static const float beyond = 1.25f;
    if (!shadows)
        return surfaces(workspace, state, drawn);
    const float deep_m = depth_of_volumes(shadows, view);
    struct view endless = *drawn;
    enum status status = STATUS_OK;
    if (deep_m > 0) {
        shadow_volume_view(&endless);
        shadow_volume_extrude(workspace, shadows->volume, &endless, beyond * deep_m);
        share(shadows, deep_m, false);
        status = surfaces(workspace, state, &endless);
        shadow_volume_count(workspace, shadows->volume, &endless, beyond * deep_m);
    }
    share(shadows, deep_m, true);
    if (status == STATUS_OK)
        status = surfaces(workspace, state, &endless);
    if (deep_m > 0)
        shadow_volume_end(workspace);
    return status;
}
