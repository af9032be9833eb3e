/* All triangles in the passes of volumes; horizon maps. */
#include "bake/shadow_passes.h"
#include "bake/backdrop.h"
#include "bake/shadow_trees.h"

struct shadow_passes {
    struct backdrop *backdrop;
    struct sampling *sampling;
    struct shadow_trees *trees;
    struct sun_shadows *sun; /* NULL: none */
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

/* A horizon is kept for every sample of the relief: no levels of detail. */
static enum status prepare_skyline(struct workspace *workspace, const struct scene *scene,
                                   const struct shadow_passes_request *request,
                                   struct backdrop *backdrop)
{
    if (scene->terrain.detail_px > 0)
        return error_set(workspace->error, STATUS_UNSUPPORTED,
                         "terrain.detail_px: %g; allowed by horizon maps: 0, every triangle is "
                         "drawn",
                         (double)scene->terrain.detail_px);
    struct arena *passing = arena_create(0);
    struct skyline skyline;
    struct terrain fine;
    skyline_refine(passing, &scene->terrain, parts_of(&scene->terrain, request), &fine);
    skyline_bake(passing, &fine, request->azimuths, workspace->threads, &skyline);
    enum status status = backdrop_skyline(workspace, backdrop, &skyline, request->mixed);
    arena_destroy(passing);
    return status;
}

enum status shadow_passes_prepare(struct workspace *workspace, const struct scene *scene,
                                  const struct shadow_passes_request *request, void **passes)
{
    struct shadow_passes *made = *passes = ARENA_NEW(workspace->arena, struct shadow_passes);
    struct sun_shadows_request sun = request->sun;
    enum status status = backdrop_prepare(workspace, scene, &made->backdrop);
    bool shadows = workspace->effects & EFFECT_SUN_SHADOWS;
    bool mapped = shadows && scene->terrain.samples_x > 1 && request->azimuths > 0;
    sun.volume.trees_alone = mapped;
    if (status == STATUS_OK)
        status = sampling_prepare(workspace, request->samples, &made->sampling);
    if (status == STATUS_OK && shadows)
        status = sun_shadows_prepare(workspace, scene, &sun, made->backdrop, &made->sun);
    if (status == STATUS_OK && mapped)
        status = prepare_skyline(workspace, scene, request, made->backdrop);
    if (status == STATUS_OK)
        status = shadow_trees_prepare(workspace, scene, sun.triangles_most,
                                      sun_shadows_map(made->sun), &made->trees);
    if (status == STATUS_OK && sun_shadows_count(made->sun))
        sampling_stencil(made->sampling);
    return status;
}

static enum status draw_surfaces(struct workspace *workspace, void *state, const struct view *view)
{
    struct shadow_passes *passes = state;
    backdrop_draw(workspace, passes->backdrop, view);
    shadow_trees_draw(workspace, passes->trees, view);
    return STATUS_OK;
}

enum status shadow_passes_draw(struct workspace *workspace, void *state, const struct view *view,
                               struct target *target)
{
    struct shadow_passes *passes = state;
    struct view drawn = sampling_view(passes->sampling, view);
    enum status status = sun_shadows_update(workspace, passes->sun, &drawn, NULL);
    if (status == STATUS_OK)
        status = sampling_begin(workspace, passes->sampling, target, view, &drawn);
    if (status == STATUS_OK)
        status = sun_shadows_draw(workspace, passes->sun, view, &drawn, draw_surfaces, passes);
    if (status != STATUS_OK)
        return status;
    sampling_end(workspace, passes->sampling, target);
    return gl_check(workspace->gl, "shadows", workspace->error);
}
