/* Declines every scene, with a reason. */
#include "wrap.h"

static enum status supported(const struct scene *scene, const char **reason)
{
    *reason = "trees are too green";
    return scene ? STATUS_UNSUPPORTED : STATUS_OK;
}

static enum status prepare(struct workspace *workspace, const struct scene *scene,
                           const void *options, void **state)
{
    (void)options;
    return wrap_prepare(workspace, scene, state);
}

static enum status draw(struct workspace *workspace, void *state, const struct view *view,
                        struct target *target)
{
    return wrap_draw(workspace, state, view, target);
}

extern const struct method refuses_method;
const struct method refuses_method = {
    .abi = METHOD_ABI,
    .name = "refuses",
    .summary = "cross quads that misbehave",
    .source = "this project",
    .traits = WRAP_TRAITS,
    .supported = supported,
    .prepare = prepare,
    .draw = draw,
};
