/* Near trees: which they are, when their triangles are uploaded. */
#include "bake/nearby.h"
#include "bake/triangles.h"

#include <string.h>

/* Places along the camera's path that are looked at. */
enum { PATH_PLACES = 65 };

struct nearby {
    const struct scene *scene;
    struct cull_cylinder *cylinders; /* of each species: an eye within is near */
    float reach_m;                   /* no near tree's middle is farther from the eye */
    struct triangles *triangles;     /* NULL: not needed yet */
    const struct shadow_map *shadows;
    size_t count;
    uint32_t instances[NEARBY_MOST];
    float depths_m[NEARBY_MOST];
};

static bool is_near(const struct nearby *nearby, uint32_t instance, const float eye_m[3])
{
    const struct instance *tree = &nearby->scene->instances[instance];
    return cull_cylinder_holds(&nearby->cylinders[tree->species], tree, eye_m, 0);
}

static enum status upload(struct workspace *workspace, struct nearby *nearby)
{
    const struct triangles_request request = {
        .trees_room = NEARBY_MOST, .sift = true, .shadows = nearby->shadows};
    return triangles_prepare(workspace, nearby->scene, &request, &nearby->triangles);
}

static bool path_comes_near(const struct nearby *nearby)
{
    const struct scene *scene = nearby->scene;
    size_t places =
        scene->camera.frames_count < PATH_PLACES ? scene->camera.frames_count : PATH_PLACES;
    for (size_t k = 0; k < places; k++) {
        struct view view;
        view_at(scene, path_time(scene, k, places), &view);
        for (size_t i = 0; i < scene->instances_count; i++)
            if (is_near(nearby, (uint32_t)i, view.eye_m))
                return true;
    }
    return false;
}

enum status nearby_prepare(struct workspace *workspace, const struct scene *scene, float radii,
                           const struct shadow_map *shadows, struct nearby **result)
{
    struct nearby *nearby = *result = ARENA_NEW(workspace->arena, struct nearby);
    nearby->scene = scene;
    nearby->shadows = shadows;
    nearby->reach_m = -INFINITY;
    nearby->cylinders = ARENA_ARRAY(workspace->arena, struct cull_cylinder, scene->species_count);
    if (!(radii > 0))
        return STATUS_OK;
    for (size_t k = 0; k < scene->species_count; k++)
        nearby->cylinders[k].radius_m = -1; /* no tree of it yet */
    for (size_t i = 0; i < scene->instances_count; i++) {
        const struct instance *tree = &scene->instances[i];
        struct cull_cylinder *cylinder = &nearby->cylinders[tree->species];
        if (cylinder->radius_m < 0) {
            const struct mesh *mesh;
            enum status status =
                plant_mesh(scene->species[tree->species].plant, &mesh, workspace->error);
            if (status != STATUS_OK)
                return status;
            float beyond_m = fmaxf(radii - 1, 0) * mesh->radius_m;
            *cylinder = (struct cull_cylinder){mesh->minimum_m[1], mesh->maximum_m[1],
                                               radii * mesh->radius_m, beyond_m};
        }
        float half_m =
            0.5f * tree->stretch * (cylinder->high_m - cylinder->low_m) + cylinder->beyond_m;
        nearby->reach_m =
            fmaxf(nearby->reach_m, tree->scale * 1.001f * hypotf(cylinder->radius_m, half_m));
    }
    return path_comes_near(nearby) ? upload(workspace, nearby) : STATUS_OK;
}

void nearby_take(struct nearby *nearby, const struct view *view, enum cull_order order,
                 struct cull_list *list)
{
    bool far_first = order == CULL_BACK_TO_FRONT;
    size_t looked = 0;
    nearby->count = 0;
    for (; looked < list->count; looked++) {
        size_t at = far_first ? list->count - 1 - looked : looked;
        if (list->depths_m[at] > nearby->reach_m)
            break;
        if (nearby->count < NEARBY_MOST && is_near(nearby, list->instances[at], view->eye_m)) {
            nearby->instances[nearby->count] = list->instances[at];
            nearby->depths_m[nearby->count++] = list->depths_m[at];
        }
    }
    if (!nearby->count)
        return;
    /* Those that stay move together, away from the near end. */
    size_t taken = nearby->count;
    for (size_t k = looked; k-- > 0;) {
        size_t at = far_first ? list->count - 1 - k : k, gap = nearby->count - taken;
        size_t to = far_first ? at - gap : at + gap;
        if (taken && list->instances[at] == nearby->instances[taken - 1]) {
            taken--;
            continue;
        }
        list->instances[to] = list->instances[at];
        list->depths_m[to] = list->depths_m[at];
    }
    list->count -= nearby->count;
    if (!far_first) {
        list->instances += nearby->count;
        list->depths_m += nearby->count;
    }
}

enum status nearby_draw(struct workspace *workspace, struct nearby *nearby, const struct view *view,
                        int samples, struct cull *cull)
{
    enum status status = STATUS_OK;
    if (!nearby->count)
        return STATUS_OK;
    if (!nearby->triangles)
        status = upload(workspace, nearby);
    if (status != STATUS_OK)
        return status;
    struct cull_list list = {nearby->count, nearby->instances, nearby->depths_m};
    struct sampling_places places = sampling_places_bound(workspace->gl, samples);
    struct triangles_frame frame = {view, view, &places, cull};
    triangles_draw(workspace, nearby->triangles, &frame, &list);
    return STATUS_OK;
}
