/* polygons: every triangle, instanced and culled; an error-controlled level of detail far away
 * (bake/triangles.h). */
#include "bake/sampling.h"
#include "bake/triangles_picture.h"

struct options {
    int samples;
    float error_px;
    bool smooth, contrast, sift;
    struct shadow_choice sun;
};

/* clang-format off */
static const struct option option_table[] = {
    SAMPLING_OPTION(struct options, 0),
    OPTION(struct options, error_px, 1, 0.1, 64, "px",
        "how large a pruned leaf may grow, and 8 times how far bark may move, at lod=auto; "
        "twice as much at intermediate, four times at low"),
    OPTION(struct options, smooth, 1, 0, 1, "", "pruned leaves shrink away one by one instead of in steps"),
    OPTION(struct options, contrast, 1, 0, 1, "",
        "pruned leaves are drawn nearer to their mean radiance, as each stands for many"),
    OPTION(struct options, sift, 1, 0, 1, "",
        "triangles that meet no sample are found on the CPU and not drawn; only where GL is software, "
        "with plants without textures, without shadows"),
    SHADOW_CHOICE_VOLUME_OPTIONS(struct options, sun),
    OPTION_END,
};
/* clang-format on */

static unsigned effects(const void *values)
{
    return shadow_choice_effects(&((const struct options *)values)->sun);
}

static enum status prepare(struct workspace *workspace, const struct scene *scene,
                           const void *values, void **state)
{
    const struct options *options = values;
    const struct sun_shadows_request shadows = shadow_choice_request(&options->sun);
    const struct triangles_picture_request request = {.samples = sampling_count(options->samples),
                                                      .error_px = options->error_px,
                                                      .smooth = options->smooth,
                                                      .contrast = options->contrast,
                                                      .sift = options->sift,
                                                      .shadows =
                                                          options->sun.shadow ? &shadows : NULL};
    return triangles_picture_prepare(workspace, scene, &request, state);
}

extern const struct method polygons_method;
const struct method polygons_method = {
    .abi = METHOD_ABI,
    .name = "polygons",
    .summary = "every triangle; far trees by simplified bark and stochastically pruned leaves",
    .source = "Cook, Halstead, Planck, Ryu, Stochastic simplification of aggregate detail, 2007, "
              "doi:10.1145/1276377.1276476; Garland, Heckbert, Surface simplification using "
              "quadric error metrics, 1997, doi:10.1145/258734.258849",
    .traits = EFFECT_TWO_SIDED | EFFECT_AMBIENT | EFFECT_SUN_SHADOWS | EFFECT_FOG |
              TRAIT_STOCHASTIC | TRAIT_MASK,
    .options = option_table,
    .options_size = sizeof(struct options),
    .effects = effects,
    .prepare = prepare,
    .draw = triangles_picture_draw,
};
