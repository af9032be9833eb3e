/* Images on disk: what is written is read, by us and by another program, and what is wrong is
 * refused by name. */
#include "testing.h"

#include "base/color.h"
#include "base/file.h"
#include "base/random.h"
#include "wall/image.h"

#include <dirent.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

static struct arena *arena;
static char folder[] = "/tmp/treeline-image-XXXXXX";

static int set_up(void **state)
{
    (void)state;
    arena = arena_create(0);
    return mkdtemp(folder) ? 0 : -1;
}

static int tear_down(void **state)
{
    (void)state;
    int rc = rmdir(folder); /* tests leave nothing behind */
    arena_destroy(arena);
    return rc;
}

static char *path_of(const char *name)
{
    return arena_printf(arena, "%s/%s", folder, name);
}

static struct image *random_image(int width_px, int height_px, int channels_count)
{
    size_t count = (size_t)width_px * (size_t)height_px * (size_t)channels_count;
    struct image *image = ARENA_NEW(arena, struct image);
    *image =
        (struct image){width_px, height_px, channels_count, ARENA_ARRAY(arena, float, count), NULL};
    struct random random = random_seed(3, 3);
    for (size_t i = 0; i < count; i++)
        image->values[i] = random_float(&random);
    return image;
}

static void write_or_fail(const char *path, const struct image *image, int bits, bool encode)
{
    struct error error;
    if (image_write(path, image, bits, encode, &error))
        fail_msg("%s", error.text);
}

static struct image *read_or_fail(const char *path, bool linear)
{
    struct image *image;
    struct error error;
    if (image_read(arena, path, linear, &image, &error))
        fail_msg("%s", error.text);
    return image;
}

/* Round trips */

static void test_image__float_exr_keeps_every_bit_and_name(void **state)
{
    (void)state;
    const char *const names[] = {"R", "G", "B", "A", "variance.R", "depth.Z"};
    char *path = path_of("a.exr");
    struct image *image = random_image(13, 7, 6);
    image->names = names;
    image->values[0] = -1e30f;
    image->values[1] = 1e-30f;
    write_or_fail(path, image, 32, false);
    struct image *back = read_or_fail(path, true);
    assert_int_equal(back->width_px, 13);
    assert_int_equal(back->height_px, 7);
    assert_int_equal(back->channels_count, 6);
    for (int c = 0; c < 6; c++) { /* EXR sorts its channels by name, behind R, G, B, A */
        int at = 0;
        while (strcmp(back->names[at], names[c]) != 0)
            assert_true(++at < 6);
        for (int i = 0; i < 13 * 7; i++)
            assert_memory_equal(&back->values[6 * i + at], &image->values[6 * i + c],
                                sizeof(float));
    }
    unlink(path);
}

static void test_image__half_exr_rounds_to_11_bits_and_clamps(void **state)
{
    (void)state;
    char *path = path_of("a.exr");
    struct image *image = random_image(16, 4, 3);
    image->values[0] = 1e9f;
    image->values[1] = -1e9f;
    write_or_fail(path, image, 16, false);
    struct image *back = read_or_fail(path, true);
    assert_true(back->values[0] >= 65504 && back->values[0] <= 65504);
    assert_true(back->values[1] >= -65504 && back->values[1] <= -65504);
    for (int i = 2; i < 16 * 4 * 3; i++)
        assert_true(fabsf(back->values[i] - image->values[i]) <=
                    image->values[i] * 0x1p-11f + 0x1p-25f);
    unlink(path);
}

static void test_image__all_256_bytes_survive_decoding_and_encoding(void **state)
{
    (void)state;
    char *path = path_of("a.png");
    struct image *image = random_image(256, 1, 1);
    for (int i = 0; i < 256; i++)
        image->values[i] = srgb_decode((float)i / 255);
    write_or_fail(path, image, 8, true);
    struct image *stored = read_or_fail(path, false), *linear = read_or_fail(path, true);
    for (int i = 0; i < 256; i++) {
        assert_int_equal(lroundf(stored->values[i] * 255), i);
        assert_true(fabsf(linear->values[i] - image->values[i]) < 1e-6f);
    }
    unlink(path);
}

