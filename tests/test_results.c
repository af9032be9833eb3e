/* Results on disk: round trips, torn and malformed lines, versions, locks, documentation. */
#include "testing.h"

#include "base/file.h"
#include "base/random.h"
#include "results/run.h"

#include <fcntl.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

static const char *folder_new(struct arena *arena)
{
    char *folder = arena_strdup(arena, "/tmp/treeline-results-XXXXXX");
    assert_non_null(mkdtemp(folder));
    return folder;
}

static void folder_remove(struct arena *arena, const char *folder)
{
    unlink(arena_printf(arena, "%s/cells.jsonl", folder));
    unlink(arena_printf(arena, "%s/.lock", folder));
    rmdir(folder);
}

/* Any double: NaN ("not measured") at times, else of any magnitude. */
static double any_double(struct random *random)
{
    if (random_below(random, 5) == 0)
        return NAN;
    return ldexp(random_double(random) - 0.5, (int)random_below(random, 400) - 200);
}

static void any_metrics(struct random *random, struct metrics *metrics)
{
#define ANY(field, word, better, domain, doc) metrics->field = any_double(random);
    METRIC_LIST(ANY)
#undef ANY
}

static void any_view(struct random *random, struct result_view *view)
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

static void any_result(struct arena *arena, struct random *random, struct result *result)
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

static void same_double(double a, double b, const char *what)
{
    if (!(a == b || (isnan(a) && isnan(b))))
        fail_msg("%s: %.17g is not %.17g", what, a, b);
}

static void same_text(const char *a, const char *b)
{
    assert_int_equal(a == NULL, b == NULL);
    if (a)
        assert_string_equal(a, b);
}

static void same_metrics(const struct metrics *a, const struct metrics *b)
{
#define SAME(field, word, better, domain, doc) same_double(a->field, b->field, word);
    METRIC_LIST(SAME)
#undef SAME
}

static void same_view(const struct result_view *a, const struct result_view *b)
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

static void same_result(const struct result *a, const struct result *b)
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

static void test_result__a_line_reads_back_to_the_same_values(void **state)
{
    (void)state;
    struct random random = random_seed(11, 0);
    for (int i = 0; i < 300; i++) {
        struct arena *arena = arena_create(0);
        struct result result, back;
        struct error error;
        any_result(arena, &random, &result);
        char *text = result_to_json(arena, &result);
        assert_null(strchr(text, '\n'));
        assert_null(strstr(text, "nan"));
        if (result_from_json(arena, text, "line", &back, &error))
            fail_msg("%s", error.text);
        same_result(&result, &back);
        arena_destroy(arena);
    }
}

static struct provenance somewhere(void)
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

/* A run of count results in a new folder. */
static const char *run_new(struct arena *arena, size_t count, struct result *results)
{
    struct random random = random_seed(5, 1);
    struct error error = {0};
    struct provenance provenance = somewhere();
    const char *folder = folder_new(arena);
    assert_int_equal(run_open(folder, &provenance, false, &error), STATUS_OK);
    for (size_t i = 0; i < count; i++) {
        any_result(arena, &random, &results[i]);
        assert_int_equal(run_append(folder, &results[i], &error), STATUS_OK);
    }
    return folder;
}

static void test_run__reads_back_what_was_appended(void **state)
{
    (void)state;
    enum { COUNT = 20 };
    struct arena *arena = arena_create(0);
    struct result results[COUNT];
    struct error error = {0};
    struct run *run;
    const char *folder = run_new(arena, COUNT, results);
    /* By the folder and by the file. */
    const char *paths[] = {folder, arena_printf(arena, "%s/cells.jsonl", folder)};
    for (int p = 0; p < 2; p++) {
        assert_int_equal(run_read(arena, paths[p], &run, &error), STATUS_OK);
        assert_string_equal(run->folder, folder);
        assert_int_equal(run->results_count, COUNT);
        assert_int_equal(run->torn_lines, 0);
        assert_string_equal(run->provenance.command, "treeline run 'p'");
        assert_true(run->provenance.plan_hash == UINT64_MAX && run->provenance.rounds == 3);
        for (size_t i = 0; i < COUNT; i++)
            same_result(&results[i], &run->results[i]);
    }
    folder_remove(arena, folder);
    arena_destroy(arena);
}

