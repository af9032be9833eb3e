/* Balls of leaves, marched and traced: shared by the tests of the march. */
#ifndef TREELINE_TESTS_MARCH_WORLD_H
#define TREELINE_TESTS_MARCH_WORLD_H

#include "reference_world.h"

#include "bake/march.h"

#include <stdlib.h>

/* Leaves of leg_m turned and placed at random in a ball of radius 4 m, 5 m above the ground. */
static inline struct mesh *ball_of_leaves(struct arena *arena, size_t count, double leg_m)
{
    struct mesh *mesh = mesh_new(arena, MATERIAL_LEAF, 0.6f, count);
    struct random random = random_seed(21, 1);
    while (mesh->triangles_count < count) {
        double at[3], u[3], v[3], corners[2][3], square = 0, uu = 0, uv = 0, vv = 0;
        for (int i = 0; i < 3; i++) {
            at[i] = 8 * random_double(&random) - 4;
            u[i] = random_double(&random) + random_double(&random) + random_double(&random) - 1.5;
            v[i] = random_double(&random) + random_double(&random) + random_double(&random) - 1.5;
            square += at[i] * at[i];
            uu += u[i] * u[i];
            uv += u[i] * v[i];
        }
        if (square > 16)
            continue;
        for (int i = 0; i < 3; i++) {
            v[i] -= uv / uu * u[i];
            vv += v[i] * v[i];
        }
        at[1] += 5;
        for (int i = 0; i < 3; i++) {
            corners[0][i] = at[i] + leg_m * u[i] / sqrt(uu);
            corners[1][i] = at[i] + leg_m * v[i] / sqrt(vv);
        }
        mesh_triangle(mesh, at, corners[0], corners[1]);
    }
    return mesh_finish(arena, mesh);
}

/* A march made ready, and what it keeps. */
struct ready {
    struct workspace workspace;
    struct error error;
    struct march *march;
};

static inline struct ready *march_ready(struct world *world, const struct march_options *options,
                                        unsigned effects, int threads)
{
    struct ready *ready = ARENA_NEW(world->arena, struct ready);
    ready->workspace = (struct workspace){
        .arena = world->arena, .error = &ready->error, .effects = effects, .threads = threads};
    setenv("TREELINE_CACHE", "off", 1);
    if (march_prepare(&ready->workspace, &world->scene, options, &ready->march))
        fail_msg("%s", ready->error.text);
    return ready;
}

static inline struct frame *ready_picture(struct world *world, struct ready *ready)
{
    struct frame *frame =
        frame_create(world->arena, world->view.width_px, world->view.height_px, false);
    struct target target = {.width_px = frame->width_px,
                            .height_px = frame->height_px,
                            .format = TARGET_RGBA32F,
                            .pixels = frame->rgba};
    if (march_draw(&ready->workspace, ready->march, &world->view, &target))
        fail_msg("%s", ready->error.text);
    return frame;
}

static inline struct frame *march_picture(struct world *world, const struct march_options *options,
                                          unsigned effects, int threads)
{
    return ready_picture(world, march_ready(world, options, effects, threads));
}

static const struct march_options usual = {.resolution = 64,
                                           .stop = 0.02f,
                                           .step = 1,
                                           .bias = 0,
                                           .tile_px = 16,
                                           .cells = true,
                                           .shadow_resolution = 32};

/* Trees of the ball, the second overlapping the first, the third within it. */
static inline struct world world_of_balls(size_t trees, size_t leaves, double leg_m)
{
    struct world world = world_create(96, 80, 0.6);
    struct scene *scene = &world.scene;
    struct mesh *mesh = ball_of_leaves(world.arena, leaves, leg_m);
    static const struct instance places[3] = {{{0, 0, 0}, 0.3f, 1, 0, 1},
                                              {{3, 0, 2}, 1.9f, 1, 0, 1},
                                              {{0.2f, 2.5f, 0.1f}, 4, 0.5f, 0, 1}};
    scene->species_count = 1;
    scene->species[0] =
        (struct species){"ball", plant_from_mesh(world.arena, "ball", mesh), 1, 1, 1};
    scene->instances_count = trees;
    memcpy(scene->instances, places, trees * sizeof *places);
    for (int i = 0; i < 3; i++)
        scene->ambient[i] = 0.3f;
    world_look(&world, 9, 8, 24, 0, 5, 0);
    world_sun(&world, 0.5, 0.7, 0.3);
    return world;
}

static inline struct frame *traced(struct world *world, unsigned effects)
{
    struct reference_options options = {
        .effects = effects, .samples_min = 64, .samples_max = 64, .threads = 2, .quiet = true};
    struct reference_stats stats;
    struct error error = {0};
    struct frame *frame;
    if (reference_render(world->arena, &world->scene, &world->view, &options, &frame, &stats,
                         &error))
        fail_msg("%s", error.text);
    return frame;
}

static inline void means_of(const struct frame *frame, double means[4])
{
    size_t pixels = (size_t)frame->width_px * (size_t)frame->height_px;
    for (int c = 0; c < 4; c++) {
        means[c] = 0;
        for (size_t i = 0; i < pixels; i++)
            means[c] += frame->rgba[4 * i + (size_t)c] / (double)pixels;
    }
}

#endif
