/* Ends the process when it is loaded, as if all were well. */
#include "wrap.h"

#include <unistd.h>

__attribute__((constructor)) static void leave(void)
{
    _exit(0);
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

WRAP_METHOD(leaves_at_load, "leaves-at-load", WRAP_TRAITS);
