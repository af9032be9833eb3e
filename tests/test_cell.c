/* Cells: what a child gives, how every bad end is classified, when a cell is warm. */
#include "testing.h"

#include "base/clock.h"
#include "base/file.h"
#include "cell/cell.h"
#include "cell/process.h"
#include "cell/warmup.h"

#include <dlfcn.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

/* A folder for a run's pictures, removed with all it holds. */
static int folder_setup(void **state)
{
    char *folder = strdup("/tmp/treeline-cell-XXXXXX");
    *state = folder;
    return mkdtemp(folder) ? 0 : -1;
}

static int folder_teardown(void **state)
{
    char command[128];
    snprintf(command, sizeof command, "rm -rf '%s'", (char *)*state);
    free(*state);
    return system(command);
}

static const char *plugin(struct arena *arena, const char *name)
{
    char program[4096];
    ssize_t length = readlink("/proc/self/exe", program, sizeof program - 1);
    assert_true(length > 0);
    program[length] = 0;
    *strrchr(program, '/') = 0;
    return arena_printf(arena, "%s/../plugins/%s.so", program, name);
}

/* The tests' plan: one short repetition, references that never stop a test. */
static struct plan *plan_of(struct arena *arena, const char *cell)
{
    struct plan *plan = NULL;
    struct error error = {0};
    struct plan_request request = {.cells = &cell,
                                   .cells_count = 1,
                                   .rounds = 2,
                                   .frame_seconds = 0.03,
                                   .frames_max = 30,
                                   .timeout_seconds = 60,
                                   .reference_error = 0.05,
                                   .reference_samples_max = 16,
                                   .views_count = 2};
    if (plan_load(arena, &request, &plan, &error))
        fail_msg("%s", error.text);
    return plan;
}

static const char *bad(struct arena *arena, const char *way)
{
    return arena_printf(arena, "tiny/%s:way=%s/trees=1/size=32x24", plugin(arena, "bad"), way);
}

static void test_cell__a_good_one_fills_what_it_measured(void **state)
{
    const char *folder = *state;
    struct arena *arena = arena_create(0);
    struct plan *plan = plan_of(arena, "tiny/null/trees=2/size=48x36");
    struct error error = {0};
    struct result result;
    assert_int_equal(cell_references(arena, plan, folder, true, &error), STATUS_OK);
    double start = clock_wall_seconds();
    if (cell_run(arena, plan, plan->cells, 0, folder, &result))
        fail_msg("%s", result.message);
    double wall = clock_wall_seconds() - start, sum = 0;
    assert_string_equal(result.message, "");
    assert_int_equal(result.instances, 2);
    assert_true(result.frames_count >= 1 && result.frames_count <= 30);
    for (size_t i = 0; i < result.frames_count; i++) {
        assert_true(result.frame_seconds[i] > 0);
        sum += result.frame_seconds[i];
    }
    assert_true(sum < wall && result.seconds <= wall);
    assert_true(result.first_frame_seconds > 0 && result.build_seconds > 0);
    bool slow = result.first_frame_seconds >= 4 * plan->frame_seconds; /* then nothing warms up */
    assert_true(result.warmup_frames >= (slow ? 1 : 2) && result.peak_bytes > 1e6);
    /* The target alone: 16-bit float RGBA and 32-bit depth. */
    assert_true(result.device_bytes >= 48 * 36 * (8 + 4));
    assert_true(result.draw_calls >= 1 && result.fragments >= 48 * 36);
    assert_true(result.plant_bytes == 0); /* null asks for no plant */
    assert_true(isnan(result.gpu_seconds_per_frame) || result.gpu_seconds_per_frame > 0);
    assert_string_equal(result.started + 19, strchr(result.started, '.'));
    assert_int_equal(result.views_count, 2);
    for (size_t i = 0; i < 2; i++) {
        const struct result_view *view = &result.views[i];
        assert_true(view->compared && view->same_key != view->full_key);
        assert_true(view->same.value.rmse > 0 && view->distance_m > 0);
        assert_true(file_exists(arena_printf(arena, "%s/%s", folder, view->picture)));
        assert_true(file_exists(arena_printf(arena, "%s/references/%016llx.frame", folder,
                                             (unsigned long long)view->full_key)));
    }
    assert_true(result.has_flicker);
    arena_destroy(arena);
}