static void test_run__cut_anywhere_loses_at_most_the_last_line(void **state)
{
    (void)state;
    enum { COUNT = 3 };
    struct arena *arena = arena_create(0);
    struct result results[COUNT], extra;
    struct error error = {0};
    struct run *run;
    char *text;
    size_t size;
    struct provenance provenance = somewhere();
    const char *folder = run_new(arena, COUNT, results);
    const char *file = arena_printf(arena, "%s/cells.jsonl", folder);
    assert_int_equal(file_read(arena, file, 0, &text, &size, &error), STATUS_OK);
    struct random random = random_seed(9, 9);
    any_result(arena, &random, &extra);
    for (size_t cut = 0; cut <= size; cut += cut + 20 < size ? 173 : 1) {
        struct arena *scratch = arena_create(0);
        size_t whole = 0;
        for (size_t i = 0; i < cut; i++)
            whole += text[i] == '\n';
        assert_int_equal(file_write(file, text, cut, &error), STATUS_OK);
        if (whole) {
            assert_int_equal(run_read(scratch, folder, &run, &error), STATUS_OK);
            assert_int_equal(run->results_count, whole - 1);
            assert_int_equal(run->torn_lines, cut && text[cut - 1] != '\n');
        }
        /* Resuming cuts the torn line, and what is appended stands on its own line. */
        assert_int_equal(run_open(folder, &provenance, true, &error), STATUS_OK);
        assert_int_equal(run_append(folder, &extra, &error), STATUS_OK);
        assert_int_equal(run_read(scratch, folder, &run, &error), STATUS_OK);
        assert_int_equal(run->results_count, whole ? whole : 1);
        assert_int_equal(run->torn_lines, 0);
        same_result(&run->results[run->results_count - 1], &extra);
        arena_destroy(scratch);
    }
    folder_remove(arena, folder);
    arena_destroy(arena);
}

static void test_run__what_is_no_run_is_refused_and_left_as_it_is(void **state)
{
    (void)state;
    static const char *const texts[] = {
        "a thesis without an end",
        "two lines\nof a thesis",
        "{\"version\":6,\"kind\":\"treeline-run\"",
        "{\"version\":6,\"kind\":\"treeline-run\"}\n{\"version\":6,\"cell\":\"cut",
    };
    struct arena *arena = arena_create(0);
    struct error error = {0};
    struct provenance provenance = somewhere();
    const char *folder = folder_new(arena);
    const char *file = arena_printf(arena, "%s/cells.jsonl", folder);
    for (size_t i = 0; i < 2 * sizeof texts / sizeof *texts; i++) {
        const char *text = texts[i / 2];
        char *after;
        size_t size;
        assert_int_equal(file_write(file, text, strlen(text), &error), STATUS_OK);
        assert_int_equal(run_open(folder, &provenance, i % 2, &error), STATUS_INVALID);
        assert_non_null(strstr(error.text, file));
        assert_int_equal(file_read(arena, file, 0, &after, &size, &error), STATUS_OK);
        assert_string_equal(after, text);
    }
    folder_remove(arena, folder);
    arena_destroy(arena);
}

static void bad_file(const char *text, const char *word, const char *other)
{
    struct arena *arena = arena_create(0);
    struct error error = {0};
    struct run *run;
    const char *folder = folder_new(arena);
    const char *file = arena_printf(arena, "%s/cells.jsonl", folder);
    assert_int_equal(file_write(file, text, strlen(text), &error), STATUS_OK);
    assert_int_equal(run_read(arena, folder, &run, &error), STATUS_INVALID);
    if (!strstr(error.text, word) || !strstr(error.text, other))
        fail_msg("'%s' lacks '%s' or '%s'", error.text, word, other);
    folder_remove(arena, folder);
    arena_destroy(arena);
}

