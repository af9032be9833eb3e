/* The files of papers: bad ones are refused, those of this project are read. */
#include "testing.h"

#include "base/file.h"
#include "report/paper.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* The file with a part replaced: what is said of it. */
static void refused(const char *from, const char *to, const char *const says[2])
{
    struct arena *arena = arena_create(0);
    struct error error = {0};
    char *text = NULL;
    size_t size = 0;
    assert_int_equal(file_read(arena, "reports/papers/senegas-2001.json", 0, &text, &size, &error),
                     STATUS_OK);
    char *at = strstr(text, from);
    if (!at)
        fail_msg("'%s' is not in the file", from);
    const char *whole =
        arena_printf(arena, "%.*s%s%s", (int)(at - text), text, to, at + strlen(from));
    char path[] = "/tmp/treeline-paper-XXXXXX.json";
    close(mkstemps(path, 5));
    assert_int_equal(file_write(path, whole, strlen(whole), &error), STATUS_OK);
    struct paper paper;
    enum status status = paper_read(arena, path, &paper, &error);
    unlink(path);
    if (status != STATUS_INVALID || !strstr(error.text, path) || !strstr(error.text, says[0]) ||
        !strstr(error.text, says[1]))
        fail_msg("'%s' gives %d '%s'", to, status, error.text);
    arena_destroy(arena);
}

static int setup(void **state)
{
    *state = arena_create(0);
    return 0;
}

static int teardown(void **state)
{
    arena_destroy(*state);
    return 0;
}

static void test_papers__bad_files_are_refused_by_one_clear_line(void **state)
{
    (void)state;
    static const struct {
        const char *from, *to, *says[2];
    } cases[] = {
        {"\"machine\"", "\"machin\"", {"machine", "missing"}},
        {"\"note\": \"A poplar", "\"nota\": \"A poplar", {"nota", "did you mean 'note'"}},
        {"\"value\": 16.84", "\"value\": -1", {"rows[0].value", "-1"}},
        {"\"value\": 16.84", "\"value\": \"16.84\"", {"rows[0].value", "number"}},
        {"\"lod\": \"low\"", "\"lod\": \"lowest\"", {"lowest", "low|intermediate|high|auto"}},
        {"\"trees\": 200, ", "", {"rows[0]", "needs method, lod and trees"}},
        {"\"trees\": 200", "\"trees\": 1e300", {"rows[0].trees", "allowed"}},
        {"\"effects\": \"diffuse\", \"method\"",
         "\"effects\": \"snow\", \"method\"",
         {"'snow'", "those that scenes names"}},
        {", \"base\": true", "", {"rows", "exactly one"}},
        {"\"value\": 16.84", "\"value\": 16.84, \"base\": true", {"2 have base", "exactly one"}},
        {"[800, 600]", "[800]", {"size", "1 values"}},
        {"[800, 600]", "[800.5, 600]", {"size", "whole numbers"}},
        {"\"kind\": \"growth\"", "\"kind\": \"guess\"", {"guess", "ratio|growth|value"}},
        {"\"kind\": \"growth\"", "\"kind\": \"ratio\"", {"over", "ratio alone"}},
        {"\"low\": 3,", "\"low\": 9,", {"band", "low below high"}},
        {"\"low\": 0.9,", "", {"band", "one of them"}},
        {"\"same_flip\"", "\"same_flop\"", {"same_flop", "did you mean 'same_flip'"}},
        {"\"same_coverage\"", "\"full_coverage\"", {"column", "begins with same_"}},
        {"[130, 140]", "[130, 400]", {"azimuth_deg", "400"}},
        {"\"unit\": \"fps\"", "\"unit\": \"mph\"", {"mph", "fps|s"}},
        {"{\n", "{,\n", {"not JSON", ":1:"}},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        refused(cases[i].from, cases[i].to, cases[i].says);
}

static void test_papers__files_of_this_project_are_read_and_their_scenes_exist(void **state)
{
    struct arena *arena = *state;
    struct paper *papers = NULL;
    size_t count = 0;
    struct error error = {0};
    if (papers_read(arena, "reports/papers", &papers, &count, &error) != STATUS_OK)
        fail_msg("%s", error.text);
    assert_true(count >= 1);
    for (size_t i = 0; i < count; i++)
        for (size_t t = 0; t < papers[i].tables_count; t++)
            for (size_t k = 0; k < papers[i].tables[t].rows_count; k++) {
                const struct paper_side *cell = &papers[i].tables[t].rows[k].cell;
                struct scene_summary summary;
                if (scene_summary(arena, cell->scene, &summary, &error) != STATUS_OK)
                    fail_msg("%s", error.text);
            }
    assert_int_equal(papers_read(arena, "/nowhere", &papers, &count, &error), STATUS_OK);
    assert_int_equal(count, 0);
}

static void test_papers__the_foggy_forest_is_the_forest_with_fog(void **state)
{
    struct arena *arena = *state;
    struct scene *plain = NULL, *fog = NULL;
    struct scene_request request = {.trees = 200, .seed = 1};
    struct error error = {0};
    if (scene_load(arena, "poplar-forest", &request, &plain, &error) != STATUS_OK ||
        scene_load(arena, "poplar-fog", &request, &fog, &error) != STATUS_OK)
        fail_msg("%s", error.text);
    assert_int_equal(fog->effects, plain->effects | EFFECT_FOG);
    assert_true(fog->fog.density_per_m > 0);
    assert_int_equal(fog->instances_count, plain->instances_count);
    assert_memory_equal(fog->instances, plain->instances,
                        plain->instances_count * sizeof *plain->instances);
    assert_memory_equal(fog->camera.keys, plain->camera.keys, sizeof *plain->camera.keys);
    assert_memory_equal(&fog->sun, &plain->sun, sizeof plain->sun);
    assert_memory_equal(fog->ambient, plain->ambient, sizeof plain->ambient);
    assert_memory_equal(&fog->sky, &plain->sky, sizeof plain->sky);
}

int main(void)
{
    setenv("TREELINE_DATA", ".", 0);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_papers__bad_files_are_refused_by_one_clear_line),
        cmocka_unit_test(test_papers__files_of_this_project_are_read_and_their_scenes_exist),
        cmocka_unit_test(test_papers__the_foggy_forest_is_the_forest_with_fog),
    };
    return cmocka_run_group_tests(tests, setup, teardown);
}
