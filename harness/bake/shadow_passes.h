/* The three passes of a scene with shadow volumes (Abderrahmani 2018, 5.1): all surfaces in the
 * sky's light, volumes into the stencil buffer, all surfaces again in the sun's light where none is
 * counted. Of the relief also by horizon maps. */
#ifndef TREELINE_BAKE_SHADOW_PASSES_H
#define TREELINE_BAKE_SHADOW_PASSES_H

#include "bake/sampling.h"
#include "bake/shadow_volume.h"

struct shadow_passes_request {
    int samples;        /* a pixel: 1, 4 or 16 */
    int triangles_most; /* of all trees together */
    struct shadow_volume_request volume;
    int azimuths; /* of horizon maps, and then the relief casts no volume; 0: none */
    int detail;   /* samples of them to one of the relief along each axis, at most */
    bool mixed;   /* of the two nearest azimuths */
};

/* clang-format off */
/* The row of a method's table for triangles_most. */
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
