/* shaded-texels: stacks of slices with colours and normals, lit in every fragment. Senegas 2001. */
#include "bake/stack.h"
#include "method/method.h"

struct options {
    int path, add, front, slices, resolution, cut, filter, samples;
    float criterion, texel, near, distant;
    bool dilate, interpolate, rough, facing, smooth, unit;
};

/* clang-format off */
static const struct option table[] = {
    OPTION_WORD(struct options, path, 1, "naive|fast",
                "naive: as published, every slice a whole trilinear quad, a draw a tree"),
    OPTION_WORD(struct options, add, 0, "nothing|batches|rectangles|bilinear|even|criterion|rough|facing|front",
                "to naive, one of what makes fast fast: to see what each gives"),
    OPTION(struct options, front, 0, 0, 64, "",
           "groups of trees drawn front to back, pixels closed after each where nothing more is seen; "
           "0: back to front; add=front: 8"),
    OPTION(struct options, slices, 64, 1, 512, "", "slices along each of the three directions"),
    OPTION(struct options, resolution, 128, 8, 512, "px", "texels along a picture's longer side"),
    OPTION_WORD(struct options, cut, 1, "clip|centroid",
                "leaves are cut by the slabs, or lie whole in that of their centroid"),
    OPTION(struct options, samples, 4, 1, 8, "",
           "samples along a texel's side when slices are baked"),
    OPTION_WORD(struct options, filter, 1, "trilinear|bilinear", "bilinear: of one mip level a tree"),
    OPTION(struct options, texel, 1, 0.1, 16, "px", "largest size of minified texels on the picture"),
    OPTION(struct options, criterion, 2, 0, 64, "px",
           "parallax between neighbouring slices at lod=auto; 0: all slices"),
    OPTION(struct options, near, 1, 0, 16, "radii",
           "trees closer to the eye than so many of their radii are drawn by their triangles; none on path=naive"),
    OPTION(struct options, rough, 1, 0, 1, "", "normals that scatter within a texel spread its light"),
    OPTION(struct options, facing, 1, 0, 1, "",
           "leaves show the area that they turn to the eye, not to the front of the slices"),
    OPTION(struct options, dilate, 1, 0, 1, "",
           "empty texels get their neighbours' normals, and on path=naive their colours"),
    OPTION(struct options, distant, 16, 0, 32, "px",
           "at lod=auto, where the largest tree is smaller, trees are single pictures drawn by the CPU; "
           "none on path=naive; 0: none"),
    OPTION(struct options, interpolate, 0, 0, 1, "",
           "up to four times the slices, by interpolation, where the criterion asks for more"),
    OPTION(struct options, smooth, 0, 0, 1, "",
           "numbers of slices and directions change gradually, and trees become distant so"),
    OPTION(struct options, unit, 0, 0, 1, "",
           "normals get length 1 after filtering: nothing scatters within a texel any more"),
    OPTION_END,
};
/* clang-format on */

enum { PATH_NAIVE, PATH_FAST };
enum {
    ADD_NOTHING,
    ADD_BATCHES,
    ADD_RECTANGLES,
    ADD_BILINEAR,
    ADD_EVEN,
    ADD_CRITERION,
    ADD_ROUGH,
    ADD_FACING,
    ADD_FRONT
};

static enum status prepare(struct workspace *workspace, const struct scene *scene,
                           const void *values, void **state)
{
    const struct options *options = values;
    bool fast = options->path == PATH_FAST;
    struct stack_request request = {
        .bake = {.directions_count = 3,
                 .directions = slices_axes,
                 .count = options->slices,
                 .samples = options->samples,
                 .cut = options->cut ? SLICES_CENTROID : SLICES_CLIP,
                 .parts = SLICES_BARK | SLICES_LEAVES},
        .resolution_px = options->resolution,
        .square = !fast && options->add != ADD_EVEN,
        .straight = !fast,
        .dilate = options->dilate,
        .unit = options->unit,
        .trilinear = fast ? options->filter == 0 : options->add != ADD_BILINEAR,
        .rectangles = fast || options->add == ADD_RECTANGLES,
        .near_radii = fast ? options->near : 0,
        .groups = !fast && options->add == ADD_FRONT ? 8 : options->front,
        .each = !fast && options->add != ADD_BATCHES,
        .rough = fast ? options->rough : options->add == ADD_ROUGH,
        .facing = fast ? options->facing : options->add == ADD_FACING,
        .interpolate = options->interpolate,
        .smooth = options->smooth,
        .criterion_px = fast || options->add == ADD_CRITERION ? options->criterion : 0,
        .texel_px = options->texel,
        .distant_px = fast ? options->distant : 0,
    };
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
    .traits = EFFECT_TWO_SIDED | EFFECT_AMBIENT | EFFECT_FOG,
    .options = table,
    .options_size = sizeof(struct options),
    .prepare = prepare,
    .draw = draw,
};