static void test_run__a_malformed_line_is_named_by_its_number(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct random random = random_seed(3, 3);
    struct provenance provenance = somewhere();
    struct result result;
    any_result(arena, &random, &result);
    char *first = provenance_to_json(arena, &provenance), *good = result_to_json(arena, &result);
    bad_file(arena_printf(arena, "%s\n%s\nnonsense\n%s\n", first, good, good), "cells.jsonl:3",
             "not JSON");
    bad_file(arena_printf(arena, "%s\n%s\n\n%s\n", first, good, good), "cells.jsonl:3", "JSON");
    bad_file(arena_printf(arena, "%s\n{\"version\":1}\n%s\n", first, good), "cells.jsonl:2",
             "cell: is missing");
    bad_file(arena_printf(arena, "%s\n{\"version\":6}\n", first), "cells.jsonl:2",
             "version 1 to 5");
    bad_file("{\"version\":6,\"kind\":\"treeline-run\"}\n", "cells.jsonl:1", "version 1 to 5");
    bad_file("{\"version\":1}\n", "cells.jsonl:1", "treeline-run");
    bad_file("", "no whole line", "provenance");
    char *unknown = arena_printf(arena, "{\"more\":1,%s", good + 1);
    bad_file(arena_printf(arena, "%s\n%s\n", first, unknown), "cells.jsonl:2", "more");
    char *status = strstr(good, "\"status\":\"");
    status[strlen("\"status\":\"")] = 'X';
    bad_file(arena_printf(arena, "%s\n%s\n", first, good), "cells.jsonl:2", "status");
    arena_destroy(arena);
}

static void test_run__a_folder_with_a_run_is_refused_unless_resumed(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct result results[1];
    struct error error = {0};
    struct provenance provenance = somewhere();
    const char *folder = run_new(arena, 1, results);
    assert_int_equal(run_open(folder, &provenance, false, &error), STATUS_USAGE);
    assert_non_null(strstr(error.text, "--resume"));
    assert_int_equal(run_open(folder, &provenance, true, &error), STATUS_OK);
    provenance.flags = "-O0";
    assert_int_equal(run_open(folder, &provenance, true, &error), STATUS_INVALID);
    provenance = somewhere();
    provenance.cpu = "another";
    assert_int_equal(run_open(folder, &provenance, true, &error), STATUS_INVALID);
    assert_non_null(strstr(error.text, "'another'"));
    provenance = somewhere();
    provenance.frame_seconds = 0.25;
    assert_int_equal(run_open(folder, &provenance, true, &error), STATUS_INVALID);
    assert_non_null(strstr(error.text, "frame_seconds: was measured with 0.5; 0.25"));
    provenance = somewhere();
    provenance.reference_error = 0.02;
    assert_int_equal(run_open(folder, &provenance, true, &error), STATUS_INVALID);
    assert_non_null(strstr(error.text, "reference_error"));
    folder_remove(arena, folder);
    arena_destroy(arena);
}

static void test_run__the_lock_admits_one_process_and_ends_with_it(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct error error = {0};
    const char *folder = folder_new(arena);
    int ends[2], lock;
    assert_int_equal(pipe(ends), 0);
    pid_t pid = fork();
    if (!pid) {
        char byte = (char)run_lock(folder, &lock, &error);
        if (write(ends[1], &byte, 1) == 1)
            pause();
        _exit(1);
    }
    char byte = 1;
    assert_int_equal(read(ends[0], &byte, 1), 1);
    assert_int_equal(byte, STATUS_OK);
    assert_int_equal(run_lock(folder, &lock, &error), STATUS_USAGE);
    assert_non_null(strstr(error.text, "another run"));
    kill(pid, SIGKILL);
    waitpid(pid, NULL, 0);
    assert_int_equal(run_lock(folder, &lock, &error), STATUS_OK);
    run_unlock(lock);
    close(ends[0]);
    close(ends[1]);
    folder_remove(arena, folder);
    arena_destroy(arena);
}

