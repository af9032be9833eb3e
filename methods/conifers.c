/* conifers: needles, cones and twigs met by one cone a pixel, each with its own shader.
 *
 * The paper casts a cone a pixel, finds the trees that it meets, shades needles, cones of needles
 * or twigs by distance, and composes by coverage. Mended here: what its integrals lose
 * (bake/needles.h; shaders=paper has them as printed), the relief, which shares a pixel by depth
 * and a mask (bake/cone_canvas.h), shadows between twigs and trees (bake/cone_light.h), and levels
 * that turn into each other.
 *
 * Not by OpenGL: 204 pines of 800 x 600 pixels are 542,544 strips a frame, and llvmpipe draws 3.2
 * to 3.5 million bare quads of 2 pixels a second on two cores (treeline calibrate, quads_2px): 0.16
 * s before one of them is shaded, of 0.40 s for all of a frame here, where putting strips to pixels
 * takes a sixth. Ambient light is not attenuated: sky-occlusion is none of this method's effects.
 */
#include "bake/cones.h"

struct options {
    int path, level, shaders;
    float needle, twig, lim1, lim2, thin, stop;
    bool shadows, edges;
};

/* clang-format off */
static const struct option table[] = {
    OPTION_WORD(struct options, path, 1, "naive|fast",
                "naive: a cone a pixel through bounding hierarchies; fast: all pixels together, the same picture"),
    OPTION_WORD(struct options, level, 0, "auto|needle|cone|twig",
                "auto: by the length of a needle on the picture, or by lim1 and lim2"),
    OPTION_WORD(struct options, shaders, 0, "exact|paper",
                "paper: as it prints them, clamped to what is physical"),
    OPTION(struct options, needle, 6, 0.1, 1000, "px", "needles at least so long are drawn one by one"),
    OPTION(struct options, twig, 2.5, 0.1, 1000, "px", "twigs whose needles are shorter are drawn as wholes"),
    OPTION(struct options, lim1, 0, 0, 1e6, "m", "the paper's: needles one by one up to this distance; 0: by needle"),
    OPTION(struct options, lim2, 0, 0, 1e6, "m", "the paper's: cones up to this distance; 0: by twig"),
    OPTION(struct options, thin, 4, 0, 64, "",
           "twigs a pixel of a tree's outline, fewer and larger ones for all; 0: every twig"),
    OPTION(struct options, stop, 0.01, 0, 0.5, "", "a cone ends when it lets through no more"),
    OPTION(struct options, shadows, 1, 0, 1, "", "twigs, bark, trees and relief shade the sun; off: nothing does"),
    OPTION(struct options, edges, 1, 0, 1, "",
           "relief is cut into layers of 16 samples where its edge crosses a pixel; off: it has one depth"),
    OPTION_END,
};
/* clang-format on */

static unsigned effects(const void *values)
{
    const struct options *options = values;
    return EFFECTS_ALL & ~(unsigned)(options->shadows ? 0 : EFFECT_SUN_SHADOWS);
}

static enum status supported(const struct scene *scene, const char **reason)
{
    enum status status = method_needs_no_stretch(scene, reason);
    for (size_t i = 0; i < scene->species_count && !status; i++) {
        const struct conifer *conifer = NULL;
        struct error error = {0};
        if (plant_conifer(scene->species[i].plant, &conifer, &error))
            continue; /* said by prepare */
        if (!conifer) {
            *reason = "it draws conifers alone, plants that are made of twigs with needles";
            status = STATUS_UNSUPPORTED;
        }
    }
    return status;
}

static enum status prepare(struct workspace *workspace, const struct scene *scene,
                           const void *values, void **state)
{
    const struct options *options = values;
    const struct cones_options cones = {
        .choice = {.forced = options->level - 1,
                   .needle_px = options->needle,
                   .twig_px = options->twig,
                   .limits_m = {options->lim1, options->lim2},
                   .thin = options->thin},
        .shaders = options->shaders ? CONE_PAPER : CONE_EXACT,
        .is_naive = options->path == 0,
        .shadows = options->shadows,
        .edges = options->edges,
        .stop = options->stop,
    };
    struct cones_options leveled = cones;
    if (options->level == 0 && workspace->lod != LOD_AUTO) /* the levels are the paper's */
        leveled.choice.forced = workspace->lod == LOD_HIGH           ? CONE_NEEDLE
                                : workspace->lod == LOD_INTERMEDIATE ? CONE_CONE
                                                                     : CONE_TWIG;
    return cones_prepare(workspace, scene, &leveled, (struct cones **)state);
}

static enum status draw(struct workspace *workspace, void *state, const struct view *view,
                        struct target *target)
{
    return cones_draw(workspace, state, view, target);
}

extern const struct method conifers_method;
const struct method conifers_method = {
    .abi = METHOD_ABI,
    .name = "conifers",
    .summary =
        "needles, cones and twigs with shaders of their own, met by one cone a pixel, on the CPU",
    .source =
        "Hattab, Babahenini and Djedi, Un modele pour l'illumination analytique et hierarchique "
        "des coniferes; Meyer and Neyret 2000, Multiscale shaders for the efficient realistic "
        "rendering of pine-trees; Amanatides 1984",
    .traits = TRAIT_CPU | EFFECT_TWO_SIDED | EFFECT_AMBIENT | EFFECT_SUN_SHADOWS | EFFECT_FOG |
              EFFECT_SPECULAR,
    .options = table,
    .options_size = sizeof(struct options),
    .effects = effects,
    .supported = supported,
    .prepare = prepare,
    .draw = draw,
};