static void test_cell__a_method_s_own_counts_are_those_of_a_picture(void **state)
{
    const char *folder = *state;
    struct arena *arena = arena_create(0);
    struct plan *plan =
        plan_of(arena, arena_printf(arena, "tiny/%s/trees=1/size=48x36", plugin(arena, "counts")));
    struct result result;
    if (cell_run(arena, plan, plan->cells, 0, folder, &result))
        fail_msg("%s", result.message);
    /* Two pictures, their neighbours and the timed frames do not add up. */
    assert_int_equal(result.views_count, 2);
    assert_true(result.rays == 48 * 36);
    assert_true(isnan(result.occlusion_rays) && result.lookups == 3 * 48 * 36);
    /* The picture of float RGBA is counted here. */
    assert_true(result.moved_bytes == 1000 + 48 * 36 * 16);
    plan = plan_of(arena, "tiny/null/trees=1/size=48x36/target=rgba8");
    assert_int_equal(cell_run(arena, plan, plan->cells, 0, folder, &result), STATUS_OK);
    assert_true(isnan(result.rays) && result.moved_bytes == 48 * 36 * 4);
    arena_destroy(arena);
}

static size_t lines_with(const char *path, const char *text)
{
    char *bytes;
    size_t size, count = 0;
    struct error error = {0};
    struct arena *arena = arena_create(0);
    if (file_read(arena, path, 0, &bytes, &size, &error))
        fail_msg("%s", error.text);
    for (const char *at = bytes; (at = strstr(at, text)); at++)
        count++;
    arena_destroy(arena);
    return count;
}

static void test_calibrate__each_round_has_its_own_and_only_once(void **state)
{
    const char *folder = *state;
    struct arena *arena = arena_create(0);
    struct plan *plan = plan_of(
        arena, arena_printf(arena, "tiny/%s/trees=1/size=128x128", plugin(arena, "honest-cpu")));
    struct error error = {0};
    struct provenance provenance = {.cores = 2};
    assert_int_equal(run_open(folder, &provenance, false, &error), STATUS_OK);
    const int rounds[] = {0, 3, 3, 0};
    for (size_t i = 0; i < 4; i++)
        if (cell_calibrate(arena, plan, folder, rounds[i], 0.01, &error))
            fail_msg("%s", error.text);
    const char *path = arena_printf(arena, "%s/cells.jsonl", folder);
    assert_int_equal(lines_with(path, "\"kind\":\"treeline-calibration\""), 2);
    assert_int_equal(lines_with(path, "\"round\":3,"), 1);
    arena_destroy(arena);
}

static void test_cell__later_repetitions_draw_the_same_bytes(void **state)
{
    const char *folder = *state;
    struct arena *arena = arena_create(0);
    struct plan *plan = plan_of(arena, "tiny/null/trees=1/size=32x24");
    struct result first, second;
    assert_int_equal(cell_run(arena, plan, plan->cells, 0, folder, &first), STATUS_OK);
    assert_int_equal(cell_run(arena, plan, plan->cells, 1, folder, &second), STATUS_OK);
    assert_string_equal(second.message, "");
    assert_int_equal(second.views_count, 1);
    assert_true(second.views[0].picture_hash == first.views[0].picture_hash);
    plan = plan_of(arena, bad(arena, "random"));
    assert_int_equal(cell_run(arena, plan, plan->cells, 0, folder, &first), STATUS_OK);
    assert_int_equal(cell_run(arena, plan, plan->cells, 1, folder, &second), STATUS_OK);
    assert_non_null(strstr(second.message, "differs"));
    arena_destroy(arena);
}

