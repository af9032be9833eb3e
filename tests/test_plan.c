/* Plans: sweeps, groups, names that can be pasted back, filters, the order of rounds. */
#include "testing.h"

#include "base/file.h"
#include "plan/plan.h"
#include "plan/settings.h"

#include <glob.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static struct plan *plan_of(struct arena *arena, const struct plan_request *request)
{
    struct plan *plan = NULL;
    struct error error = {0};
    if (plan_load(arena, request, &plan, &error))
        fail_msg("%s", error.text);
    return plan;
}

/* The request must be refused with this status and all of these words. */
static void refused(const struct plan_request *request, enum status status, const char *word,
                    const char *other)
{
    struct arena *arena = arena_create(0);
    struct plan *plan = NULL;
    struct error error = {0};
    assert_int_equal(plan_load(arena, request, &plan, &error), status);
    if (!strstr(error.text, word) || !strstr(error.text, other))
        fail_msg("'%s' lacks '%s' or '%s'", error.text, word, other);
    assert_null(strchr(error.text, '\n'));
    arena_destroy(arena);
}

#define ONE_SCENE .scenes = (const char *[]){"tiny"}, .scenes_count = 1
#define ONE_METHOD .methods = (const char *[]){"null"}, .methods_count = 1

/* A method with options, as a shared object that the Makefile builds for the tests. */
static const char *plugin(struct arena *arena)
{
    char program[4096];
    ssize_t length = readlink("/proc/self/exe", program, sizeof program - 1);
    assert_true(length > 0);
    program[length] = 0;
    *strrchr(program, '/') = 0;
    return arena_printf(arena, "%s/../plugins/bad.so", program);
}

static const char *file_with(struct arena *arena, const char *text)
{
    const char *path = arena_printf(arena, "/tmp/treeline-plan-%d.json", getpid());
    struct error error;
    assert_int_equal(file_write(path, text, strlen(text), &error), STATUS_OK);
    return path;
}

static void test_plan__lists_multiply(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct plan *plan = plan_of(
        arena, &(struct plan_request){ONE_SCENE, ONE_METHOD, .trees = "1,2,4", .lods = "high,auto",
                                      .sizes = "32x24,64x48", .targets = "rgba8,rgba32f"});
    assert_int_equal(plan->cells_count, 3 * 2 * 2 * 2);
    for (size_t i = 0; i < plan->cells_count; i++)
        for (size_t k = 0; k < i; k++)
            assert_string_not_equal(plan->cells[i].name, plan->cells[k].name);
    arena_destroy(arena);
}

static void test_plan__an_item_without_equals_continues_the_option_before_it(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    const char *spec = arena_printf(arena, "%s:way=hang,crash,none", plugin(arena));
    struct plan *plan =
        plan_of(arena, &(struct plan_request){ONE_SCENE, .trees = "1", .methods = &spec,
                                              .methods_count = 1});
    assert_int_equal(plan->cells_count, 3);
    assert_string_equal(plan->cells[0].options, "way=hang");
    assert_string_equal(plan->cells[1].options, "way=crash");
    assert_string_equal(plan->cells[2].options, ""); /* the default is not written */
    arena_destroy(arena);
}

static void test_plan__a_cell_stands_once(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    const char *methods[] = {"null", "null"};
    struct plan *plan =
        plan_of(arena, &(struct plan_request){ONE_SCENE, .trees = "1,1", .methods = methods,
                                              .methods_count = 2});
    assert_int_equal(plan->cells_count, 1);
    arena_destroy(arena);
}

/* Also where all of them have the same name: nobody waits for a billion that are one. */
static void test_plan__more_than_100000_cells_are_refused(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    char *many = arena_strdup(arena, "");
    for (int i = 0; i < 400; i++)
        many = arena_printf(arena, "%s%s1", many, i ? "," : "");
    const char *sizes = "8x8",
               *spec = arena_printf(arena, "billboards:views=%s,samples=%s", many, many);
    refused(&(struct plan_request){ONE_SCENE, .methods = &spec, .methods_count = 1, .trees = "1"},
            STATUS_INVALID, "more than 100000 cells", "");
    for (int i = 1; i < 400; i++)
        sizes = arena_printf(arena, "%s,8x8", sizes);
    refused(&(struct plan_request){ONE_SCENE, ONE_METHOD, .trees = many, .sizes = sizes},
            STATUS_INVALID, "more than 100000 cells", "");
    arena_destroy(arena);
}

