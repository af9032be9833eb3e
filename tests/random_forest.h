/* Trees of two species at random, with spheres around them, for the tests of culling. */
#ifndef TREELINE_TESTS_RANDOM_FOREST_H
#define TREELINE_TESTS_RANDOM_FOREST_H

#include "testing.h"

#include "bake/cull.h"
#include "base/random.h"

/* On 400 x 400 m, up to 30 m high, half as large to half as large again. */
static inline struct scene *random_forest(struct arena *arena, size_t trees, float far_m,
                                          struct cull_bound bounds[2])
{
    struct scene *scene = ARENA_NEW(arena, struct scene);
    struct random random = random_seed(7, 1);
    scene->width_px = 80;
    scene->height_px = 60;
    scene->camera = (struct camera_path){.fov_y_rad = 0.9f, .near_m = 1, .far_m = far_m};
    scene->species_count = 2;
    scene->instances_count = trees;
    scene->instances = ARENA_ARRAY(arena, struct instance, trees);
    for (size_t i = 0; i < trees; i++)
        scene->instances[i] =
            (struct instance){{400 * random_float(&random) - 200, 30 * random_float(&random),
                               400 * random_float(&random) - 200},
                              6 * random_float(&random),
                              0.5f + random_float(&random),
                              random_below(&random, 2),
                              1};
    bounds[0] = (struct cull_bound){6, 7};
    bounds[1] = (struct cull_bound){-1, 3};
    return scene;
}

#endif