static void test_cell__without_references_it_runs_uncompared(void **state)
{
    const char *folder = *state;
    struct arena *arena = arena_create(0);
    struct plan *plan = plan_of(arena, bad(arena, "none"));
    struct result result;
    assert_int_equal(cell_run(arena, plan, plan->cells, 0, folder, &result), STATUS_OK);
    assert_false(result.views[0].compared);
    assert_non_null(strstr(result.message, "not compared"));
    assert_false(result.has_flicker);
    arena_destroy(arena);
}

static void test_cell__every_bad_end_has_its_status(void **state)
{
    const char *folder = *state;
    const struct {
        const char *way;
        enum status status;
        int signal;
        const char *message;
    } ends[] = {
        {"crash", STATUS_CRASH, SIGABRT, "in prepare: about to abort; crash in "},
        {"exit-0", STATUS_CRASH, 0, "exit code 0 in prepare"},
        {"exit-1", STATUS_CRASH, 0, "exit code 1 in prepare"},
        {"memory", STATUS_MEMORY, 0, "budget of 67108864"},
        {"nan", STATUS_BAD_PICTURE, 0, "picture 0: pixel x 0, y 0"},
        {"undrawn", STATUS_BAD_PICTURE, 0, "picture 0: pixel x 0, y 0"},
        {"gl-error", STATUS_GL, 0, "GL_INVALID_ENUM"},
        {"silent", STATUS_GL, 0, "gave no reason"},
        {"noisy", STATUS_OK, 0, ""},
        {"slow", STATUS_OK, 0, ""},
    };
    for (size_t i = 0; i < sizeof ends / sizeof *ends; i++) {
        struct arena *arena = arena_create(0);
        struct plan *plan = plan_of(arena, bad(arena, ends[i].way));
        struct result result;
        plan->memory_bytes = 64 << 20;
        enum status status = cell_run(arena, plan, plan->cells, 0, folder, &result);
        if (status != ends[i].status || result.signal != ends[i].signal ||
            !strstr(result.message, ends[i].message))
            fail_msg("%s: %s, signal %d, '%s'", ends[i].way, status_word(status), result.signal,
                     result.message);
        assert_int_equal(result.status, status);
        assert_string_equal(result.cell.name, plan->cells->name);
        arena_destroy(arena);
    }
}

static void test_cell__a_timeout_ends_it_even_when_it_blocks_the_alarm(void **state)
{
    const char *folder = *state;
    const char *ways[] = {"hang", "hang-hard"};
    for (int i = 0; i < 2; i++) {
        struct arena *arena = arena_create(0);
        struct plan *plan = plan_of(arena, bad(arena, ways[i]));
        struct result result;
        plan->timeout_seconds = 0.5;
        double start = clock_wall_seconds();
        assert_int_equal(cell_run(arena, plan, plan->cells, 0, folder, &result), STATUS_TIMEOUT);
        double spent = clock_wall_seconds() - start;
        assert_true(spent > 0.45 && spent < 4);
        assert_non_null(strstr(result.message, "0.5 s in "));
        assert_int_equal(result.signal, 0);
        arena_destroy(arena);
    }
}

static void test_cell__what_its_child_started_ends_with_it(void **state)
{
    const char *folder = *state;
    struct arena *arena = arena_create(0);
    struct plan *plan = plan_of(arena, bad(arena, "orphan"));
    struct result result;
    double start = clock_wall_seconds();
    assert_int_equal(cell_run(arena, plan, plan->cells, 0, folder, &result), STATUS_OK);
    assert_true(clock_wall_seconds() - start < 20);
    arena_destroy(arena);
}

static void test_cell__an_unsupported_scene_says_why(void **state)
{
    const char *folder = *state;
    struct arena *arena = arena_create(0);
    struct plan *plan =
        plan_of(arena, arena_printf(arena, "tiny/%s/trees=4", plugin(arena, "bad")));
    struct result result;
    assert_int_equal(cell_run(arena, plan, plan->cells, 0, folder, &result), STATUS_UNSUPPORTED);
    assert_non_null(strstr(result.message, "four trees are too many"));
    arena_destroy(arena);
}

