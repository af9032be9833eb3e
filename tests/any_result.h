/* Results of random values, and a folder for a run of them. */
#ifndef TREELINE_TESTS_ANY_RESULT_H
#define TREELINE_TESTS_ANY_RESULT_H

#include "testing.h"

#include "base/random.h"
#include "results/run.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static inline const char *folder_new(struct arena *arena)
{
    char *folder = arena_strdup(arena, "/tmp/treeline-results-XXXXXX");
    assert_non_null(mkdtemp(folder));
    return folder;
}

static inline void folder_remove(struct arena *arena, const char *folder)
{
    unlink(arena_printf(arena, "%s/cells.jsonl", folder));
    unlink(arena_printf(arena, "%s/.lock", folder));
    rmdir(folder);
}

/* Any double: NaN ("not measured") at times, else of any magnitude. */
static inline double any_double(struct random *random)
{
    if (random_below(random, 5) == 0)
        return NAN;
    return ldexp(random_double(random) - 0.5, (int)random_below(random, 400) - 200);
}

static inline void any_metrics(struct random *random, struct metrics *metrics)
{
#define ANY(field, word, better, domain, doc) metrics->field = any_double(random);
    METRIC_LIST(ANY)
#undef ANY
}

static inline void any_view(struct random *random, struct result_view *view)
{
    view->time = random_double(random);
    view->distance_m = any_double(random);
    view->elevation_deg = any_double(random);
    view->azimuth_deg = any_double(random);
    view->picture_hash = ((uint64_t)random_u32(random) << 32) | random_u32(random);
    view->picture = random_below(random, 2) ? "pictures/a b-v0.frame" : NULL;
    view->same_key = UINT64_MAX - random_u32(random);
    view->full_key = random_u32(random);
    view->compared = random_below(random, 2);
    if (!view->compared)
        return;
    any_metrics(random, &view->same.value);
    any_metrics(random, &view->same.raw);
    any_metrics(random, &view->same.floor);
    any_metrics(random, &view->full.value);
    any_metrics(random, &view->full.raw);
    any_metrics(random, &view->full.floor);
    view->masked = random_below(random, 2);
#define ANY(field, word, better, unit, doc) view->mask.field = any_double(random);
    MASK_LIST(ANY)
#undef ANY
    view->same_standard_error = random_float(random);
    view->full_standard_error = random_float(random);
}

static inline void any_result(struct arena *arena, struct random *random, struct result *result)
{
    static const enum status statuses[] = {STATUS_OK, STATUS_TIMEOUT, STATUS_CRASH, STATUS_MEMORY};
    struct cell cell = {.name = arena_printf(arena, "tiny/null/trees=%u", random_u32(random)),
                        .scene = "tiny",
                        .method_name = "null",
                        .options = "a=1,b=x",
                        .trees = random_below(random, 1000000),
                        .lod = (enum lod)random_below(random, 4),
                        .width_px = 1 + (int)random_below(random, 4000),
                        .height_px = 1 + (int)random_below(random, 4000),
                        .format = (enum target_format)random_below(random, 3),
                        .seed = UINT64_MAX - random_u32(random)};
    result_init(result, &cell, (int)random_below(random, 100));
    result->status = statuses[random_below(random, 4)];
    result->message = "\"quoted\" \\ back, tab\t, ümläut";
    result->signal = (int)random_below(random, 32);
    result->started = "2026-01-02T03:04:05.678Z";
    result->seconds = any_double(random);
    result->effects = random_below(random, EFFECTS_ALL + 1);
    result->scene_effects = random_below(random, EFFECTS_ALL + 1);
    result->instances = random_below(random, 1000000);
    result->scene_hash = ((uint64_t)random_u32(random) << 32) | random_u32(random);
    result->backend = random_below(random, 2) ? "osmesa" : NULL;
    result->threads = (int)random_below(random, 64);
#define ANY(field, unit, better, doc) result->field = any_double(random);
    RESULT_COLUMNS(ANY)
#undef ANY
    result->frames_count = random_below(random, 50);
    result->frame_seconds = ARENA_ARRAY(arena, double, result->frames_count);
    for (size_t i = 0; i < result->frames_count; i++)
        result->frame_seconds[i] = random_double(random);
    result->views_count = random_below(random, 4);
    result->views = ARENA_ARRAY(arena, struct result_view, result->views_count);
    for (size_t i = 0; i < result->views_count; i++)
        any_view(random, &result->views[i]);
    result->has_flicker = random_below(random, 2);
    if (result->has_flicker)
        result->flicker = (struct flicker){any_double(random), any_double(random), 0.5, 3};
}

