/* The three passes of a scene with shadow volumes (Abderrahmani 2018, 5.1): all surfaces in the
 * sky's light, volumes into the stencil buffer, all surfaces again in the sun's light where none is
 * counted. Of the relief also by horizon maps. With a shadow map, volumes shade what is near: the
 * first pass has the map's light beyond, and the third one what both say of the band between. */
#ifndef TREELINE_BAKE_SHADOW_PASSES_H
#define TREELINE_BAKE_SHADOW_PASSES_H

#include "bake/sampling.h"
#include "bake/shadow_choice.h"
#include "bake/shadow_volume.h"

struct shadow_passes_request {
    int samples;        /* a pixel: 1, 4 or 16 */
    int triangles_most; /* of all trees together */
    struct shadow_volume_request volume;
    int azimuths; /* of horizon maps, and then the relief casts no volume; 0: none */
    int detail;   /* samples of them to one of the relief along each axis, at most */
    bool mixed;   /* of the two nearest azimuths */
    /* Of what is deeper than near_m; NULL: none. Its options are shared, its casters own. */
    const struct sun_shadows_request *map;
    float near_m;   /* volumes shade what is nearer; 0: to where the map's texels are as small as */
    float texel_px; /* so many pixels */
    float blend;    /* share of that depth, 0..1, before whose end both count */
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
