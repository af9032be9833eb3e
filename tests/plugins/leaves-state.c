/* Leaves the scissor test on. */
#include "wrap.h"

static enum status prepare(struct workspace *workspace, const struct scene *scene,
                           const void *options, void **state)
{
    (void)options;
    return wrap_prepare(workspace, scene, state);
}

static enum status draw(struct workspace *workspace, void *state, const struct view *view,
                        struct target *target)
{
    enum status status = wrap_draw(workspace, state, view, target);
    workspace->gl->Enable(GL_SCISSOR_TEST);
    return status;
}

WRAP_METHOD(leaves_state, "leaves-state", WRAP_TRAITS);
