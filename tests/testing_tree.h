/* A small lopsided tree in a hand-made scene, drawn by a method and by the ray-traced reference. */
#ifndef TREELINE_TESTS_TESTING_TREE_H
#define TREELINE_TESTS_TESTING_TREE_H

#include "testing.h"

#include "base/random.h"
#include "method/method.h"
#include "truth/frame.h"
#include "truth/reference.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { TREE_WIDTH = 96, TREE_HEIGHT = 96, TREE_PIXELS = TREE_WIDTH * TREE_HEIGHT };

static inline void tree_triangle(struct mesh *mesh, const float corners[3][3], const float color[3])
{
    float e[2][3], n[3];
    for (int k = 0; k < 2; k++)
        for (int i = 0; i < 3; i++)
            e[k][i] = corners[k + 1][i] - corners[0][i];
    for (int i = 0; i < 3; i++)
        n[i] = e[0][(i + 1) % 3] * e[1][(i + 2) % 3] - e[0][(i + 2) % 3] * e[1][(i + 1) % 3];
    float length = sqrtf(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    for (uint32_t k = 0; k < 3; k++) {
        size_t at = mesh->vertices_count++;
        memcpy(mesh->positions[at], corners[k], sizeof corners[k]);
        memcpy(mesh->colors[at], color, 3 * sizeof *color);
        for (int i = 0; i < 3; i++)
            mesh->normals[at][i] = n[i] / length;
        mesh->triangles[mesh->triangles_count][k] = (uint32_t)at;
    }
    mesh->triangles_count++;
}

/* A trunk with four sides and leaves around a slanted branch: the crown leans to +x and a little to
 * +z. Leaves are randomly turned triangles of two greens. */
static inline struct mesh *tree_mesh(struct arena *arena, uint32_t leaves)
{
    enum { SIDES = 4 };
    size_t triangles = 2 * SIDES + leaves;
    struct mesh *mesh = ARENA_NEW(arena, struct mesh);
    mesh->positions = arena_alloc(arena, 3 * triangles, sizeof *mesh->positions);
    mesh->normals = arena_alloc(arena, 3 * triangles, sizeof *mesh->normals);
    mesh->colors = arena_alloc(arena, 3 * triangles, sizeof *mesh->colors);
    mesh->triangles = arena_alloc(arena, triangles, sizeof *mesh->triangles);
    static const float white[3] = {1, 1, 1};
    for (int side = 0; side < SIDES; side++) {
        float a = (float)side * 1.5707963f, b = a + 1.5707963f, r = 0.25f;
        float foot[2][3] = {{r * sinf(a), 0, r * cosf(a)}, {r * sinf(b), 0, r * cosf(b)}};
        float low[3][3] = {
            {foot[0][0], 0, foot[0][2]}, {foot[1][0], 0, foot[1][2]}, {foot[1][0], 5, foot[1][2]}};
        float high[3][3] = {
            {foot[0][0], 0, foot[0][2]}, {foot[1][0], 5, foot[1][2]}, {foot[0][0], 5, foot[0][2]}};
        tree_triangle(mesh, (const float(*)[3])low, white);
        tree_triangle(mesh, (const float(*)[3])high, white);
    }
    struct random random = random_seed(7, 1);
    for (uint32_t leaf = 0; leaf < leaves; leaf++) {
        float c[3], corners[3][3], green = random_float(&random);
        float along = random_float(&random);
        c[0] = 1.4f * along + 1.6f * (random_float(&random) - 0.5f);
        c[1] = 2.5f + 4 * along + 1.2f * (random_float(&random) - 0.5f);
        c[2] = 0.5f * along + 1.6f * (random_float(&random) - 0.5f);
        for (int k = 0; k < 3; k++)
            for (int i = 0; i < 3; i++)
                corners[k][i] = c[i] + 0.5f * (random_float(&random) - 0.5f);
        const float color[3] = {0.5f + 0.5f * green, 1, 0.6f};
        tree_triangle(mesh, (const float(*)[3])corners, color);
    }
    mesh->materials_count = mesh->parts_count = 2;
    mesh->materials = ARENA_ARRAY(arena, struct material, 2);
    mesh->materials[0] = (struct material){
        arena_strdup(arena, "bark"), MATERIAL_BARK, {0.3f, 0.22f, 0.15f}, NULL, false};
    mesh->materials[1] = (struct material){
        arena_strdup(arena, "leaf"), MATERIAL_LEAF, {0.25f, 0.5f, 0.12f}, NULL, false};
    mesh->parts = ARENA_ARRAY(arena, struct mesh_part, 2);
    mesh->parts[0] = (struct mesh_part){.triangles_count = 2 * SIDES};
    mesh->parts[1] =
        (struct mesh_part){.first_triangle = 2 * SIDES, .triangles_count = leaves, .material = 1};
    mesh->parts[1].elements_count = leaves;
    mesh->parts[1].element_first = ARENA_ARRAY(arena, uint32_t, leaves + 1);
    for (uint32_t i = 0; i <= leaves; i++)
        mesh->parts[1].element_first[i] = 2 * SIDES + i;
    mesh_bounds(mesh);
    return mesh;
}

/* Trees of one plant without terrain under a black sky; the sun at an azimuth, 35 degrees high. */
static inline struct scene *tree_scene(struct arena *arena, struct plant *plant, size_t trees,
                                       float azimuth_rad)
{
    struct scene *scene = ARENA_NEW(arena, struct scene);
    *scene = (struct scene){.name = "test",
                            .path = "test",
                            .width_px = TREE_WIDTH,
                            .height_px = TREE_HEIGHT,
                            .effects = EFFECT_TWO_SIDED | EFFECT_AMBIENT,
                            .species_count = 1,
                            .instances_count = trees,
                            .forest_half_m = 50,
                            .sun = {azimuth_rad, 0.61f, azimuth_rad, 0.61f, {1, 0.95f, 0.9f}},
                            .ambient = {0.15f, 0.17f, 0.2f},
                            .fog = {{0.5f, 0.55f, 0.6f}, 0.02f},
                            .hash = 1};
    scene->species = ARENA_NEW(arena, struct species);
    *scene->species = (struct species){"tree", plant, 1, 1, 1};
    scene->instances = ARENA_ARRAY(arena, struct instance, trees + 1);
    for (size_t i = 0; i < trees; i++)
        scene->instances[i].scale = scene->instances[i].stretch = 1;
    scene->camera = (struct camera_path){.kind = PATH_STILL,
                                         .keys_count = 1,
                                         .keys = ARENA_NEW(arena, struct camera_key),
                                         .fov_y_rad = 0.35f,
                                         .near_m = 0.1f,
                                         .far_m = 1000,
                                         .frames_count = 1};
    return scene;
}

/* From a distance, looking at the tree's middle; span_m fits into the picture there. */
static inline struct view tree_view(const struct scene *scene, float azimuth_rad,
                                    float elevation_rad, float distance_m, float span_m)
{
    struct view view;
    struct scene zoomed = *scene;
    zoomed.camera.fov_y_rad = 2 * atanf(0.5f * span_m / distance_m);
    const float target[3] = {0, 3.5f, 0};
    const float eye[3] = {
        target[0] + distance_m * cosf(elevation_rad) * sinf(azimuth_rad),
        target[1] + distance_m * sinf(elevation_rad),
        target[2] + distance_m * cosf(elevation_rad) * cosf(azimuth_rad),
    };
    view_look_at(&zoomed, eye, target, &view);
    const struct sun *sun = &scene->sun;
    view.sun_direction[0] = cosf(sun->elevation_rad) * sinf(sun->azimuth_rad);
    view.sun_direction[1] = sinf(sun->elevation_rad);
    view.sun_direction[2] = cosf(sun->elevation_rad) * cosf(sun->azimuth_rad);
    return view;
}

/* A method made ready once in a context of its own, for pictures of a scene from many sides. */
struct studio {
    struct error error;
    struct workspace workspace;
    struct target target;
    const struct method *method;
    void *state;
};

static inline void studio_prepare(struct studio *studio, const char *options,
                                  const struct scene *scene, int width_px, int height_px)
{
    const struct method *method = studio->method;
    struct workspace *workspace = &studio->workspace;
    void *values = arena_alloc(workspace->arena, 1, method->options_size);
    workspace->error = &studio->error;
    workspace->threads = 2;
    options_default(method->options, values);
    if (options_parse(method->options, options, values, &studio->error) != STATUS_OK ||
        gl_context_create(NULL, 2, &workspace->gl, &studio->error) != STATUS_OK ||
        gl_target(workspace->gl, width_px, height_px, workspace->format, &studio->target,
                  &studio->error) != STATUS_OK ||
        method->prepare(workspace, scene, values, &studio->state) != STATUS_OK)
        fail_msg("%s", studio->error.text);
}

static inline void studio_open(struct studio *studio, struct arena *arena,
                               const struct method *method, const char *options, enum lod lod,
                               const struct scene *scene, unsigned effects)
{
    *studio = (struct studio){
        .method = method,
        .workspace = {.arena = arena, .effects = effects, .lod = lod, .format = TARGET_RGBA32F}};
    studio_prepare(studio, options, scene, TREE_WIDTH, TREE_HEIGHT);
}

static inline struct frame *studio_draw(struct studio *studio, const struct view *view)
{
    struct frame *frame =
        frame_create(studio->workspace.arena, view->width_px, view->height_px, false);
    if (studio->method->draw(&studio->workspace, studio->state, view, &studio->target) != STATUS_OK)
        fail_msg("%s", studio->error.text);
    gl_target_read(studio->workspace.gl, &studio->target, frame->rgba);
    if (frame_check(frame, &studio->error) != STATUS_OK)
        fail_msg("%s", studio->error.text);
    return frame;
}

static inline void studio_close(struct studio *studio)
{
    gl_context_destroy(studio->workspace.gl);
}

/* One picture in a context of its own. counters may be NULL. */
static inline struct frame *tree_draw_as(struct arena *arena, const struct method *method,
                                         const char *options, enum lod lod,
                                         enum target_format format, const struct scene *scene,
                                         unsigned effects, const struct view *view,
                                         struct gl_counters *counters)
{
    struct studio studio = {
        .method = method,
        .workspace = {.arena = arena, .effects = effects, .lod = lod, .format = format}};
    studio_prepare(&studio, options, scene, view->width_px, view->height_px);
    gl_counters_reset(studio.workspace.gl);
    struct frame *frame = studio_draw(&studio, view);
    if (counters)
        *counters = studio.workspace.gl->counters;
    studio_close(&studio);
    return frame;
}

static inline struct frame *tree_draw(struct arena *arena, const struct method *method,
                                      const char *options, const struct scene *scene,
                                      unsigned effects, const struct view *view,
                                      struct gl_counters *counters)
{
    return tree_draw_as(arena, method, options, LOD_HIGH, TARGET_RGBA32F, scene, effects, view,
                        counters);
}

static inline struct frame *tree_reference(struct arena *arena, const struct scene *scene,
                                           unsigned effects, const struct view *view)
{
    struct error error = {0};
    struct reference_options options = {.effects = effects,
                                        .samples_min = 64,
                                        .samples_max = 64,
                                        .threads = 2,
                                        .seed = 1,
                                        .quiet = true};
    struct reference_stats stats;
    struct frame *frame;
    if (reference_render(arena, scene, view, &options, &frame, &stats, &error) != STATUS_OK)
        fail_msg("%s", error.text);
    return frame;
}

/* Mean of one channel. */
static inline double tree_mean(const struct frame *frame, int channel)
{
    double sum = 0;
    for (int i = 0; i < frame->width_px * frame->height_px; i++)
        sum += frame->rgba[4 * i + channel];
    return sum / (frame->width_px * frame->height_px);
}

/* Mean absolute difference of the coverage; mirrored: of the left-right mirrored second picture. */
static inline double tree_difference(const struct frame *a, const struct frame *b, bool mirrored)
{
    double sum = 0;
    int width = a->width_px, height = a->height_px;
    for (int y = 0; y < height; y++)
        for (int x = 0; x < width; x++) {
            int other = mirrored ? width - 1 - x : x;
            sum += fabs(a->rgba[4 * (y * width + x) + 3] - b->rgba[4 * (y * width + other) + 3]);
        }
    return sum / (width * height);
}

static inline double tree_rmse(const struct frame *a, const struct frame *b)
{
    double sum = 0;
    int count = a->width_px * a->height_px;
    for (int i = 0; i < 4 * count; i++)
        if (i % 4 < 3)
            sum += pow(a->rgba[i] - b->rgba[i], 2);
    return sqrt(sum / (3 * count));
}

static inline const struct method *tree_method(const char *name)
{
    struct error error = {0};
    const struct method *method;
    if (method_find(name, &method, &error) != STATUS_OK)
        fail_msg("%s", error.text);
    return method;
}

#endif
