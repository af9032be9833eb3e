/* Draws another picture than before, without being asked to. */
#include "wrap.h"

#include <time.h>

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
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    const float color[4] = {(float)(now.tv_nsec % 1000003) * 1e-6f, 0, 0, 0};
    workspace->gl->Enable(GL_SCISSOR_TEST);
    workspace->gl->Scissor(0, 0, 1, 1);
    workspace->gl->ClearNamedFramebufferfv(target->framebuffer, GL_COLOR, 0, color);
    workspace->gl->Disable(GL_SCISSOR_TEST);
    return status;
}

WRAP_METHOD(never_the_same, "never-the-same", WRAP_TRAITS);
