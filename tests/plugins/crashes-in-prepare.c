/* Dies before its first picture. */
#include "wrap.h"

#include <stdlib.h>

static enum status prepare(struct workspace *workspace, const struct scene *scene,
                           const void *options, void **state)
{
    (void)options;
    if (scene)
        abort();
    return wrap_prepare(workspace, scene, state);
}

static enum status draw(struct workspace *workspace, void *state, const struct view *view,
                        struct target *target)
{
    return wrap_draw(workspace, state, view, target);
}

WRAP_METHOD(crashes_in_prepare, "crashes-in-prepare", WRAP_TRAITS);
