/* Takes 4 kB more with every picture. */
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
    arena_alloc(workspace->arena, 4096, 1);
    return wrap_draw(workspace, state, view, target);
}

WRAP_METHOD(grows, "grows", WRAP_TRAITS);
