/* The camera's path: kinds of motion, keys in metres, near and far. */
#include "scene/camera.h"

#include <string.h>

static const double TWO_PI = 6.283185307179586;

static void mix3(const float a[3], const float b[3], double t, float to[3])
{
    for (int i = 0; i < 3; i++)
        to[i] = (float)(a[i] + t * ((double)b[i] - a[i]));
}

static double distance3(const float a[3], const float b[3])
{
    double sum = 0;
    for (int i = 0; i < 3; i++)
        sum += ((double)a[i] - b[i]) * ((double)a[i] - b[i]);
    return sqrt(sum);
}

/* Raises a point about the origin; from straight above or below it comes down toward +z. */
static void raise3(double by_rad, double point[3])
{
    double level = hypot(point[0], point[2]), radius = hypot(level, point[1]);
    double elevation = atan2(point[1], level) + by_rad;
    elevation = fmin(fmax(elevation, -TWO_PI / 4), TWO_PI / 4);
    double x = level > 0 ? point[0] / level : 0, z = level > 0 ? point[2] / level : 1;
    point[0] = x * radius * cos(elevation);
    point[1] = radius * sin(elevation);
    point[2] = z * radius * cos(elevation);
}

static void orbit_at(const struct camera_path *path, double time, float eye_m[3])
{
    const float *eye = path->keys[0].eye_m, *target = path->keys[0].target_m;
    double angle = time * path->turn_rad, c = cos(angle), s = sin(angle), from[3];
    for (int i = 0; i < 3; i++)
        from[i] = (double)eye[i] - target[i];
    if (path->rise_rad != 0)
        raise3(time * path->rise_rad, from);
    eye_m[0] = (float)(target[0] + from[0] * c + from[2] * s);
    eye_m[1] = (float)(target[1] + from[1]);
    eye_m[2] = (float)(target[2] - from[0] * s + from[2] * c);
}

/* Where between first and last key: evenly, or so that the distance to the target shrinks in equal
 * ratios. */
static double straight_at(const struct camera_path *path, double time)
{
    const struct camera_key *first = &path->keys[0], *last = &path->keys[path->keys_count - 1];
    if (path->kind != PATH_APPROACH)
        return time;
    double from = distance3(first->eye_m, first->target_m);
    double to = distance3(last->eye_m, last->target_m);
    if (!(from > 0) || !(to > 0) || fabs(from - to) < 1e-6 * from)
        return time;
    return (from - from * pow(to / from, time)) / (from - to);
}

/* Uniform Catmull-Rom spline, Catmull and Rom 1974; the end keys are doubled. */
static void spline_at(const float *before, const float *from, const float *to, const float *after,
                      double t, float point[3])
{
    for (int i = 0; i < 3; i++) {
        double a = before[i], b = from[i], c = to[i], d = after[i];
        point[i] =
            (float)(b + 0.5 * t *
                            (c - a + t * (2 * a - 5 * b + 4 * c - d + t * (3 * (b - c) + d - a))));
    }
}

static void keys_at(const struct camera_path *path, double time, float eye_m[3], float target_m[3])
{
    size_t last = path->keys_count - 1;
    double at = time * (double)last;
    size_t k = (size_t)at < last ? (size_t)at : last - 1;
    const struct camera_key *from = &path->keys[k], *to = from + 1;
    const struct camera_key *before = k > 0 ? from - 1 : from, *after = k + 1 < last ? to + 1 : to;
    double t = at - (double)k;
    spline_at(before->eye_m, from->eye_m, to->eye_m, after->eye_m, t, eye_m);
    spline_at(before->target_m, from->target_m, to->target_m, after->target_m, t, target_m);
}

static float above_ground(const struct terrain *terrain, const float eye_m[3])
{
    return eye_m[1] - terrain_height(terrain, eye_m[0], eye_m[2]);
}

void camera_at(const struct scene *scene, double time, float eye_m[3], float target_m[3])
{
    const struct camera_path *path = &scene->camera;
    const struct terrain *terrain = &scene->terrain;
    if (path->keys_count == 0) {
        memcpy(eye_m, (float[3]){0, 2, 10}, sizeof(float[3]));
        memcpy(target_m, (float[3]){0, 2, 0}, sizeof(float[3]));
        return;
    }
    const struct camera_key *first = &path->keys[0], *last = &path->keys[path->keys_count - 1];
    memcpy(eye_m, first->eye_m, sizeof first->eye_m);
    memcpy(target_m, first->target_m, sizeof first->target_m);
    if (path->kind == PATH_ORBIT) {
        orbit_at(path, time, eye_m);
    } else if (path->kind == PATH_KEYS && path->keys_count > 1) {
        keys_at(path, time, eye_m, target_m);
    } else if (path->kind != PATH_STILL && path->keys_count > 1) {
        double t = straight_at(path, time);
        mix3(first->eye_m, last->eye_m, t, eye_m);
        mix3(first->target_m, last->target_m, t, target_m);
    }
    if (terrain->samples_x == 0)
        return;
    float ground_m = terrain_height(terrain, eye_m[0], eye_m[2]);
    if (path->kind == PATH_WALK) {
        double from = above_ground(terrain, first->eye_m), to = above_ground(terrain, last->eye_m);
        eye_m[1] = (float)(ground_m + from + time * (to - from));
    }
    eye_m[1] = fmaxf(eye_m[1], ground_m + path->clearance_m);
}

