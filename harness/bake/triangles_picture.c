/* Pictures of trees by their triangles: shadows, backdrop, trees, samples. */
#include "bake/triangles_picture.h"
#include "bake/sampling.h"

struct triangles_picture {
    struct backdrop *backdrop;
    struct sampling *sampling;
    struct sun_shadows *shadows; /* NULL: none */
    struct triangles *triangles;
    struct cull *cull;
};

enum status triangles_picture_prepare(struct workspace *workspace, const struct scene *scene,
                                      const struct triangles_picture_request *request,
                                      void **result)
{
    struct triangles_picture *picture = *result =
        ARENA_NEW(workspace->arena, struct triangles_picture);
    enum status status = backdrop_prepare(workspace, scene, &picture->backdrop);
    if (status == STATUS_OK)
        status = sampling_prepare(workspace, request->samples, &picture->sampling);
    if (status == STATUS_OK && request->shadows && workspace->effects & EFFECT_SUN_SHADOWS)
        status = sun_shadows_prepare(workspace, scene, request->shadows, picture->backdrop,
                                     &picture->shadows);
    if (sun_shadows_count(picture->shadows))
        sampling_stencil(picture->sampling);
    struct triangles_request triangles = {
        .trees_room = scene->instances_count,
        .tolerance_px = triangles_tolerance_px(request->error_px, workspace->lod),
        .smooth = request->smooth,
        .contrast = request->contrast,
        .sift = request->sift,
        .shadows = sun_shadows_map(picture->shadows)};
    if (status == STATUS_OK)
        status = triangles_prepare(workspace, scene, &triangles, &picture->triangles);
    if (status == STATUS_OK)
        picture->cull = cull_create(workspace->arena, scene, triangles_bounds(picture->triangles));
    return status;
}

/* What is drawn in each pass. */
struct surfaces {
    struct triangles_picture *picture;
    const struct view *view; /* the picture's */
};

static enum status draw_surfaces(struct workspace *workspace, void *state, const struct view *drawn)
{
    const struct surfaces *surfaces = state;
    struct triangles_picture *picture = surfaces->picture;
    struct view view = *drawn; /* error_px refers to the picture's size */
    view.width_px = surfaces->view->width_px;
    view.height_px = surfaces->view->height_px;
    backdrop_draw(workspace, picture->backdrop, drawn);
    struct cull_list list =
        cull_view(picture->cull, surfaces->view, triangles_order(picture->triangles));
    struct triangles_frame frame = {.view = &view,
                                    .drawn = drawn,
                                    .places = sampling_places(picture->sampling),
                                    .cull = picture->cull};
    triangles_draw(workspace, picture->triangles, &frame, &list);
    return STATUS_OK;
}

enum status triangles_picture_draw(struct workspace *workspace, void *state,
                                   const struct view *view, struct target *target)
{
    struct triangles_picture *picture = state;
    struct surfaces surfaces = {picture, view};
    struct view drawn = sampling_view(picture->sampling, view);
    enum status status =
        sun_shadows_update(workspace, picture->shadows, &drawn, picture->triangles);
    if (status == STATUS_OK)
        status = sampling_begin(workspace, picture->sampling, target, view, &drawn);
    if (status == STATUS_OK)
        status =
            sun_shadows_draw(workspace, picture->shadows, view, &drawn, draw_surfaces, &surfaces);
    if (status != STATUS_OK)
        return status;
    sampling_end(workspace, picture->sampling, target);
    return gl_check(workspace->gl, "triangles", workspace->error);
}
