/* Light that is baked into slices: for which turns and stretches of trees. */
#include "bake/stack_bake.h"

#include <math.h>
#include <string.h>

static size_t turns_of(const struct stack *stack)
{
    return (size_t)stack->request.turns;
}

static size_t tall_step(const struct instance *instance)
{
    enum { MIDDLE = STACK_TALLS / 2 };
    long step = lroundf(4 * log2f(instance->stretch)) + MIDDLE;
    return (size_t)(step < 0 ? 0 : step >= STACK_TALLS ? STACK_TALLS - 1 : step);
}

/* The mean octave of the trees of each step. */
static void stretches_find(const struct stack *stack)
{
    const struct scene *scene = stack->scene;
    struct arena *scratch = arena_create(0);
    size_t count = scene->species_count * STACK_TALLS;
    double *sums = ARENA_ARRAY(scratch, double, count);
    size_t *trees = ARENA_ARRAY(scratch, size_t, count);
    for (size_t i = 0; i < scene->instances_count; i++) {
        const struct instance *tree = &scene->instances[i];
        size_t at = tree->species * STACK_TALLS + tall_step(tree);
        sums[at] += log2((double)tree->stretch);
        trees[at]++;
    }
    for (size_t at = 0; at < count; at++)
        stack->stretches[at] = trees[at] ? (float)exp2(sums[at] / (double)trees[at]) : 0;
    arena_destroy(scratch);
}

void stack_steps(struct workspace *workspace, struct stack *stack)
{
    size_t count = stack->scene->species_count * STACK_TALLS;
    bool lit = stack->request.turns > 0, tall = lit && scene_is_stretched(stack->scene);
    stack->steps_count = lit ? turns_of(stack) : 1;
    if (!tall)
        return;
    stack->steps_count *= STACK_TALLS;
    stack->stretches = ARENA_ARRAY(workspace->arena, float, count);
    stretches_find(stack);
}

size_t stack_plant_index(const struct stack *stack, const struct instance *instance)
{
    size_t turns = turns_of(stack);
    if (turns == 0)
        return instance->species;
    double share = instance->rotation_rad / (2 * M_PI);
    size_t step = (size_t)lround((share - floor(share)) * (double)turns) % turns;
    step += stack->stretches ? tall_step(instance) * turns : 0;
    return instance->species * stack->steps_count + step;
}

const struct stack_plant *stack_plant_of(const struct stack *stack, const struct instance *instance)
{
    return &stack->plants[stack_plant_index(stack, instance)];
}

void stack_lights(const struct workspace *workspace, const struct stack *stack, size_t index,
                  struct slices_light lights[STACK_LIGHTS])
{
    const struct scene *scene = stack->scene;
    size_t step = index % stack->steps_count, species = index / stack->steps_count;
    double angle = 2 * M_PI * (double)(step % turns_of(stack)) / (double)turns_of(stack);
    float c = (float)cos(angle), s = (float)sin(angle);
    const float *sun = stack->sun_direction;
    for (int light = 0; light < STACK_LIGHTS; light++) {
        bool behind = light % 2, shaded = light / 2;
        lights[light] = (struct slices_light){
            .sun_direction = {sun[0] * c - sun[2] * s, sun[1], sun[0] * s + sun[2] * c},
            .two_sided = workspace->effects & EFFECT_TWO_SIDED,
            .from_behind = behind};
        if (stack->stretches)
            lights[light].stretch =
                stack->stretches[species * STACK_TALLS + step / turns_of(stack)];
        if (!shaded)
            memcpy(lights[light].sun_radiance, scene->sun.radiance, sizeof scene->sun.radiance);
        if (workspace->effects & EFFECT_AMBIENT)
            memcpy(lights[light].ambient, scene->ambient, sizeof scene->ambient);
    }
}
