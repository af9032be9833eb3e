/* The conformance suite: the registered methods pass it, and each plugin that misbehaves fails the
 * check that is there for it, with its own status and message. */
#include "testing.h"

#include "conform/conform.h"
#include "method/method.h"
#include "wall/gl.h"

#include <dlfcn.h>
#include <libgen.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { ROWS_MAX = 64 };

struct rows {
    size_t count;
    struct conform_row rows[ROWS_MAX];
};

static void keep(void *listener, const struct conform_row *row)
{
    struct rows *rows = listener;
    assert_true(rows->count < ROWS_MAX);
    rows->rows[rows->count++] = *row;
}

static const char *plugin(struct arena *arena, const char *name)
{
    char program[PATH_MAX];
    ssize_t length = readlink("/proc/self/exe", program, sizeof program - 1);
    assert_true(length > 0);
    program[length] = 0;
    return arena_printf(arena, "%s/../plugins/%s.so", dirname(program), name);
}

static enum status conform(struct arena *arena, const char *method, const char *pattern,
                           double timeout_seconds, struct rows *rows)
{
    struct error error = {0};
    enum status status;
    *rows = (struct rows){0};
    struct conform_request request = {.method = method,
                                      .pattern = pattern,
                                      .timeout_seconds = timeout_seconds,
                                      .heard = keep,
                                      .listener = rows};
    if (conform_run(arena, &request, &status, &error))
        fail_msg("%s", error.text);
    return status;
}

struct checks {
    const char *pattern;
    size_t count;
};

/* What the sanitizers should see; the rest, with the large pictures, is tests/conform.sh's. */
static const struct checks quick = {
    "^(load|description|state|memory|empty|one-tree|user-mesh|tiny)$", 8};
/* What another back end could change; all of it is tests/conform.sh's. */
static const struct checks few = {"^(load|formats|state|one-tree)$", 4};

static bool is_sanitized(void)
{
    return strstr(TREELINE_FLAGS, "-fsanitize");
}

/* It draws conifers alone; the world of all other checks is then one of conifers. */
static bool may_refuse(const char *name, const char *check)
{
    return !strcmp(name, "conifers") && !strcmp(check, "user-mesh");
}

static void all_pass(const char *name, struct checks checks)
{
    struct arena *arena = arena_create(0);
    struct rows rows;
    enum status status = conform(arena, name, checks.pattern, 120, &rows);
    for (size_t i = 0; i < rows.count; i++)
        if (rows.rows[i].result == CONFORM_FAILED ||
            (rows.rows[i].result == CONFORM_REFUSED && !may_refuse(name, rows.rows[i].check)))
            fail_msg("%s: %s: %s", name, rows.rows[i].check, rows.rows[i].message);
    assert_int_equal(status, STATUS_OK);
    assert_int_equal(rows.count, checks.count);
    arena_destroy(arena);
}

static void test_conform__the_registered_methods_keep_the_contract(void **unused)
{
    (void)unused;
    if (!is_sanitized() && strcmp(gl_backends[0], "osmesa") == 0)
        skip(); /* the build that tests/conform.sh asks for all this and more */
    for (const struct method *const *each = methods_builtin; *each; each++)
        all_pass((*each)->name, is_sanitized() ? quick : few);
}

static void test_conform__a_plugin_that_keeps_the_contract_passes(void **unused)
{
    (void)unused;
    struct arena *arena = arena_create(0);
    all_pass(plugin(arena, "honest"), quick);
    all_pass(plugin(arena, "honest-cpu"), quick);
    arena_destroy(arena);
}

static void test_conform__methods_of_pictures_honour_a_trees_stretch(void **unused)
{
    (void)unused;
    static const struct checks stretch = {"^stretch$", 1};
    all_pass("texels", stretch);
    all_pass("jakulin", stretch);
    all_pass("billboards", stretch);
    all_pass("cross-quads", stretch);
}

