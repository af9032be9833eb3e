/* shadow-hybrid: every triangle, near the eye in the shadow of volumes, farther away in that of a
 * depth map (bake/shadow_passes.h): what Abderrahmani 2018 proposes at its end and leaves open.
 *
 * Volumes are right at every distance and cost what they fill; a map's texels are too large only
 * near the eye. Volumes are made of those trees alone whose shadows come near, and what fills the
 * picture beyond is dropped. */
#include "bake/shadow_passes.h"

struct options {
    int size, cascades, casters, samples, triangles;
    float near_m, texel_px, blend;
};

/* clang-format off */
static const struct option option_table[] = {
    OPTION(struct options, near_m, 0, 0, 1000000, "m",
        "shadows are the volumes' to this depth, the map's beyond; 0: where its texels get as small as texel_px"),
    OPTION(struct options, texel_px, 1, 0.01, 1000, "px",
        "near_m=0: how large a texel of the map may be where the map begins, across the light"),
    OPTION(struct options, blend, 0.2, 0, 1, "",
        "share of that depth, before its end, over which one goes over into the other; 0: at once"),
    OPTION(struct options, size, 2048, 256, 8192, "", "texels along a side of a map"),
    OPTION(struct options, cascades, 1, 1, 4, "", "maps, one behind the other along the view"),
    OPTION_WORD(struct options, casters, 1, SHADOW_CASTERS_WORDS, SHADOW_CASTERS_DOC),
    SAMPLING_OPTION(struct options, 0),
    SHADOW_PASSES_TRIANGLES(struct options),
    OPTION_END,
};
/* clang-format on */

static enum status prepare(struct workspace *workspace, const struct scene *scene,
                           const void *values, void **state)
{
    const struct options *options = values;
    const struct shadow_choice choice = {.shadow = SHADOW_BY_HYBRID,
                                         .shadow_size = options->size,
                                         .cascades = options->cascades,
                                         .casters = options->casters,
                                         .triangles = options->triangles};
    struct shadow_passes_request request = {.samples = sampling_count(options->samples),
                                            .sun = shadow_choice_request(&choice)};
    request.sun.map.bias = SHADOW_BIAS_SLOPE; /* as method shadow-map */
    request.sun.own = true;
    request.sun.volume.behind_px = 0; /* the very triangles that cast */
    request.sun.near_m = options->near_m;
    request.sun.texel_px = options->texel_px;
    request.sun.blend = options->blend;
    return shadow_passes_prepare(workspace, scene, &request, state);
}

extern const struct method shadow_hybrid_method;
const struct method shadow_hybrid_method = {
    .abi = METHOD_ABI,
    .name = "shadow-hybrid",
    .summary = "every triangle in a sun whose shadows come from volumes near by, from a map beyond",
    .source = "Abderrahmani 2018, perspectives, 5, proposed and not built; McCool, Shadow volume "
              "reconstruction from depth maps, 2000, doi:10.1145/343002.343006; Chan, Durand, An "
              "efficient hybrid shadow rendering algorithm, 2004, which share them by the edges of "
              "shadows, not by distance",
    .traits = EFFECT_TWO_SIDED | EFFECT_AMBIENT | EFFECT_SUN_SHADOWS | EFFECT_FOG |
              TRAIT_STOCHASTIC | TRAIT_MASK,
    .options = option_table,
    .options_size = sizeof(struct options),
    .prepare = prepare,
    .draw = shadow_passes_draw,
};
