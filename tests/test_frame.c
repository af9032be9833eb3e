/* Frames: their raw file and every way it can be damaged, their checks, their pictures on disk. */
#include "testing.h"

#include "base/file.h"
#include "base/hash.h"
#include "base/random.h"
#include "truth/frame_image.h"

#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

static struct arena *arena;
static char folder[] = "/tmp/treeline-frame-XXXXXX";

static int set_up(void **state)
{
    (void)state;
    arena = arena_create(0);
    return mkdtemp(folder) ? 0 : -1;
}

static int tear_down(void **state)
{
    (void)state;
    rmdir(folder);
    arena_destroy(arena);
    return 0;
}

static char *path_of(const char *name)
{
    return arena_printf(arena, "%s/%s", folder, name);
}

static struct frame *random_frame(int width_px, int height_px, bool with_variance)
{
    struct frame *frame = frame_create(arena, width_px, height_px, with_variance);
    struct random random = random_seed(5, 5);
    for (int i = 0; i < width_px * height_px * 4; i++) {
        frame->rgba[i] = i % 4 == 3 ? random_float(&random) : random_float(&random) * 3 - 0.5f;
        if (with_variance)
            frame->variance[i] = random_float(&random) * 1e-3f;
    }
    return frame;
}

static void assert_same(const struct frame *a, const struct frame *b)
{
    size_t bytes = (size_t)a->width_px * (size_t)a->height_px * 4 * sizeof(float);
    assert_int_equal(a->width_px, b->width_px);
    assert_int_equal(a->height_px, b->height_px);
    assert_memory_equal(a->rgba, b->rgba, bytes);
    assert_int_equal(a->variance != NULL, b->variance != NULL);
    if (a->variance)
        assert_memory_equal(a->variance, b->variance, bytes);
}

/* The raw file */

static void test_frame__what_is_saved_is_loaded(void **state)
{
    (void)state;
    char *path = path_of("a.frame");
    for (int with_variance = 0; with_variance < 2; with_variance++) {
        struct frame *frame = random_frame(7, 5, with_variance), *back;
        struct error error;
        assert_int_equal(frame_save(frame, path, &error), STATUS_OK);
        assert_int_equal(frame_load(arena, path, &back, &error), STATUS_OK);
        assert_same(frame, back);
        struct stat about;
        assert_int_equal(stat(path, &about), 0);
        assert_int_equal(about.st_size, 20 + 7 * 5 * 16 * (1 + with_variance) + 8);
    }
    unlink(path);
}

static enum status unpack_error(const void *data, size_t size, char *text)
{
    struct frame *frame;
    struct error error = {0};
    /* An own block of exactly this size, so that the address sanitizer sees a byte too many. */
    unsigned char *copy = malloc(size ? size : 1);
    memcpy(copy, data, size);
    enum status status = frame_unpack(arena, copy, size, "x.frame", &frame, &error);
    free(copy);
    strcpy(text, error.text);
    return status;
}

static void test_frame__a_file_cut_anywhere_is_refused(void **state)
{
    (void)state;
    size_t size;
    char text[1024];
    unsigned char *data = frame_pack(arena, random_frame(3, 2, true), &size);
    for (size_t length = 0; length < size; length++) {
        assert_int_equal(unpack_error(data, length, text), STATUS_INVALID);
        assert_non_null(strstr(text, "x.frame: "));
    }
    unsigned char *longer = arena_alloc(arena, size + 1, 1);
    memcpy(longer, data, size);
    assert_int_equal(unpack_error(longer, size + 1, text), STATUS_INVALID);
}

static void test_frame__a_file_with_any_byte_changed_is_refused(void **state)
{
    (void)state;
    size_t size;
    char text[1024];
    unsigned char *data = frame_pack(arena, random_frame(3, 2, true), &size);
    for (size_t i = 0; i < size; i++) {
        data[i] ^= 0x10;
        assert_int_equal(unpack_error(data, size, text), STATUS_INVALID);
        data[i] ^= 0x10;
    }
    assert_int_equal(unpack_error(data, size, text), STATUS_OK);
}

/* A file with this header whose hash is right. */
static enum status forged(int32_t width, int32_t height, int32_t flags, char *text)
{
    unsigned char data[20 + 16 + 8] = "TLFRAME1";
    int32_t header[3] = {width, height, flags};
    memcpy(data + 8, header, sizeof header);
    uint64_t hash = hash_bytes(0, data, 36);
    memcpy(data + 36, &hash, 8);
    return unpack_error(data, sizeof data, text);
}

