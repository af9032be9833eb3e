/* base/: status, error, arena, option table, random numbers, hashes, files, cache, nearest name. */
#include "testing.h"

#include "base/arena.h"
#include "base/clock.h"
#include "base/file.h"
#include "base/hash.h"
#include "base/nearest.h"
#include "base/option.h"
#include "base/random.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

static void test_status__every_word_leads_back_to_its_code(void **unused)
{
    (void)unused;
    enum status status;
#define CHECK(name, code, word, meaning)                                                           \
    assert_true(status_from_word(word, &status));                                                  \
    assert_int_equal(status, code);                                                                \
    assert_string_equal(status_word(name), word);                                                  \
    assert_string_equal(status_meaning(name), meaning);                                            \
    assert_true(code == 0 || code >= 64);
    STATUS_LIST(CHECK)
#undef CHECK
    assert_false(status_from_word("fine", &status));
    assert_string_equal(status_word((enum status)1), "unknown");
}

static void test_error__context_stands_before_the_text_and_newlines_go(void **unused)
{
    (void)unused;
    struct error error;
    assert_int_equal(error_set(&error, STATUS_INVALID, "a\nb %d", 7), STATUS_INVALID);
    assert_int_equal(error_context(&error, "file %s", "x.json"), STATUS_INVALID);
    assert_string_equal(error.text, "file x.json: a b 7");
    errno = ENOENT;
    assert_int_equal(error_errno(&error, STATUS_IO, "y"), STATUS_IO);
    assert_string_equal(error.text, "y: No such file or directory");
    assert_int_equal(error_set(NULL, STATUS_GL, "nobody listens"), STATUS_GL);
}

static void test_error__an_over_long_text_ends_in_dots(void **unused)
{
    (void)unused;
    struct error error;
    char text[4000];
    memset(text, 'x', sizeof text - 1);
    text[sizeof text - 1] = 0;
    error_set(&error, STATUS_INVALID, "%s", text);
    assert_int_equal(strlen(error.text), sizeof error.text - 1);
    assert_string_equal(error.text + sizeof error.text - 5, "x...");
    error_context(&error, "%s", text);
    assert_int_equal(strlen(error.text), sizeof error.text - 1);
}

struct ended {
    char *text; /* grows by name when it ends */
    char name;
};

static void note_end(void *thing)
{
    const struct ended *ended = thing;
    ended->text[strlen(ended->text)] = ended->name;
}

static void test_arena__ends_what_it_was_given_newest_first_while_it_still_holds(void **state)
{
    (void)state;
    char text[4] = "";
    struct arena *arena = arena_create(0);
    for (int i = 0; i < 3; i++) {
        struct ended *ended = ARENA_NEW(arena, struct ended);
        *ended = (struct ended){text, (char)('a' + i)};
        arena_at_end(arena, note_end, ended);
    }
    assert_string_equal(text, "");
    arena_destroy(arena);
    assert_string_equal(text, "cba");
}

static void test_arena__memory_is_zero_aligned_apart_and_counted(void **unused)
{
    (void)unused;
    struct arena *arena = arena_create(0);
    unsigned char *blocks[300];
    size_t sizes[300], asked = 0;
    for (size_t i = 0; i < 300; i++) {
        sizes[i] = i * i * 7 % 5000 + (i == 200 ? 3000000 : 0);
        blocks[i] = arena_alloc(arena, sizes[i], 1);
        assert_int_equal((uintptr_t)blocks[i] % 64, 0);
        for (size_t k = 0; k < sizes[i]; k++)
            if (blocks[i][k] != 0)
                fail_msg("byte %zu of block %zu is not zero", k, i);
        memset(blocks[i], (int)(i & 255), sizes[i]);
        asked += sizes[i];
    }
    for (size_t i = 0; i < 300; i++)
        for (size_t k = 0; k < sizes[i]; k++)
            if (blocks[i][k] != (i & 255))
                fail_msg("block %zu was overwritten", i);
    assert_true(arena_used_bytes(arena) >= asked);
    assert_true(arena_used_bytes(arena) <= asked + 300 * 64);
    assert_string_equal(arena_printf(arena, "%d-%s", 4, "x"), "4-x");
    arena_destroy(arena);
    arena_destroy(NULL);
}