static void test_run__a_place_that_cannot_be_written_is_an_io_error(void **state)
{
    (void)state;
    struct error error = {0};
    struct provenance provenance = somewhere();
    assert_int_equal(run_open("/proc/no/such", &provenance, false, &error), STATUS_IO);
    assert_non_null(strstr(error.text, "/proc"));
    /* A full disk: cells.jsonl leads to /dev/full. */
    struct arena *arena = arena_create(0);
    const char *folder = folder_new(arena);
    assert_int_equal(symlink("/dev/full", arena_printf(arena, "%s/cells.jsonl", folder)), 0);
    struct result result;
    struct random random = random_seed(1, 1);
    any_result(arena, &random, &result);
    assert_int_equal(run_append(folder, &result, &error), STATUS_IO);
    assert_non_null(strstr(error.text, "No space left"));
    folder_remove(arena, folder);
    arena_destroy(arena);
}

static void test_provenance__names_this_machine_and_build(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct cell cell = {.seed = 5};
    struct plan plan = {.name = "p", .cells = &cell, .cells_count = 1, .rounds = 2, .hash = 3};
    struct provenance here;
    char host[256];
    provenance_here(arena, &plan, "treeline run p", "", &here);
    assert_int_equal(gethostname(host, sizeof host), 0);
    assert_string_equal(here.host, host);
    assert_true(here.memory_bytes > 1e8 && here.cores >= 1);
    assert_string_not_equal(here.cpu, "unknown");
    assert_string_not_equal(here.os, "unknown");
    assert_non_null(strstr(here.kernel, "Linux"));
    assert_non_null(strstr(here.libraries, "embree"));
    assert_true(here.seed == 5 && here.plan_hash == 3);
    arena_destroy(arena);
}

static void test_tracing__a_line_reads_back_among_the_results(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct error error = {0};
    const char *folder = arena_printf(arena, "/tmp/treeline-tracing-%d", (int)getpid());
    struct provenance provenance = somewhere();
    struct run *run;
    assert_int_equal(run_open(folder, &provenance, false, &error), STATUS_OK);
    for (size_t i = 0; i < 5; i++) {
        const struct tracing tracing = {.scene = "oak \"hills\"",
                                        .trees = 1000 + i,
                                        .width_px = 400,
                                        .height_px = 300,
                                        .threads = 3,
                                        .effects = EFFECT_FOG | EFFECT_SUN_SHADOWS,
                                        .key = UINT64_MAX - i,
                                        .time = 0.25,
                                        .build_seconds = 1.0 / 3,
                                        .trace_seconds = 2.0 / 3,
                                        .primary_rays = 7e6,
                                        .shadow_rays = 8e6,
                                        .occlusion_rays = NAN,
                                        .standard_error = 0.004,
                                        .from_cache = i % 2};
        if (run_append_tracing(folder, &tracing, &error))
            fail_msg("%s", error.text);
    }
    if (run_read(arena, folder, &run, &error))
        fail_msg("%s", error.text);
    assert_int_equal(run->results_count, 0);
    assert_int_equal(run->tracings_count, 5);
    for (size_t i = 0; i < 5; i++) {
        const struct tracing *back = &run->tracings[i];
        assert_string_equal(back->scene, "oak \"hills\"");
        assert_true(back->trees == 1000 + i && back->key == UINT64_MAX - i);
        assert_true(back->width_px == 400 && back->height_px == 300 && back->threads == 3);
        assert_int_equal(back->effects, EFFECT_FOG | EFFECT_SUN_SHADOWS);
        assert_true(back->time == 0.25 && back->standard_error == 0.004);
        assert_true(back->build_seconds == 1.0 / 3 && back->trace_seconds == 2.0 / 3);
        assert_true(back->primary_rays == 7e6 && back->shadow_rays == 8e6);
        assert_true(isnan(back->occlusion_rays) && back->from_cache == (i % 2 == 1));
    }
    folder_remove(arena, folder);
    arena_destroy(arena);
}

