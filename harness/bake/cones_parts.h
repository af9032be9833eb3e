/* What both ways to draw conifers share. */
#ifndef TREELINE_BAKE_CONES_PARTS_H
#define TREELINE_BAKE_CONES_PARTS_H

#include "bake/cones.h"

struct cones_fast;
struct cones_naive;

struct cones {
    struct arena *arena;
    const struct scene *scene;
    struct cones_options options;
    struct cone_plant **plants;
    struct cone_lights *lights; /* NULL: no shadows wanted */
    struct cone_canvas *canvas;
    void (*shade)(struct cone_lanes_job *job); /* NULL: twigs are shaded one by one */
    struct cull *cull;
    struct cones_fast *fast;
    struct cones_naive *naive; /* one of both is NULL */
};

struct cones_fast *cones_fast_create(struct arena *arena, const struct cones *cones);
/* Returns how many strips there were, and pixels that they were put to. */
uint64_t cones_fast_draw(struct workspace *workspace, struct cones *cones,
                         const struct cone_picture *picture);
struct cones_naive *cones_naive_create(struct arena *arena, const struct cones *cones);
uint64_t cones_naive_draw(struct workspace *workspace, struct cones *cones,
                          const struct cone_picture *picture);

/* Whether the eye stands within a tree's trunk or bough: then the bark's light is all that is seen.
 */
bool cones_within(const struct cones *cones, const struct cone_picture *picture, float rgb[3]);

#endif