static void test_frame__absurd_headers_with_a_right_hash_are_refused(void **state)
{
    (void)state;
    char text[1024];
    assert_int_equal(forged(1, 1, 0, text), STATUS_OK);
    const int32_t sizes[][2] = {{0, 1},          {1, 0},         {-1, 1},
                                {INT32_MIN, -1}, {INT32_MAX, 1}, {INT32_MAX, INT32_MAX},
                                {32768, 32768},  {65536, 65536}, {1 << 30, 4}};
    for (size_t k = 0; k < sizeof sizes / sizeof *sizes; k++) {
        assert_int_equal(forged(sizes[k][0], sizes[k][1], 0, text), STATUS_INVALID);
        assert_non_null(strstr(text, " is outside 1..32768 px a side, 67108864 px in all"));
    }
    unsigned char padded[20 + 16 + 4 + 8] = "TLFRAME1";
    padded[8] = padded[12] = 1;
    uint64_t hash = hash_bytes(0, padded, 40);
    memcpy(padded + 40, &hash, 8);
    assert_int_equal(unpack_error(padded, sizeof padded, text), STATUS_INVALID);
    assert_string_equal(text, "x.frame: 48 bytes; a frame of 1 x 1 has 44 (cut off, or padded)");
    assert_int_equal(forged(1, 1, 2, text), STATUS_INVALID);
    assert_string_equal(text, "x.frame: flags 2 are not 0 or 1");
    assert_int_equal(forged(1, 1, 1, text), STATUS_INVALID);        /* variance is missing */
    assert_int_equal(forged(32768, 1024, 0, text), STATUS_INVALID); /* allowed, but not there */
    assert_non_null(strstr(text, "44 bytes; a frame of 32768 x 1024 has 536870940"));
}

static void test_frame__missing_files_folders_and_text_are_refused_by_name(void **state)
{
    (void)state;
    struct frame *frame;
    struct error error;
    assert_int_equal(frame_load(arena, path_of("none.frame"), &frame, &error), STATUS_NOT_FOUND);
    assert_non_null(strstr(error.text, "none.frame"));
    assert_int_equal(frame_load(arena, folder, &frame, &error), STATUS_INVALID);
    assert_non_null(strstr(error.text, folder));
    char *path = path_of("text.frame");
    assert_int_equal(file_write(path, "a text that is longer than a header\n", 36, &error), 0);
    assert_int_equal(frame_load(arena, path, &frame, &error), STATUS_INVALID);
    assert_non_null(strstr(error.text, "not a frame file (no TLFRAME1 at its start)"));
    unlink(path);
    assert_int_equal(frame_save(random_frame(2, 2, false), "/proc/none/a.frame", &error),
                     STATUS_IO);
    assert_non_null(strstr(error.text, "/proc/none/a.frame"));
}

static void test_frame__a_full_disk_leaves_no_half_file(void **state)
{
    (void)state;
    char *path = path_of("full.frame");
    struct rlimit before, small;
    getrlimit(RLIMIT_FSIZE, &before);
    small = before;
    small.rlim_cur = 1000;
    signal(SIGXFSZ, SIG_IGN);
    setrlimit(RLIMIT_FSIZE, &small);
    struct error error;
    enum status status = frame_save(random_frame(30, 30, false), path, &error);
    setrlimit(RLIMIT_FSIZE, &before);
    assert_int_equal(status, STATUS_IO);
    assert_non_null(strstr(error.text, "full.frame"));
    assert_false(file_exists(path));
    assert_int_equal(rmdir(folder), 0); /* nothing else was left either */
    assert_int_equal(mkdir(folder, 0777), 0);
}

/* Hash and checks */

static void test_frame__the_hash_is_of_size_and_values_not_of_variance(void **state)
{
    (void)state;
    struct frame *frame = random_frame(6, 4, true), *other = random_frame(6, 4, true);
    uint64_t hash = frame_hash(frame);
    other->variance[3] += 1;
    assert_true(frame_hash(other) == hash);
    other->rgba[95] += 1e-3f;
    assert_true(frame_hash(other) != hash);
    struct frame turned = *frame;
    turned.width_px = 4;
    turned.height_px = 6;
    assert_true(frame_hash(&turned) != hash);
}

static void test_frame__check_names_the_first_bad_pixel(void **state)
{
    (void)state;
    struct error error;
    struct frame *frame = random_frame(6, 4, true);
    assert_int_equal(frame_check(frame, &error), STATUS_OK);
    frame->variance[4 * 23 + 3] = -1e-9f;
    assert_int_equal(frame_check(frame, &error), STATUS_BAD_PICTURE);
    assert_string_equal(error.text,
                        "pixel x 5, y 3: variance of alpha is -1e-09, not finite and >= 0");
    frame->rgba[4 * 14 + 2] = INFINITY;
    assert_int_equal(frame_check(frame, &error), STATUS_BAD_PICTURE);
    assert_string_equal(error.text, "pixel x 2, y 2: blue is inf, not finite");
    frame->rgba[4 * 7 + 3] = 1.02f;
    assert_int_equal(frame_check(frame, &error), STATUS_BAD_PICTURE);
    assert_string_equal(error.text, "pixel x 1, y 1: alpha is 1.02, not in 0..1");
    frame->rgba[1] = NAN;
    assert_int_equal(frame_check(frame, NULL), STATUS_BAD_PICTURE);
    struct frame *edge = random_frame(1, 1, false);
    edge->rgba[3] = 1.005f;
    assert_int_equal(frame_check(edge, &error), STATUS_OK);
}

/* Pictures */