static void test_plan__the_standard_trees_are_the_scenes_own(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct error error;
    struct scene_summary summary;
    assert_int_equal(scene_summary(arena, "tiny", &summary, &error), STATUS_OK);
    struct plan *plan =
        plan_of(arena, &(struct plan_request){ONE_SCENE, ONE_METHOD, .trees = "standard"});
    assert_int_equal(plan->cells_count, summary.trees_count);
    for (size_t i = 0; i < summary.trees_count; i++)
        assert_int_equal(plan->cells[i].trees, summary.trees[i]);
    arena_destroy(arena);
}

static void same_cell(const struct cell *a, const struct cell *b)
{
    assert_string_equal(a->name, b->name);
    assert_string_equal(a->scene, b->scene);
    assert_string_equal(a->method_name, b->method_name);
    assert_string_equal(a->options, b->options);
    assert_ptr_equal(a->method, b->method);
    assert_int_equal(a->trees, b->trees);
    assert_int_equal(a->lod, b->lod);
    assert_int_equal(a->width_px, b->width_px);
    assert_int_equal(a->height_px, b->height_px);
    assert_int_equal(a->format, b->format);
    assert_true(a->seed == b->seed);
}

static void test_cell_parse__every_name_of_a_plan_can_be_pasted_back(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    const char *methods[] = {"null", arena_printf(arena, "%s:way=hang,none", plugin(arena))};
    const char *scenes[] = {"tiny", arena_printf(arena, "%s/scenes/tiny.json", data_folder())};
    struct plan *plan = plan_of(arena, &(struct plan_request){.scenes = scenes,
                                                              .scenes_count = 2,
                                                              .methods = methods,
                                                              .methods_count = 2,
                                                              .trees = "0,1,4",
                                                              .lods = "low,high",
                                                              .sizes = "31x17",
                                                              .targets = "rgba8,rgba16f",
                                                              .seed_given = true,
                                                              .seed = UINT64_MAX});
    assert_int_equal(plan->cells_count, 2 * 3 * 3 * 2 * 2);
    for (size_t i = 0; i < plan->cells_count; i++) {
        struct cell cell;
        struct error error;
        if (cell_parse(arena, plan->cells[i].name, &cell, &error))
            fail_msg("%s", error.text);
        same_cell(&cell, &plan->cells[i]);
    }
    arena_destroy(arena);
}

static void test_cell_parse__missing_parts_are_the_defaults(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct error error;
    struct cell cell;
    struct scene_summary summary;
    assert_int_equal(scene_summary(arena, "tiny", &summary, &error), STATUS_OK);
    assert_int_equal(cell_parse(arena, "tiny/null", &cell, &error), STATUS_OK);
    assert_int_equal(cell.trees, summary.default_trees);
    assert_int_equal(cell.width_px, summary.width_px);
    assert_int_equal(cell.height_px, summary.height_px);
    assert_int_equal(cell.format, TARGET_RGBA16F);
    assert_int_equal(cell.lod, LOD_AUTO);
    assert_true(cell.seed == 1);
    /* The order of the parts does not matter. */
    struct cell other;
    assert_int_equal(cell_parse(arena, "tiny/null/seed=1/trees=4/lod=high", &cell, &error), 0);
    assert_int_equal(cell_parse(arena, "tiny/null/lod=high/trees=4", &other, &error), 0);
    same_cell(&cell, &other);
    arena_destroy(arena);
}

