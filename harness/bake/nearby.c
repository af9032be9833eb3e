/* Near trees: which they are, when their triangles are uploaded. */
#include "bake/nearby.h"
#include "bake/triangles.h"

#include <string.h>

/* Places along the camera's path that are looked at. */
enum { PATH_PLACES = 65 };

struct nearby {
    const struct scene *scene;
    float radii, octaves;
    struct cull_cylinder *cylinders; /* of each species: an eye within is near, or begins to be */
    float *radii_m;                  /* of each species */
    float reach_m;                   /* no near tree's middle is farther from the eye */
    struct triangles *triangles;     /* NULL: not needed yet */
    const struct shadow_map *shadows;
    size_t count, partial_count; /* near; becoming so, at the end of the arrays */
    uint32_t instances[NEARBY_MOST];
    float depths_m[NEARBY_MOST], shares[NEARBY_MOST];
};

/* In radii, how far the eye is from a tree's axis, or one more than above or below it. */
static float radii_to(const struct nearby *nearby, const struct instance *tree,
                      const float eye_m[3])
{
    const struct cull_cylinder *cylinder = &nearby->cylinders[tree->species];
    const float radius_m = tree->scale * nearby->radii_m[tree->species];
    const float *foot_m = tree->position_m;
    float aside_m = hypotf(eye_m[0] - foot_m[0], eye_m[2] - foot_m[2]);
    float rise_m = eye_m[1] - foot_m[1], height = tree->scale * tree->stretch;
    float past_m = fmaxf(rise_m - height * cylinder->high_m, height * cylinder->low_m - rise_m);
    return fmaxf(aside_m / radius_m, past_m > 0 ? 1 + past_m / radius_m : 0);
}

/* How much of a tree is near. */
static float share_of(const struct nearby *nearby, uint32_t instance, const float eye_m[3])
{
    const struct instance *tree = &nearby->scene->instances[instance];
    if (!cull_cylinder_holds(&nearby->cylinders[tree->species], tree, eye_m, 0))
        return 0;
    if (!(nearby->octaves > 0))
        return 1;
    float octaves = log2f(fmaxf(radii_to(nearby, tree, eye_m) / nearby->radii, 1));
    return fmaxf(1 - octaves / nearby->octaves, 0);
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
            if (share_of(nearby, (uint32_t)i, view.eye_m) > 0)
                return true;
    }
    return false;
}

enum status nearby_prepare(struct workspace *workspace, const struct scene *scene, float radii,
                           float octaves, const struct shadow_map *shadows, struct nearby **result)
{
    struct nearby *nearby = *result = ARENA_NEW(workspace->arena, struct nearby);
    nearby->scene = scene;
    nearby->shadows = shadows;
    nearby->radii = radii;
    nearby->octaves = octaves;
    nearby->reach_m = -INFINITY;
    nearby->cylinders = ARENA_ARRAY(workspace->arena, struct cull_cylinder, scene->species_count);
    nearby->radii_m = ARENA_ARRAY(workspace->arena, float, scene->species_count);
    if (!(radii > 0))
        return STATUS_OK;
    const float widest = radii * exp2f(octaves);
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
            float beyond_m = fmaxf(widest - 1, 0) * mesh->radius_m;
            *cylinder = (struct cull_cylinder){mesh->minimum_m[1], mesh->maximum_m[1],
                                               widest * mesh->radius_m, beyond_m};
            nearby->radii_m[tree->species] = mesh->radius_m;
        }
        float half_m =
            0.5f * tree->stretch * (cylinder->high_m - cylinder->low_m) + cylinder->beyond_m;
        nearby->reach_m =
            fmaxf(nearby->reach_m, tree->scale * 1.001f * hypotf(cylinder->radius_m, half_m));
    }
    return path_comes_near(nearby) ? upload(workspace, nearby) : STATUS_OK;
}

/* Takes the trees from the array that are in it altogether, the others from the list's part that
 * was looked at; those that stay move together, away from the near end. */
static void list_close(const struct nearby *nearby, bool far_first, size_t looked,
                       struct cull_list *list)
{
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

void nearby_take(struct nearby *nearby, const struct view *view, enum cull_order order,
                 struct cull_list *list)
{
    bool far_first = order == CULL_BACK_TO_FRONT;
    size_t looked = 0;
    nearby->count = nearby->partial_count = 0;
    for (; looked < list->count; looked++) {
        size_t at = far_first ? list->count - 1 - looked : looked;
        if (list->depths_m[at] > nearby->reach_m)
            break;
        if (nearby->count + nearby->partial_count == NEARBY_MOST)
            continue;
        float share = share_of(nearby, list->instances[at], view->eye_m);
        if (!(share > 0))
            continue;
        size_t to = share < 1 ? NEARBY_MOST - ++nearby->partial_count : nearby->count++;
        nearby->instances[to] = list->instances[at];
        nearby->depths_m[to] = list->depths_m[at];
        nearby->shares[to] = share;
    }
    if (nearby->count)
        list_close(nearby, far_first, looked, list);
}

float nearby_share(const struct nearby *nearby, uint32_t instance)
{
    for (size_t k = NEARBY_MOST - nearby->partial_count; k < NEARBY_MOST; k++)
        if (nearby->instances[k] == instance)
            return nearby->shares[k];
    return 0;
}

static enum status draw_some(struct workspace *workspace, struct nearby *nearby,
                             const struct view *view, struct cull_list list, int samples,
                             struct cull *cull)
{
    enum status status = nearby->triangles ? STATUS_OK : upload(workspace, nearby);
    if (status != STATUS_OK)
        return status;
    struct sampling_places places = sampling_places_bound(workspace->gl, samples);
    struct triangles_frame frame = {view, view, &places, cull};
    triangles_draw(workspace, nearby->triangles, &frame, &list);
    return STATUS_OK;
}

enum status nearby_draw(struct workspace *workspace, struct nearby *nearby, const struct view *view,
                        int samples, struct cull *cull)
{
    struct cull_list list = {nearby->count, nearby->instances, nearby->depths_m};
    return nearby->count ? draw_some(workspace, nearby, view, list, samples, cull) : STATUS_OK;
}

enum status nearby_draw_one(struct workspace *workspace, struct nearby *nearby,
                            const struct view *view, uint32_t instance, int samples,
                            struct cull *cull)
{
    for (size_t k = NEARBY_MOST - nearby->partial_count; k < NEARBY_MOST; k++) {
        float depth_m = nearby->depths_m[k]; /* a list is drawn from a copy: it is reordered */
        struct cull_list list = {1, &instance, &depth_m};
        if (nearby->instances[k] == instance)
            return draw_some(workspace, nearby, view, list, samples, cull);
    }
    return STATUS_OK;
}
