/* Draws NaN. */
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
    const float color[4] = {NAN, 0, 0, 0};
    enum status status = wrap_draw(workspace, state, view, target);
    workspace->gl->ClearNamedFramebufferfv(target->framebuffer, GL_COLOR, 0, color);
    return status;
}

WRAP_METHOD(draws_nan, "draws-nan", WRAP_TRAITS);