static void test_cell_parse__a_bad_name_is_refused_in_one_clear_line(void **state)
{
    (void)state;
    const struct {
        const char *name, *word;
        enum status status;
    } bad[] = {
        {"", "SCENE/METHOD", STATUS_INVALID},
        {"tiny", "SCENE/METHOD", STATUS_INVALID},
        {"/null", "SCENE/METHOD", STATUS_INVALID},
        {"tiny/", "SCENE/METHOD", STATUS_INVALID},
        {"tiny/nul", "null", STATUS_NOT_FOUND},
        {"tinny/null", "tiny", STATUS_NOT_FOUND},
        {"tiny/null:views=3", "views", STATUS_INVALID},
        {"tiny/null/trees=-1", "0..4000000", STATUS_INVALID},
        {"tiny/null/trees=5000000", "0..4000000", STATUS_INVALID},
        {"tiny/null/trees=1e3", "trees", STATUS_INVALID},
        {"tiny/null/lod=best", "low|intermediate|high|auto", STATUS_INVALID},
        {"tiny/null/size=0x5", "1..16384", STATUS_INVALID},
        {"tiny/null/size=800", "WIDTHxHEIGHT", STATUS_INVALID},
        {"tiny/null/size=8192x8193", "67117056 pixels; at most 67108864", STATUS_INVALID},
        {"tiny/null/trees=1/lod=low/trees=2", "'trees' stands twice", STATUS_INVALID},
        {"tiny/null/target=rgb", "rgba8|rgba16f|rgba32f", STATUS_INVALID},
        {"tiny/null/seed=x", "seed", STATUS_INVALID},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        struct arena *arena = arena_create(0);
        struct error error = {0};
        struct cell cell;
        enum status status = cell_parse(arena, bad[i].name, &cell, &error);
        if (status != bad[i].status || !strstr(error.text, bad[i].word))
            fail_msg("'%s': %s, '%s'", bad[i].name, status_word(status), error.text);
        arena_destroy(arena);
    }
}

static void test_plan__a_file_is_overridden_by_the_command_line(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    const char *path = file_with(
        arena,
        "{\"doc\": \"t\", \"scenes\": [\"tiny\"], \"methods\": [\"null\"], \"trees\": \"1,2\", "
        "\"rounds\": 7, \"frame_seconds\": 0.25, \"seed\": 9, \"views\": 3, \"threads\": 2, "
        "\"memory_bytes\": 1e9}");
    struct plan *plan = plan_of(arena, &(struct plan_request){.plan_path = path});
    assert_int_equal(plan->cells_count, 2);
    assert_int_equal(plan->rounds, 7);
    assert_true(plan->frame_seconds == 0.25);
    assert_true(plan->cells[0].seed == 9);
    assert_int_equal(plan->views_count, 3);
    assert_int_equal(plan->threads, 2);
    assert_int_equal(plan->memory_bytes, 1000000000);
    struct plan *other = plan_of(
        arena, &(struct plan_request){
                   .plan_path = path, .trees = "4", .rounds = 2, .seed_given = true, .seed = 0});
    assert_int_equal(other->cells_count, 1);
    assert_int_equal(other->cells[0].trees, 4);
    assert_true(other->cells[0].seed == 0);
    assert_int_equal(other->rounds, 2);
    assert_true(other->frame_seconds == 0.25);
    assert_int_equal(other->threads, 2);
    assert_true(plan->hash != other->hash);
    /* 0 threads are all of them, 0 bytes no budget: both can be said. */
    struct plan *zeros = plan_of(
        arena,
        &(struct plan_request){.plan_path = path, .threads_given = true, .memory_given = true});
    assert_int_equal(zeros->threads, 0);
    assert_int_equal(zeros->memory_bytes, 0);
    unlink(path);
    arena_destroy(arena);
}

static void test_plan__groups_inherit_from_the_top(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    const char *path = file_with(
        arena, "{\"scenes\": [\"tiny\"], \"methods\": [\"null\"], \"trees\": \"1\", \"groups\": "
               "[{}, {\"trees\": \"2,4\"}, {\"lods\": \"high,low\"}], \"cells\": "
               "[\"tiny/null/trees=0\"]}");
    struct plan *plan = plan_of(arena, &(struct plan_request){.plan_path = path});
    assert_int_equal(plan->cells_count, 1 + 2 + 2 + 1);
    assert_int_equal(plan->cells[2].trees, 4);
    assert_int_equal(plan->cells[3].lod, LOD_HIGH);
    assert_int_equal(plan->cells[3].trees, 1);
    assert_int_equal(plan->cells[5].trees, 0);
    unlink(path);
    arena_destroy(arena);
}

