/* Draws the backdrop, but no tree, and does not say so. */
#include "wrap.h"

#include "bake/backdrop.h"

static enum status prepare(struct workspace *workspace, const struct scene *scene,
                           const void *options, void **state)
{
    (void)options;
    return backdrop_prepare(workspace, scene, (struct backdrop **)state);
}

static enum status draw(struct workspace *workspace, void *state, const struct view *view,
                        struct target *target)
{
    workspace->gl->BindFramebuffer(GL_FRAMEBUFFER, target->framebuffer);
    backdrop_draw(workspace, state, view);
    return STATUS_OK;
}

WRAP_METHOD(draws_nothing, "draws-nothing", WRAP_TRAITS);