double path_time(const struct scene *scene, size_t frame, size_t frames_count)
{
    if (frames_count <= 1)
        return 0;
    double turns = scene->camera.turn_rad / TWO_PI;
    bool closed = scene->camera.kind == PATH_ORBIT && scene->camera.rise_rad == 0 &&
                  fabs(turns) > 0.5 && fabs(turns - round(turns)) < 1e-5;
    return (double)frame / (double)(closed ? frames_count : frames_count - 1);
}

static float far_corner(const struct scene *scene, const float eye_m[3])
{
    double sum = 0;
    for (int i = 0; i < 3; i++) {
        double low = (double)eye_m[i] - (scene->minimum_m[i] - scene->tree_reach_m);
        double high = (double)scene->maximum_m[i] + scene->tree_reach_m - eye_m[i];
        double farther = fmax(fabs(low), fabs(high));
        sum += farther * farther;
    }
    return (float)sqrt(sum);
}

/* Nothing of the scene is nearer to any eye: by the trees' reach, and by the terrain, taken to be
 * at most 60 degrees steep. */
static float free_distance(const struct scene *scene, float (*eyes_m)[3], size_t count)
{
    float nearest2_m2 = 1e18f, free_m = 1e9f;
    for (size_t k = 0; k < scene->instances_count; k++) {
        const float *foot = scene->instances[k].position_m;
        for (size_t e = 0; e < count; e++) {
            float x = eyes_m[e][0] - foot[0], y = eyes_m[e][1] - foot[1],
                  z = eyes_m[e][2] - foot[2];
            nearest2_m2 = fminf(nearest2_m2, x * x + y * y + z * z);
        }
    }
    if (scene->instances_count > 0)
        free_m = sqrtf(nearest2_m2) - scene->tree_reach_m;
    for (size_t e = 0; e < count && scene->terrain.samples_x > 0; e++)
        free_m = fminf(free_m, 0.5f * above_ground(&scene->terrain, eyes_m[e]));
    return fmaxf(free_m, 0);
}

void camera_depths(const struct scene *scene, float (*eyes_m)[3], size_t count, float *near_m,
                   float *far_m)
{
    float aspect = (float)scene->width_px / (float)scene->height_px;
    float tangent = tanf(0.5f * scene->camera.fov_y_rad);
    float corner_cosine = 1.0f / sqrtf(1.0f + tangent * tangent * (1.0f + aspect * aspect));
    float far_corner_m = 1e-3f;
    for (size_t e = 0; e < count; e++)
        far_corner_m = fmaxf(far_corner_m, far_corner(scene, eyes_m[e]));
    *far_m = 1.02f * far_corner_m;
    float moving = count > 1 ? 0.5f : 0.95f; /* the eye may come nearer between two samples */
    float near_sphere_m = moving * corner_cosine * free_distance(scene, eyes_m, count);
    /* 0.1 m, or less where the trees themselves are small */
    float least_m = scene->tree_reach_m > 0 ? fminf(0.1f, 0.02f * scene->tree_reach_m) : 0.1f;
    *near_m = fminf(fmaxf(near_sphere_m, least_m), 0.5f * *far_m);
}

static void keys_build(struct arena *arena, const struct description *description,
                       struct scene *scene)
{
    double unit_m = 1;
    if (description->camera_in_extents)
        unit_m = fmax(scene->forest_half_m, description->extent_min_m);
    if (!(unit_m > 0))
        unit_m = 1;
    size_t count = description->camera.keys_count;
    scene->camera.keys = ARENA_ARRAY(arena, struct camera_key, count);
    for (size_t k = 0; k < count; k++) {
        float *points[2] = {scene->camera.keys[k].eye_m, scene->camera.keys[k].target_m};
        const float *given[2] = {description->camera.keys[k].eye_m,
                                 description->camera.keys[k].target_m};
        for (int p = 0; p < 2; p++) {
            for (int i = 0; i < 3; i++)
                points[p][i] = (float)(given[p][i] * unit_m);
            if (description->ground_relative)
                points[p][1] += terrain_height(&scene->terrain, points[p][0], points[p][2]);
        }
    }
}

void camera_build(struct arena *arena, const struct description *description, struct scene *scene)
{
    scene->camera = description->camera;
    keys_build(arena, description, scene);
    float eyes_m[EYES_MAX][3], target_m[3], near_m, far_m;
    size_t count = scene->camera.kind == PATH_STILL ? 1 : EYES_MAX;
    for (size_t e = 0; e < count; e++)
        camera_at(scene, count > 1 ? (double)e / (double)(count - 1) : 0, eyes_m[e], target_m);
    camera_depths(scene, eyes_m, count, &near_m, &far_m);
    if (!(scene->camera.far_m > 0))
        scene->camera.far_m = fmaxf(far_m, 2 * scene->camera.near_m);
    if (!(scene->camera.near_m > 0))
        scene->camera.near_m = fminf(near_m, 0.5f * scene->camera.far_m);
}
