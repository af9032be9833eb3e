/* treeline diff as a user calls it: the table, the JSON, the map, and what it refuses. */
#include "testing.h"

#include "truth/frame_image.h"
#include "truth/metrics.h"
#include "wall/json.h"

#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

static struct arena *arena;
static char folder[] = "/tmp/treeline-diff-XXXXXX";
static const char *const files[] = {"a.exr", "b.exr", "small.exr", "a.png", "b.frame"};

static char *path_of(const char *name)
{
    return arena_printf(arena, "%s/%s", folder, name);
}

/* b is a plus .1 in green, with variance; small has another size. */
static int set_up(void **state)
{
    (void)state;
    arena = arena_create(0);
    if (!mkdtemp(folder))
        return -1;
    struct frame *a = frame_create(arena, 24, 16, false), *b = frame_create(arena, 24, 16, true);
    for (int i = 0; i < 24 * 16 * 4; i++) {
        a->rgba[i] = 0.25f;
        b->rgba[i] = i % 4 == 1 ? 0.35f : 0.25f;
        b->variance[i] = 0.0012f;
    }
    struct frame *small = frame_create(arena, 8, 8, false);
    return frame_write_image(path_of("a.exr"), a, NULL) ||
           frame_write_image(path_of("b.exr"), b, NULL) ||
           frame_write_image(path_of("small.exr"), small, NULL) ||
           frame_write_image(path_of("a.png"), a, NULL) || frame_save(b, path_of("b.frame"), NULL);
}

static int tear_down(void **state)
{
    (void)state;
    for (size_t k = 0; k < sizeof files / sizeof *files; k++)
        unlink(path_of(files[k]));
    int rc = rmdir(folder);
    arena_destroy(arena);
    return rc;
}

/* Runs the program that was built with this test, in the folder of the pictures; returns its exit
 * code. */
static int diff(const char *arguments, char *output, size_t size)
{
    char self[PATH_MAX] = "";
    assert_true(readlink("/proc/self/exe", self, sizeof self - 1) > 0);
    *strrchr(self, '/') = 0;
    FILE *pipe = popen(
        arena_printf(arena, "cd %s && %s/../treeline diff %s 2>&1", folder, self, arguments), "r");
    assert_non_null(pipe);
    output[fread(output, 1, size - 1, pipe)] = 0;
    return WEXITSTATUS(pclose(pipe));
}

static double value_of(const char *text, const char *metric, const char *key)
{
    struct error error;
    struct json_doc *doc = json_parse(arena, text, "diff", &error);
    struct json *metrics = json_object(json_root(doc), "metrics");
    double value = json_number(json_object(metrics, metric), key, -1e9, -1e9, 1e9);
    json_end(doc);
    return value;
}

static void test_diff__json_gives_value_raw_and_floor_of_every_metric(void **state)
{
    (void)state;
    char text[16384];
    const char *const pairs[] = {"--json a.exr b.exr", "a.exr b.frame --json"};
    for (int k = 0; k < 2; k++) {
        assert_int_equal(diff(pairs[k], text, sizeof text), STATUS_OK);
        assert_true(fabs(value_of(text, "rmse", "raw") - 0.1 / sqrt(3)) < 1e-6);
        assert_true(fabs(value_of(text, "rmse", "floor") - sqrt(0.0012)) < 1e-6);
        assert_true(fabs(value_of(text, "rmse", "value") - sqrt(0.01 / 3 - 0.0012)) < 1e-6);
        assert_true(fabs(value_of(text, "mae", "raw") - 0.1 / 3) < 1e-6);
        assert_true(fabs(value_of(text, "coverage", "raw")) < 1e-9);
        for (const struct metric_info *info = metric_table; info->field; info++)
            assert_true(isfinite(value_of(text, info->word, "floor")));
    }
}

static void test_diff__the_table_lists_every_metric_and_no_coverage_without_alpha(void **state)
{
    (void)state;
    char text[16384], line[64];
    assert_int_equal(diff("a.png a.exr", text, sizeof text), STATUS_OK);
    for (const struct metric_info *info = metric_table; info->field; info++) {
        snprintf(line, sizeof line, "\n%-14s ", info->word);
        assert_non_null(strstr(text, line));
    }
    assert_non_null(strstr(text, "\ncoverage                  -            -            -"));
    assert_int_equal(diff("--json a.png a.exr", text, sizeof text), STATUS_OK);
    assert_non_null(strstr(text, "\"coverage\":{\"value\":null,\"raw\":null,\"floor\":null"));
}

static void test_diff__the_map_is_written_in_colours_or_as_values(void **state)
{
    (void)state;
    char text[16384];
    struct image *colours, *values;
    assert_int_equal(diff("a.exr b.exr --json --map map.png", text, sizeof text), STATUS_OK);
    double flip = value_of(text, "flip", "raw");
    assert_int_equal(diff("a.exr b.exr --map map.exr", text, sizeof text), STATUS_OK);
    assert_int_equal(image_read(arena, path_of("map.png"), false, &colours, NULL), STATUS_OK);
    assert_int_equal(image_read(arena, path_of("map.exr"), false, &values, NULL), STATUS_OK);
    unlink(path_of("map.png"));
    unlink(path_of("map.exr"));
    assert_int_equal(values->channels_count, 1);
    double mean = 0;
    for (int i = 0; i < 24 * 16; i++)
        mean += (double)values->values[i] / (24 * 16);
    assert_true(fabs(mean - flip) < 1e-6);
    struct image *expected = map_to_image(arena, values->values, 24, 16, 1);
    for (int i = 0; i < 24 * 16 * 3; i++)
        assert_true(fabsf(expected->values[i] - colours->values[i]) < 0.5f / 255 + 1e-5f);
}

static void test_diff__wrong_use_is_told_in_one_line_and_an_exit_code(void **state)
{
    (void)state;
    const struct {
        const char *arguments;
        enum status status;
        const char *part;
    } cases[] = {
        {"a.exr", STATUS_USAGE, "give the test and its reference"},
        {"a.exr b.exr a.png", STATUS_USAGE, "'a.png' is too much"},
        {"a.exr small.exr", STATUS_INVALID,
         "a.exr, small.exr: the pictures differ in size: test 24 x 16, reference 8 x 8\n"},
        {"a.exr none.exr", STATUS_NOT_FOUND, "treeline: none.exr: No such file or directory\n"},
        {". b.exr", STATUS_INVALID, "treeline: .: is a folder, not a picture\n"},
        {"a.exr b.exr --map map.gif", STATUS_INVALID, "map.gif: pictures are written as"},
        {"a.exr b.exr --map none/map.png", STATUS_IO, "none/map.png: cannot be written"},
    };
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        char text[16384];
        int rc = diff(cases[k].arguments, text, sizeof text);
        if (rc != (int)cases[k].status || !strstr(text, cases[k].part) ||
            strchr(text, '\n') != text + strlen(text) - 1)
            fail_msg("diff %s: exit code %d: %s", cases[k].arguments, rc, text);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_diff__json_gives_value_raw_and_floor_of_every_metric),
        cmocka_unit_test(test_diff__the_table_lists_every_metric_and_no_coverage_without_alpha),
        cmocka_unit_test(test_diff__the_map_is_written_in_colours_or_as_values),
        cmocka_unit_test(test_diff__wrong_use_is_told_in_one_line_and_an_exit_code),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
