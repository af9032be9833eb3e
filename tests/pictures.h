/* For tests of GL methods: scenes made by hand, a method drawn once, and a slow ray caster to
 * compare with. */
#ifndef TREELINE_TESTS_PICTURES_H
#define TREELINE_TESTS_PICTURES_H

#include "testing.h"

#include "method/method.h"

#include <stdlib.h>
#include <string.h>

/* Light and camera that every such scene has; no trees, no terrain. */
static inline struct scene *scene_by_hand(struct arena *arena, int width_px, int height_px)
{
    struct scene *scene = ARENA_NEW(arena, struct scene);
    *scene = (struct scene){.name = "by hand",
                            .path = "by hand",
                            .width_px = width_px,
                            .height_px = height_px,
                            .effects = EFFECTS_ALL,
                            .forest_half_m = 10,
                            .sun = {.azimuth_rad = 0.6f,
                                    .elevation_rad = 0.8f,
                                    .end_azimuth_rad = 0.6f,
                                    .end_elevation_rad = 0.8f,
                                    .radiance = {0.9f, 0.8f, 0.7f}},
                            .ambient = {0.1f, 0.15f, 0.2f},
                            .sky = {.zenith = {0.2f, 0.3f, 0.8f},
                                    .horizon = {0.7f, 0.8f, 0.9f},
                                    .ground = {0.3f, 0.25f, 0.2f}},
                            .fog = {.color = {0.6f, 0.65f, 0.7f}, .density_per_m = 0.01f},
                            .camera = {.fov_y_rad = 0.8f, .near_m = 0.1f, .far_m = 1000}};
    scene->camera.keys_count = 1;
    scene->camera.keys = ARENA_NEW(arena, struct camera_key);
    scene->camera.keys[0] = (struct camera_key){{0, 2, 20}, {0, 2, 0}};
    scene->camera.frames_count = 1;
    return scene;
}

/* One species of a mesh, instances_count trees that the caller places. */
static inline void scene_plant(struct arena *arena, struct scene *scene, const struct mesh *mesh,
                               size_t instances_count)
{
    scene->species_count = 1;
    scene->species = ARENA_NEW(arena, struct species);
    scene->species[0] = (struct species){"plant", plant_from_mesh(arena, "plant", mesh), 1, 1, 1};
    scene->instances_count = instances_count;
    scene->instances = ARENA_ARRAY(arena, struct instance, instances_count);
    for (size_t i = 0; i < instances_count; i++)
        scene->instances[i].scale = scene->instances[i].stretch = 1;
}

struct picture {
    int width_px, height_px;
    float *rgba; /* height x width x 4, row 0 on top; in the arena */
    uint64_t triangles, draw_calls;
    size_t device_bytes;
};

struct setting {
    const char *method, *options, *backend; /* options, backend: NULL is the default */
    unsigned effects;
    enum lod lod;
    enum target_format format;
    bool masked;               /* the shadow mask in place of light; by OpenGL */
    const struct view *before; /* drawn first by the same method, of the same size; by OpenGL */
};

static inline struct picture picture_draw_cpu(struct arena *arena, const struct scene *scene,
                                              const struct view *view,
                                              const struct setting *setting,
                                              const struct method *method)
{
    struct error error;
    void *state = NULL, *options = arena_alloc(arena, 1, method->options_size);
    struct picture picture = {view->width_px, view->height_px, NULL, 0, 0, 0};
    picture.rgba = ARENA_ARRAY(arena, float, 4 * (size_t)(view->width_px * view->height_px));
    struct target target = {.width_px = view->width_px,
                            .height_px = view->height_px,
                            .format = setting->format,
                            .pixels = picture.rgba};
    struct workspace workspace = {.arena = arena,
                                  .error = &error,
                                  .effects = setting->effects & method->traits,
                                  .lod = setting->lod,
                                  .format = setting->format,
                                  .threads = 2,
                                  .seed = 1};
    options_default(method->options, options);
    if (options_parse(method->options, setting->options, options, &error) != STATUS_OK ||
        method->prepare(&workspace, scene, options, &state) != STATUS_OK ||
        method->draw(&workspace, state, view, &target) != STATUS_OK)
        fail_msg("%s", error.text);
    return picture;
}

