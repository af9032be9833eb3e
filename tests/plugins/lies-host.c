/* Takes 256 MB past the arena. */
#include "wrap.h"

#include <stdlib.h>

static enum status prepare(struct workspace *workspace, const struct scene *scene,
                           const void *options, void **state)
{
    (void)options;
    enum { BYTES = 256 << 20, PAGE = 4096 };
    volatile char *memory = malloc(BYTES);
    for (size_t i = 0; memory && i < BYTES; i += PAGE)
        memory[i] = 1;
    return wrap_prepare(workspace, scene, state);
}

static enum status draw(struct workspace *workspace, void *state, const struct view *view,
                        struct target *target)
{
    return wrap_draw(workspace, state, view, target);
}

WRAP_METHOD(lies_host, "lies-host", WRAP_TRAITS);
