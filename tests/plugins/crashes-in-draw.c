/* Dies in its first picture. */
#include "wrap.h"

#include <stdlib.h>

static enum status prepare(struct workspace *workspace, const struct scene *scene,
                           const void *options, void **state)
{
    (void)options;
    return wrap_prepare(workspace, scene, state);
}

static enum status draw(struct workspace *workspace, void *state, const struct view *view,
                        struct target *target)
{
    if (view)
        abort();
    return wrap_draw(workspace, state, view, target);
}

WRAP_METHOD(crashes_in_draw, "crashes-in-draw", WRAP_TRAITS);