static void test_image__png_of_16_bits_keeps_heights_and_never_encodes_alpha(void **state)
{
    (void)state;
    char *path = path_of("a.png");
    struct image *image = random_image(20, 10, 4);
    for (int i = 0; i < 20 * 10 * 4; i++)
        image->values[i] = floorf(image->values[i] * 65535) / 65535;
    image->values[3] = 0; /* colour under no alpha must survive */
    write_or_fail(path, image, 16, false);
    struct image *back = read_or_fail(path, false);
    for (int i = 0; i < 20 * 10 * 4; i++)
        assert_true(fabsf(back->values[i] - image->values[i]) < 1e-6f);
    write_or_fail(path, image, 16, true);
    back = read_or_fail(path, true);
    for (int i = 0; i < 20 * 10 * 4; i++)
        assert_true(fabsf(back->values[i] - image->values[i]) < (i % 4 == 3 ? 1e-6f : 4e-5f));
    unlink(path);
}

static void test_image__values_outside_0_to_1_and_nan_become_ends_of_a_png(void **state)
{
    (void)state;
    char *path = path_of("a.png");
    float values[6] = {-2, 3, NAN, INFINITY, -INFINITY, 0.5f};
    struct image image = {6, 1, 1, values, NULL};
    write_or_fail(path, &image, 8, false);
    const int expected[6] = {0, 255, 0, 255, 0, 128};
    struct image *back = read_or_fail(path, false);
    for (int i = 0; i < 6; i++)
        assert_int_equal(lroundf(back->values[i] * 255), expected[i]);
    unlink(path);
}

static void test_image__another_program_reads_the_same_png(void **state)
{
    (void)state;
    char *path = path_of("a.png"), output[4096];
    float values[12] = {0, 0.25f, 1, 1, 0.5f, 0.0625f, 0.75f, 0.5f, 1, 1, 1, 0};
    struct image image = {3, 1, 4, values, NULL};
    write_or_fail(path, &image, 8, false);
    FILE *pipe = popen(arena_printf(arena,
                                    "P=/usr/bin/python3; [ -x $P ] || P=python3; $P -c 'import PIL."
                                    "Image as I; print(list(I.open(\"%s\").getdata()))' 2>&1",
                                    path),
                       "r");
    assert_non_null(pipe);
    output[fread(output, 1, sizeof output - 1, pipe)] = 0;
    pclose(pipe);
    unlink(path);
    if (strstr(output, "No module named")) {
        print_message("skipped: python3-pil is not installed\n");
        skip();
    }
    assert_string_equal(output, "[(0, 64, 255, 255), (128, 16, 191, 128), (255, 255, 255, 0)]\n");
}

static void test_image__equal_images_are_equal_files_a_second_later(void **state)
{
    (void)state;
    struct image *image = random_image(9, 9, 4);
    const char *const names[] = {"a.exr", "b.exr", "a.png", "b.png"};
    char *data[4];
    size_t sizes[4];
    struct error error;
    for (int k = 0; k < 4; k += 2)
        write_or_fail(path_of(names[k]), image, 16, true);
    usleep(1100000);
    for (int k = 1; k < 4; k += 2)
        write_or_fail(path_of(names[k]), image, 16, true);
    for (int k = 0; k < 4; k++) {
        assert_int_equal(file_read(arena, path_of(names[k]), 0, &data[k], &sizes[k], &error), 0);
        unlink(path_of(names[k]));
    }
    for (int k = 0; k < 4; k += 2) {
        assert_int_equal(sizes[k], sizes[k + 1]);
        assert_memory_equal(data[k], data[k + 1], sizes[k]);
    }
}

static void test_image__png_in_memory_is_the_png_on_disk(void **state)
{
    (void)state;
    char *path = path_of("a.png"), *data;
    struct image *image = random_image(11, 5, 3);
    write_or_fail(path, image, 8, true);
    uint8_t *bytes;
    size_t size, on_disk;
    assert_int_equal(image_png(arena, image, true, &bytes, &size, NULL), STATUS_OK);
    assert_int_equal(file_read(arena, path, 0, &data, &on_disk, NULL), STATUS_OK);
    assert_int_equal(size, on_disk);
    assert_memory_equal(bytes, data, size);
    unlink(path);
}

static int thread_count(void)
{
    int count = 0;
    DIR *tasks = opendir("/proc/self/task");
    assert_non_null(tasks);
    for (struct dirent *entry; (entry = readdir(tasks));)
        count += entry->d_name[0] != '.';
    closedir(tasks);
    return count;
}

