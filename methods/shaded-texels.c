/* shaded-texels: stacks of slices with colours and normals, lit in every fragment. Senegas 2001. */
#include "bake/stack_axes.h"
#include "method/method.h"

struct options {
    struct stack_axes axes;
    int add, front;
    float criterion;
    bool dilate, rough, facing, unit;
};

/* clang-format off */
static const struct option table[] = {
    STACK_AXES_OPTIONS(struct options),
    OPTION_WORD(struct options, add, 0, "nothing|batches|rectangles|bilinear|even|criterion|rough|facing|front|oblique",
                "to naive, one of what makes fast fast: to see what each gives"),
    OPTION(struct options, front, 0, 0, 64, "",
           "groups of trees drawn front to back, pixels closed after each where nothing more is seen; "
           "0: back to front; add=front: 8"),
    OPTION(struct options, criterion, 2, 0, 64, "px",
           "parallax between neighbouring slices at lod=auto; 0: all slices"),
    OPTION(struct options, rough, 1, 0, 1, "", "normals that scatter within a texel spread its light"),
    OPTION(struct options, facing, 1, 0, 1, "",
           "leaves show the area that they turn to the eye, not to the front of the slices"),
    OPTION(struct options, dilate, 1, 0, 1, "",
           "empty texels get their neighbours' normals, and on path=naive their colours"),
    OPTION(struct options, unit, 0, 0, 1, "",
           "normals get length 1 after filtering: nothing scatters within a texel any more"),
    OPTION_END,
};
/* clang-format on */

enum {
    ADD_NOTHING,
    ADD_BATCHES,
    ADD_RECTANGLES,
    ADD_BILINEAR,
    ADD_EVEN,
    ADD_CRITERION,
    ADD_ROUGH,
    ADD_FACING,
    ADD_FRONT,
    ADD_OBLIQUE
};

/* One of what is fast added to what is as published. */
static void add_one(int add, const struct options *options, struct stack_request *request)
{
    request->straight = true;
    request->square = add != ADD_EVEN;
    request->trilinear = add != ADD_BILINEAR;
    request->rectangles = add == ADD_RECTANGLES;
    request->groups = add == ADD_FRONT ? 8 : options->front;
    request->each = add != ADD_BATCHES;
    request->rough = add == ADD_ROUGH;
    request->facing = add == ADD_FACING;
    request->oblique = add == ADD_OBLIQUE;
    request->criterion_px = add == ADD_CRITERION ? options->criterion : 0;
}

static unsigned effects(const void *values)
{
    return shadow_choice_effects(&((const struct options *)values)->axes.sun);
}

static enum status prepare(struct workspace *workspace, const struct scene *scene,
                           const void *values, void **state)
{
    const struct options *options = values;
    struct stack_request request = stack_axes_request(&options->axes);
    request.dilate = options->dilate;
    request.unit = options->unit;
    request.groups = options->front;
    request.rough = options->rough;
    request.facing = options->facing;
    request.criterion_px = options->criterion;
    if (options->axes.path == STACK_NAIVE)
        add_one(options->add, options, &request);
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

extern const struct method shaded_texels_method;
const struct method shaded_texels_method = {
    .abi = METHOD_ABI,
    .name = "shaded-texels",
    .summary = "stacks of slices with colours and normals, lit in every fragment",
    .source = "Senegas, Rendu de forets en temps reel, DEA IVR, INPG, 2001; Meyer and Neyret, "
              "Interactive Volumetric Textures, 1998, doi:10.1007/978-3-7091-6453-2_15",
    .traits = EFFECT_TWO_SIDED | EFFECT_AMBIENT | EFFECT_SUN_SHADOWS | EFFECT_FOG | TRAIT_MASK,
    .options = table,
    .options_size = sizeof(struct options),
    .effects = effects,
    .prepare = prepare,
    .draw = draw,
};
