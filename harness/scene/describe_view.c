/* scene.json: light, ambient, sky, fog, camera. */
#include "scene/describe.h"

#include <math.h>
#include <string.h>

static const double DEGREE = 0.017453292519943295;

static void describe_color(struct json *object, const char *key, float color[3], float red,
                           float green, float blue)
{
    float values[3] = {red, green, blue};
    json_vector(object, key, values, 3, 0, 1000);
    memcpy(color, values, sizeof values);
}

void describe_light(struct json *root, struct description *description)
{
    struct json *light = json_object(root, "light");
    struct sun *sun = &description->sun;
    double azimuth_deg = json_number(light, "azimuth_deg", 40, -720, 720);
    double elevation_deg = json_number(light, "elevation_deg", 45, -90, 90);
    double end_azimuth_deg = json_number(light, "end_azimuth_deg", azimuth_deg, -720, 720);
    double end_elevation_deg = json_number(light, "end_elevation_deg", elevation_deg, -90, 90);
    sun->azimuth_rad = (float)(azimuth_deg * DEGREE);
    sun->elevation_rad = (float)(elevation_deg * DEGREE);
    sun->end_azimuth_rad = (float)(end_azimuth_deg * DEGREE);
    sun->end_elevation_rad = (float)(end_elevation_deg * DEGREE);
    describe_color(light, "radiance", sun->radiance, 3.2f, 3.05f, 2.7f);
    describe_color(root, "ambient", description->ambient, 0.55f, 0.68f, 0.9f);

    struct json *sky = json_object(root, "sky");
    describe_color(sky, "zenith", description->sky.zenith, 0.16f, 0.32f, 0.7f);
    describe_color(sky, "horizon", description->sky.horizon, 0.62f, 0.74f, 0.88f);
    describe_color(sky, "ground", description->sky.ground, 0.17f, 0.23f, 0.09f);

    struct json *fog = json_object(root, "fog");
    const float *horizon = description->sky.horizon;
    describe_color(fog, "color", description->fog.color, horizon[0], horizon[1], horizon[2]);
    description->fog.density_per_m = (float)json_number(fog, "density_per_m", 0, 0, 10);
    if (description->effects & EFFECT_FOG && !(description->fog.density_per_m > 0))
        json_fail(root, "fog",
                  "is missing or has no density, but effects ask for fog; allowed: "
                  "density_per_m above 0");
}

/* Coordinates of some hundred kilometres leave 32-bit floats centimetres. Without a terrain, which
 * is centred on the origin, the scene's own coordinates begin near the camera instead. */
static void choose_origin(struct json *key, struct description *description)
{
    static const double FAR_M = 8192, STEP_M = 1024;
    if (description->ground.given || description->camera_in_extents)
        return;
    for (size_t axis = 0; axis < 3; axis += 2) {
        double at_m = json_element_number(key, "eye", axis, -1e6, 1e6);
        if (fabs(at_m) > FAR_M)
            description->origin_m[axis] = STEP_M * round(at_m / STEP_M);
    }
}

/* False when there is no such point. */
static bool describe_point(struct json *key, const char *name, const double origin_m[3],
                           float point_m[3])
{
    if (!json_vector(key, name, point_m, 3, -1e6, 1e6))
        return false;
    for (size_t axis = 0; axis < 3; axis++)
        point_m[axis] = (float)(json_element_number(key, name, axis, -1e6, 1e6) - origin_m[axis]);
    return true;
}

static void describe_keys(struct arena *arena, struct json *camera, struct description *description)
{
    struct camera_path *path = &description->camera;
    double *origin_m = description->origin_m;
    enum { KEYS_MAX = 1000 };
    static const size_t least[] = {1, 1, 2, 2, 2, 2}, most[] = {1, 1, 2, 2, 2, KEYS_MAX};
    size_t count = json_array(camera, "keys");
    if (count < least[path->kind] || count > most[path->kind]) {
        json_fail(camera, "keys", "has %zu elements; allowed for this kind: %zu..%zu", count,
                  least[path->kind], most[path->kind]);
        return;
    }
    path->keys_count = count;
    path->keys = ARENA_ARRAY(arena, struct camera_key, count);
    for (size_t k = 0; k < count; k++) {
        struct json *key = json_element(camera, "keys", k);
        if (!key)
            return;
        if (k == 0 && json_has(key, "eye"))
            choose_origin(key, description);
        if (!describe_point(key, "eye", origin_m, path->keys[k].eye_m))
            json_fail(key, "eye", "is missing; allowed: [x, y, z]");
        if (!describe_point(key, "target", origin_m, path->keys[k].target_m))
            json_fail(key, "target", "is missing; allowed: [x, y, z]");
        if (memcmp(path->keys[k].eye_m, path->keys[k].target_m, sizeof(float[3])) == 0)
            json_fail(key, "target", "is the eye; allowed: another point");
    }
}

void describe_camera(struct arena *arena, struct json *root, struct description *description)
{
    struct camera_path *path = &description->camera;
    struct json *camera = json_object(root, "camera");
    if (!camera) {
        json_fail(root, "camera", "is missing; allowed: an object with kind and keys");
        return;
    }
    path->kind =
        (enum path_kind)json_word(camera, "kind", "still|orbit|walk|approach|fly-over|keys", -1);
    description->camera_in_extents = json_word(camera, "unit", "m|extent", 0) == 1;
    describe_keys(arena, camera, description);
    description->extent_min_m = json_number(camera, "extent_min_m", 0, 0, 10000);
    if (!description->camera_in_extents && json_has(camera, "extent_min_m"))
        json_fail(camera, "extent_min_m", "means nothing to metres; allowed: with unit extent");
    description->ground_relative = json_bool(camera, "ground_relative", true);
    path->turn_rad = (float)(json_number(camera, "turn_deg", 360, -3600, 3600) * DEGREE);
    if (path->kind != PATH_ORBIT && json_has(camera, "turn_deg"))
        json_fail(camera, "turn_deg", "means nothing to this kind; allowed: with orbit");
    path->rise_rad = (float)(json_number(camera, "rise_deg", 0, -180, 180) * DEGREE);
    if (path->kind != PATH_ORBIT && json_has(camera, "rise_deg"))
        json_fail(camera, "rise_deg", "means nothing to this kind; allowed: with orbit");
    path->clearance_m = (float)json_number(camera, "clearance_m", 1, 0, 10000);
    path->fov_y_rad = (float)(json_number(camera, "fov_y_deg", 45, 1, 170) * DEGREE);
    path->near_m = (float)json_number(camera, "near_m", 0, 0.001, 1e5);
    path->far_m = (float)json_number(camera, "far_m", 0, 0.01, 1e7);
    if (path->near_m > 0 && path->far_m > 0 && path->near_m >= path->far_m)
        json_fail(camera, "far_m", "value is %g; allowed: above near_m, %g", (double)path->far_m,
                  (double)path->near_m);
    path->frames_count = (size_t)json_integer(camera, "frames", 60, 1, 100000);
}
