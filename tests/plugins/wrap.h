/* Cross quads under another name: what a plugin does wrong is all that is in its file. */
#ifndef TREELINE_TESTS_WRAP_H
#define TREELINE_TESTS_WRAP_H

#include "method/method.h"

extern const struct method cross_quads_method; /* treeline's own */

static inline enum status wrap_prepare(struct workspace *workspace, const struct scene *scene,
                                       void **state)
{
    void *options = arena_alloc(workspace->arena, 1, cross_quads_method.options_size);
    options_default(cross_quads_method.options, options);
    return cross_quads_method.prepare(workspace, scene, options, state);
}

static inline enum status wrap_draw(struct workspace *workspace, void *state,
                                    const struct view *view, struct target *target)
{
    return cross_quads_method.draw(workspace, state, view, target);
}

#define WRAP_TRAITS (EFFECT_TWO_SIDED | EFFECT_AMBIENT | EFFECT_FOG)
/* NAME_method of this file; its functions are named by the slots. */
#define WRAP_METHOD_SUPPORTED(id, given_name, given_traits, given_supported)                       \
    extern const struct method id##_method;                                                        \
    const struct method id##_method = {                                                            \
        .abi = METHOD_ABI,                                                                         \
        .name = given_name,                                                                        \
        .summary = "cross quads that misbehave",                                                   \
        .source = "this project",                                                                  \
        .traits = given_traits,                                                                    \
        .supported = given_supported,                                                              \
        .prepare = prepare,                                                                        \
        .draw = draw,                                                                              \
    }
#define WRAP_METHOD(id, given_name, given_traits)                                                  \
    WRAP_METHOD_SUPPORTED(id, given_name, given_traits, method_needs_no_stretch)

#endif
