/* polygons: every triangle, instanced and culled; an error-controlled level of detail far away
 * (bake/triangles.h). */
#include "bake/backdrop.h"
#include "bake/triangles.h"

struct options {
    int samples;
    float error_px;
    bool smooth, contrast, sift;
};

/* clang-format off */
static const struct option option_table[] = {
    OPTION_WORD(struct options, samples, 0, "1|4|16",
        "samples a pixel: 4 are multisampled, 16 too where the driver has them, else 4 in 2 x 2 texels"),
    OPTION(struct options, error_px, 1, 0.1, 64, "px",
        "how large a pruned leaf may grow, and 8 times how far bark may move, at lod=auto; "
        "twice as much at intermediate, four times at low"),
    OPTION(struct options, smooth, 1, 0, 1, "", "pruned leaves shrink away one by one instead of in steps"),
    OPTION(struct options, contrast, 1, 0, 1, "",
        "pruned leaves are drawn nearer to their mean radiance, as each stands for many"),
    OPTION(struct options, sift, 1, 0, 1, "",
        "triangles that meet no sample are found on the CPU and not drawn; only where GL is software, "
        "with plants without textures"),
    OPTION_END,
};
/* clang-format on */

struct state {
    struct backdrop *backdrop;
    struct sampling *sampling;
    struct triangles *triangles;
    struct cull *cull;
};

static const int samples_of_word[] = {1, 4, 16};

static enum status prepare(struct workspace *workspace, const struct scene *scene,
                           const void *values, void **state)
{
    static const float allowances[] = {
        [LOD_LOW] = 4, [LOD_INTERMEDIATE] = 2, [LOD_HIGH] = 0, [LOD_AUTO] = 1};
    const struct options *options = values;
    struct state *made = *state = ARENA_NEW(workspace->arena, struct state);
    struct triangles_request request = {.trees_room = scene->instances_count,
                                        .tolerance_px =
                                            options->error_px * allowances[workspace->lod],
                                        .smooth = options->smooth,
                                        .contrast = options->contrast,
                                        .sift = options->sift};
    enum status status = backdrop_prepare(workspace, scene, &made->backdrop);
    if (status == STATUS_OK)
        status = sampling_prepare(workspace, samples_of_word[options->samples], &made->sampling);
    if (status == STATUS_OK)
        status = triangles_prepare(workspace, scene, &request, &made->triangles);
    if (status == STATUS_OK)
        made->cull = cull_create(workspace->arena, scene, triangles_bounds(made->triangles));
    return status;
}

static enum status draw(struct workspace *workspace, void *own, const struct view *view,
                        struct target *target)
{
    struct state *state = own;
    struct view drawn;
    enum status status = sampling_begin(workspace, state->sampling, target, view, &drawn);
    if (status != STATUS_OK)
        return status;
    backdrop_draw(workspace, state->backdrop, &drawn);
    struct cull_list list = cull_view(state->cull, view, triangles_order(state->triangles));
    struct triangles_frame frame = {.view = view, /* error_px refers to the picture's size */
                                    .drawn = &drawn,
                                    .places = sampling_places(state->sampling),
                                    .cull = state->cull};
    triangles_draw(workspace, state->triangles, &frame, &list);
    sampling_end(workspace, state->sampling, target);
    return gl_check(workspace->gl, "polygons", workspace->error);
}

extern const struct method polygons_method;
const struct method polygons_method = {
    .abi = METHOD_ABI,
    .name = "polygons",
    .summary = "every triangle; far trees by simplified bark and stochastically pruned leaves",
    .source = "Cook, Halstead, Planck, Ryu, Stochastic simplification of aggregate detail, 2007, "
              "doi:10.1145/1276377.1276476; Garland, Heckbert, Surface simplification using "
              "quadric error metrics, 1997, doi:10.1145/258734.258849",
    .traits = EFFECT_TWO_SIDED | EFFECT_AMBIENT | EFFECT_FOG | TRAIT_STOCHASTIC,
    .options = option_table,
    .options_size = sizeof(struct options),
    .prepare = prepare,
    .draw = draw,
};
