/* Metrics against published values, scikit-image, a second implementation of FLIP, idiff, and
 * closed forms. */
#include "testing.h"

#include "base/random.h"
#include "truth/frame_image.h"
#include "truth/metrics.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define NEAR(a, b, tolerance)                                                                      \
    do {                                                                                           \
        double a_ = (a), b_ = (b);                                                                 \
        if (!(fabs(a_ - b_) <= (tolerance)))                                                       \
            fail_msg("%s is %.9g, not %.9g", #a, a_, b_);                                          \
    } while (0)

static struct arena *arena;

static int set_up(void **state)
{
    (void)state;
    arena = arena_create(0);
    return 0;
}

static int tear_down(void **state)
{
    (void)state;
    arena_destroy(arena);
    return 0;
}

static struct frame *constant(int width_px, int height_px, float r, float g, float b)
{
    struct frame *frame = frame_create(arena, width_px, height_px, false);
    const float color[4] = {r, g, b, 1};
    for (int i = 0; i < width_px * height_px; i++)
        memcpy(frame->rgba + 4 * i, color, sizeof color);
    return frame;
}

/* A sky, a bright disc and leaves: smooth parts, edges, dots, values from 0 to bright. */
static struct frame *scenery(int width_px, int height_px, float bright, uint64_t seed)
{
    struct frame *frame = frame_create(arena, width_px, height_px, false);
    struct random random = random_seed(seed, 1);
    for (int y = 0; y < height_px; y++)
        for (int x = 0; x < width_px; x++) {
            float *pixel = frame->rgba + 4 * (y * width_px + x);
            float u = (float)x / (float)width_px, v = (float)y / (float)height_px;
            bool disc = hypotf(u - 0.3f, v - 0.6f) < 0.2f, leaf = random_float(&random) < 0.3f;
            pixel[0] = disc ? bright : leaf ? 0.05f * random_float(&random) : 0.3f + 0.4f * v;
            pixel[1] = disc ? bright * 0.8f : leaf ? 0.3f * random_float(&random) : 0.5f;
            pixel[2] = disc ? bright * 0.1f : leaf ? 0.02f : 0.9f - 0.3f * u;
            pixel[3] = leaf;
        }
    return frame;
}

static struct comparison compare(const struct frame *test, const struct frame *reference)
{
    struct comparison comparison;
    struct error error;
    if (metrics_compare(arena, test, reference, &comparison, NULL, &error))
        fail_msg("%s", error.text);
    return comparison;
}

/* FLIP */

static double flip_of(float r, float g, float b, float r2, float g2, float b2)
{
    return compare(constant(64, 64, r, g, b), constant(64, 64, r2, g2, b2)).raw.flip;
}

static float stored(double display) /* what an 8-bit picture of it decodes to */
{
    return srgb_decode((float)(floor(display * 255 + 0.5) / 255));
}

static void test_metrics__flip_gives_the_published_values(void **state)
{
    (void)state;
    /* The published means are sums of 64 x 64 single-precision numbers, with an error of up to
     * 4e-5. */
    NEAR(flip_of(0, 0, 0, 1, 1, 1), 0.967345, 6e-5);
    NEAR(flip_of(1, 0, 0, 0, 1, 0), 0.986630, 6e-5);
    float a = stored(0.5), b = stored(0.6), c = stored(0.55);
    NEAR(flip_of(a, a, a, b, b, b), 0.281074, 6e-5);
    NEAR(flip_of(a, a, a, c, c, c), 0.169134, 6e-5);
}

/* Of two greys only the lightness differs: |L1 - L2|^.7, stretched by .95 over .4 of the largest
 * difference. */
static double grey_flip(double a, double b)
{
    const double largest =
        41.276098; /* green to blue, from the primaries' CIELab in double precision */
    double power = pow(fabs(116 * (cbrt(a) - cbrt(b))), 0.7), knee = 0.4 * largest;
    return power < knee ? 0.95 / knee * power : 0.95 + 0.05 * (power - knee) / (largest - knee);
}

static void test_metrics__flip_of_two_greys_is_its_closed_form(void **state)
{
    (void)state;
    const float pairs[][2] = {{0.5f, 0.4f}, {0.02f, 1}, {0.9f, 0.901f}, {0.1f, 0.5f}};
    for (int k = 0; k < 4; k++) {
        float a = pairs[k][0], b = pairs[k][1];
        NEAR(flip_of(a, a, a, b, b, b), grey_flip((double)a, (double)b), 2e-6);
    }
}

static void test_metrics__the_flip_map_is_in_0_to_1_symmetric_and_has_the_mean(void **state)
{
    (void)state;
    const struct frame *a = scenery(60, 50, 1, 1), *b = scenery(60, 50, 0.6f, 2);
    float *map, *back;
    struct comparison comparison;
    assert_int_equal(metrics_compare(arena, a, b, &comparison, &map, NULL), STATUS_OK);
    double sum = 0;
    for (int i = 0; i < 60 * 50; i++) {
        assert_true(map[i] >= 0 && map[i] <= 1);
        sum += (double)map[i];
    }
    NEAR(comparison.raw.flip, sum / (60 * 50), 1e-9);
    assert_true(comparison.raw.flip > 0.1);
    assert_int_equal(metrics_compare(arena, b, a, &comparison, &back, NULL), STATUS_OK);
    assert_memory_equal(map, back, 60 * 50 * sizeof *map);
}

static void test_metrics__hdr_flip_of_a_scaled_pair_is_the_same(void **state)
{
    (void)state;
    struct frame *a = scenery(40, 40, 20, 1), *b = scenery(40, 40, 15, 1);
    double before = compare(a, b).raw.hdr_flip;
    for (int i = 0; i < 40 * 40 * 4; i++)
        if (i % 4 != 3) {
            a->rgba[i] *= 64;
            b->rgba[i] *= 64;
        }
    NEAR(compare(a, b).raw.hdr_flip, before, 1e-6);
    assert_true(before > 0.01);
}

static void test_metrics__hdr_flip_of_black_and_of_one_pixel_pictures_is_finite(void **state)
{
    (void)state;
    const struct frame *black = constant(9, 9, 0, 0, 0), *white = constant(9, 9, 1, 1, 1);
    NEAR(compare(black, black).raw.hdr_flip, 0, 0);
    assert_true(compare(white, black).raw.hdr_flip > 0.9);
    assert_true(compare(black, white).raw.hdr_flip > 0.5);
    struct comparison one = compare(constant(1, 1, 1, 0, 0), constant(1, 1, 0, 0, 0));
    for (const struct metric_info *m = metric_table; m->field; m++)
        assert_true(isfinite(*(double *)((char *)&one.raw + m->offset)));
}

/* Other programs */

static void write_planes(const char *path, const struct frame *frame)
{
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    for (int i = 0; i < frame->width_px * frame->height_px; i++)
        assert_int_equal(fwrite(frame->rgba + 4 * i, sizeof(float), 3, file), 3);
    assert_int_equal(fclose(file), 0);
}

static double value_after(const char *text, const char *word)
{
    const char *at = strstr(text, word);
    if (!at)
        fail_msg("no '%s' in: %s", word, text);
    return at ? strtod(at + strlen(word), NULL) : NAN;
}

static void run(const char *command, char *output, size_t size)
{
    FILE *pipe = popen(command, "r");
    assert_non_null(pipe);
    output[fread(output, 1, size - 1, pipe)] = 0;
    pclose(pipe);
}

static const char *root(void)
{
    const char *folder = getenv("TREELINE_DATA");
    return folder ? folder : ".";
}

static void test_metrics__ssim_flip_and_hdr_flip_are_those_of_python(void **state)
{
    (void)state;
    const struct frame *a = scenery(61, 47, 1.4f, 1), *b = scenery(61, 47, 3, 7);
    char folder[] = "/tmp/treeline-metrics-XXXXXX", command[1024], output[4096];
    assert_non_null(mkdtemp(folder));
    char *a_path = arena_printf(arena, "%s/a", folder),
         *b_path = arena_printf(arena, "%s/b", folder);
    write_planes(a_path, a);
    write_planes(b_path, b);
    /* Debian's python3-skimage belongs to /usr/bin/python3. */
    snprintf(command, sizeof command,
             "P=/usr/bin/python3; [ -x $P ] || P=python3; OMP_NUM_THREADS=1 "
             "$P '%s/tests/metrics_oracle.py' 61 47 %s %s 2>&1",
             root(), a_path, b_path);
    run(command, output, sizeof output);
    unlink(a_path);
    unlink(b_path);
    rmdir(folder);
    if (strstr(output, "missing skimage") || strstr(output, "No module named")) {
        print_message("skipped: python3-skimage is not installed\n");
        skip();
    }
    float *map;
    struct comparison mine;
    assert_int_equal(metrics_compare(arena, a, b, &mine, &map, NULL), STATUS_OK);
    NEAR(mine.raw.ssim, value_after(output, "ssim "), 2e-6);
    NEAR(mine.raw.psnr_db, value_after(output, "psnr "), 1e-4);
    NEAR(mine.raw.mae, value_after(output, "mae "), 1e-7);
    NEAR(mine.raw.relmse, value_after(output, "relmse "), 1e-6);
    NEAR(mine.raw.flip, value_after(output, "flip "), 1e-5);
    NEAR((double)map[0], value_after(output, "flip-corner "), 5e-5);
    NEAR((double)map[47 / 2 * 61 + 61 / 3], value_after(output, "flip-inside "), 5e-5);
    NEAR(mine.raw.hdr_flip, value_after(output, "hdr-flip "), 1e-5);
}

static void test_metrics__rmse_mae_and_psnr_are_those_of_idiff(void **state)
{
    (void)state;
    struct frame *a = scenery(50, 40, 1, 1), *b = scenery(50, 40, 0.7f, 3);
    struct frame *a_display = frame_create(arena, 50, 40, false);
    struct frame *b_display = frame_create(arena, 50, 40, false);
    for (int i = 0; i < 50 * 40 * 4; i++) { /* idiff counts alpha: make it equal, and scale */
        if (i % 4 == 3)
            a->rgba[i] = b->rgba[i] = 1;
        a_display->rgba[i] = srgb_encode(a->rgba[i]);
        b_display->rgba[i] = srgb_encode(b->rgba[i]);
    }
    char folder[] = "/tmp/treeline-metrics-XXXXXX", output[4096];
    assert_non_null(mkdtemp(folder));
    const struct frame *frames[] = {a, b, a_display, b_display};
    char *paths[4];
    for (int k = 0; k < 4; k++) {
        paths[k] = arena_printf(arena, "%s/%d.exr", folder, k);
        struct error error;
        if (frame_write_image(paths[k], frames[k], &error))
            fail_msg("%s", error.text);
    }
    struct comparison mine = compare(a, b);
    run(arena_printf(arena, "idiff -a %s %s", paths[0], paths[1]), output, sizeof output);
    double rgb_in_rgba = 4 / 3.0; /* the mean over four channels, one of them 0 */
    NEAR(mine.raw.mae, value_after(output, "Mean error = ") * rgb_in_rgba,
         2e-6 * mine.raw.mae + 1e-7);
    NEAR(mine.raw.rmse, value_after(output, "RMS error = ") * sqrt(rgb_in_rgba), 1e-6);
    run(arena_printf(arena, "idiff -a %s %s", paths[2], paths[3]), output, sizeof output);
    double rms = value_after(output, "RMS error = ");
    NEAR(mine.raw.psnr_db, -20 * log10(rms * sqrt(rgb_in_rgba)), 1e-4);
    for (int k = 0; k < 4; k++)
        unlink(paths[k]);
    rmdir(folder);
}

/* Closed forms */

static void test_metrics__identical_pictures_have_no_error(void **state)
{
    (void)state;
    const struct frame *a = scenery(33, 21, 4, 5);
    struct comparison same = compare(a, a);
    for (const struct metric_info *m = metric_table; m->field; m++) {
        double expected = m->better > 0 ? (strcmp(m->word, "ssim") ? 100 : 1) : 0;
        NEAR(*(double *)((char *)&same.raw + m->offset), expected, 0);
        NEAR(*(double *)((char *)&same.value + m->offset), expected, 0);
        NEAR(*(double *)((char *)&same.floor + m->offset), expected, 0);
    }
}

static void test_metrics__a_constant_offset_has_the_errors_of_its_formulas(void **state)
{
    (void)state;
    struct frame *b = constant(30, 22, 0.2f, 0.4f, 0.5f), *a = constant(30, 22, 0.3f, 0.2f, 0.5f);
    for (int i = 0; i < 30 * 22; i++) {
        a->rgba[4 * i + 3] = i % 2 ? 0.5f : 0.25f;
        b->rgba[4 * i + 3] = i % 2 ? 0.25f : 0.75f;
    }
    struct comparison c = compare(a, b);
    double rmse = sqrt((0.01 + 0.04) / 3);
    NEAR(c.raw.rmse, rmse, 1e-7);
    NEAR(c.raw.rmse_box2, rmse, 1e-7);
    NEAR(c.raw.rmse_box4, rmse, 1e-7);
    NEAR(c.raw.rmse_box8, rmse, 1e-7);
    NEAR(c.raw.mae, 0.1, 1e-7);
    NEAR(c.raw.relmse, (0.01 / 0.05 + 0.04 / 0.17) / 3, 1e-7);
    NEAR(c.raw.mean_color, sqrt(0.05), 1e-7);
    NEAR(c.raw.coverage, 0.375, 1e-7);
    NEAR(c.raw.coverage_bias, -0.125, 1e-7);
    /* SSIM of two constants: (2 ab + C1) / (aa + bb + C1). */
    double luma_a = 0.2126 * (double)srgb_encode(0.3f) + 0.7152 * (double)srgb_encode(0.2f) +
                    0.0722 * (double)srgb_encode(0.5f);
    double luma_b = 0.2126 * (double)srgb_encode(0.2f) + 0.7152 * (double)srgb_encode(0.4f) +
                    0.0722 * (double)srgb_encode(0.5f);
    NEAR(c.raw.ssim, (2 * luma_a * luma_b + 1e-4) / (luma_a * luma_a + luma_b * luma_b + 1e-4),
         1e-6);
}

static void test_metrics__boxes_average_a_checkerboard_away(void **state)
{
    (void)state;
    struct frame *b = constant(19, 13, 0.5f, 0.5f, 0.5f), *a = constant(19, 13, 0.5f, 0.5f, 0.5f);
    for (int y = 0; y < 13; y++)
        for (int x = 0; x < 19; x++)
            for (int c = 0; c < 3; c++)
                a->rgba[4 * (19 * y + x) + c] += (x + y) % 2 ? 0.1f : -0.1f;
    struct comparison c = compare(a, b);
    NEAR(c.raw.rmse, 0.1, 1e-7);
    /* Whole boxes are 0. The cut 2 x 2 boxes: 6 columns of 1 x 2 and 9 rows of 2 x 1 are 0, the
     * corner is 1 x 1. */
    NEAR(c.raw.rmse_box2, sqrt(0.01 / (19 * 13)), 1e-7);
    /* 4 x 4: 4 x 1 and 3 x 4 boxes are 0; the corner is 3 x 1: mean .1 / 3, weight 3. 8 x 8: corner
     * 3 x 5, mean .1 / 15. */
    NEAR(c.raw.rmse_box4, sqrt(3 * 0.01 / 9 / (19 * 13)), 1e-7);
    NEAR(c.raw.rmse_box8, sqrt(15 * 0.01 / 225 / (19 * 13)), 1e-7);
}

static void test_metrics__pictures_of_two_sizes_or_with_nan_are_refused(void **state)
{
    (void)state;
    struct comparison comparison;
    struct error error;
    struct frame *a = constant(4, 4, 0, 0, 0), *b = constant(4, 5, 0, 0, 0);
    assert_int_equal(metrics_compare(arena, a, b, &comparison, NULL, &error), STATUS_INVALID);
    assert_string_equal(error.text, "the pictures differ in size: test 4 x 4, reference 4 x 5");
    b = constant(4, 4, 0, 0, 0);
    b->rgba[4 * 6 + 1] = NAN;
    assert_int_equal(metrics_compare(arena, a, b, &comparison, NULL, &error), STATUS_BAD_PICTURE);
    assert_string_equal(error.text, "reference: pixel x 2, y 1: green is nan, not finite");
    assert_int_equal(metrics_compare(arena, b, a, &comparison, NULL, NULL), STATUS_BAD_PICTURE);
}

static void test_metrics__negative_and_huge_values_give_finite_metrics(void **state)
{
    (void)state;
    struct frame *a = constant(12, 12, -1, 1e30f, 0), *b = constant(12, 12, 1e30f, -5, 1e-30f);
    struct comparison c = compare(a, b);
    for (const struct metric_info *m = metric_table; m->field; m++)
        if (!isfinite(*(double *)((char *)&c.value + m->offset)))
            fail_msg("%s is not finite", m->word);
    assert_true(c.value.ssim >= -1 && c.value.flip <= 1 && c.value.hdr_flip <= 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_metrics__flip_gives_the_published_values),
        cmocka_unit_test(test_metrics__flip_of_two_greys_is_its_closed_form),
        cmocka_unit_test(test_metrics__the_flip_map_is_in_0_to_1_symmetric_and_has_the_mean),
        cmocka_unit_test(test_metrics__hdr_flip_of_a_scaled_pair_is_the_same),
        cmocka_unit_test(test_metrics__hdr_flip_of_black_and_of_one_pixel_pictures_is_finite),
        cmocka_unit_test(test_metrics__ssim_flip_and_hdr_flip_are_those_of_python),
        cmocka_unit_test(test_metrics__rmse_mae_and_psnr_are_those_of_idiff),
        cmocka_unit_test(test_metrics__identical_pictures_have_no_error),
        cmocka_unit_test(test_metrics__a_constant_offset_has_the_errors_of_its_formulas),
        cmocka_unit_test(test_metrics__boxes_average_a_checkerboard_away),
        cmocka_unit_test(test_metrics__pictures_of_two_sizes_or_with_nan_are_refused),
        cmocka_unit_test(test_metrics__negative_and_huge_values_give_finite_metrics),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
