/* Runs on disk: torn and malformed lines, versions, locks, places that cannot be written. */
#include "any_result.h"

#include "base/file.h"

#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/wait.h>

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
    provenance = somewhere();
    provenance.settings = "--timeout 3 --threads 1";
    assert_int_equal(run_open(folder, &provenance, true, &error), STATUS_INVALID);
    assert_non_null(strstr(error.text, "with the defaults; --threads 1 cannot"));
    provenance.settings = "--timeout 9"; /* a limit may be raised */
    assert_int_equal(run_open(folder, &provenance, true, &error), STATUS_OK);
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

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_run__reads_back_what_was_appended),
        cmocka_unit_test(test_run__cut_anywhere_loses_at_most_the_last_line),
        cmocka_unit_test(test_run__what_is_no_run_is_refused_and_left_as_it_is),
        cmocka_unit_test(test_run__a_malformed_line_is_named_by_its_number),
        cmocka_unit_test(test_run__a_folder_with_a_run_is_refused_unless_resumed),
        cmocka_unit_test(test_run__the_lock_admits_one_process_and_ends_with_it),
        cmocka_unit_test(test_run__a_place_that_cannot_be_written_is_an_io_error),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