static void test_image__reading_and_writing_leave_no_thread_behind(void **state)
{
    (void)state;
    int before = thread_count();
    write_or_fail(path_of("a.exr"), random_image(300, 200, 4), 16, false);
    write_or_fail(path_of("a.png"), random_image(300, 200, 4), 8, true);
    read_or_fail(path_of("a.exr"), true);
    read_or_fail(path_of("a.png"), true);
    assert_int_equal(thread_count(), before);
    unlink(path_of("a.exr"));
    unlink(path_of("a.png"));
}

/* Errors */

static void expect_read_error(const char *path, enum status expected, const char *part)
{
    struct image *image;
    struct error error = {0};
    enum status status = image_read(arena, path, true, &image, &error);
    if (status != expected || error.status != expected)
        fail_msg("%s: status %d, not %d: %s", path, (int)status, (int)expected, error.text);
    if (strncmp(error.text, path, strlen(path)) != 0 || !strstr(error.text, part) ||
        strchr(error.text, '\n'))
        fail_msg("the error reads: %s", error.text);
}

static void test_image__a_missing_file_a_folder_and_text_are_refused(void **state)
{
    (void)state;
    expect_read_error(path_of("none.png"), STATUS_NOT_FOUND, "No such file");
    expect_read_error(path_of("none/none.exr"), STATUS_NOT_FOUND, "No such file");
    expect_read_error(folder, STATUS_INVALID, "is a folder");
    const char *const names[] = {"text.png", "text.exr", "text.jpg", "text"};
    for (int k = 0; k < 4; k++) {
        char *path = path_of(names[k]);
        assert_int_equal(file_write(path, "not a picture at all\n", 21, NULL), STATUS_OK);
        expect_read_error(path, STATUS_INVALID, "no picture can be read");
        assert_int_equal(file_write(path, "", 0, NULL), STATUS_OK);
        expect_read_error(path, STATUS_INVALID, "no picture can be read");
        unlink(path);
    }
}

static void test_image__a_file_cut_off_is_refused(void **state)
{
    (void)state;
    const char *const names[] = {"cut.png", "cut.exr"};
    for (int k = 0; k < 2; k++) {
        char *path = path_of(names[k]), *data;
        size_t size;
        write_or_fail(path, random_image(40, 30, 3), 16, false);
        assert_int_equal(file_read(arena, path, 0, &data, &size, NULL), STATUS_OK);
        for (int part = 1; part < 8; part++) {
            assert_int_equal(file_write(path, data, size * (size_t)part / 8, NULL), STATUS_OK);
            expect_read_error(path, STATUS_INVALID,
                              k == 0 ? "the PNG is cut off" : "no picture can be read");
        }
        unlink(path);
    }
}

/* CRC-32 of PNG chunks (ISO 3309), bit by bit. */
static uint32_t crc32_of(const unsigned char *data, size_t size)
{
    uint32_t crc = 0xffffffffu;
    for (size_t i = 0; i < size; i++) {
        crc ^= data[i];
        for (int bit = 0; bit < 8; bit++)
            crc = crc >> 1 ^ (crc & 1 ? 0xedb88320u : 0);
    }
    return ~crc;
}

static void put_u32(unsigned char *at, uint32_t value)
{
    for (int k = 0; k < 4; k++)
        at[k] = (unsigned char)(value >> (24 - 8 * k));
}

static void test_image__a_header_of_a_huge_size_costs_nothing_and_is_refused(void **state)
{
    (void)state;
    char *path = path_of("huge.png"), *data;
    size_t size, used = arena_used_bytes(arena);
    write_or_fail(path, random_image(4, 4, 3), 8, false);
    assert_int_equal(file_read(arena, path, 0, &data, &size, NULL), STATUS_OK);
    unsigned char *header = (unsigned char *)data + 12; /* "IHDR", width, height, ... */
    put_u32(header + 4, 60000);
    put_u32(header + 8, 60000);
    put_u32(header + 17, crc32_of(header, 17));
    assert_int_equal(file_write(path, data, size, NULL), STATUS_OK);
    expect_read_error(path, STATUS_INVALID, "60000 x 60000 x 3");
    put_u32(header + 4, 0);
    put_u32(header + 17, crc32_of(header, 17));
    assert_int_equal(file_write(path, data, size, NULL), STATUS_OK);
    expect_read_error(path, STATUS_INVALID, "no picture can be read");
    assert_true(arena_used_bytes(arena) < used + (1 << 16));
    unlink(path);
}

