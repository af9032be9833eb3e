/* texels: stacks of slices whose colours hold their light. Meyer and Neyret 1998.
 *
 * Light is baked for trees turned by steps of the world's light, so that a picture is what was lit
 * and nothing is computed a fragment; each step needs textures of its own, front and back: with 64
 * slices of 128 texels about 40 MB a step and species. When the sun moves all is baked anew.
 *
 * With source=voxels or opaque the slices are layers of a volume that is coloured from pictures
 * with depth around each plant: Babahenini and Djedi 2006, Seitz and Dyer 1997. */
#include "bake/stack.h"
#include "method/method.h"

struct options {
    int path, source, views, criterion, slices, resolution, turns, ground, cut, filter, samples;
    float gap, parallax, texel, near, distant;
    bool interpolate, smooth;
};

/* clang-format off */
static const struct option table[] = {
    OPTION_WORD(struct options, path, 1, "naive|fast",
                "naive: as published, every slice a whole trilinear quad, a draw a tree"),
    OPTION_WORD(struct options, source, 0, "mesh|voxels|opaque",
                "voxels: from pictures, a layer a slice, resolution (to 256) a side; opaque: as published, opacity 1"),
    OPTION(struct options, views, 12, 1, 64, "", "pictures around a plant that voxels are coloured from"),
    OPTION(struct options, slices, 64, 1, 512, "", "slices along each of the three directions"),
    OPTION(struct options, resolution, 128, 8, 512, "px", "texels along a picture's longer side"),
    OPTION_WORD(struct options, criterion, 1, "c1|c2|both|none",
                "what the number of slices at lod=auto follows: gap, parallax, the stricter, or all there are"),
    OPTION(struct options, gap, 2, 0.01, 512, "",
           "C1: largest gap between neighbouring slices along them, in texels"),
    OPTION(struct options, parallax, 2, 0.01, 64, "px", "C2: largest parallax between neighbouring slices"),
    OPTION(struct options, turns, 4, 1, 32, "",
           "steps of a tree's rotation that light is baked for; memory and baking grow with them"),
    OPTION_WORD(struct options, ground, 0, "upright|base|patch",
                "boxes stand as trees do; on the terrain with four points; bent along its normals with eight"),
    OPTION_WORD(struct options, cut, 1, "clip|centroid",
                "leaves are cut by the slabs, or lie whole in that of their centroid"),
    OPTION(struct options, samples, 4, 1, 8, "",
           "samples along a texel's side when slices are baked"),
    OPTION_WORD(struct options, filter, 1, "trilinear|bilinear", "bilinear: of one mip level a tree"),
    OPTION(struct options, texel, 1, 0.1, 16, "px", "largest size of minified texels on the picture"),
    OPTION(struct options, near, 1, 0, 16, "radii",
           "upright trees closer to the eye than so many of their radii are drawn by their triangles; "
           "none on path=naive"),
    OPTION(struct options, distant, 16, 0, 32, "px",
           "at lod=auto, where the largest tree is smaller, trees are single pictures drawn by the CPU; "
           "none on path=naive; 0: none"),
    OPTION(struct options, interpolate, 0, 0, 1, "",
           "up to four times the slices, by interpolation, where the criterion asks for more"),
    OPTION(struct options, smooth, 0, 0, 1, "",
           "numbers of slices and directions change gradually, and trees become distant so"),
    OPTION_END,
};
/* clang-format on */

enum { CRITERION_C1, CRITERION_C2, CRITERION_BOTH }; /* as in the table */

static enum status prepare(struct workspace *workspace, const struct scene *scene,
                           const void *values, void **state)
{
    const struct options *options = values;
    bool fast = options->path == 1;
    bool c1 = options->criterion == CRITERION_C1 || options->criterion == CRITERION_BOTH;
    bool c2 = options->criterion == CRITERION_C2 || options->criterion == CRITERION_BOTH;
    bool voxels = options->source > 0;
    struct stack_request request = {
        .bake = {.directions_count = 3,
                 .directions = slices_axes,
                 .count = voxels ? options->resolution : options->slices,
                 .views = voxels ? (size_t)options->views : 0,
                 .binary = options->source == 2,
                 .samples = options->samples,
                 .cut = options->cut ? SLICES_CENTROID : SLICES_CLIP,
                 .parts = SLICES_BARK | SLICES_LEAVES},
        .resolution_px = options->resolution,
        .square = !fast || voxels,
        .trilinear = !fast || options->filter == 0,
        .rectangles = fast,
        .near_radii = fast && !voxels && options->ground == GROUND_UPRIGHT ? options->near : 0,
        .each = !fast,
        .interpolate = options->interpolate,
        .smooth = options->smooth,
        .criterion_px = c2 ? options->parallax : 0,
        .criterion_texels = c1 ? options->gap : 0,
        .texel_px = options->texel,
        .distant_px = fast ? options->distant : 0,
        .turns = options->turns,
        .ground = (enum stack_ground)options->ground,
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

extern const struct method texels_method;
const struct method texels_method = {
    .abi = METHOD_ABI,
    .name = "texels",
    .summary = "stacks of slices whose colours hold their light",
    .source = "Meyer and Neyret, Interactive Volumetric Textures, EGWR 1998, "
              "doi:10.1007/978-3-7091-6453-2_15",
    .traits = EFFECT_TWO_SIDED | EFFECT_AMBIENT | EFFECT_FOG,
    .options = table,
    .options_size = sizeof(struct options),
    .supported = method_needs_no_stretch,
    .prepare = prepare,
    .draw = draw,
};
