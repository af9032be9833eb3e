/* The calibration's record: its line, among a run's results, over rounds, in the documents. */
#include "round_machine.h"

#include "base/file.h"
#include "results/limit.h"
#include "results/run.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static void test_calibration__rounds_merge_into_medians_of_each_kind(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct calibration measured[6];
    struct run run = {.measured = measured, .measured_count = 6};
    for (int i = 0; i < 6; i++) {
        measured[i] = round_machine();
        measured[i].round = i;
        measured[i].format = i == 3 ? TARGET_RGBA16F : TARGET_RGBA8;
        measured[i].measures[CALIBRATION_fill_opaque].rate.value = 100.0 * (i * 7 % 6);
    }
    calibrations_merge(arena, &run);
    assert_int_equal(run.calibrations_count, 2);
    const struct calibration *merged = run.calibrations;
    struct interval rate = merged->measures[CALIBRATION_fill_opaque].rate;
    /* 0, 100, 200, 400, 500 are left of the rgba8 ones. */
    check_near(rate.value, 200, 1e-9);
    assert_true(rate.low >= 0 && rate.low < 200 && rate.high > 200 && rate.high <= 500);
    check_near(merged->seconds, 5 * 3.5, 1e-9);
    check_near(merged->measures[CALIBRATION_quads_2px].fragments_per_triangle, 16, 0);
    assert_true(isnan(merged->measures[CALIBRATION_rays_ambient].rate.value));
    /* A single one is as it was. */
    rate = run.calibrations[1].measures[CALIBRATION_quads_2px].rate;
    check_near(rate.low, 1e6, 0);
    check_near(rate.value, 2e6, 0);
    check_near(rate.high, 4e6, 0);
    arena_destroy(arena);
}

static void check_same(double a, double b)
{
    if (a != b && !(isnan(a) && isnan(b)))
        fail_msg("%.17g became %.17g", a, b);
}

static void test_calibration__a_line_reads_back_to_the_same_values(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct error error = {0};
    struct calibration before = round_machine(), after;
    before.measures[0].rate.value = 1e9 / 3;
    before.round = 3;
    char *line = calibration_to_json(arena, &before);
    assert_null(strchr(line, '\n'));
    if (calibration_from_json(arena, line, "here:1", &after, &error))
        fail_msg("%s", error.text);
    assert_int_equal(after.round, 3);
    assert_int_equal(after.width_px, 800);
    assert_int_equal(after.height_px, 600);
    assert_int_equal(after.format, TARGET_RGBA8);
    assert_int_equal(after.threads, 2);
    assert_string_equal(after.backend, "osmesa");
    assert_string_equal(after.renderer, "round");
    check_same(before.core_ghz, after.core_ghz);
    check_same(before.seconds, after.seconds);
    for (size_t i = 0; i < CALIBRATION_COUNT; i++) {
        const struct calibration_measure *a = &before.measures[i], *b = &after.measures[i];
        check_same(a->rate.value, b->rate.value);
        check_same(a->rate.low, b->rate.low);
        check_same(a->rate.high, b->rate.high);
        check_same(a->fragments_per_triangle, b->fragments_per_triangle);
    }
    arena_destroy(arena);
}

/* The line with one text in place of another is refused, and the error holds the word. */
static void check_refused(const char *from, const char *to, const char *word)
{
    struct arena *arena = arena_create(0);
    struct error error = {0};
    struct calibration machine = round_machine(), after;
    char *line = calibration_to_json(arena, &machine), *at = strstr(line, from);
    assert_non_null(at);
    char *bad = arena_printf(arena, "%.*s%s%s", (int)(at - line), line, to, at + strlen(from));
    assert_int_equal(calibration_from_json(arena, bad, "there:7", &after, &error), STATUS_INVALID);
    if (!strstr(error.text, "there:7") || !strstr(error.text, word))
        fail_msg("'%s' lacks there:7 or '%s'", error.text, word);
    arena_destroy(arena);
}