static void test_frame__an_exr_holds_every_bit_and_the_variance(void **state)
{
    (void)state;
    char *path = path_of("a.exr");
    for (int with_variance = 0; with_variance < 2; with_variance++) {
        struct frame *frame = random_frame(21, 9, with_variance), *back;
        struct error error = {0};
        bool has_coverage = false;
        if (frame_write_image(path, frame, &error) ||
            frame_read_image(arena, path, &back, &has_coverage, &error))
            fail_msg("%s", error.text);
        assert_same(frame, back);
        assert_true(has_coverage);
    }
    unlink(path);
}

static void test_frame__a_png_is_srgb_without_alpha(void **state)
{
    (void)state;
    char *path = path_of("a.png");
    struct frame *frame = frame_create(arena, 3, 1, false), *back;
    const float values[12] = {0, 0.002f, 1, 0.5f, 0.2158605f, 0.5f, 7, 0, -1, 1, 0.0031308f, 0};
    memcpy(frame->rgba, values, sizeof values);
    struct error error = {0};
    assert_int_equal(frame_write_image(path, frame, &error), STATUS_OK);
    struct image *stored;
    assert_int_equal(image_read(arena, path, false, &stored, &error), STATUS_OK);
    assert_int_equal(stored->channels_count, 3);
    /* 12.92 x, then 1.055 x^(1/2.4) - .055; .2158605 is 128 of 255. */
    const int bytes[9] = {0, 7, 255, 128, 188, 255, 0, 255, 10};
    for (int i = 0; i < 9; i++)
        assert_int_equal(lroundf(stored->values[i] * 255), bytes[i]);
    bool has_coverage = false;
    assert_int_equal(frame_read_image(arena, path, &back, &has_coverage, &error), STATUS_OK);
    assert_false(has_coverage);
    assert_true(back->rgba[3] >= 1 && back->rgba[3] <= 1);
    assert_true(fabsf(back->rgba[4] - 0.2158605f) < 1e-6f);
    unlink(path);
}

static void test_frame__frame_files_and_grey_pictures_are_read_as_pictures(void **state)
{
    (void)state;
    struct frame *frame = random_frame(5, 4, true), *back;
    struct error error = {0};
    bool has_coverage = false;
    char *path = path_of("raw.png"); /* the first bytes count, not the ending */
    assert_int_equal(frame_save(frame, path, &error), STATUS_OK);
    assert_int_equal(frame_read_image(arena, path, &back, &has_coverage, &error), STATUS_OK);
    assert_same(frame, back);
    assert_true(has_coverage);
    unlink(path);
    float grey[4] = {0.25f, 0.75f, 1, 0.5f};
    struct image image = {2, 1, 2, grey, NULL};
    path = path_of("grey.exr");
    assert_int_equal(image_write(path, &image, 32, false, &error), STATUS_OK);
    assert_int_equal(frame_read_image(arena, path, &back, &has_coverage, &error), STATUS_OK);
    const float expected[8] = {0.25f, 0.25f, 0.25f, 0.75f, 1, 1, 1, 0.5f};
    assert_memory_equal(back->rgba, expected, sizeof expected);
    assert_true(has_coverage);
    unlink(path);
}

static void test_frame__a_map_of_errors_runs_from_black_to_pale_yellow(void **state)
{
    (void)state;
    const float map[6] = {0, 0.25f, 0.5f, 1, 9, NAN};
    struct image *image = map_to_image(arena, map, 6, 1, 1);
    assert_int_equal(image->channels_count, 3);
    /* matplotlib: cm.get_cmap("magma").colors interpolated at 0, 1/4, 1/2, 1. */
    const float expected[4][3] = {{0.001462f, 0.000466f, 0.013866f},
                                  {0.316654f, 0.071690f, 0.485380f},
                                  {0.716387f, 0.214982f, 0.475290f},
                                  {0.987053f, 0.991438f, 0.749504f}};
    for (int i = 0; i < 6; i++)
        for (int c = 0; c < 3; c++) {
            int of = i < 4 ? i : i == 4 ? 3 : 0;
            assert_true(fabsf(image->values[3 * i + c] - expected[of][c]) < 0.005f);
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_frame__what_is_saved_is_loaded),
        cmocka_unit_test(test_frame__a_file_cut_anywhere_is_refused),
        cmocka_unit_test(test_frame__a_file_with_any_byte_changed_is_refused),
        cmocka_unit_test(test_frame__absurd_headers_with_a_right_hash_are_refused),
        cmocka_unit_test(test_frame__missing_files_folders_and_text_are_refused_by_name),
        cmocka_unit_test(test_frame__a_full_disk_leaves_no_half_file),
        cmocka_unit_test(test_frame__the_hash_is_of_size_and_values_not_of_variance),
        cmocka_unit_test(test_frame__check_names_the_first_bad_pixel),
        cmocka_unit_test(test_frame__an_exr_holds_every_bit_and_the_variance),
        cmocka_unit_test(test_frame__a_png_is_srgb_without_alpha),
        cmocka_unit_test(test_frame__frame_files_and_grey_pictures_are_read_as_pictures),
        cmocka_unit_test(test_frame__a_map_of_errors_runs_from_black_to_pale_yellow),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
