/* rays: a number of rays a pixel at the plants' own geometry. What supersampling costs and errs, so
 * that a representation can be held against it at equal time; with ever more rays it is the
 * reference, whose tracer it uses. */
#include "bake/rays.h"

struct options {
    int samples;
    bool sky;
};

/* clang-format off */
static const struct option table[] = {
    OPTION(struct options, samples, 4, 4, 4096, "", "rays a pixel; the next power of two"),
    OPTION(struct options, sky, 1, 0, 1, "", "a ray into the sky from every hit, where the scene asks for it"),
    OPTION_END,
};
/* clang-format on */

struct state {
    struct options options;
    struct rays *rays;
};

static unsigned effects(const void *values)
{
    const struct options *options = values;
    return EFFECTS_ALL & ~(unsigned)(options->sky ? 0 : EFFECT_SKY_OCCLUSION);
}

static enum status prepare(struct workspace *workspace, const struct scene *scene,
                           const void *values, void **state)
{
    struct state *made = *state = ARENA_NEW(workspace->arena, struct state);
    made->options = *(const struct options *)values;
    return rays_prepare(workspace, scene, &made->rays);
}

static enum status draw(struct workspace *workspace, void *state, const struct view *view,
                        struct target *target)
{
    const struct state *own = state;
    int samples = 4;
    while (samples < own->options.samples)
        samples *= 2;
    return rays_draw(workspace, own->rays, view, samples, target);
}

extern const struct method rays_method;
const struct method rays_method = {
    .abi = METHOD_ABI,
    .name = "rays",
    .summary = "a few rays a pixel at the plants' own geometry, on the CPU: supersampling",
    .source = "Whitted 1980, An improved illumination model for shaded display, "
              "doi:10.1145/358876.358882; Cook, Porter and Carpenter 1984, Distributed ray "
              "tracing, doi:10.1145/800031.808590",
    .traits = TRAIT_CPU | TRAIT_STOCHASTIC | EFFECTS_ALL,
    .options = table,
    .options_size = sizeof(struct options),
    .effects = effects,
    .prepare = prepare,
    .draw = draw,
};
