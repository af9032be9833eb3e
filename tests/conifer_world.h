/* Twigs, their pictures and sums of them, for the tests of conifers. */
#ifndef TREELINE_TESTS_CONIFER_WORLD_H
#define TREELINE_TESTS_CONIFER_WORLD_H

#include "reference_world.h"

#include "bake/cones.h"
#include "plant/conifer.h"

#include <stdlib.h>

/* What is drawn unless a test says otherwise: all of it, at one level. */
static inline struct cones_options options_of(int level)
{
    return (struct cones_options){.choice = {.forced = level, .needle_px = 6, .twig_px = 2.5f},
                                  .shadows = true,
                                  .edges = true};
}

/* Twigs on a branch wherever it is. */
static inline struct plant *plant_on(struct arena *arena, const struct conifer_branch *branch,
                                     const struct conifer_twig *twigs, size_t count)
{
    struct conifer *conifer = ARENA_NEW(arena, struct conifer);
    struct error error = {0};
    conifer->branches_count = 1;
    conifer->branches = ARENA_NEW(arena, struct conifer_branch);
    *conifer->branches = *branch;
    conifer->branches->twigs_count = (uint32_t)count;
    conifer->twigs_count = count;
    conifer->twigs = ARENA_ARRAY(arena, struct conifer_twig, count);
    memcpy(conifer->twigs, twigs, count * sizeof *twigs);
    conifer->needle_sides = 12;
    for (int i = 0; i < 3; i++)
        conifer->needle_albedo[i] = conifer->bark_albedo[i] = 0.5f;
    conifer->needle_specular = 0.4f;
    conifer->needle_exponent = 20;
    if (conifer_finish(conifer, &error))
        fail_msg("%s", error.text);
    return plant_from_conifer(arena, "test", conifer);
}

/* Twigs on one hardly visible branch far below. */
static inline struct plant *plant_of(struct arena *arena, const struct conifer_twig *twigs,
                                     size_t count)
{
    static const struct conifer_branch hidden = {{0, -0.1f, 0}, {0, -0.11f, 0}, 1e-5f, 1e-5f, 0, 0};
    return plant_on(arena, &hidden, twigs, count);
}

static inline void plant_add(struct world *world, struct plant *plant)
{
    struct scene *scene = &world->scene;
    scene->species[0] = (struct species){"test", plant, 1, 1, 1};
    scene->species_count = 1;
    scene->instances[scene->instances_count++] = (struct instance){{0, 0, 0}, 0, 1, 0, 1};
}

static inline struct frame *drawn(struct world *world, const struct cones_options *options,
                                  unsigned effects, int threads)
{
    struct error error = {0};
    struct workspace workspace = {
        .arena = world->arena, .error = &error, .effects = effects, .threads = threads};
    struct frame *frame =
        frame_create(world->arena, world->view.width_px, world->view.height_px, false);
    struct target target = {.width_px = frame->width_px,
                            .height_px = frame->height_px,
                            .format = TARGET_RGBA32F,
                            .pixels = frame->rgba};
    struct cones *cones;
    if (cones_prepare(&workspace, &world->scene, options, &cones) ||
        cones_draw(&workspace, cones, &world->view, &target))
        fail_msg("%s", error.text);
    return frame;
}

static inline double sum_of(const struct frame *frame, int channel)
{
    double sum = 0;
    for (size_t i = 0; i < (size_t)frame->width_px * (size_t)frame->height_px; i++)
        sum += frame->rgba[4 * i + (size_t)channel];
    return sum;
}

/* A twig at the origin along a direction, as dense as the paper's. */
static inline struct conifer_twig twig_along(double x, double y, double z)
{
    double length = sqrt(x * x + y * y + z * z);
    return (struct conifer_twig){
        .axis = {(float)(x / length), (float)(y / length), (float)(z / length)},
        .length_m = 0.24f,
        .axis_radius_m = 1e-5f,
        .cones_count = 12,
        .spacing_m = 0.02f,
        .needles_count = 12,
        .needle_length_m = 0.05f,
        .needle_radius_m = 0.0005f,
        .needle_angle_rad = 0.7f,
        .azimuth_step_rad = 0.9f};
}

#endif
