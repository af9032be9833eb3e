/* shadow-volume: every triangle, lit by the sun where it is in no shadow volume. Three passes as in
 * Abderrahmani 2018, 5.1: all surfaces in the sky's light, volumes into the stencil buffer, all
 * surfaces again in the sun's light where none is counted. */
#include "bake/backdrop.h"
#include "bake/sampling.h"
#include "bake/shadow_trees.h"
#include "bake/shadow_volume.h"

struct options {
    int samples, test, volumes;
};

/* clang-format off */
static const struct option option_table[] = {
    OPTION_WORD(struct options, samples, 1, "1|4|16",
        "samples a pixel: 4 are multisampled, 16 too where the driver has them, else 4 in 2 x 2 texels"),
    OPTION_WORD(struct options, test, 0, "auto|z-fail|z-pass",
        "what is counted: boundaries behind a sample, or those before it, which is wrong where the eye is in a shadow; "
        "auto: z-pass for the trees that cannot shade the eye"),
    OPTION_WORD(struct options, volumes, 0, "silhouette|triangles",
        "one volume behind what is connected, or one behind each triangle"),
    OPTION_END,
};
/* clang-format on */

struct state {
    struct backdrop *backdrop;
    struct sampling *sampling;
    struct shadow_trees *trees;
    struct shadow_volume *volume; /* NULL: shadows are not wanted */
};

static const int samples_of_word[] = {1, 4, 16};

static enum status prepare(struct workspace *workspace, const struct scene *scene,
                           const void *values, void **state)
{
    const struct options *options = values;
    struct state *made = *state = ARENA_NEW(workspace->arena, struct state);
    struct shadow_volume_request request = {.test = (enum shadow_test)options->test,
                                            .triangles = options->volumes};
    enum status status = backdrop_prepare(workspace, scene, &made->backdrop);
    if (status == STATUS_OK)
        status = sampling_prepare(workspace, samples_of_word[options->samples], &made->sampling);
    if (status == STATUS_OK)
        status = shadow_trees_prepare(workspace, scene, &made->trees);
    if (status == STATUS_OK && workspace->effects & EFFECT_SUN_SHADOWS) {
        sampling_stencil(made->sampling);
        status = shadow_volume_prepare(workspace, scene, &request, &made->volume);
    }
    return status;
}

static void draw_surfaces(struct workspace *workspace, struct state *state, const struct view *view)
{
    backdrop_draw(workspace, state->backdrop, view);
    shadow_trees_draw(workspace, state->trees, view);
}

static enum status draw(struct workspace *workspace, void *own, const struct view *view,
                        struct target *target)
{
    struct state *state = own;
    struct view lit;
    enum status status = sampling_begin(workspace, state->sampling, target, view, &lit);
    if (status != STATUS_OK)
        return status;
    if (state->volume) {
        shadow_volume_extrude(workspace, state->volume, view->sun_direction);
        shadow_volume_view(&lit);
        struct view dark = lit; /* N.L is 0 */
        dark.sun_direction[0] = dark.sun_direction[1] = dark.sun_direction[2] = 0;
        draw_surfaces(workspace, state, &dark);
        shadow_volume_count(workspace, state->volume, &lit);
    }
    draw_surfaces(workspace, state, &lit);
    shadow_volume_end(workspace);
    sampling_end(workspace, state->sampling, target);
    return gl_check(workspace->gl, "shadow-volume", workspace->error);
}

extern const struct method shadow_volume_method;
const struct method shadow_volume_method = {
    .abi = METHOD_ABI,
    .name = "shadow-volume",
    .summary = "every triangle, in the sun where no shadow volume is: stencil, silhouettes, z-fail",
    .source = "Crow, Shadow algorithms for computer graphics, 1977, doi:10.1145/965141.563901; "
              "Everitt, Kilgard, Practical and robust stenciled shadow volumes for "
              "hardware-accelerated rendering, 2002, arXiv:cs/0301002; Abderrahmani 2018, 5.1",
    .traits = EFFECT_TWO_SIDED | EFFECT_AMBIENT | EFFECT_SUN_SHADOWS | EFFECT_FOG,
    .options = option_table,
    .options_size = sizeof(struct options),
    .supported = shadow_trees_supported,
    .prepare = prepare,
    .draw = draw,
};