static void test_conform__each_way_to_misbehave_is_told_apart(void **unused)
{
    (void)unused;
    static const struct {
        const char *plugin, *check;
        enum status exit, status;
        const char *message;
    } ways[] = {
        {"lies-shadows", "effects", STATUS_NONCONFORMING, STATUS_NONCONFORMING,
         "claims sun-shadows, which changes nothing"},
        {"lies-fog", "effects", STATUS_NONCONFORMING, STATUS_NONCONFORMING,
         "does not claim fog, but draws it"},
        {"lies-treeless", "one-tree", STATUS_NONCONFORMING, STATUS_NONCONFORMING,
         "says that it draws no trees, but coverage is"},
        {"lies-stretch", "stretch", STATUS_NONCONFORMING, STATUS_NONCONFORMING,
         "stretch 2: coverage is"},
        {"lies-host", "memory", STATUS_NONCONFORMING, STATUS_NONCONFORMING, "the process grew by"},
        {"lies-device", "memory", STATUS_NONCONFORMING, STATUS_NONCONFORMING,
         "made without gl_buffer, gl_texture"},
        {"grows", "growth", STATUS_NONCONFORMING, STATUS_NONCONFORMING, "410 kB of host"},
        {"leaves-state", "state", STATUS_NONCONFORMING, STATUS_NONCONFORMING,
         "leaves GL_SCISSOR_TEST at 1"},
        {"never-the-same", "bytes", STATUS_NONCONFORMING, STATUS_NONCONFORMING,
         "a view drawn again after another one differs"},
        {"draws-nothing", "one-tree", STATUS_NONCONFORMING, STATUS_NONCONFORMING,
         "coverage is 0, the reference's"},
        {"draws-nan", "formats", STATUS_NONCONFORMING, STATUS_BAD_PICTURE, "red is nan"},
        {"crashes-in-prepare", "formats", STATUS_NONCONFORMING, STATUS_CRASH,
         "died of signal 6 (Aborted) in: prepare"},
        {"crashes-in-draw", "formats", STATUS_NONCONFORMING, STATUS_CRASH,
         "died of signal 6 (Aborted) in: draw: crash in "},
        {"crashes-in-draw", "formats", STATUS_NONCONFORMING, STATUS_CRASH, " (trial_draw"},
        {"hangs", "formats", STATUS_NONCONFORMING, STATUS_TIMEOUT,
         "ran past its limit of 4 s in: draw"},
        {"crashes-at-load", "load", STATUS_CRASH, STATUS_CRASH,
         "dies of signal 6 (Aborted) when it is loaded"},
        {"leaves-at-load", "load", STATUS_CRASH, STATUS_CRASH,
         "leaves by exit code 0 when it is loaded"},
        {"hangs-at-load", "load", STATUS_TIMEOUT, STATUS_TIMEOUT, "in: loading the method"},
        {"old", "load", STATUS_INVALID, STATUS_INVALID, "was built for method ABI 1"},
        {"none", "load", STATUS_NOT_FOUND, STATUS_NOT_FOUND, "No such file"},
    };
    struct arena *arena = arena_create(0);
    bool instrumented = dlsym(RTLD_DEFAULT, "__asan_init");
    for (size_t w = 0; w < sizeof ways / sizeof *ways; w++) {
        struct rows rows;
        if (instrumented && !strcmp(ways[w].plugin, "lies-host"))
            continue; /* a sanitizer's own memory hides it */
        enum status exit = conform(arena, plugin(arena, ways[w].plugin), ways[w].check,
                                   strstr(ways[w].plugin, "hangs") ? 4 : 60, &rows);
        const struct conform_row *row = &rows.rows[0];
        if (exit != ways[w].exit || rows.count != 1 || row->result != CONFORM_FAILED ||
            row->status != ways[w].status || !strstr(row->message, ways[w].message))
            fail_msg("%s: exit %s, %zu rows; %s: %s: %s", ways[w].plugin, status_word(exit),
                     rows.count, row->check, status_word(row->status), row->message);
    }
    arena_destroy(arena);
}

static void test_conform__every_check_of_pictures_can_fail(void **unused)
{
    (void)unused;
    if (is_sanitized())
        skip(); /* what the checks compute is the same, and takes minutes here */
    static const struct {
        const char *check, *message;
    } bends[] = {
        {"options", "detail=10: pixel x 0, y 0: red is nan"},
        {"sun-moved", "differs from a fresh start's"},
        {"empty", "differs from the reference by"},
        {"user-mesh", "coverage is 0, the reference's"},
        {"lod", "lod=high errs by"},
        {"pixel", "a forest of trees of a pixel: coverage is 0"},
        {"close", "a tree that fills the picture: coverage is 0"},
        {"down", "tilted by 0.001 rad the picture differs by"},
        {"sun", "the sun below the horizon: terrain and sky differ by"},
        {"scale", "scale 1e+06: differs from scale 1 by"},
        {"offset", "999000 m from the origin the picture differs by"},
        {"tiny", "1 x 1: pixel x 0, y 0: red is nan"},
        {"huge", "terrain and sky differ by"},
        {"million", "prepare failed and gave no reason"},
    };
    struct arena *arena = arena_create(0);
    bool instrumented = dlsym(RTLD_DEFAULT, "__asan_init");
    for (size_t b = 0; b < sizeof bends / sizeof *bends; b++) {
        struct rows rows;
        if (instrumented && strcmp(bends[b].check, "huge") == 0)
            continue; /* slow */
        setenv("BENDS", bends[b].check, 1);
        enum status exit = conform(arena, plugin(arena, "bends"),
                                   arena_printf(arena, "^%s$", bends[b].check), 60, &rows);
        const struct conform_row *row = &rows.rows[0];
        if (exit != STATUS_NONCONFORMING || rows.count != 1 || row->result != CONFORM_FAILED ||
            !strstr(row->message, bends[b].message))
            fail_msg("%s: exit %s, %zu rows: %s", bends[b].check, status_word(exit), rows.count,
                     row->message);
    }
    unsetenv("BENDS");
    arena_destroy(arena);
}

