/* Counts what it did not do, in the way that the environment's TALLY names. */
#include "wrap.h"

#include <stdlib.h>
#include <string.h>

static enum status prepare(struct workspace *workspace, const struct scene *scene,
                           const void *options, void **state)
{
    (void)options;
    return wrap_prepare(workspace, scene, state);
}

static enum status draw(struct workspace *workspace, void *state, const struct view *view,
                        struct target *target)
{
    static uint64_t draws;
    const char *way = getenv("TALLY");
    struct method_tally *tally = &workspace->tally;
    bool counted = workspace->counted;
    if (!way)
        way = "";
    if (counted && strcmp(way, "impossible") == 0)
        tally->samples += UINT64_C(1000000000000000000);
    if (counted && strcmp(way, "random") == 0)
        tally->lookups += 100 + ++draws;
    if (counted && strcmp(way, "rays") == 0)
        tally->rays += 100;
    if (counted && strcmp(way, "flat") == 0)
        tally->samples += 1000;
    if (strcmp(way, "timed") == 0)
        tally->lookups += (uint64_t)target->width_px * (uint64_t)target->height_px;
    workspace->counted = counted && !*way;
    enum status status = wrap_draw(workspace, state, view, target);
    workspace->counted = counted;
    return status;
}

WRAP_METHOD(lies_tally, "lies-tally", WRAP_TRAITS);
