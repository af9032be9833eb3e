/* jakulin: the trunk as polygons, the foliage as few slices along vertical directions, of which the
 * two nearest to the eye are mixed. Jakulin 2000; Senegas 2001, 3.1.
 *
 * Departures: a stack's weight multiplies the optical depth of its slices, not their opacity:
 * between two directions the crown stays as dense as along one. And a third stack is horizontal
 * (above=stack): seen from straight above vertical slices are lines. */
#include "bake/stack.h"
#include "bake/triangles.h"

struct options {
    int directions, above, slices, resolution, order, cut, samples;
    float criterion, texel, error_px, near;
    bool oblique, smooth;
    struct shadow_choice sun;
};

/* clang-format off */
static const struct option table[] = {
    OPTION(struct options, directions, 4, 2, 8, "", "vertical directions that slices are made along"),
    OPTION_WORD(struct options, above, 1, "none|stack",
                "stack: horizontal slices take over as the view rises above 30 degrees; none: as published"),
    OPTION(struct options, slices, 8, 1, 32, "", "slices along each of them"),
    OPTION(struct options, resolution, 256, 8, 512, "px", "texels along a picture's longer side"),
    OPTION_WORD(struct options, order, 0, "mixed|exact",
                "mixed: as published, one stack after the other though their slices cross; "
                "exact: cut where they cross, from far to near"),
    OPTION_WORD(struct options, cut, 1, "clip|centroid",
                "leaves are cut by the slabs, or lie whole in that of their centroid"),
    OPTION(struct options, samples, 4, 1, 8, "",
           "samples along a texel's side when slices are baked"),
    OPTION(struct options, criterion, 2, 0, 64, "px",
           "parallax between neighbouring slices at lod=auto; 0: all slices"),
    OPTION(struct options, texel, 1, 0.1, 16, "px", "largest size of minified texels on the picture"),
    OPTION(struct options, error_px, 1, 0.1, 64, "px",
           "8 times how far bark may move at lod=auto; twice as much at intermediate, four times at low"),
    OPTION(struct options, near, 1, 0, 16, "radii",
           "trees nearer to the eye are drawn by their triangles; 0: none"),
    OPTION(struct options, oblique, 1, 0, 1, "",
           "slices seen at a slant hide as much as the longer way through them"),
    OPTION(struct options, smooth, 0, 0, 1, "",
           "numbers of slices change gradually, and trees turn into their triangles so"),
    SHADOW_CHOICE_OPTIONS(struct options, sun),
    OPTION_END,
};
/* clang-format on */

enum { DIRECTIONS_MOST = 8 };

struct state {
    struct stack *foliage;
    struct triangles *trunks;
    struct cull *cull; /* of the trunks */
};

static unsigned effects(const void *values)
{
    return shadow_choice_effects(&((const struct options *)values)->sun);
}

/* Bark parts come first in a mesh. */
static enum status bark_of(struct workspace *workspace, struct plant *plant, struct plant **bark)
{
    const struct mesh *whole;
    enum status status = plant_mesh(plant, &whole, workspace->error);
    if (status != STATUS_OK)
        return status;
    struct mesh *mesh = ARENA_NEW(workspace->arena, struct mesh);
    *mesh = *whole;
    mesh->parts_count = mesh->triangles_count = 0;
    for (size_t i = 0; i < whole->parts_count; i++)
        if (whole->materials[whole->parts[i].material].kind == MATERIAL_BARK) {
            mesh->parts_count++;
            mesh->triangles_count += whole->parts[i].triangles_count;
        }
    *bark = plant_from_mesh(workspace->arena, plant_name(plant), mesh);
    return STATUS_OK;
}

