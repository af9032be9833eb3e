/* The eye within bark: projected, what is around it would be nowhere on the picture. */
#include "bake/cones_parts.h"

#include <math.h>

#define PI 3.14159265f

static float dot3(const float a[3], const float b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Whether a place is within a frustum; axis: its unit axis. */
static bool holds(const struct cone_bark *bark, const float place_m[3], float axis[3])
{
    float way[3], from[3], square = 0;
    for (int i = 0; i < 3; i++) {
        way[i] = bark->to_m[i] - bark->from_m[i];
        from[i] = place_m[i] - bark->from_m[i];
    }
    const float length2 = fmaxf(dot3(way, way), 1e-30f), at = dot3(from, way) / length2;
    for (int i = 0; i < 3; i++) {
        square += (from[i] - at * way[i]) * (from[i] - at * way[i]);
        axis[i] = way[i] / sqrtf(length2);
    }
    const float radius_m = bark->radius_m[0] + at * (bark->radius_m[1] - bark->radius_m[0]);
    return at >= 0 && at <= 1 && square < radius_m * radius_m;
}

/* The bark that holds a place; NULL: none. */
static const struct cone_bark *bark_around(const struct cone_plant *plant, const float place_m[3],
                                           float axis[3])
{
    for (size_t i = 0; i < plant->barks_count; i++)
        if (holds(&plant->barks[i], place_m, axis))
            return &plant->barks[i];
    return NULL;
}

/* A camera's place in the plant's axes: to_camera is a turn times the scale. */
static void from_camera(const struct cone_tree *tree, const float camera_m[3], float place_m[3])
{
    for (int i = 0; i < 3; i++) {
        place_m[i] = 0;
        for (int k = 0; k < 3; k++)
            place_m[i] += tree->to_camera[k][i] * (camera_m[k] - tree->foot_m[k]) /
                          (tree->scale * tree->scale);
    }
}

static bool tree_holds(const struct cone_picture *picture, const struct cone_tree *tree,
                       float axis[3])
{
    const float near_m = picture->view->near_m;
    const float right_m = 0.5f * (float)picture->view->width_px * near_m / picture->focal_px;
    const float up_m = 0.5f * (float)picture->view->height_px * near_m / picture->focal_px;
    for (int corner = 0; corner < 5; corner++) { /* the near plane's, and its middle */
        const float camera_m[3] = {corner < 4 ? (corner & 1 ? right_m : -right_m) : 0,
                                   corner < 4 ? (corner & 2 ? up_m : -up_m) : 0, near_m};
        float place_m[3];
        from_camera(tree, camera_m, place_m);
        if (!bark_around(tree->plant, place_m, axis))
            return false;
    }
    return true;
}

bool cones_within(const struct cones *cones, const struct cone_picture *picture, float rgb[3])
{
    const struct scene *scene = cones->scene;
    for (size_t i = 0; i < scene->instances_count; i++) {
        const struct instance *instance = &scene->instances[i];
        const struct cone_plant *plant = cones->plants[instance->species];
        const float x = instance->position_m[0] - picture->view->eye_m[0];
        const float z = instance->position_m[2] - picture->view->eye_m[2];
        const float reach_m = instance->scale * 2 * plant->radius_m;
        struct cone_tree tree;
        float axis[3];
        if (x * x + z * z > reach_m * reach_m)
            continue;
        cone_tree_of(picture, i, &tree);
        if (!tree_holds(picture, &tree, axis))
            continue;
        /* No sun comes in. Without shadows it shines on the wall that faces it: max(cos, 0) in the
         * mean around the axis. */
        const float along = dot3(axis, tree.sun);
        const float sun = picture->lights ? 0 : sqrtf(fmaxf(1 - along * along, 0)) / PI;
        for (int c = 0; c < 3; c++)
            rgb[c] = plant->conifer->bark_albedo[c] * (picture->ambient[c] + sun * picture->sun[c]);
        return true;
    }
    return false;
}
