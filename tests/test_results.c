/* Lines of results: round trips, provenance, tracing, documentation. */
#include "any_result.h"

#include "base/file.h"

#include <string.h>

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
        cmocka_unit_test(test_provenance__names_this_machine_and_build),
        cmocka_unit_test(test_tracing__a_line_reads_back_among_the_results),
        cmocka_unit_test(test_results__the_readme_documents_every_column),
        cmocka_unit_test(test_results__the_readme_names_every_key_that_is_written),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