static void test_plan__a_bad_file_names_key_value_and_allowance(void **state)
{
    (void)state;
    const struct {
        const char *text, *word, *other;
    } bad[] = {
        {"{", "not JSON", "treeline-plan"},
        {"{\"scenes\": [\"tiny\"], \"methods\": [\"null\"], \"round\": 3}", "round", "not a key"},
        {"{\"scenes\": [\"tiny\"], \"methods\": [\"null\"], \"rounds\": 0}", "rounds", "1..10000"},
        {"{\"scenes\": [\"tiny\"], \"methods\": [\"null\"], \"rounds\": 1.5}", "rounds", "whole"},
        {"{\"scenes\": \"tiny\", \"methods\": [\"null\"]}", "scenes", "a list"},
        {"{\"scenes\": [\"tiny\"], \"methods\": [\"null\"], \"trees\": \"1,,2\"}", "trees",
         "empty"},
        {"{\"scenes\": [\"tiny\"]}", "no method", "name a plan"},
        {"{\"scenes\": [\"tiny\"], \"methods\": [\"null:x=1\"]}", "null", "no options"},
        {"{\"scenes\": [\"tiny\"], \"methods\": [\"null\"], \"backend\": \"dx\"}", "backend", "dx"},
        {"{\"groups\": [{\"scene\": [\"tiny\"]}]}", "groups[0].scene", "not a key"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        struct arena *arena = arena_create(0);
        const char *path = file_with(arena, bad[i].text);
        refused(&(struct plan_request){.plan_path = path}, STATUS_INVALID, bad[i].word,
                bad[i].other);
        unlink(path);
        arena_destroy(arena);
    }
}

static void test_plan__a_name_that_is_no_plan_lists_the_plans(void **state)
{
    (void)state;
    refused(&(struct plan_request){.plan_path = "no-such"}, STATUS_NOT_FOUND, "no-such", "smoke");
    refused(&(struct plan_request){.plan_path = "/no/such.json"}, STATUS_NOT_FOUND, "/no/such.json",
            "No such file");
    refused(&(struct plan_request){0}, STATUS_USAGE, "no scene", "name a plan");
    refused(&(struct plan_request){ONE_SCENE}, STATUS_USAGE, "no method", "name a plan");
}

static void test_plan__the_filter_keeps_what_it_matches(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct plan *plan = plan_of(arena, &(struct plan_request){ONE_SCENE, ONE_METHOD,
                                                              .trees = "1,2,4", .lods = "high,low",
                                                              .filter = "trees=(1|4)/lod=high"});
    assert_int_equal(plan->cells_count, 2);
    arena_destroy(arena);
    refused(&(struct plan_request){ONE_SCENE, ONE_METHOD, .filter = "trees=77"}, STATUS_INVALID,
            "trees=77", "none of the 1");
    refused(&(struct plan_request){ONE_SCENE, ONE_METHOD, .filter = "("}, STATUS_INVALID, "filter",
            "regular expression");
    /* What would keep the system's compiler or matcher busy for ever. */
    char longest[1002];
    memset(longest, 'a', sizeof longest - 1);
    longest[sizeof longest - 1] = 0;
    static const char *const endless[] = {"((((a{100}){100}){100}){100}){100}",
                                          "(((a{2,}){2,900}){2})", "(a*)*\\1b", "x{1001}"};
    for (size_t i = 0; i < sizeof endless / sizeof *endless; i++)
        refused(&(struct plan_request){ONE_SCENE, ONE_METHOD, .filter = endless[i]}, STATUS_INVALID,
                "filter", "may take for ever");
    refused(&(struct plan_request){ONE_SCENE, ONE_METHOD, .filter = longest}, STATUS_INVALID,
            "filter", "longer than 1000 bytes");
    /* Braces in brackets and behind a backslash repeat nothing. */
    refused(&(struct plan_request){ONE_SCENE, ONE_METHOD, .filter = "[]{9999}]x"}, STATUS_INVALID,
            "filter", "none of the 1");
    refused(&(struct plan_request){ONE_SCENE, ONE_METHOD, .filter = "\\{9999\\}"}, STATUS_INVALID,
            "filter", "none of the 1");
}

static void test_plan__settings_out_of_range_are_refused(void **state)
{
    (void)state;
    refused(&(struct plan_request){ONE_SCENE, ONE_METHOD, .rounds = -1}, STATUS_INVALID, "rounds",
            "1..10000");
    refused(&(struct plan_request){ONE_SCENE, ONE_METHOD, .timeout_seconds = 1e9}, STATUS_INVALID,
            "timeout_seconds", "86400");
    refused(&(struct plan_request){ONE_SCENE, ONE_METHOD, .views_count = 65}, STATUS_INVALID,
            "views", "1..64");
}

static void test_plan_order__every_round_is_a_permutation_of_its_own(void **state)
{
    (void)state;
    enum { CELLS = 24, ROUNDS = 400 };
    struct arena *arena = arena_create(0);
    struct plan *plan =
        plan_of(arena, &(struct plan_request){ONE_SCENE, ONE_METHOD, .trees = "1,2,4",
                                              .lods = "high,low,auto,intermediate",
                                              .targets = "rgba8,rgba16f"});
    assert_int_equal(plan->cells_count, CELLS);
    size_t order[CELLS], again[CELLS], first[CELLS] = {0};
    double position = 0;
    for (int round = 0; round < ROUNDS; round++) {
        bool seen[CELLS] = {false};
        plan_order(plan, round, order);
        plan_order(plan, round, again);
        assert_memory_equal(order, again, sizeof order);
        for (size_t i = 0; i < CELLS; i++) {
            assert_true(order[i] < CELLS && !seen[order[i]]);
            seen[order[i]] = true;
            if (order[i] == 0)
                position += (double)i;
        }
        first[order[0]]++;
    }
    /* Uniform: chi squared of the cell that comes first, 23 degrees of freedom, p = 1e-4 at 55.5;
     * and the mean position of cell 0 within 4 standard errors of 11.5. */
    double expected = (double)ROUNDS / CELLS, chi2 = 0;
    for (size_t i = 0; i < CELLS; i++)
        chi2 += ((double)first[i] - expected) * ((double)first[i] - expected) / expected;
    assert_true(chi2 < 55.5);
    double mean = position / ROUNDS, deviation = 6.92 / 20;
    assert_true(mean > 11.5 - 4 * deviation && mean < 11.5 + 4 * deviation);
    arena_destroy(arena);
}

static void test_plan__the_readme_documents_every_setting(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct error error;
    char *text, allowed[64];
    size_t size;
    const char *path = arena_printf(arena, "%s/harness/plan/README.md", data_folder());
    assert_int_equal(file_read(arena, path, 0, &text, &size, &error), STATUS_OK);
    for (const struct option *o = plan_settings_table; o->name; o++) {
        option_allowed(o, allowed, sizeof allowed);
        char *row = arena_printf(arena, "| `%s` | %g | %s | %s | %s |\n", o->name, o->fallback,
                                 allowed, *o->unit ? o->unit : "-", o->doc);
        if (!strstr(text, row))
            fail_msg("%s lacks: %s", path, row);
    }
    arena_destroy(arena);
}

static void test_plan__every_plan_that_is_shipped_loads(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    glob_t found = {0};
    const char *pattern = arena_printf(arena, "%s/scenes/plans/*.json", data_folder());
    assert_int_equal(glob(pattern, 0, NULL, &found), 0);
    assert_true(found.gl_pathc >= 10);
    for (size_t i = 0; i < found.gl_pathc; i++) {
        char *name = arena_strdup(arena, strrchr(found.gl_pathv[i], '/') + 1);
        *strrchr(name, '.') = 0;
        struct plan *plan = plan_of(arena, &(struct plan_request){.plan_path = name});
        assert_true(plan->cells_count >= 4);
        assert_string_equal(plan->name, name);
    }
    globfree(&found);
    arena_destroy(arena);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_plan__lists_multiply),
        cmocka_unit_test(test_plan__an_item_without_equals_continues_the_option_before_it),
        cmocka_unit_test(test_plan__a_cell_stands_once),
        cmocka_unit_test(test_plan__more_than_100000_cells_are_refused),
        cmocka_unit_test(test_plan__the_standard_trees_are_the_scenes_own),
        cmocka_unit_test(test_cell_parse__every_name_of_a_plan_can_be_pasted_back),
        cmocka_unit_test(test_cell_parse__missing_parts_are_the_defaults),
        cmocka_unit_test(test_cell_parse__a_bad_name_is_refused_in_one_clear_line),
        cmocka_unit_test(test_plan__a_file_is_overridden_by_the_command_line),
        cmocka_unit_test(test_plan__groups_inherit_from_the_top),
        cmocka_unit_test(test_plan__a_bad_file_names_key_value_and_allowance),
        cmocka_unit_test(test_plan__a_name_that_is_no_plan_lists_the_plans),
        cmocka_unit_test(test_plan__the_filter_keeps_what_it_matches),
        cmocka_unit_test(test_plan__settings_out_of_range_are_refused),
        cmocka_unit_test(test_plan_order__every_round_is_a_permutation_of_its_own),
        cmocka_unit_test(test_plan__the_readme_documents_every_setting),
        cmocka_unit_test(test_plan__every_plan_that_is_shipped_loads),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
