/* What tests of methods begin with that draw a plant by pictures or slices of it: the lopsided tree
 * and the method. */
#ifndef TREELINE_TESTS_TESTING_STACKS_H
#define TREELINE_TESTS_TESTING_STACKS_H

#include "testing_tree.h"

static const unsigned lit = EFFECT_TWO_SIDED | EFFECT_AMBIENT;

struct fixture {
    struct arena *arena;
    struct mesh *mesh;
    struct plant *plant;
    const struct method *method;
};

static inline int fixture_open(void **state, const char *method)
{
    struct fixture *fixture = calloc(1, sizeof *fixture);
    fixture->arena = arena_create(0);
    fixture->mesh = tree_mesh(fixture->arena, 400);
    fixture->plant = plant_from_mesh(fixture->arena, "lopsided", fixture->mesh);
    fixture->method = tree_method(method);
    *state = fixture;
    return 0;
}

static inline int close_fixture(void **state)
{
    struct fixture *fixture = *state;
    arena_destroy(fixture->arena);
    free(fixture);
    return 0;
}

/* From pictures of the plant with texels that are half of a pixel at 9 m across: more would only
 * take longer. */
static inline struct frame *fixture_draw(struct fixture *f, const char *options,
                                         const struct scene *scene, unsigned effects,
                                         const struct view *view, struct gl_counters *counters)
{
    const char *more = strstr(options, "resolution") ? "" : ",resolution=128";
    return tree_draw(f->arena, f->method,
                     *options ? arena_printf(f->arena, "%s%s", options, more) : more + 1, scene,
                     effects, view, counters);
}

#endif