static void test_results__the_readme_documents_every_column(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct error error;
    char *text;
    size_t size;
    const char *path = arena_printf(arena, "%s/results/README.md", data_folder());
    assert_int_equal(file_read(arena, path, 0, &text, &size, &error), STATUS_OK);
#define DOCUMENTED(field, unit, better, doc)                                                       \
    if (!strstr(text,                                                                              \
                arena_printf(arena, "| `%s` | %s | %s | %s |\n", #field, *(unit) ? (unit) : "-",   \
                             (better) < 0   ? "lower"                                              \
                             : (better) > 0 ? "higher"                                             \
                                            : "-",                                                 \
                             doc)))                                                                \
        fail_msg("%s: the row of %s is not as in RESULT_COLUMNS", path, #field);
    RESULT_COLUMNS(DOCUMENTED)
#undef DOCUMENTED
#define DOCUMENTED(field, word, better, domain, doc)                                               \
    if (!strstr(text, arena_printf(arena, "| `%s` | %s | %s | %s | %s |\n", #field, word, domain,  \
                                   (better) < 0   ? "lower"                                        \
                                   : (better) > 0 ? "higher"                                       \
                                                  : "zero",                                        \
                                   doc)))                                                          \
        fail_msg("%s: the row of %s is not as in METRIC_LIST", path, #field);
    METRIC_LIST(DOCUMENTED)
#undef DOCUMENTED
    arena_destroy(arena);
}

static void test_results__the_readme_names_every_key_that_is_written(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct error error;
    char *text;
    size_t size;
    struct random random = random_seed(2, 2);
    struct provenance provenance = somewhere();
    struct result result;
    do
        any_result(arena, &random, &result);
    while (!result.has_flicker || !result.views_count || !result.views[0].compared);
    const char *path = arena_printf(arena, "%s/results/README.md", data_folder());
    assert_int_equal(file_read(arena, path, 0, &text, &size, &error), STATUS_OK);
    const struct tracing tracing = {.scene = "tiny"};
    const char *lines[] = {provenance_to_json(arena, &provenance), result_to_json(arena, &result),
                           tracing_to_json(arena, &tracing)};
    for (int l = 0; l < 3; l++)
        for (const char *c = lines[l]; (c = strstr(c, "\":"));) {
            const char *start = c;
            while (start[-1] != '"')
                start--;
            char *key = arena_printf(arena, "`%.*s`", (int)(c - start), start);
            if (!strstr(text, key))
                fail_msg("%s does not name the key %s", path, key);
            c += 2;
        }
    arena_destroy(arena);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_result__a_line_reads_back_to_the_same_values),
        cmocka_unit_test(test_run__reads_back_what_was_appended),
        cmocka_unit_test(test_run__cut_anywhere_loses_at_most_the_last_line),
        cmocka_unit_test(test_run__what_is_no_run_is_refused_and_left_as_it_is),
        cmocka_unit_test(test_run__a_malformed_line_is_named_by_its_number),
        cmocka_unit_test(test_run__a_folder_with_a_run_is_refused_unless_resumed),
        cmocka_unit_test(test_run__the_lock_admits_one_process_and_ends_with_it),
        cmocka_unit_test(test_run__a_place_that_cannot_be_written_is_an_io_error),
        cmocka_unit_test(test_provenance__names_this_machine_and_build),
        cmocka_unit_test(test_tracing__a_line_reads_back_among_the_results),
        cmocka_unit_test(test_results__the_readme_documents_every_column),
        cmocka_unit_test(test_results__the_readme_names_every_key_that_is_written),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
