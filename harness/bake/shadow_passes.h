/* A scene whose trees are all their triangles in the world (bake/shadow_trees.h), with shadow
 * volumes that stand at these very triangles, or with volumes near by and a map beyond: the passes
 * of bake/shadow_choice.h. The relief's own shadows also by horizon maps. */
#ifndef TREELINE_BAKE_SHADOW_PASSES_H
#define TREELINE_BAKE_SHADOW_PASSES_H

#include "bake/sampling.h"
#include "bake/shadow_choice.h"

struct shadow_passes_request {
    int samples; /* a pixel: 1, 4 or 16 */
    struct sun_shadows_request
        sun;      /* SHADOW_BY_VOLUME or SHADOW_BY_HYBRID, whose casters are own */
    int azimuths; /* of horizon maps, and then the relief casts no volume; 0: none */
    int detail;   /* samples of them to one of the relief along each axis, at most */
    bool mixed;   /* of the two nearest azimuths */
};

/* clang-format off */
/* The row of a method's table for sun.triangles_most. */
#define SHADOW_PASSES_TRIANGLES(type)                                                              \
    OPTION(type, triangles, 524288, 10000, 8388608, "",                                            \
        "that all trees may have together; more are refused: each is drawn twice and casts a volume in every frame")
/* clang-format on */

enum status shadow_passes_prepare(struct workspace *workspace, const struct scene *scene,
                                  const struct shadow_passes_request *request, void **passes);
/* One picture, a method's `draw`. Without shadows, or without anything that casts volumes, in one
 * pass. */
enum status shadow_passes_draw(struct workspace *workspace, void *passes, const struct view *view,
                               struct target *target);

#endif
