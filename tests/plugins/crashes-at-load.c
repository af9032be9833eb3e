/* Dies when it is loaded. */
#include "wrap.h"

#include <stdlib.h>

__attribute__((constructor)) static void die(void)
{
    abort();
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

WRAP_METHOD(crashes_at_load, "crashes-at-load", WRAP_TRAITS);
