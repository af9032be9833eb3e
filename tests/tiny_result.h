/* Results of cells of scene tiny, as the tests of the report's tables need them. */
#ifndef TREELINE_TESTS_TINY_RESULT_H
#define TREELINE_TESTS_TINY_RESULT_H

#include "testing.h"

#include "results/run.h"

#include <string.h>

static inline struct run *tiny_run(struct arena *arena, size_t most)
{
    struct run *run = ARENA_NEW(arena, struct run);
    run->results = ARENA_ARRAY(arena, struct result, most);
    return run;
}

/* Adds a repetition of a cell whose one frame took 10 ms; a method that is not built in is
 * foreign. */
static inline struct result *tiny_result(struct arena *arena, struct run *run, const char *method,
                                         const char *options, size_t trees, int round)
{
    struct result *result = &run->results[run->results_count++];
    struct cell cell = {.scene = "tiny",
                        .method_name = method,
                        .options = options,
                        .trees = trees,
                        .lod = LOD_AUTO,
                        .width_px = 96,
                        .height_px = 72,
                        .format = TARGET_RGBA16F,
                        .seed = 1};
    for (const struct method *const *each = methods_builtin; *each; each++)
        if (strcmp((*each)->name, method) == 0)
            cell.method = *each;
    cell.name = arena_printf(arena, "tiny/%s:%s/trees=%zu", method, options, trees);
    result_init(result, &cell, round);
    result->instances = trees;
    result->frames_count = 1;
    result->frame_seconds = ARENA_ARRAY(arena, double, 1);
    result->frame_seconds[0] = 0.01;
    return result;
}

/* The same of four trees and a built-in method, whose frame took so long and which drew what its
 * options draw of all effects, as the scene asks. */
static inline struct result *tiny_drawn(struct arena *arena, struct run *run, const char *method,
                                        const char *options, int round, double seconds)
{
    struct result *result = tiny_result(arena, run, method, options, 4, round);
    const struct option *table = result->cell.method->options;
    void *values = arena_alloc(arena, 1, result->cell.method->options_size);
    options_default(table, values);
    assert_int_equal(options_parse(table, options, values, NULL), STATUS_OK);
    result->effects = method_effects(result->cell.method, values, EFFECTS_ALL);
    result->scene_effects = EFFECTS_ALL;
    result->frame_seconds[0] = seconds;
    return result;
}

#endif
