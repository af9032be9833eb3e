/* Small scenes made in code for the tests of the reference. */
#ifndef TREELINE_TESTS_REFERENCE_WORLD_H
#define TREELINE_TESTS_REFERENCE_WORLD_H

#include "level_ground.h"
#include "loose_mesh.h"

#include "base/random.h"
#include "truth/reference.h"

#include <float.h>
#include <math.h>
#include <string.h>

#define WORLD_TREES 64

struct world {
    struct arena *arena;
    struct scene scene;
    struct view view;
};

/* Black sky, a white sun at the zenith, a picture of width x height px. */
static inline struct world world_create(int width_px, int height_px, double fov_y_rad)
{
    struct world world = {.arena = arena_create(0)};
    struct scene *scene = &world.scene;
    scene->name = scene->path = "test";
    scene->width_px = width_px;
    scene->height_px = height_px;
    scene->camera.fov_y_rad = (float)fov_y_rad;
    scene->camera.near_m = 0.01f;
    scene->camera.far_m = 1e5f;
    scene->sun.elevation_rad = scene->sun.end_elevation_rad = (float)(M_PI / 2);
    for (int i = 0; i < 3; i++)
        scene->sun.radiance[i] = 1;
    scene->species = ARENA_ARRAY(world.arena, struct species, WORLD_TREES);
    scene->instances = ARENA_ARRAY(world.arena, struct instance, WORLD_TREES);
    return world;
}

static inline void world_look(struct world *world, float ex, float ey, float ez, float tx, float ty,
                              float tz)
{
    view_look_at(&world->scene, (float[3]){ex, ey, ez}, (float[3]){tx, ty, tz}, &world->view);
}

static inline void world_sun(struct world *world, double x, double y, double z)
{
    double length = sqrt(x * x + y * y + z * z);
    world->view.sun_direction[0] = (float)(x / length);
    world->view.sun_direction[1] = (float)(y / length);
    world->view.sun_direction[2] = (float)(z / length);
}

/* Adds the mesh as a species and one instance of it. */
static inline struct instance *world_add(struct world *world, const struct mesh *mesh, float x,
                                         float y, float z)
{
    struct scene *scene = &world->scene;
    assert_true(scene->instances_count < WORLD_TREES);
    struct species *species = &scene->species[scene->species_count];
    *species = (struct species){"test", plant_from_mesh(world->arena, "test", mesh), 1, 1, 1};
    struct instance *instance = &scene->instances[scene->instances_count++];
    *instance = (struct instance){{x, y, z}, 0, 1, (uint32_t)scene->species_count++, 1};
    return instance;
}

/* A horizontal polygon of `sides` corners, radius 1, that faces up; facing: 1 up, -1 down, 2 toward
 * +z. */
static inline struct mesh *disc_mesh(struct arena *arena, enum material_kind kind, float albedo,
                                     int sides, int facing)
{
    struct mesh *mesh = mesh_new(arena, kind, albedo, (size_t)sides);
    for (int i = 0; i < sides; i++) {
        double from = 2 * M_PI * i / sides, to = 2 * M_PI * (i + 1) / sides;
        double middle[3] = {0, 0, 0};
        double a[3] = {cos(from), 0, -sin(from)}, b[3] = {cos(to), 0, -sin(to)};
        if (facing == 2) {
            a[1] = sin(from), a[2] = 0;
            b[1] = sin(to), b[2] = 0;
        }
        mesh_triangle(mesh, middle, facing < 0 ? b : a, facing < 0 ? a : b);
    }
    return mesh_finish(arena, mesh);
}

static inline double disc_area(int sides)
{
    return 0.5 * sides * sin(2 * M_PI / sides);
}

static inline struct frame *world_render(struct world *world, struct reference_options options,
                                         struct reference_stats *stats)
{
    struct error error = {0};
    struct frame *frame = NULL;
    options.quiet = true;
    if (reference_render(world->arena, &world->scene, &world->view, &options, &frame, stats,
                         &error))
        fail_msg("%s", error.text);
    return frame;
}

/* Mean of a channel over the picture, and its stated standard error: pixels are independent. */
static inline double frame_mean(const struct frame *frame, int channel, double *error)
{
    size_t pixels = (size_t)frame->width_px * (size_t)frame->height_px;
    double sum = 0, variance = 0;
    for (size_t i = 0; i < pixels; i++) {
        sum += frame->rgba[4 * i + (size_t)channel];
        variance += frame->variance[4 * i + (size_t)channel];
    }
    *error = sqrt(variance) / (double)pixels;
    return sum / (double)pixels;
}

#endif