static void test_cell__a_plugin_of_another_abi_is_refused(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct error error = {0};
    struct cell cell;
    const char *name = arena_printf(arena, "tiny/%s", plugin(arena, "old"));
    assert_int_equal(cell_parse(arena, name, &cell, &error), STATUS_INVALID);
    assert_non_null(strstr(error.text, "ABI 1; this treeline has "));
    arena_destroy(arena);
}

static void test_cell__an_interrupt_stops_it_at_once(void **state)
{
    const char *folder = *state;
    struct arena *arena = arena_create(0);
    struct plan *plan = plan_of(arena, bad(arena, "hang"));
    struct result result;
    pid_t parent = getpid(), pid = fork();
    if (!pid) {
        usleep(400000);
        kill(parent, SIGINT);
        _exit(0);
    }
    double start = clock_wall_seconds();
    enum status status = cell_run(arena, plan, plan->cells, 0, folder, &result);
    waitpid(pid, NULL, 0);
    assert_int_equal(status, STATUS_INTERRUPTED);
    assert_true(clock_wall_seconds() - start < 10);
    arena_destroy(arena);
}

static void test_cell__the_budget_counts_only_the_methods_memory(void **state)
{
    const char *folder = *state;
    struct arena *arena = arena_create(0);
    struct plan *plan = plan_of(arena, "tiny/null/trees=4/size=512x512");
    struct result result;
    plan->memory_bytes = 1 << 16; /* less than one picture */
    if (cell_run(arena, plan, plan->cells, 0, folder, &result))
        fail_msg("%s", result.message);
    assert_true(result.host_bytes <= 1 << 16);
    arena_destroy(arena);
}

static enum status says_and_waits(void *context, int out)
{
    dprintf(out, "one\ntwo\nthree");
    fprintf(stderr, "first\nlast words\n\n");
    printf("on stdout\n");
    return *(enum status *)context;
}

static void count_lines(void *listener, const char *line)
{
    assert_true(!strcmp(line, "one") || !strcmp(line, "two"));
    ++*(int *)listener;
}

static void test_process__hears_lines_and_keeps_the_last_words(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct error error;
    struct process_outcome outcome;
    enum status status = STATUS_GL;
    int lines = 0;
    struct process_request request = {
        .work = says_and_waits, .context = &status, .heard = count_lines, .listener = &lines};
    assert_int_equal(process_run(arena, &request, &outcome, &error), STATUS_OK);
    assert_int_equal(lines, 2);
    assert_int_equal(outcome.exit_code, STATUS_GL);
    assert_string_equal(outcome.output, "one\ntwo\nthree");
    assert_string_equal(outcome.errors, "on stdout");
    arena_destroy(arena);
}

/* Not static: a crash in it can name it. */
enum status touches_nothing(void *context, int out);
enum status touches_nothing(void *context, int out)
{
    dprintf(STDERR_FILENO, "about to touch %d\n", out > 0 ? 1 : 0);
    *(volatile int *)context = 1;
    return STATUS_OK;
}

static void test_process__a_crash_tells_where(void **state)
{
    (void)state;
    if (dlsym(RTLD_DEFAULT, "__asan_init"))
        skip(); /* it tells of crashes itself */
    struct arena *arena = arena_create(0);
    struct error error;
    struct process_outcome outcome;
    struct process_request request = {.work = touches_nothing, .context = (void *)0xbad0};
    void (*before)(int) = signal(SIGSEGV, SIG_DFL); /* cmocka has its own */
    enum status status = process_run(arena, &request, &outcome, &error);
    signal(SIGSEGV, before);
    assert_int_equal(status, STATUS_OK);
    assert_int_equal(outcome.signal, SIGSEGV);
    static const char start[] = "about to touch 1; crash at address 0xbad0 in test_cell+0x";
    if (strncmp(outcome.errors, start, strlen(start)) != 0 ||
        !strstr(outcome.errors, " (touches_nothing), ") ||
        !strstr(outcome.errors, " (process_run), "))
        fail_msg("%s", outcome.errors);
    arena_destroy(arena);
}

static enum status writes_much(void *context, int out)
{
    (void)context;
    for (int i = 0; i < 20000; i++)
        dprintf(out, "%0100d\n", i);
    return STATUS_OK;
}