static int exit_code_of_alloc(size_t budget, size_t count, size_t size)
{
    fflush(NULL);
    pid_t child = fork();
    if (child == 0) {
        close(STDERR_FILENO);
        struct arena *arena = arena_create(budget);
        arena_alloc(arena, count, size);
        _Exit(0);
    }
    int status;
    waitpid(child, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

/* The address sanitizer's, where there is one. */
int __asan_address_is_poisoned(const volatile void *address) __attribute__((weak));

static void test_arena__what_was_not_asked_for_is_fenced_under_the_sanitizer(void **unused)
{
    (void)unused;
    bool fenced = __asan_address_is_poisoned != NULL;
    static const size_t sizes[] = {0, 1, 63, 64, 65, 4096, 1 << 18, (1 << 18) + 1, 3 << 20};
    struct arena *arena = arena_create(0);
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
        char *memory = arena_alloc(arena, sizes[i], 1);
        memset(memory, 1, sizes[i]);
        if (fenced && !__asan_address_is_poisoned(memory + sizes[i]))
            fail_msg("the byte behind %zu may be touched", sizes[i]);
    }
    arena_destroy(arena);
}

static void test_arena__over_budget_and_overflow_end_the_process_as_memory(void **unused)
{
    (void)unused;
    assert_int_equal(exit_code_of_alloc(1024, 960, 1), 0);
    assert_int_equal(exit_code_of_alloc(1024, 1024, 1), 0);
    assert_int_equal(exit_code_of_alloc(1024, 1025, 1), STATUS_MEMORY);
    assert_int_equal(exit_code_of_alloc(0, SIZE_MAX / 2, 3), STATUS_MEMORY);
    assert_int_equal(exit_code_of_alloc(0, 1, SIZE_MAX / 2), STATUS_MEMORY);
}

struct options {
    bool fast;
    int slices;
    float gain;
    double angle;
    int alpha;
};
static const struct option table[] = {
    OPTION(struct options, fast, 1, 0, 1, "", "be fast"),
    OPTION(struct options, slices, 64, 1, 512, "", "slices"),
    OPTION(struct options, gain, 0.1, 0, 1, "", "gain"),
    OPTION(struct options, angle, 0.25, -3, 3, "rad", "angle"),
    OPTION_WORD(struct options, alpha, 1, "blend|test|coverage", "alpha"),
    OPTION_END,
};

static void test_option__defaults_come_from_the_table_and_print_as_nothing(void **unused)
{
    (void)unused;
    struct options options;
    char text[64];
    options_default(table, &options);
    assert_true(options.fast);
    assert_int_equal(options.slices, 64);
    assert_true(options.gain == 0.1f && options.angle == 0.25 && options.alpha == 1);
    assert_int_equal(options_print(table, &options, text, sizeof text), 0);
    assert_string_equal(text, "");
    options_default(NULL, NULL);
}

static void test_option__text_goes_in_and_the_canonical_text_comes_out(void **unused)
{
    (void)unused;
    struct options options, again;
    struct error error;
    char text[128], small[8];
    options_default(table, &options);
    options_default(table, &again);
    assert_int_equal(options_parse(table, "alpha=coverage,slices=7,fast=off,gain=0.3,angle=-1e-3",
                                   &options, &error),
                     STATUS_OK);
    size_t needed = options_print(table, &options, text, sizeof text);
    assert_string_equal(text, "fast=off,slices=7,gain=0.3,angle=-0.001,alpha=coverage");
    assert_int_equal(needed, strlen(text));
    assert_int_equal(options_parse(table, text, &again, &error), STATUS_OK);
    assert_true(again.fast == options.fast && again.slices == options.slices &&
                again.gain == options.gain && again.angle == options.angle &&
                again.alpha == options.alpha);
    options.gain = 1;
    options.angle = 300;
    options_print(table + 2, &options, text, sizeof text);
    assert_string_equal(text, "gain=1,angle=300,alpha=coverage"); /* not 3e+02 */
    options.gain = 0.3f;
    options.angle = -1e-3;
    assert_int_equal(options_print(table, &options, small, sizeof small), needed);
    assert_int_equal(strlen(small), 7);
}

static void test_option__bad_values_name_option_value_and_allowance(void **unused)
{
    (void)unused;
    static const struct {
        const char *text, *message;
    } cases[] = {
        {"slices=900", "slices: '900' is outside 1..512"},
        {"slices=0", "slices: '0' is outside 1..512"},
        {"slices=1.5", "slices: '1.5' is not a whole number in 1..512"},
        {"slices=x", "slices: 'x' is not a whole number in 1..512"},
        {"gain=nan", "gain: 'nan' is not a number in 0..1"},
        {"gain=", "gain: '' is not a number in 0..1"},
        {"gain=inf", "gain: 'inf' is outside 0..1"},
        {"fast=maybe", "fast: 'maybe' is not one of on|off"},
        {"alpha=blen", "alpha: 'blen' is not one of blend|test|coverage"},
        {"slices", "option 'slices' has no value; write slices=VALUE"},
        {"slice=3",
         "no option 'slice'; did you mean 'slices'? options are fast, slices, gain, angle, alpha"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct options options;
        struct error error = {0};
        options_default(table, &options);
        assert_int_equal(options_parse(table, cases[i].text, &options, &error), STATUS_INVALID);
        assert_string_equal(error.text, cases[i].message);
    }
}

static void test_random__first_numbers_are_those_of_the_reference_demo(void **unused)
{
    (void)unused;
    /* pcg32-demo of O'Neill's distribution, seed 42, stream 54, round 1. */
    static const uint32_t demo[] = {0xa15c02b7, 0x7b47f409, 0xba1d3330,
                                    0x83d2f293, 0xbfa4784b, 0xcbed606e};
    struct random random = random_seed(42, 54);
    for (size_t i = 0; i < 6; i++)
        assert_int_equal(random_u32(&random), demo[i]);
}

static void test_random__floats_fill_the_unit_interval_evenly(void **unused)
{
    (void)unused;
    struct random random = random_seed(1, 2);
    double sum = 0, square = 0;
    int bins[10] = {0};
    enum { COUNT = 100000 };
    for (int i = 0; i < COUNT; i++) {
        double x = i % 2 ? (double)random_float(&random) : random_double(&random);
        assert_true(x >= 0 && x < 1);
        sum += x;
        square += x * x;
        bins[(int)(x * 10)]++;
    }
    assert_true(fabs(sum / COUNT - 0.5) < 5 * 0.2887 / sqrt(COUNT));
    assert_true(fabs(square / COUNT - 1.0 / 3) < 5 * 0.2981 / sqrt(COUNT));
    double chi2 = 0;
    for (int i = 0; i < 10; i++)
        chi2 += pow(bins[i] - COUNT / 10.0, 2) / (COUNT / 10.0);
    assert_true(chi2 < 33.7); /* 9 degrees of freedom, p = 1e-4 */
}

static void test_random__below_stays_below_and_zero_is_allowed(void **unused)
{
    (void)unused;
    struct random random = random_seed(3, 4);
    int seen[7] = {0};
    for (int i = 0; i < 7000; i++)
        seen[random_below(&random, 7)]++;
    for (int i = 0; i < 7; i++)
        assert_in_range(seen[i], 850, 1150);
    assert_int_equal(random_below(&random, 0), 0);
    assert_int_equal(random_below(&random, 1), 0);
    for (int i = 0; i < 1000; i++)
        assert_true(random_below(&random, 0xC0000000u) < 0xC0000000u);
}

static void test_hash__order_length_and_seed_matter_and_zero_has_one_sign(void **unused)
{
    (void)unused;
    assert_true(hash_text(0, "ab") != hash_text(0, "ba"));
    assert_true(hash_text(hash_text(0, "a"), "bc") != hash_text(hash_text(0, "ab"), "c"));
    assert_true(hash_text(0, "a") != hash_text(1, "a"));
    assert_true(hash_text(0, NULL) == hash_text(0, ""));
    assert_true(hash_double(0, -0.0) == hash_double(0, 0.0));
    assert_true(hash_double(0, 1) != hash_double(0, 2));
}

static char folder[] = "/tmp/treeline-test-XXXXXX";

static int folder_make(void **unused)
{
    (void)unused;
    return mkdtemp(folder) ? 0 : -1;
}

static int folder_remove(void **unused)
{
    (void)unused;
    char command[128];
    snprintf(command, sizeof command, "rm -rf '%s'", folder);
    return system(command);
}

static const char *in_folder(const char *name)
{
    static char path[256];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    return path;
}

static void test_file__what_is_written_is_read_and_appended(void **unused)
{
    (void)unused;
    struct arena *arena = arena_create(0);
    struct error error;
    char *text;
    size_t size;
    assert_int_equal(file_make_folder(in_folder("a/b/c"), &error), STATUS_OK);
    assert_int_equal(file_make_folder(in_folder("a/b/c"), &error), STATUS_OK);
    assert_int_equal(file_write(in_folder("a/b/c/x"), "one\n", 4, &error), STATUS_OK);
    assert_int_equal(file_append(in_folder("a/b/c/x"), "two\n", 4, &error), STATUS_OK);
    assert_int_equal(file_read(arena, in_folder("a/b/c/x"), 0, &text, &size, &error), STATUS_OK);
    assert_int_equal(size, 8);
    assert_string_equal(text, "one\ntwo\n");
    assert_int_equal(file_read(arena, in_folder("a/b/c/x"), 7, &text, &size, &error),
                     STATUS_INVALID);
    arena_destroy(arena);
}

static void test_path__an_ending_needs_a_name_before_it_and_the_stem_is_between(void **unused)
{
    (void)unused;
    assert_true(path_ends_with("trees/Oak.OBJ", ".obj"));
    assert_false(path_ends_with("oak.objx", ".obj"));
    assert_false(path_ends_with("oakobj", ".obj"));
    assert_false(path_ends_with(".obj", ".obj"));
    assert_false(path_ends_with("trees/.obj", ".obj"));
    assert_false(path_ends_with("", ".obj"));
    struct arena *arena = arena_create(0);
    assert_string_equal(path_stem(arena, "a.b/Oak.old.obj"), "Oak.old");
    assert_string_equal(path_stem(arena, "a.b/oak"), "oak");
    assert_string_equal(path_stem(arena, ".hidden"), ".hidden");
    arena_destroy(arena);
}

static void test_file__folders_missing_files_and_full_disks_are_told(void **unused)
{
    (void)unused;
    struct arena *arena = arena_create(0);
    struct error error;
    char *text;
    size_t size;
    assert_int_equal(file_read(arena, folder, 0, &text, &size, &error), STATUS_INVALID);
    assert_non_null(strstr(error.text, "is not a regular file"));
    assert_int_equal(file_read(arena, in_folder("none"), 0, &text, &size, &error),
                     STATUS_NOT_FOUND);
    assert_non_null(strstr(error.text, "none"));
    assert_int_equal(file_append("/dev/full", "x", 1, &error), STATUS_IO);
    assert_non_null(strstr(error.text, "No space left"));
    assert_int_equal(file_write(in_folder("plain"), "", 0, &error), STATUS_OK);
    assert_int_equal(file_make_folder(in_folder("plain/below"), &error), STATUS_IO);
    arena_destroy(arena);
}

static void test_cache__gives_back_what_was_put_and_nothing_torn(void **unused)
{
    (void)unused;
    struct arena *arena = arena_create(0);
    void *data;
    size_t size, removed;
    setenv("TREELINE_CACHE", in_folder("cache"), 1);
    assert_false(cache_get(arena, "slice", 7, &data, &size));
    cache_put("slice", 7, "hello", 5);
    assert_true(cache_get(arena, "slice", 7, &data, &size));
    assert_int_equal(size, 5);
    assert_memory_equal(data, "hello", 5);
    assert_int_equal((uintptr_t)data % 64, 0);
    assert_false(cache_get(arena, "slice", 8, &data, &size));
    const char *path = in_folder("cache/slice-0000000000000007");
    assert_int_equal(truncate(path, 27), 0);
    assert_false(cache_get(arena, "slice", 7, &data, &size));
    cache_put("slice", 7, "hello", 5);
    int file = open(in_folder("cache/slice-0000000000000007"), O_WRONLY);
    assert_int_equal(pwrite(file, "J", 1, 24), 1); /* same size, another content */
    close(file);
    assert_false(cache_get(arena, "slice", 7, &data, &size));
    cache_put("slice", 9, "", 0);
    assert_int_equal(cache_trim(0, &removed, NULL), STATUS_OK);
    assert_true(removed > 0);
    assert_false(cache_get(arena, "slice", 9, &data, &size));
    setenv("TREELINE_CACHE", "off", 1);
    cache_put("slice", 7, "hello", 5);
    assert_false(cache_get(arena, "slice", 7, &data, &size));
    arena_destroy(arena);
}

static void test_cache__the_oldest_go_first(void **unused)
{
    (void)unused;
    struct arena *arena = arena_create(0);
    void *data;
    size_t size;
    setenv("TREELINE_CACHE", in_folder("trim"), 1);
    char block[1000] = {0};
    for (uint64_t i = 0; i < 4; i++) {
        char name[64];
        cache_put("k", i, block, sizeof block);
        snprintf(name, sizeof name, "trim/k-%016llx", (unsigned long long)i);
        struct timespec times[2] = {{.tv_sec = (time_t)(1000 + i)}, {.tv_sec = (time_t)(1000 + i)}};
        utimensat(AT_FDCWD, in_folder(name), times, 0);
    }
    assert_int_equal(cache_trim(2100, NULL, NULL), STATUS_OK);
    assert_false(cache_get(arena, "k", 0, &data, &size));
    assert_false(cache_get(arena, "k", 1, &data, &size));
    assert_true(cache_get(arena, "k", 2, &data, &size));
    assert_true(cache_get(arena, "k", 3, &data, &size));
    arena_destroy(arena);
}

static void test_nearest__is_the_smallest_edit_distance(void **unused)
{
    (void)unused;
    static const char *const names[] = {"polygons", "billboards", "cross-quads", "null"};
    const char *best = NULL;
    for (size_t i = 0; i < 4; i++)
        best = nearest_of("bilboard", best, names[i]);
    assert_string_equal(best, "billboards");
    assert_string_equal(nearest_of("", "ab", "a"), "a");
}

static void test_clock__moves_forward_and_counts_cpus(void **unused)
{
    (void)unused;
    double wall = clock_wall_seconds(), cpu = clock_cpu_seconds();
    volatile double sum = 0; /* work that cannot be left out */
    for (int i = 0; i < 3000000; i++)
        sum = sum + i;
    assert_true(clock_wall_seconds() > wall && clock_cpu_seconds() > cpu);
    assert_in_range(clock_cpu_count(), 1, 4096);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_status__every_word_leads_back_to_its_code),
        cmocka_unit_test(test_error__context_stands_before_the_text_and_newlines_go),
        cmocka_unit_test(test_error__an_over_long_text_ends_in_dots),
        cmocka_unit_test(test_arena__ends_what_it_was_given_newest_first_while_it_still_holds),
        cmocka_unit_test(test_arena__memory_is_zero_aligned_apart_and_counted),
        cmocka_unit_test(test_arena__what_was_not_asked_for_is_fenced_under_the_sanitizer),
        cmocka_unit_test(test_arena__over_budget_and_overflow_end_the_process_as_memory),
        cmocka_unit_test(test_option__defaults_come_from_the_table_and_print_as_nothing),
        cmocka_unit_test(test_option__text_goes_in_and_the_canonical_text_comes_out),
        cmocka_unit_test(test_option__bad_values_name_option_value_and_allowance),
        cmocka_unit_test(test_random__first_numbers_are_those_of_the_reference_demo),
        cmocka_unit_test(test_random__floats_fill_the_unit_interval_evenly),
        cmocka_unit_test(test_random__below_stays_below_and_zero_is_allowed),
        cmocka_unit_test(test_hash__order_length_and_seed_matter_and_zero_has_one_sign),
        cmocka_unit_test(test_file__what_is_written_is_read_and_appended),
        cmocka_unit_test(test_path__an_ending_needs_a_name_before_it_and_the_stem_is_between),
        cmocka_unit_test(test_file__folders_missing_files_and_full_disks_are_told),
        cmocka_unit_test(test_cache__gives_back_what_was_put_and_nothing_torn),
        cmocka_unit_test(test_cache__the_oldest_go_first),
        cmocka_unit_test(test_nearest__is_the_smallest_edit_distance),
        cmocka_unit_test(test_clock__moves_forward_and_counts_cpus),
    };
    return cmocka_run_group_tests(tests, folder_make, folder_remove);
}
