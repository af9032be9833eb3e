/* Sky light, volumes, sun light. */
#include "bake/shadow_passes.h"
#include "bake/backdrop.h"
#include "bake/shadow_trees.h"

struct shadow_passes {
    struct backdrop *backdrop;
    struct sampling *sampling;
    struct shadow_trees *trees;
    struct shadow_volume *volume; /* NULL: nothing casts one */
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
    enum status status = STATUS_OK;
    volume.trees_alone = mapped;
    if (mapped)
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
    if (status == STATUS_OK)
        status = sampling_prepare(workspace, request->samples, &made->sampling);
    if (status == STATUS_OK)
        status = shadow_trees_prepare(workspace, scene, request->triangles_most, &made->trees);
    if (status == STATUS_OK && workspace->effects & EFFECT_SUN_SHADOWS)
        status = prepare_shadows(workspace, scene, request, made);
    return status;
}

static void draw_surfaces(struct workspace *workspace, struct shadow_passes *passes,
                          const struct view *view)
{
    backdrop_draw(workspace, passes->backdrop, view);
    shadow_trees_draw(workspace, passes->trees, view);
}

enum status shadow_passes_draw(struct workspace *workspace, void *state, const struct view *view,
                               struct target *target)
{
    struct shadow_passes *passes = state;
    struct view lit;
    enum status status = sampling_begin(workspace, passes->sampling, target, view, &lit);
    if (status != STATUS_OK)
        return status;
    if (passes->volume) {
        shadow_volume_extrude(workspace, passes->volume, view->sun_direction);
        shadow_volume_view(&lit);
        struct view dark = lit; /* N.L is 0 */
        dark.sun_direction[0] = dark.sun_direction[1] = dark.sun_direction[2] = 0;
        draw_surfaces(workspace, passes, &dark);
        shadow_volume_count(workspace, passes->volume, &lit);
    }
    draw_surfaces(workspace, passes, &lit);
    shadow_volume_end(workspace);
    sampling_end(workspace, passes->sampling, target);
    return gl_check(workspace->gl, "shadows", workspace->error);
}
