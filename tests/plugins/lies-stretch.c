/* Draws trees of their plants' height, whatever their stretch. */
#include "wrap.h"

static enum status prepare(struct workspace *workspace, const struct scene *scene,
                           const void *options, void **state)
{
    struct scene *plain = ARENA_NEW(workspace->arena, struct scene);
    (void)options;
    *plain = *scene;
    plain->instances = ARENA_ARRAY(workspace->arena, struct instance, scene->instances_count);
    for (size_t k = 0; k < scene->instances_count; k++) {
        plain->instances[k] = scene->instances[k];
        plain->instances[k].stretch = 1;
    }
    return wrap_prepare(workspace, plain, state);
}

static enum status draw(struct workspace *workspace, void *state, const struct view *view,
                        struct target *target)
{
    return wrap_draw(workspace, state, view, target);
}

WRAP_METHOD_SUPPORTED(lies_stretch, "lies-stretch", WRAP_TRAITS, NULL);