static inline void same_double(double a, double b, const char *what)
{
    if (!(a == b || (isnan(a) && isnan(b))))
        fail_msg("%s: %.17g is not %.17g", what, a, b);
}

static inline void same_text(const char *a, const char *b)
{
    assert_int_equal(a == NULL, b == NULL);
    if (a)
        assert_string_equal(a, b);
}

static inline void same_metrics(const struct metrics *a, const struct metrics *b)
{
#define SAME(field, word, better, domain, doc) same_double(a->field, b->field, word);
    METRIC_LIST(SAME)
#undef SAME
}

static inline void same_view(const struct result_view *a, const struct result_view *b)
{
    same_double(a->time, b->time, "time");
    same_double(a->distance_m, b->distance_m, "distance_m");
    same_double(a->elevation_deg, b->elevation_deg, "elevation_deg");
    same_double(a->azimuth_deg, b->azimuth_deg, "azimuth_deg");
    assert_true(a->picture_hash == b->picture_hash && a->same_key == b->same_key);
    assert_true(a->full_key == b->full_key && a->compared == b->compared);
    same_text(a->picture, b->picture);
    assert_true(a->masked == b->masked);
#define SAME(field, word, better, unit, doc)                                                       \
    if (a->masked)                                                                                 \
        same_double(a->mask.field, b->mask.field, word);
    MASK_LIST(SAME)
#undef SAME
    if (!a->compared)
        return;
    same_metrics(&a->same.value, &b->same.value);
    same_metrics(&a->same.raw, &b->same.raw);
    same_metrics(&a->same.floor, &b->same.floor);
    same_metrics(&a->full.value, &b->full.value);
    same_metrics(&a->full.raw, &b->full.raw);
    same_metrics(&a->full.floor, &b->full.floor);
    assert_true(a->same_standard_error == b->same_standard_error);
    assert_true(a->full_standard_error == b->full_standard_error);
}

static inline void same_result(const struct result *a, const struct result *b)
{
    same_text(a->cell.name, b->cell.name);
    same_text(a->cell.scene, b->cell.scene);
    same_text(a->cell.method_name, b->cell.method_name);
    same_text(a->cell.options, b->cell.options);
    assert_true(a->cell.trees == b->cell.trees && a->cell.seed == b->cell.seed);
    assert_true(a->cell.lod == b->cell.lod && a->cell.format == b->cell.format);
    assert_true(a->cell.width_px == b->cell.width_px && a->cell.height_px == b->cell.height_px);
    assert_true(a->repetition == b->repetition && a->status == b->status);
    assert_true(a->signal == b->signal && a->threads == b->threads);
    same_text(a->message, b->message);
    same_text(a->started, b->started);
    same_text(a->backend, b->backend);
    same_double(a->seconds, b->seconds, "seconds");
    assert_true(a->effects == b->effects && a->scene_effects == b->scene_effects);
    assert_true(a->instances == b->instances && a->scene_hash == b->scene_hash);
#define SAME(field, unit, better, doc) same_double(a->field, b->field, #field);
    RESULT_COLUMNS(SAME)
#undef SAME
    assert_int_equal(a->frames_count, b->frames_count);
    for (size_t i = 0; i < a->frames_count; i++)
        same_double(a->frame_seconds[i], b->frame_seconds[i], "frame_seconds");
    assert_int_equal(a->views_count, b->views_count);
    for (size_t i = 0; i < a->views_count; i++)
        same_view(&a->views[i], &b->views[i]);
    assert_true(a->has_flicker == b->has_flicker);
    same_double(a->flicker.mean, b->flicker.mean, "flicker.mean");
    same_double(a->flicker.peak, b->flicker.peak, "flicker.peak");
    assert_true(a->flicker.peak_frame == b->flicker.peak_frame);
}

static inline struct provenance somewhere(void)
{
    return (struct provenance){.host = "h",
                               .cpu = "c",
                               .kernel = "k",
                               .os = "o",
                               .compiler = "gcc",
                               .flags = "-O3",
                               .revision = "r",
                               .libraries = "l",
                               .plan = "p",
                               .command = "treeline run 'p'",
                               .settings = "--timeout 3",
                               .started = "now",
                               .cores = 2,
                               .memory_bytes = 1e10,
                               .seed = 7,
                               .plan_hash = UINT64_MAX,
                               .rounds = 3,
                               .frame_seconds = 0.5,
                               .reference_error = 0.01};
}

#endif
