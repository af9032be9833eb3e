/* A method that paints one colour and says that it did a lot. */
#include "method/method.h"

static enum status prepare(struct workspace *workspace, const struct scene *scene,
                           const void *options, void **state)
{
    (void)workspace, (void)scene, (void)options;
    *state = NULL;
    return STATUS_OK;
}

static enum status draw(struct workspace *workspace, void *state, const struct view *view,
                        struct target *target)
{
    (void)state, (void)view;
    uint64_t pixels = (uint64_t)target->width_px * (uint64_t)target->height_px;
    for (size_t i = 0; i < 4 * pixels; i++)
        target->pixels[i] = 0.5f;
    workspace->tally.rays += pixels;
    workspace->tally.lookups += 3 * pixels;
    workspace->tally.bytes += 1000;
    return STATUS_OK;
}

extern const struct method counts_method;
const struct method counts_method = {
    .abi = METHOD_ABI,
    .name = "counts",
    .summary = "one colour",
    .source = "this project",
    .traits = TRAIT_CPU,
    .prepare = prepare,
    .draw = draw,
};
