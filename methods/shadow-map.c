/* shadow-map: every triangle, lit by a sun whose shadows come from depth maps (bake/shadow_map.h).
 */
#include "bake/sampling.h"
#include "bake/triangles_picture.h"

struct options {
    int size, cascades, taps, bias, depth, foliage, casters, samples;
    float split, bias_scale, layer_m, caster_tx, reach_m, error_px;
    bool stable, perspective, linear;
};

/* clang-format off */
static const struct option option_table[] = {
    OPTION(struct options, size, 2048, 256, 8192, "", "texels along a side of a map"),
    OPTION(struct options, cascades, 1, 1, 4, "", "maps, one behind the other along the view"),
    OPTION(struct options, split, 0.9, 0, 1, "",
        "where cascades end: 1 in equal ratios of depth, 0 in equal lengths, between them a blend"),
    OPTION(struct options, stable, 1, 0, 1, "",
        "texels stand still in the world while the eye moves; else maps fit the view tightly"),
    OPTION(struct options, perspective, 0, 0, 1, "",
        "maps are perspective along the view: finer near the eye; they do not stand still"),
    OPTION_WORD(struct options, taps, 1, "1|3|5|7", "along a side of the percentage-closer filter"),
    OPTION(struct options, linear, 1, 0, 1, "", "a tap is the bilinear mean of four comparisons"),
    OPTION_WORD(struct options, bias, 2, "none|constant|slope|plane|normal",
        "against self-shadowing: for 45 degrees; by the slope; along the receiver's plane; a step along the normal"),
    OPTION(struct options, bias_scale, 1, 0, 100, "", "times the bias that the closed form asks for"),
    OPTION_WORD(struct options, depth, 2, "16|24|32", "bits of a depth"),
    OPTION_WORD(struct options, foliage, 0, "solid|alpha|deep",
        "what a texel holds: a depth; and how much of it is covered; and how much up to four depths behind the first"),
    OPTION(struct options, layer_m, 1, 0.001, 1000, "m", "foliage=deep: between two of the depths"),
    OPTION_WORD(struct options, casters, 1, SHADOW_CASTERS_WORDS, SHADOW_CASTERS_DOC),
    OPTION(struct options, caster_tx, 1, 0, 64, "",
        "casters=low: how large a pruned leaf of a caster may grow, in texels; 0: every triangle casts"),
    OPTION(struct options, reach_m, 0, 0, 1000000, "m", "shadows are seen to this depth; 0: to the end of the view"),
    SAMPLING_OPTION(struct options, 1),
    OPTION(struct options, error_px, 1, 0.1, 64, "px",
        "how large a pruned leaf that is seen may grow at lod=auto; twice as much at intermediate, four times at low"),
    OPTION_END,
};
/* clang-format on */

static enum status prepare(struct workspace *workspace, const struct scene *scene,
                           const void *values, void **state)
{
    static const int bits_of_word[] = {16, 24, 32};
    const struct options *options = values;
    const struct sun_shadows_request shadows = {
        .technique = SHADOW_BY_MAP,
        .map = {.size_px = options->size,
                .cascades = options->cascades,
                .split = options->split,
                .stable = options->stable,
                .perspective = options->perspective,
                .linear = options->linear,
                .radius = options->taps,
                .bias = (enum shadow_bias)options->bias,
                .bias_scale = options->bias_scale,
                .depth_bits = bits_of_word[options->depth],
                .foliage = (enum shadow_foliage)options->foliage,
                .layer_m = options->layer_m,
                .caster_tx = options->caster_tx,
                .reach_m = options->reach_m},
        .casters = (enum shadow_casters)options->casters};
    const struct triangles_picture_request request = {.samples = sampling_count(options->samples),
                                                      .error_px = options->error_px,
                                                      .shadows = &shadows};
    return triangles_picture_prepare(workspace, scene, &request, state);
}

extern const struct method shadow_map_method;
const struct method shadow_map_method = {
    .abi = METHOD_ABI,
    .name = "shadow-map",
    .summary =
        "every triangle in a sun whose shadows come from depth maps: filters, cascades, biases",
    .source =
        "Williams, Casting curved shadows on curved surfaces, 1978, "
        "doi:10.1145/800248.807402; Reeves, Salesin, Cook, Rendering antialiased shadows with "
        "depth maps, 1987, doi:10.1145/37402.37435; Zhang, Sun, Xu, Lun, Parallel-split shadow "
        "maps, 2006, doi:10.1145/1128923.1128975; Wimmer, Scherzer, Purgathofer, Light space "
        "perspective shadow maps, 2004; Kim, Neumann, Opacity shadow maps, 2001; Yuksel, "
        "Keyser, Deep opacity maps, 2008; Abderrahmani 2018",
    .traits = EFFECT_TWO_SIDED | EFFECT_AMBIENT | EFFECT_SUN_SHADOWS | EFFECT_FOG |
              TRAIT_STOCHASTIC | TRAIT_MASK,
    .options = option_table,
    .options_size = sizeof(struct options),
    .prepare = prepare,
    .draw = triangles_picture_draw,
};
