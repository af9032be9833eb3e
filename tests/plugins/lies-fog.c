/* Draws fog that it does not claim. */
#include "wrap.h"

static enum status prepare(struct workspace *workspace, const struct scene *scene,
                           const void *options, void **state)
{
    (void)options;
    workspace->effects |= scene->effects & EFFECT_FOG;
    return wrap_prepare(workspace, scene, state);
}

static enum status draw(struct workspace *workspace, void *state, const struct view *view,
                        struct target *target)
{
    return wrap_draw(workspace, state, view, target);
}

WRAP_METHOD(lies_fog, "lies-fog", EFFECT_TWO_SIDED | EFFECT_AMBIENT);
