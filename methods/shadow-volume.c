/* shadow-volume: every triangle, lit by the sun where it is in no shadow volume
 * (bake/shadow_passes.h). */
#include "bake/shadow_passes.h"

struct options {
    int samples, test, volumes, triangles;
};

/* clang-format off */
static const struct option option_table[] = {
    OPTION_WORD(struct options, samples, 0, "1|4|16",
        "samples a pixel: 4 are multisampled, 16 too where the driver has them, else 4 in 2 x 2 texels"),
    OPTION_WORD(struct options, test, 0, "auto|z-fail|z-pass",
        "what is counted: boundaries behind a sample, or those before it, which is wrong where the eye is in a shadow; "
        "auto: z-pass for the trees that cannot shade the eye"),
    OPTION_WORD(struct options, volumes, 0, "silhouette|triangles",
        "one volume behind what is connected, or one behind each triangle"),
    OPTION(struct options, triangles, 524288, 10000, 8388608, "",
        "that all trees may have together; more are refused: each is drawn twice and casts a volume in every frame"),
    OPTION_END,
};
/* clang-format on */

static enum status prepare(struct workspace *workspace, const struct scene *scene,
                           const void *values, void **state)
{
    static const int samples_of_word[] = {1, 4, 16};
    const struct options *options = values;
    struct shadow_passes *passes = NULL;
    struct shadow_passes_request request = {
        .samples = samples_of_word[options->samples],
        .triangles_most = options->triangles,
        .volume = {.test = (enum shadow_test)options->test, .triangles = options->volumes}};
    enum status status = shadow_passes_prepare(workspace, scene, &request, &passes);
    *state = passes;
    return status;
}

static enum status draw(struct workspace *workspace, void *state, const struct view *view,
                        struct target *target)
{
    return shadow_passes_draw(workspace, state, view, target);
}

extern const struct method shadow_volume_method;
const struct method shadow_volume_method = {
    .abi = METHOD_ABI,
    .name = "shadow-volume",
    .summary = "every triangle, in the sun where no shadow volume is: stencil, silhouettes, z-fail",
    .source = "Crow, Shadow algorithms for computer graphics, 1977, doi:10.1145/965141.563901; "
              "Everitt, Kilgard, Practical and robust stenciled shadow volumes for "
              "hardware-accelerated rendering, 2002, arXiv:cs/0301002; Abderrahmani 2018, 5.1",
    .traits = EFFECT_TWO_SIDED | EFFECT_AMBIENT | EFFECT_SUN_SHADOWS | EFFECT_FOG |
              TRAIT_MASK,
    .options = option_table,
    .options_size = sizeof(struct options),
    .prepare = prepare,
    .draw = draw,
};