static enum status prepare_trunks(struct workspace *workspace, const struct scene *scene,
                                  const struct options *options, struct state *state)
{
    struct triangles_request request = {
        .trees_room = scene->instances_count,
        .tolerance_px = triangles_tolerance_px(options->error_px, workspace->lod),
        .smooth = true,
        .contrast = true,
        .sift = true,
        .shadows = sun_shadows_map(state->foliage->shadows)};
    struct scene *trunks = ARENA_NEW(workspace->arena, struct scene);
    enum status status = STATUS_OK;
    *trunks = *scene;
    trunks->species = ARENA_ARRAY(workspace->arena, struct species, scene->species_count);
    for (size_t i = 0; i < scene->species_count && status == STATUS_OK; i++) {
        trunks->species[i] = scene->species[i];
        status = bark_of(workspace, scene->species[i].plant, &trunks->species[i].plant);
    }
    if (status == STATUS_OK)
        status = triangles_prepare(workspace, trunks, &request, &state->trunks);
    if (status == STATUS_OK)
        state->cull = cull_create(workspace->arena, trunks, triangles_bounds(state->trunks));
    return status;
}

static enum status prepare(struct workspace *workspace, const struct scene *scene,
                           const void *values, void **result)
{
    const struct options *options = values;
    struct state *state = *result = ARENA_NEW(workspace->arena, struct state);
    float(*directions)[3] = arena_alloc(workspace->arena, DIRECTIONS_MOST + 1, sizeof *directions);
    for (int i = 0; i < options->directions; i++) {
        float angle = (float)i * (float)M_PI / (float)options->directions;
        directions[i][0] = sinf(angle);
        directions[i][1] = 0;
        directions[i][2] = cosf(angle);
    }
    directions[options->directions][1] = 1;
    struct stack_request request = {
        .bake = {.directions_count = (size_t)(options->directions + options->above),
                 .directions = (const float(*)[3])directions,
                 .count = options->slices,
                 .samples = options->samples,
                 .cut = options->cut ? SLICES_CENTROID : SLICES_CLIP,
                 .parts = SLICES_LEAVES},
        .resolution_px = options->resolution,
        .dilate = true,
        .rectangles = true,
        .rough = true,
        .facing = true,
        .oblique = options->oblique,
        .near_radii = options->near,
        .near_octaves = options->smooth ? STACK_NEAR_OCTAVES : 0,
        .smooth = options->smooth,
        .mix = options->order ? STACK_CROSSED : STACK_MIXED,
        .above = options->above,
        .sun = options->sun,
        .criterion_px = options->criterion,
        .texel_px = options->texel,
    };
    enum status status = stack_prepare(workspace, scene, &request, &state->foliage);
    return status == STATUS_OK ? prepare_trunks(workspace, scene, options, state) : status;
}

static enum status draw(struct workspace *workspace, void *own, const struct view *view,
                        struct target *target)
{
    static const struct sampling_places middle = {1, {{0.5f, 0.5f}}};
    struct state *state = own;
    enum status status = stack_backdrop(workspace, state->foliage, view, target);
    if (status != STATUS_OK)
        return status;
    struct cull_list list = cull_view(state->cull, view, triangles_order(state->trunks));
    struct triangles_frame frame = {
        .view = view, .drawn = view, .places = &middle, .cull = state->cull};
    triangles_draw(workspace, state->trunks, &frame, &list);
    return stack_trees(workspace, state->foliage, view, target);
}

extern const struct method jakulin_method;
const struct method jakulin_method = {
    .abi = METHOD_ABI,
    .name = "jakulin",
    .summary = "the trunk as polygons, the foliage as slices of two directions mixed by angle",
    .source = "Jakulin, Interactive Vegetation Rendering with Slicing and Blending, Eurographics "
              "2000, short presentations; Senegas, DEA IVR, INPG, 2001, 3.1",
    .traits = EFFECT_TWO_SIDED | EFFECT_AMBIENT | EFFECT_SUN_SHADOWS | EFFECT_FOG |
              TRAIT_STOCHASTIC | TRAIT_MASK,
    .options = table,
    .options_size = sizeof(struct options),
    .effects = effects,
    .prepare = prepare,
    .draw = draw,
};
