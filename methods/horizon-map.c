/* horizon-map: a relief under a moving sun, in the shadow of horizon maps that are made once (Max
 * 1988, bake/skyline.h). Trees are no height field: they cast shadow volumes
 * (bake/shadow_passes.h), and the relief casts nothing on them. */
#include "bake/shadow_passes.h"
#include "bake/skyline.h"

struct options {
    int samples, azimuths, detail, lookup, triangles;
};

/* clang-format off */
static const struct option option_table[] = {
    SAMPLING_OPTION(struct options, 0),
    OPTION(struct options, azimuths, 64, 1, SKYLINE_AZIMUTHS_MOST, "",
        "directions that the horizon is known in"),
    OPTION(struct options, detail, 4, 1, 8, "",
        "samples of the maps to one of the relief along each axis, as far as 128 MB hold them; 1: as published"),
    OPTION_WORD(struct options, lookup, 0, "mixed|nearest",
        "the horizon toward the sun from the two directions beside it, or the nearest one's, as published"),
    SHADOW_PASSES_TRIANGLES(struct options),
    OPTION_END,
};
/* clang-format on */

static enum status prepare(struct workspace *workspace, const struct scene *scene,
                           const void *values, void **state)
{
    const struct options *options = values;
    struct shadow_passes_request request = {
        .samples = sampling_count(options->samples),
        .sun = {.technique = SHADOW_BY_VOLUME, .triangles_most = options->triangles},
        .azimuths = options->azimuths,
        .detail = options->detail,
        .mixed = options->lookup == 0};
    return shadow_passes_prepare(workspace, scene, &request, state);
}

extern const struct method horizon_map_method;
const struct method horizon_map_method = {
    .abi = METHOD_ABI,
    .name = "horizon-map",
    .summary = "a relief in its own shadow by horizon maps that a moving sun leaves as they are",
    .source =
        "Max, Horizon mapping: shadows for bump-mapped surfaces, 1988, doi:10.1007/BF01905562; "
        "Stewart, Fast horizon computation at all points of a terrain with visibility and "
        "shading applications, 1998, doi:10.1109/2945.675656",
    .traits = EFFECT_TWO_SIDED | EFFECT_AMBIENT | EFFECT_SUN_SHADOWS | EFFECT_FOG | TRAIT_MASK,
    .options = option_table,
    .options_size = sizeof(struct options),
    .prepare = prepare,
    .draw = shadow_passes_draw,
};
