/* Sky light, volumes, sun light; beyond the volumes, a map. */
#include "bake/shadow_passes.h"
#include "bake/backdrop.h"
#include "bake/shadow_trees.h"

struct shadow_passes {
    struct backdrop *backdrop;
    struct sampling *sampling;
    struct shadow_trees *trees;
    struct shadow_volume *volume; /* NULL: nothing casts one */
    struct sun_shadows *map;      /* NULL: volumes shade everything */
    float near_m, texel_px, blend;
};

/* As many parts as are wanted and texels there is room for. */
static int parts_of(const struct terrain *terrain, const struct shadow_passes_request *request)
{
    const size_t texels_most = (size_t)1 << 25;
    size_t samples = (size_t)terrain->samples_x * terrain->samples_z * (size_t)request->azimuths;
    int parts = request->detail;
    while (parts > 1 && samples * (size_t)(parts * parts) > texels_most)
        parts--;
    return parts;
}

/* Triangles of a relief that casts volumes, at most: neighbours of each are kept. */
enum { RELIEF_MOST = 1 << 22 };

/* A horizon is kept for every sample of the relief, and a volume stands behind the very triangles
 * that are drawn: no levels of detail. */
static enum status check_relief(struct workspace *workspace, const struct terrain *terrain,
                                bool mapped)
{
    double triangles = 2.0 * (terrain->samples_x - 1) * (terrain->samples_z - 1);
    if (terrain->detail_px > 0)
        return error_set(workspace->error, STATUS_UNSUPPORTED,
                         "terrain.detail_px: %g; allowed by %s: 0, every triangle is drawn%s",
                         (double)terrain->detail_px, mapped ? "horizon maps" : "shadow volumes",
                         mapped ? "" : " and casts");
    if (!mapped && triangles > RELIEF_MOST)
        return error_set(workspace->error, STATUS_UNSUPPORTED,
                         "terrain: %.0f triangles; allowed by shadow volumes: %d", triangles,
                         RELIEF_MOST);
    return STATUS_OK;
}

static enum status prepare_skyline(struct workspace *workspace, const struct scene *scene,
                                   const struct shadow_passes_request *request,
                                   struct backdrop *backdrop)
{
    struct arena *passing = arena_create(0);
    struct skyline skyline;
    struct terrain fine;
    skyline_refine(passing, &scene->terrain, parts_of(&scene->terrain, request), &fine);
    skyline_bake(passing, &fine, request->azimuths, workspace->threads, &skyline);
    enum status status = backdrop_skyline(workspace, backdrop, &skyline, request->mixed);
    arena_destroy(passing);
    return status;
}

static enum status prepare_shadows(struct workspace *workspace, const struct scene *scene,
                                   const struct shadow_passes_request *request,
                                   struct shadow_passes *passes)
{
    bool relief = scene->terrain.samples_x > 1, mapped = relief && request->azimuths > 0;
    struct shadow_volume_request volume = request->volume;
    enum status status = relief ? check_relief(workspace, &scene->terrain, mapped) : STATUS_OK;
    volume.trees_alone = mapped;
    if (status == STATUS_OK && mapped)
        status = prepare_skyline(workspace, scene, request, passes->backdrop);
    if (status != STATUS_OK || !(scene->instances_count || (relief && !mapped)))
        return status;
    sampling_stencil(passes->sampling);
    return shadow_volume_prepare(workspace, scene, &volume, &passes->volume);
}

enum status shadow_passes_prepare(struct workspace *workspace, const struct scene *scene,
                                  const struct shadow_passes_request *request, void **passes)
{
    struct shadow_passes *made = *passes = ARENA_NEW(workspace->arena, struct shadow_passes);
    enum status status = backdrop_prepare(workspace, scene, &made->backdrop);
    bool shadows = workspace->effects & EFFECT_SUN_SHADOWS;
    made->near_m = request->near_m;
    made->texel_px = request->texel_px;
    made->blend = request->blend;
    if (status == STATUS_OK)
        status = sampling_prepare(workspace, request->samples, &made->sampling);
    if (status == STATUS_OK && shadows && request->map)
        status = sun_shadows_prepare(workspace, scene, request->map, made->backdrop, &made->map);
    if (status == STATUS_OK)
        status = shadow_trees_prepare(workspace, scene, request->triangles_most,
                                      sun_shadows_map(made->map), &made->trees);
    if (status == STATUS_OK && shadows)
        status = prepare_shadows(workspace, scene, request, made);
    return status;
}

static void draw_surfaces(struct workspace *workspace, struct shadow_passes *passes,
                          const struct view *view)
{
    backdrop_draw(workspace, passes->backdrop, view);
    shadow_trees_draw(workspace, passes->trees, view);
}

/* To which depth volumes shade, m; 0: they need not be drawn. */
static float depth_of_volumes(const struct shadow_passes *passes, const struct view *view)
{
    const struct shadow_map *map = sun_shadows_map(passes->map);
    float deep_m = passes->near_m;
    if (!passes->volume)
        return 0;
    if (!map)
        return INFINITY;
    if (!(deep_m > 0))
        deep_m = shadow_map_fine_m(map, view, passes->texel_px);
    return deep_m > view->near_m ? deep_m : 0;
}

/* lit: where no volume is, else in one. */
static void share_with_map(struct shadow_passes *passes, float deep_m, bool lit)
{
    static const float step = 1e-4f; /* of the depth, that a blend takes at least */
    if (passes->map)
        sun_shadows_share(passes->map,
                          (struct shadow_share){deep_m * (1 - fmaxf(passes->blend, step)),
                                                deep_m > 0 ? deep_m : 1e-30f, lit});
}

/* Surfaces out of the sun, but for what the map says, then the volumes' count: a little beyond
 * their depth, which the middle of a pixel's triangle may be before and its samples behind. */
static void draw_volumes(struct workspace *workspace, struct shadow_passes *passes,
                         const struct view *view, float deep_m)
{
    static const float beyond = 1.25f;
    shadow_volume_extrude(workspace, passes->volume, view, beyond * deep_m);
    struct view dark = *view; /* N.L is 0 */
    dark.sun_direction[0] = dark.sun_direction[1] = dark.sun_direction[2] = 0;
    share_with_map(passes, deep_m, false);
    draw_surfaces(workspace, passes, passes->map ? view : &dark);
    shadow_volume_count(workspace, passes->volume, view, beyond * deep_m);
}

enum status shadow_passes_draw(struct workspace *workspace, void *state, const struct view *view,
                               struct target *target)
{
    struct shadow_passes *passes = state;
    struct view lit = sampling_view(passes->sampling, view);
    enum status status = sun_shadows_update(workspace, passes->map, &lit, NULL);
    if (status == STATUS_OK)
        status = sampling_begin(workspace, passes->sampling, target, view, &lit);
    if (status != STATUS_OK)
        return status;
    const float deep_m = depth_of_volumes(passes, view);
    if (deep_m > 0) {
        shadow_volume_view(&lit);
        draw_volumes(workspace, passes, &lit, deep_m);
    }
    share_with_map(passes, deep_m, true);
    draw_surfaces(workspace, passes, &lit);
    shadow_volume_end(workspace);
    sampling_end(workspace, passes->sampling, target);
    return gl_check(workspace->gl, "shadows", workspace->error);
}
