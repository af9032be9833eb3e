/* Draws for ever. */
#include "wrap.h"

#include <unistd.h>

static enum status prepare(struct workspace *workspace, const struct scene *scene,
                           const void *options, void **state)
{
    (void)options;
    return wrap_prepare(workspace, scene, state);
}

static enum status draw(struct workspace *workspace, void *state, const struct view *view,
                        struct target *target)
{
    for (volatile bool on = true; on;)
        usleep(1000);
    return wrap_draw(workspace, state, view, target);
}

WRAP_METHOD(hangs, "hangs", WRAP_TRAITS);
