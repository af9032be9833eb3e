/* null: sky and terrain, no tree. The floor of every comparison. */
#include "bake/backdrop.h"
#include "method/method.h"

/* What prepare leaves for draw; in the workspace's arena, so nothing is freed. */
struct state {
    struct backdrop *backdrop;
};

/* Everything that does not depend on the view: baking, uploads, shaders. Timed as build_seconds. */
static enum status prepare(struct workspace *workspace, const struct scene *scene,
                           const void *options, void **state)
{
    (void)options; /* a method with options casts this to its own struct */
    struct state *made = *state = ARENA_NEW(workspace->arena, struct state);
    return backdrop_prepare(workspace, scene, &made->backdrop);
}

/* One picture. The harness finishes the GPU's work and stops the clock. */
static enum status draw(struct workspace *workspace, void *state, const struct view *view,
                        struct target *target)
{
    struct state *own = state;
    workspace->gl->BindFramebuffer(GL_FRAMEBUFFER, target->framebuffer);
    backdrop_draw(workspace, own->backdrop, view);
    /* A method that draws trees does so here, alpha 1 where a plant is seen. */
    return gl_check(workspace->gl, "null", workspace->error);
}

extern const struct method null_method;
const struct method null_method = {
    .abi = METHOD_ABI,
    .name = "null",
    .summary = "sky and terrain without trees: what the harness and the backdrop cost",
    .source = "this project",
    .traits = EFFECT_TWO_SIDED | EFFECT_AMBIENT | EFFECT_FOG | TRAIT_NO_TREES,
    .prepare = prepare,
    .draw = draw,
};
