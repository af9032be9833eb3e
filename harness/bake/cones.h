/* Conifers drawn by one cone a pixel through trees, twigs, cones and needles, on the CPU: pixel by
 * pixel through bounding hierarchies, or all pixels together, the hierarchy descended once a
 * picture and what it ends in put to tiles of pixels, front to back. Both give the same picture. */
#ifndef TREELINE_BAKE_CONES_H
#define TREELINE_BAKE_CONES_H

#include "bake/cone_canvas.h"
#include "bake/cone_emit.h"
#include "bake/cull.h"

struct cones_options {
    struct cone_choice choice;
    enum cone_shaders shaders;
    bool is_naive;
    const char *isa; /* a name of cone_isas(); NULL: the last */
    bool shadows;
    bool edges; /* relief is cut into layers where its edge crosses a pixel */
    float stop; /* a pixel is closed when it lets through no more */
};

struct cones;
enum status cones_prepare(struct workspace *workspace, const struct scene *scene,
                          const struct cones_options *options, struct cones **cones);
enum status cones_draw(struct workspace *workspace, struct cones *cones, const struct view *view,
                       struct target *target);

#endif