static void test_calibration__a_malformed_line_names_key_and_value(void **state)
{
    (void)state;
    check_refused("\"version\":5", "\"version\":6", "this treeline reads version 1 to 5");
    check_refused(CALIBRATION_KIND, "treeline-run", CALIBRATION_KIND);
    check_refused("\"rgba8\"", "\"rgb\"", "rgba8|rgba16f|rgba32f");
    check_refused("\"threads\":2", "\"threads\":0", "threads");
    check_refused("\"round\":0", "\"round\":-1", "round");
    check_refused("\"width_px\":800", "\"width_px\":-1", "width_px");
    check_refused("\"rate\":250000000", "\"rate\":-5", "rate");
    check_refused("\"fill_opaque\"", "\"fill_purple\"", "fill_purple");
    check_refused("}}", "}", "JSON");
}

/* The first lines of a run that version 1 wrote, before there was a calibration. */
static void test_run__of_version_1_is_read_as_one_without_calibration(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct error error = {0};
    struct run *run;
    const char *path = arena_printf(arena, "%s/tests/results-v1", data_folder());
    if (run_read(arena, path, &run, &error))
        fail_msg("%s", error.text);
    assert_int_equal(run->calibrations_count, 0);
    assert_int_equal(run->results_count, 3);
    arena_destroy(arena);
}

static void test_run__keeps_its_calibrations_among_its_results(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct error error = {0};
    char folder[] = "/tmp/treeline-calibrate-XXXXXX";
    assert_non_null(mkdtemp(folder));
    struct provenance provenance = {.cores = 2};
    struct cell cell = {.name = "tiny/null/trees=1", .width_px = 8, .height_px = 6};
    struct result result;
    struct run *run;
    result_init(&result, &cell, 0);
    result.message = CALIBRATION_KIND; /* a word in a text makes no calibration */
    assert_int_equal(run_open(folder, &provenance, false, &error), STATUS_OK);
    for (int i = 0; i < 5; i++) {
        struct calibration machine = round_machine();
        machine.width_px = 100 + i;
        assert_int_equal(run_append_calibration(folder, &machine, &error), STATUS_OK);
        result.repetition = i;
        assert_int_equal(run_append(folder, &result, &error), STATUS_OK);
    }
    if (run_read(arena, folder, &run, &error))
        fail_msg("%s", error.text);
    assert_int_equal(run->calibrations_count, 5);
    assert_int_equal(run->results_count, 5);
    for (int i = 0; i < 5; i++) {
        assert_int_equal(run->calibrations[i].width_px, 100 + i);
        assert_int_equal(run->results[i].repetition, i);
    }
    unlink(arena_printf(arena, "%s/cells.jsonl", folder));
    rmdir(folder);
    arena_destroy(arena);
}

static void test_calibration__the_readme_documents_every_measure(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct error error = {0};
    char *text;
    size_t size;
    const char *path = arena_printf(arena, "%s/results/README.md", data_folder());
    assert_int_equal(file_read(arena, path, 0, &text, &size, &error), STATUS_OK);
    for (size_t i = 0; i < CALIBRATION_COUNT; i++) {
        const struct calibration_info *info = &calibration_table[i];
        char *row = arena_printf(arena, "| `%s` | %s/s | %s |", info->field, info->unit, info->doc);
        if (!strstr(text, row))
            fail_msg("%s lacks the row\n%s", path, row);
    }
#define LIMIT_ROW(name, word, doc)                                                                 \
    if (*(word) && !strstr(text, "| " word " | " doc " |"))                                        \
        fail_msg("%s lacks the row\n%s", path, "| " word " | " doc " |");
    LIMIT_LIST(LIMIT_ROW)
#undef LIMIT_ROW
    arena_destroy(arena);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_calibration__rounds_merge_into_medians_of_each_kind),
        cmocka_unit_test(test_calibration__a_line_reads_back_to_the_same_values),
        cmocka_unit_test(test_calibration__a_malformed_line_names_key_and_value),
        cmocka_unit_test(test_run__of_version_1_is_read_as_one_without_calibration),
        cmocka_unit_test(test_run__keeps_its_calibrations_among_its_results),
        cmocka_unit_test(test_calibration__the_readme_documents_every_measure),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
