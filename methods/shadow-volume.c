/* shadow-volume: every triangle, lit by the sun where it is in no shadow volume
 * (bake/shadow_passes.h). */
#include "bake/shadow_passes.h"

struct options {
    int samples, test, volumes, triangles;
};

/* clang-format off */
static const struct option option_table[] = {
    SAMPLING_OPTION(struct options, 0),
    OPTION_WORD(struct options, test, 0, "auto|z-fail|z-pass",
        "what is counted: boundaries behind a sample, or those before it, which is wrong where the eye is in a shadow; "
        "auto: z-pass for the trees that cannot shade the eye"),
    OPTION_WORD(struct options, volumes, 0, "silhouette|triangles",
        "one volume behind what is connected, or one behind each triangle"),
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
        .sun = {
            .technique = SHADOW_BY_VOLUME,
            .triangles_most = options->triangles,
            .volume = {.test = (enum shadow_test)options->test, .triangles = options->volumes}}};
    return shadow_passes_prepare(workspace, scene, &request, state);
}

extern const struct method shadow_volume_method;
const struct method shadow_volume_method = {
    .abi = METHOD_ABI,
    .name = "shadow-volume",
    .summary = "every triangle, in the sun where no shadow volume is: stencil, silhouettes, z-fail",
    .source = "Crow, Shadow algorithms for computer graphics, 1977, doi:10.1145/965141.563901; "
              "Everitt, Kilgard, Practical and robust stenciled shadow volumes for "
              "hardware-accelerated rendering, 2002, arXiv:cs/0301002; Abderrahmani 2018, 5.1",
    .traits = EFFECT_TWO_SIDED | EFFECT_AMBIENT | EFFECT_SUN_SHADOWS | EFFECT_FOG | TRAIT_MASK,
    .options = option_table,
    .options_size = sizeof(struct options),
    .prepare = prepare,
    .draw = shadow_passes_draw,
};