static void test_process__takes_more_than_a_pipe_holds(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct error error;
    struct process_outcome outcome;
    struct process_request request = {.work = writes_much};
    assert_int_equal(process_run(arena, &request, &outcome, &error), STATUS_OK);
    assert_int_equal(strlen(outcome.output), 20000 * 101);
    arena_destroy(arena);
}

static void test_warmup__waits_while_the_time_falls(void **state)
{
    (void)state;
    double falling[WARMUP_FRAMES_MAX], flat[WARMUP_FRAMES_MAX];
    for (int i = 0; i < WARMUP_FRAMES_MAX; i++) {
        falling[i] = pow(0.9, i);
        flat[i] = 1e-3;
    }
    for (size_t n = 0; n < WARMUP_FRAMES_MAX; n++)
        assert_false(warmup_done(falling, n, 1e9));
    assert_true(warmup_done(falling, WARMUP_FRAMES_MAX, 1e9));
    for (size_t n = 0; n < 2 * WARMUP_WINDOW; n++)
        assert_false(warmup_done(flat, n, 1e9));
    assert_true(warmup_done(flat, 2 * WARMUP_WINDOW, 1e9));
}

static void test_warmup__one_outlier_does_not_change_the_answer(void **state)
{
    (void)state;
    for (size_t at = 0; at < 2 * WARMUP_WINDOW; at++) {
        double seconds[2 * WARMUP_WINDOW];
        for (size_t i = 0; i < 2 * WARMUP_WINDOW; i++)
            seconds[i] = i == at ? 1 : 1e-3;
        assert_true(warmup_done(seconds, 2 * WARMUP_WINDOW, 1e9));
        for (size_t i = 0; i < 2 * WARMUP_WINDOW; i++)
            seconds[i] = i == at ? 1 : i < WARMUP_WINDOW ? 2e-3 : 1e-3;
        assert_false(warmup_done(seconds, 2 * WARMUP_WINDOW, 1e9));
    }
}

static void test_warmup__is_bounded_in_time(void **state)
{
    (void)state;
    double seconds[] = {3, 2, 1};
    assert_false(warmup_done(seconds, 0, 2));
    assert_true(warmup_done(seconds, 1, 2));
    assert_false(warmup_done(seconds, 1, 4));
    assert_true(warmup_done(seconds, 2, 4));
}

#define cmocka_unit_test_in_folder(test)                                                           \
    cmocka_unit_test_setup_teardown(test, folder_setup, folder_teardown)

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_warmup__waits_while_the_time_falls),
        cmocka_unit_test(test_warmup__one_outlier_does_not_change_the_answer),
        cmocka_unit_test(test_warmup__is_bounded_in_time),
        cmocka_unit_test(test_process__hears_lines_and_keeps_the_last_words),
        cmocka_unit_test(test_process__a_crash_tells_where),
        cmocka_unit_test(test_process__takes_more_than_a_pipe_holds),
        cmocka_unit_test_in_folder(test_cell__a_good_one_fills_what_it_measured),
        cmocka_unit_test_in_folder(test_cell__a_method_s_own_counts_are_those_of_a_picture),
        cmocka_unit_test_in_folder(test_calibrate__each_round_has_its_own_and_only_once),
        cmocka_unit_test_in_folder(test_cell__later_repetitions_draw_the_same_bytes),
        cmocka_unit_test_in_folder(test_cell__without_references_it_runs_uncompared),
        cmocka_unit_test_in_folder(test_cell__every_bad_end_has_its_status),
        cmocka_unit_test_in_folder(test_cell__a_timeout_ends_it_even_when_it_blocks_the_alarm),
        cmocka_unit_test_in_folder(test_cell__what_its_child_started_ends_with_it),
        cmocka_unit_test_in_folder(test_cell__an_unsupported_scene_says_why),
        cmocka_unit_test(test_cell__a_plugin_of_another_abi_is_refused),
        cmocka_unit_test_in_folder(test_cell__an_interrupt_stops_it_at_once),
        cmocka_unit_test_in_folder(test_cell__the_budget_counts_only_the_methods_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