/* Prepares and draws one view; fails the test on any error. */
static inline struct picture picture_draw(struct arena *arena, const struct scene *scene,
                                          const struct view *view, const struct setting *setting)
{
    struct error error;
    struct gl *gl;
    const struct method *method;
    struct target target;
    void *state = NULL;
    struct picture picture = {view->width_px, view->height_px, NULL, 0, 0, 0};
    assert_int_equal(method_find(setting->method, &method, &error), STATUS_OK);
    if (method->traits & TRAIT_CPU)
        return picture_draw_cpu(arena, scene, view, setting, method);
    if (gl_context_create(setting->backend, 2, &gl, &error) != STATUS_OK)
        fail_msg("%s", error.text);
    struct workspace workspace = {.arena = arena,
                                  .gl = gl,
                                  .error = &error,
                                  .effects = setting->effects & method->traits,
                                  .lod = setting->lod,
                                  .format = setting->format,
                                  .threads = 2,
                                  .seed = 1,
                                  .masked = setting->masked};
    void *options = arena_alloc(arena, 1, method->options_size);
    options_default(method->options, options);
    if (options_parse(method->options, setting->options, options, &error) != STATUS_OK ||
        gl_target(gl, view->width_px, view->height_px, setting->format, &target, &error) !=
            STATUS_OK ||
        method->prepare(&workspace, scene, options, &state) != STATUS_OK)
        fail_msg("%s", error.text);
    if (setting->before && method->draw(&workspace, state, setting->before, &target) != STATUS_OK)
        fail_msg("%s", error.text);
    gl_counters_reset(gl);
    if (method->draw(&workspace, state, view, &target) != STATUS_OK)
        fail_msg("%s", error.text);
    picture.triangles = gl->counters.triangles;
    picture.draw_calls = gl->counters.draw_calls;
    picture.device_bytes = gl_device_bytes(gl);
    picture.rgba = ARENA_ARRAY(arena, float, 4 * (size_t)(view->width_px * view->height_px));
    gl_target_read(gl, &target, picture.rgba);
    assert_int_equal(gl_check(gl, "picture", &error), STATUS_OK);
    gl_context_destroy(gl);
    return picture;
}

static inline double picture_coverage(const struct picture *picture)
{
    double sum = 0;
    size_t pixels = (size_t)(picture->width_px * picture->height_px);
    for (size_t i = 0; i < pixels; i++)
        sum += picture->rgba[4 * i + 3];
    return sum / (double)pixels;
}

/* What a ray meets. */
struct hit {
    double distance_m, p, q; /* barycentric of corners 1 and 2 */
    double margin;           /* to the triangle's nearest edge, barycentric */
    size_t triangle;
    bool front; /* the counter-clockwise side */
};

/* Moller and Trumbore 1997, in double. corners: 3 points. Replaces *hit when nearer. */
static inline void ray_triangle(const float eye[3], const float direction[3],
                                const double corners[3][3], size_t triangle, struct hit *hit)
{
    double u[3], v[3], w[3], c[3], d[3];
    for (int i = 0; i < 3; i++) {
        u[i] = corners[1][i] - corners[0][i];
        v[i] = corners[2][i] - corners[0][i];
        w[i] = eye[i] - corners[0][i];
    }
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        c[i] = direction[j] * v[k] - direction[k] * v[j];
        d[i] = w[j] * u[k] - w[k] * u[j];
    }
    double volume = u[0] * c[0] + u[1] * c[1] + u[2] * c[2];
    if (volume == 0)
        return;
    double p = (w[0] * c[0] + w[1] * c[1] + w[2] * c[2]) / volume;
    double q = (direction[0] * d[0] + direction[1] * d[1] + direction[2] * d[2]) / volume;
    double t = (v[0] * d[0] + v[1] * d[1] + v[2] * d[2]) / volume;
    if (p < 0 || q < 0 || p + q > 1 || t <= 0 || t >= hit->distance_m)
        return;
    *hit = (struct hit){t, p, q, fmin(fmin(p, q), 1 - p - q), triangle, volume > 0};
}

/* effects.h without shadows and sky occlusion, in double. normal: unit, turned to the eye by
 * facing. */
static inline void shade(const struct scene *scene, const struct view *view, unsigned effects,
                         bool leaf, const double albedo[3], const double normal[3], bool facing,
                         double distance_m, double radiance[3])
{
    double d = 0, f = effects & EFFECT_FOG ? exp(-scene->fog.density_per_m * distance_m) : 1;
    for (int i = 0; i < 3; i++)
        d += normal[i] * view->sun_direction[i];
    d = leaf && effects & EFFECT_TWO_SIDED ? fabs(d) : fmax(0, facing ? d : -d);
    for (int i = 0; i < 3; i++) {
        double ambient = effects & EFFECT_AMBIENT ? scene->ambient[i] : 0;
        radiance[i] =
            f * albedo[i] * (scene->sun.radiance[i] * d + ambient) + (1 - f) * scene->fog.color[i];
    }
}

#endif