static void test_conform__each_lie_about_a_tally_is_told_apart(void **unused)
{
    (void)unused;
    static const struct {
        const char *way, *message;
    } lies[] = {
        {"impossible", "are more than any machine does"},
        {"random", "a view counts 101 lookups, again 102"},
        {"rays", "counts rays, which are the CPU's alone: it draws with OpenGL"},
        {"timed", "counts lookups in a draw that is timed"},
        {"flat", "a picture of four times the pixels counts 1000 samples, not more than 1000"},
    };
    struct arena *arena = arena_create(0);
    struct rows rows;
    for (size_t k = 0; k < sizeof lies / sizeof *lies; k++) {
        setenv("TALLY", lies[k].way, 1);
        enum status exit = conform(arena, plugin(arena, "lies-tally"), "^tally$", 60, &rows);
        const struct conform_row *row = &rows.rows[0];
        if (exit != STATUS_NONCONFORMING || rows.count != 1 || row->result != CONFORM_FAILED ||
            row->status != STATUS_NONCONFORMING || !strstr(row->message, lies[k].message))
            fail_msg("%s: exit %s, %zu rows: %s", lies[k].way, status_word(exit), rows.count,
                     row->message);
    }
    unsetenv("TALLY");
    assert_int_equal(conform(arena, plugin(arena, "lies-tally"), "^tally$", 60, &rows), STATUS_OK);
    assert_int_equal(conform(arena, plugin(arena, "honest-cpu"), "^tally$", 60, &rows), STATUS_OK);
    assert_non_null(strstr(rows.rows[0].message, "only its picture's bytes can bind it"));
    assert_int_equal(conform(arena, plugin(arena, "counts"), "^tally$", 60, &rows), STATUS_OK);
    arena_destroy(arena);
}

static void test_conform__a_refusal_with_a_reason_is_no_failure(void **unused)
{
    (void)unused;
    struct arena *arena = arena_create(0);
    struct rows rows;
    assert_int_equal(conform(arena, plugin(arena, "refuses"), "^(formats|huge)$", 60, &rows), 0);
    assert_int_equal(rows.count, 2);
    for (size_t i = 0; i < rows.count; i++) {
        assert_int_equal(rows.rows[i].result, CONFORM_REFUSED);
        assert_int_equal(rows.rows[i].status, STATUS_UNSUPPORTED);
        assert_non_null(strstr(rows.rows[i].message, "trees are too green"));
    }
    arena_destroy(arena);
}

static void test_conform__loading_a_plugin_that_dies_leaves_this_process_alive(void **unused)
{
    (void)unused;
    struct arena *arena = arena_create(0);
    struct error error = {0};
    const struct method *method;
    assert_int_equal(method_find(plugin(arena, "crashes-at-load"), &method, &error), STATUS_CRASH);
    assert_non_null(strstr(error.text, "crashes-at-load.so: dies of signal 6"));
    assert_int_equal(method_find(plugin(arena, "honest"), &method, &error), STATUS_OK);
    assert_string_equal(method->name, "honest");
    arena_destroy(arena);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_conform__the_registered_methods_keep_the_contract),
        cmocka_unit_test(test_conform__a_plugin_that_keeps_the_contract_passes),
        cmocka_unit_test(test_conform__methods_of_pictures_honour_a_trees_stretch),
        cmocka_unit_test(test_conform__each_way_to_misbehave_is_told_apart),
        cmocka_unit_test(test_conform__every_check_of_pictures_can_fail),
        cmocka_unit_test(test_conform__each_lie_about_a_tally_is_told_apart),
        cmocka_unit_test(test_conform__a_refusal_with_a_reason_is_no_failure),
        cmocka_unit_test(test_conform__loading_a_plugin_that_dies_leaves_this_process_alive),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
