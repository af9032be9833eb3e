/* billboards: one picture a tree that turns to the eye, from an atlas of views. */
#include "bake/impostor.h"
#include "method/method.h"

#include "billboards.glsl.h"

struct options {
    int views, layout, pick, resolution, alpha, filter, samples;
    float near;
    bool depth;
    struct shadow_choice sun;
};

/* clang-format off */
static const struct option table[] = {
    OPTION(struct options, views, 16, 1, 1024, "",
           "pictures a species; on the square layouts the largest n x n up to it"),
    OPTION_WORD(struct options, layout, 0, "circle|hemisphere|octahedron",
                "directions: on the horizon, above it, or all"),
    OPTION_WORD(struct options, pick, 0, "nearest|blended",
                "one picture, or the 2 (circle) or 3 (square layouts) nearest by weight"),
    OPTION(struct options, resolution, 256, 8, 2048, "px", "texels along a plant's longest extent"),
    OPTION_WORD(struct options, alpha, 1, "blend|test|coverage",
                "sorted blending, alpha test, or 4 samples a pixel"),
    OPTION_WORD(struct options, filter, 0, "bilinear|nearest",
                "texels of pictures that are not magnified"),
    OPTION(struct options, samples, 4, 1, 8, "",
           "samples along a texel's side when pictures are baked"),
    OPTION(struct options, near, 2, 0, 16, "radii",
           "trees closer to the eye than so many of their radii are drawn by their triangles"),
    OPTION(struct options, depth, 0, 0, 1, "",
           "depth from the picture in each fragment, not from a plane"),
    SHADOW_CHOICE_VOLUME_OPTIONS(struct options, sun),
    OPTION_END,
};
/* clang-format on */

struct state {
    struct impostor *impostor;
    GLuint far_program; /* triangles, or quads where several pictures are mixed */
    GLuint hulls;       /* 0 where several pictures are mixed */
    int far_corners;
    int side;
};

/* The level of detail is the pictures' resolution. */
static int resolution_of(const struct options *options, enum lod lod)
{
    int divisor = lod == LOD_LOW ? 4 : lod == LOD_INTERMEDIATE ? 2 : 1;
    return options->resolution / divisor < 8 ? 8 : options->resolution / divisor;
}

/* Pictures in a fragment. */
static int mixed_of(const struct options *options)
{
    return options->pick == 0 ? 1 : options->layout == VIEWS_CIRCLE ? 2 : 3;
}

static enum status programs(struct workspace *workspace, const struct options *options,
                            struct state *state)
{
    int views = mixed_of(options);
    state->far_corners = views == 1 ? 3 : 4;
    const char *far = arena_printf(workspace->arena, "LAYOUT %d\nVIEWS %d\nCORNERS %d\n",
                                   options->layout, views, state->far_corners);
    const char *hulls = arena_printf(workspace->arena, "LAYOUT %d\nVIEWS %d\nCORNERS %d\n",
                                     options->layout, views, ATLAS_HULL);
    enum status status = impostor_program(workspace, state->impostor, "billboards", billboards_glsl,
                                          far, &state->far_program);
    if (status == STATUS_OK && views == 1)
        status = impostor_program(workspace, state->impostor, "billboards", billboards_glsl, hulls,
                                  &state->hulls);
    return status;
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
    enum views_layout layout = (enum views_layout)options->layout;
    struct atlas_request atlas = {
        .layout = layout,
        .side = views_side(layout, (size_t)options->views),
        .resolution_px = resolution_of(options, workspace->lod),
        .samples = options->samples,
        .alpha = (enum atlas_alpha)options->alpha,
        .nearest = options->filter == 1,
        .depth = options->depth,
    };
    state->side = (int)atlas.side;
    struct impostor_request request = {.atlas = atlas,
                                       .quads_each = 1,
                                       .mixed = mixed_of(options),
                                       .near_radii = options->near,
                                       .sun = options->sun};
    enum status status = impostor_prepare(workspace, scene, &request, &state->impostor);
    return status == STATUS_OK ? programs(workspace, options, state) : status;
}

static void draw_trees(struct workspace *workspace, const struct state *state,
                       const struct view *view, GLuint program, size_t first, size_t count)
{
    if (count == 0)
        return;
    impostor_use(workspace, state->impostor, program, view, first);
    workspace->gl->Uniform1i(gl_uniform(workspace->gl, program, "side"), state->side);
    impostor_draw(workspace, state->impostor,
                  program == state->hulls ? ATLAS_HULL : state->far_corners, count);
}

static void draw_list(struct workspace *workspace, const void *own, const struct view *view,
                      const struct cull_list *list)
{
    const struct state *state = own;
    size_t near =
        state->hulls ? impostor_near_count(state->impostor, view, list, IMPOSTOR_HULL_PX, 1) : 0;
    size_t far = list->count - near;
    if (state->impostor->alpha == ATLAS_BLEND) {
        draw_trees(workspace, state, view, state->far_program, 0, far);
        draw_trees(workspace, state, view, state->hulls, far, near);
    } else {
        draw_trees(workspace, state, view, state->hulls, 0, near);
        draw_trees(workspace, state, view, state->far_program, near, far);
    }
}

static enum status draw(struct workspace *workspace, void *own, const struct view *view,
                        struct target *target)
{
    struct state *state = own;
    return impostor_picture(workspace, state->impostor, view, target, draw_list, state,
                            "billboards");
}

extern const struct method billboards_method;
const struct method billboards_method = {
    .abi = METHOD_ABI,
    .name = "billboards",
    .summary = "one view-facing quad a tree, from pictures of it from many sides",
    .source =
        "Rohlf and Helman, IRIS Performer, SIGGRAPH 1994, doi:10.1145/192161.192262; Castano, "
        "Computing Alpha Mipmaps, 2010; Cigolle et al., JCGT 3(2), 2014",
    .traits = EFFECT_TWO_SIDED | EFFECT_AMBIENT | EFFECT_SUN_SHADOWS | EFFECT_FOG | TRAIT_MASK,
    .options = table,
    .options_size = sizeof(struct options),
    .effects = effects,
    .prepare = prepare,
    .draw = draw,
};