static void expect_write_error(const char *path, const struct image *image, int bits,
                               enum status expected, const char *part)
{
    struct error error = {0};
    enum status status = image_write(path, image, bits, false, &error);
    if (status != expected || strncmp(error.text, path, strlen(path)) != 0 ||
        !strstr(error.text, part))
        fail_msg("status %d: %s", (int)status, error.text);
}

static void test_image__wrong_endings_bits_and_channels_are_refused(void **state)
{
    (void)state;
    struct image *image = random_image(2, 2, 3), *five = random_image(2, 2, 5);
    expect_write_error(path_of("a.jpg"), image, 8, STATUS_INVALID, "written as .exr or .png");
    expect_write_error(path_of("a"), image, 8, STATUS_INVALID, "written as .exr or .png");
    expect_write_error(path_of("a.png"), image, 32, STATUS_INVALID, "32 bits; a PNG has 8 or 16");
    expect_write_error(path_of("a.exr"), image, 8, STATUS_INVALID, "8 bits; an EXR has 16 or 32");
    expect_write_error(path_of("a.png"), five, 8, STATUS_INVALID, "5 channels are outside 1..4");
    expect_write_error(path_of("a.exr"), five, 16, STATUS_INVALID, "1..4 without names");
    image->width_px = 0;
    expect_write_error(path_of("a.png"), image, 8, STATUS_INVALID, "size 0 x 2 x 3 is outside");
}

static void test_image__unwritable_folders_and_full_disks_are_told_and_leave_nothing(void **state)
{
    (void)state;
    struct image *image = random_image(64, 64, 3);
    expect_write_error(path_of("none/a.png"), image, 8, STATUS_IO, "No such file");
    expect_write_error("/proc/treeline.exr", image, 16, STATUS_IO, "cannot be written");
    /* Root may write to any folder: the rights of one are only tried by others. */
    if (geteuid() != 0) {
        assert_int_equal(chmod(folder, 0555), 0);
        expect_write_error(path_of("a.png"), image, 8, STATUS_IO, "Permission denied");
        assert_int_equal(chmod(folder, 0777), 0);
    }
    struct rlimit before, small;
    getrlimit(RLIMIT_FSIZE, &before);
    small = before;
    small.rlim_cur = 1000;
    signal(SIGXFSZ, SIG_IGN);
    setrlimit(RLIMIT_FSIZE, &small);
    expect_write_error(path_of("a.exr"), image, 32, STATUS_IO, "cannot be written");
    expect_write_error(path_of("a.png"), image, 8, STATUS_IO, "cannot be written");
    setrlimit(RLIMIT_FSIZE, &before);
    assert_int_equal(rmdir(folder), 0); /* empty: nothing half-written was left */
    assert_int_equal(mkdir(folder, 0777), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_image__float_exr_keeps_every_bit_and_name),
        cmocka_unit_test(test_image__half_exr_rounds_to_11_bits_and_clamps),
        cmocka_unit_test(test_image__all_256_bytes_survive_decoding_and_encoding),
        cmocka_unit_test(test_image__png_of_16_bits_keeps_heights_and_never_encodes_alpha),
        cmocka_unit_test(test_image__values_outside_0_to_1_and_nan_become_ends_of_a_png),
        cmocka_unit_test(test_image__another_program_reads_the_same_png),
        cmocka_unit_test(test_image__equal_images_are_equal_files_a_second_later),
        cmocka_unit_test(test_image__png_in_memory_is_the_png_on_disk),
        cmocka_unit_test(test_image__reading_and_writing_leave_no_thread_behind),
        cmocka_unit_test(test_image__a_missing_file_a_folder_and_text_are_refused),
        cmocka_unit_test(test_image__a_file_cut_off_is_refused),
        cmocka_unit_test(test_image__a_header_of_a_huge_size_costs_nothing_and_is_refused),
        cmocka_unit_test(test_image__wrong_endings_bits_and_channels_are_refused),
        cmocka_unit_test(test_image__unwritable_folders_and_full_disks_are_told_and_leave_nothing),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
