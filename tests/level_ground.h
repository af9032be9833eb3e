/* Ground that is flat, level and grey. */
#ifndef TREELINE_TESTS_LEVEL_GROUND_H
#define TREELINE_TESTS_LEVEL_GROUND_H

#include "base/arena.h"
#include "scene/scene.h"

/* A square at height 0 about the origin. */
static inline struct terrain level_ground(struct arena *arena, float side_m, float albedo)
{
    struct terrain terrain = {.samples_x = 2,
                              .samples_z = 2,
                              .size_x_m = side_m,
                              .size_z_m = side_m,
                              .heights_m = ARENA_ARRAY(arena, float, 4),
                              .normals = arena_alloc(arena, 4, sizeof *terrain.normals),
                              .albedo = {albedo, albedo, albedo}};
    for (int i = 0; i < 4; i++)
        terrain.normals[i][1] = 1;
    return terrain;
}

#endif
