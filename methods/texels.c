/* texels: stacks of slices whose colours hold their light. Meyer and Neyret 1998.
 *
 * Light is baked for trees turned by steps of the world's light, so that a picture is what was lit
 * and nothing is computed a fragment; each step needs textures of its own, front and back: with 64
 * slices of 128 texels about 40 MB a step and species. So do steps of a quarter of an octave of the
 * trees' stretch, which turns their normals. When the sun moves all is baked anew.
 *
 * With source=voxels or opaque the slices are layers of a volume that is coloured from pictures
 * with depth around each plant: Babahenini and Djedi 2006, Seitz and Dyer 1997. */
#include "bake/stack_axes.h"
#include "method/method.h"

struct options {
    struct stack_axes axes;
    int source, views, criterion, turns, ground;
    float gap, parallax;
};

/* clang-format off */
static const struct option table[] = {
    STACK_AXES_OPTIONS(struct options),
    OPTION_WORD(struct options, source, 0, "mesh|voxels|opaque",
                "voxels: from pictures, a layer a slice, resolution (to 256) a side; opaque: as published, opacity 1"),
    OPTION(struct options, views, 12, 1, 64, "", "pictures around a plant that voxels are coloured from"),
    OPTION_WORD(struct options, criterion, 1, "c1|c2|both|none",
                "what the number of slices at lod=auto follows: gap, parallax, the stricter, or all there are"),
    OPTION(struct options, gap, 2, 0.01, 512, "",
           "C1: largest gap between neighbouring slices along them, in texels"),
    OPTION(struct options, parallax, 2, 0.01, 64, "px", "C2: largest parallax between neighbouring slices"),
    OPTION(struct options, turns, 4, 1, 32, "",
           "steps of a tree's rotation that light is baked for; memory and baking grow with them"),
    OPTION_WORD(struct options, ground, 0, "upright|base|patch",
                "boxes stand as trees do; on the terrain with four points; bent along its normals with eight"),
    OPTION_END,
};
/* clang-format on */

enum { CRITERION_C1, CRITERION_C2, CRITERION_BOTH }; /* as in the table */

static unsigned effects(const void *values)
{
    return shadow_choice_effects(&((const struct options *)values)->axes.sun);
}

static enum status prepare(struct workspace *workspace, const struct scene *scene,
                           const void *values, void **state)
{
    const struct options *options = values;
    bool c1 = options->criterion == CRITERION_C1 || options->criterion == CRITERION_BOTH;
    bool c2 = options->criterion == CRITERION_C2 || options->criterion == CRITERION_BOTH;
    struct stack_request request = stack_axes_request(&options->axes);
    if (options->source > 0) {
        request.bake.count = options->axes.resolution;
        request.bake.directions_count = 3;
        request.bake.views = (size_t)options->views;
        request.bake.binary = options->source == 2;
        request.square = true;
        request.near_radii = 0;
    }
    if (options->ground != GROUND_UPRIGHT)
        request.near_radii = 0;
    request.criterion_px = c2 ? options->parallax : 0;
    request.criterion_texels = c1 ? options->gap : 0;
    request.turns = options->turns;
    request.ground = (enum stack_ground)options->ground;
    struct stack *stack;
    enum status status = stack_prepare(workspace, scene, &request, &stack);
    *state = stack;
    return status;
}

static enum status draw(struct workspace *workspace, void *state, const struct view *view,
                        struct target *target)
{
    return stack_draw(workspace, state, view, target);
}

extern const struct method texels_method;
const struct method texels_method = {
    .abi = METHOD_ABI,
    .name = "texels",
    .summary = "stacks of slices whose colours hold their light",
    .source = "Meyer and Neyret, Interactive Volumetric Textures, EGWR 1998, "
              "doi:10.1007/978-3-7091-6453-2_15",
    .traits = EFFECT_TWO_SIDED | EFFECT_AMBIENT | EFFECT_SUN_SHADOWS | EFFECT_FOG | TRAIT_MASK,
    .options = table,
    .options_size = sizeof(struct options),
    .effects = effects,
    .prepare = prepare,
    .draw = draw,
};
