/* cross-quads: a few fixed vertical planes that cross in a tree's axis, each with the tree's
 * picture. */
#include "bake/impostor.h"
#include "method/method.h"

#include "cross-quads.glsl.h"

struct options {
    int planes, resolution, alpha, filter, samples;
    float near;
    bool depth;
    struct shadow_choice sun;
};

/* clang-format off */
static const struct option table[] = {
    OPTION(struct options, planes, 2, 2, 8, "", "vertical planes a tree, evenly turned"),
    OPTION(struct options, resolution, 256, 8, 2048, "px", "texels along a plant's longest extent"),
    OPTION_WORD(struct options, alpha, 1, "blend|test|coverage",
                "sorted blending, alpha test, or 4 samples a pixel"),
    OPTION_WORD(struct options, filter, 1, "bilinear|nearest",
                "texels of pictures that are not magnified"),
    OPTION(struct options, samples, 4, 1, 8, "",
           "samples along a texel's side when pictures are baked"),
    OPTION(struct options, near, 2, 0, 16, "radii",
           "trees closer to the eye than so many of their radii are drawn by their triangles"),
    OPTION(struct options, depth, 0, 0, 1, "",
           "depth from the picture in each fragment, not from the plane"),
    SHADOW_CHOICE_VOLUME_OPTIONS(struct options, sun),
    OPTION_END,
};
/* clang-format on */

/* Up to this many pixels whole planes are blended, though each hides a part of the others: that
 * errs where two of them cover, by the difference of their colours, and halves the quads. */
static const float whole_area_px = 1000;

struct state {
    struct impostor *impostor;
    GLuint far_program;  /* of whole planes, a triangle each */
    GLuint near_program; /* of halves (blended) or hulls (opaque) */
    size_t planes;
};

/* The level of detail is the pictures' resolution. */
static int resolution_of(const struct options *options, enum lod lod)
{
    int divisor = lod == LOD_LOW ? 4 : lod == LOD_INTERMEDIATE ? 2 : 1;
    return options->resolution / divisor < 8 ? 8 : options->resolution / divisor;
}

static unsigned effects(const void *values)
{
    return shadow_choice_effects(&((const struct options *)values)->sun);
}

static enum status prepare(struct workspace *workspace, const struct scene *scene,
                           const void *values, void **result)
{
    const struct options *options = values;
    struct state *state = *result = ARENA_NEW(workspace->arena, struct state);
    bool halves = options->alpha == ATLAS_BLEND;
    struct atlas_request atlas = {
        .layout = VIEWS_PLANES,
        .side = (size_t)options->planes,
        .resolution_px = resolution_of(options, workspace->lod),
        .samples = options->samples,
        .alpha = (enum atlas_alpha)options->alpha,
        .nearest = options->filter == 1,
        .depth = options->depth,
    };
    state->planes = (size_t)options->planes;
    struct impostor_request request = {.atlas = atlas,
                                       .quads_each = (halves ? 2 : 1) * state->planes,
                                       .near_radii = options->near,
                                       .sun = options->sun};
    enum status status = impostor_prepare(workspace, scene, &request, &state->impostor);
    if (status == STATUS_OK)
        status = impostor_program(workspace, state->impostor, "cross-quads", cross_quads_glsl,
                                  "VIEWS 1\nHALVES 0\nCORNERS 3\n", &state->far_program);
    if (status == STATUS_OK)
        status = impostor_program(workspace, state->impostor, "cross-quads", cross_quads_glsl,
                                  halves ? "VIEWS 1\nHALVES 1\nCORNERS 4\n"
                                         : "VIEWS 1\nHALVES 0\nCORNERS 8\n",
                                  &state->near_program);
    return status;
}

static void draw_trees(struct workspace *workspace, const struct state *state,
                       const struct view *view, bool near, size_t first, size_t count)
{
    bool blend = state->impostor->alpha == ATLAS_BLEND;
    GLuint program = near ? state->near_program : state->far_program;
    if (count == 0)
        return;
    impostor_use(workspace, state->impostor, program, view, first);
    workspace->gl->Uniform1i(gl_uniform(workspace->gl, program, "planes"), (GLint)state->planes);
    impostor_draw(workspace, state->impostor,
                  !near   ? 3
                  : blend ? 4
                          : ATLAS_HULL,
                  count * state->planes * (near && blend ? 2 : 1));
}

static void draw_list(struct workspace *workspace, const void *own, const struct view *view,
                      const struct cull_list *list)
{
    const struct state *state = own;
    bool blend = state->impostor->alpha == ATLAS_BLEND;
    size_t near = impostor_near_count(state->impostor, view, list,
                                      blend ? whole_area_px : IMPOSTOR_HULL_PX, state->planes);
    size_t far = list->count - near;
    draw_trees(workspace, state, view, !blend, 0, blend ? far : near);
    draw_trees(workspace, state, view, blend, blend ? far : near, blend ? near : far);
}

static enum status draw(struct workspace *workspace, void *own, const struct view *view,
                        struct target *target)
{
    struct state *state = own;
    return impostor_picture(workspace, state->impostor, view, target, draw_list, state,
                            "cross-quads");
}

extern const struct method cross_quads_method;
const struct method cross_quads_method = {
    .abi = METHOD_ABI,
    .name = "cross-quads",
    .summary = "fixed vertical planes that cross in a tree's axis",
    .source =
        "Meyer, Neyret and Poulin, Interactive Rendering of Trees with Shading and Shadows, 2001, "
        "doi:10.1007/978-3-7091-6242-2_17 (previous work); Castano, Computing Alpha Mipmaps, 2010",
    .traits = EFFECT_TWO_SIDED | EFFECT_AMBIENT | EFFECT_SUN_SHADOWS | EFFECT_FOG | TRAIT_MASK,
    .options = table,
    .options_size = sizeof(struct options),
    .effects = effects,
    .prepare = prepare,
    .draw = draw,
};
