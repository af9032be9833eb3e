/* Noise of known variance: what is taken out of the metrics, what is left, and the flicker of a
 * path. */
#include "testing.h"

#include "base/random.h"
#include "truth/metrics.h"

#include <math.h>
#include <omp.h>
#include <string.h>

#define NEAR(a, b, tolerance)                                                                      \
    do {                                                                                           \
        double a_ = (a), b_ = (b), t_ = (tolerance);                                               \
        if (!(fabs(a_ - b_) <= t_))                                                                \
            fail_msg("%s is %.9g, not %.9g +- %.2g", #a, a_, b_, t_);                              \
    } while (0)

enum { WIDTH = 200, HEIGHT = 152, PIXELS = WIDTH * HEIGHT };

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

static double gaussian(struct random *random)
{
    double radius = sqrt(-2 * log(1 - random_double(random)));
    return radius * cos(2 * M_PI * random_double(random));
}

/* Values in [.25, .75] with edges, plus a bias; everything well inside the display's range. */
static struct frame *truth(double bias)
{
    struct frame *frame = frame_create(arena, WIDTH, HEIGHT, false);
    for (int i = 0; i < PIXELS * 4; i++) {
        int x = i / 4 % WIDTH, y = i / 4 / WIDTH;
        double wave = 0.15 * sin(x * 0.07 * (i % 4 + 1)) + 0.1 * ((x / 20 + y / 15) % 2);
        frame->rgba[i] = (float)(0.45 + wave + bias);
    }
    return frame;
}

/* Standard deviation of value i: between half of sigma and sigma. */
static double deviation(int i, double sigma)
{
    return sigma * (0.5 + 0.5 * ((i / 4) % 7) / 6.0);
}

/* The frame with independent noise in every value (together: one deviate for R, G, B), and its
 * variance known. */
static struct frame *noisy(const struct frame *clean, double sigma, uint64_t seed, bool together)
{
    struct frame *frame = frame_create(arena, WIDTH, HEIGHT, true);
    struct random random = random_seed(seed, 99);
    double deviate = 0;
    for (int i = 0; i < PIXELS * 4; i++) {
        if (!together || i % 4 == 0)
            deviate = gaussian(&random);
        double s = deviation(i, sigma);
        frame->rgba[i] = (float)((double)clean->rgba[i] + s * deviate);
        frame->variance[i] = (float)(s * s);
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

/* Five standard errors of a mean square of count Gaussian values: each has relative variance 2
 * (more where the variances differ: here at most 1.5 times). */
static double five_errors(double mean_square, double count)
{
    return 5 * mean_square * sqrt(1.5 * 2 / count);
}

static void test_noise__of_two_pictures_of_one_truth_is_taken_out(void **state)
{
    (void)state;
    const struct frame *clean = truth(0);
    struct comparison c = compare(noisy(clean, 0.03, 1, false), noisy(clean, 0.02, 2, false));
    double variance = 0, mean_deviation = 0; /* of the difference, expected */
    for (int i = 0; i < 28; i++) {
        double v = pow(deviation(i, 0.03), 2) + pow(deviation(i, 0.02), 2);
        variance += v / 28;
        mean_deviation += sqrt(2 * v / M_PI) / 28;
    }
    double error = five_errors(variance, 3.0 * PIXELS);
    NEAR(c.floor.rmse, sqrt(variance), 1e-4);
    NEAR(c.raw.rmse * c.raw.rmse, variance, error);
    NEAR(c.value.rmse, 0, sqrt(error));
    assert_true(c.value.rmse < 0.2 * c.raw.rmse);
    const double *raw[] = {&c.raw.rmse_box2, &c.raw.rmse_box4, &c.raw.rmse_box8};
    const double *value[] = {&c.value.rmse_box2, &c.value.rmse_box4, &c.value.rmse_box8};
    const double *least[] = {&c.floor.rmse_box2, &c.floor.rmse_box4, &c.floor.rmse_box8};
    for (int k = 0; k < 3; k++) { /* boxes divide the sizes: variance falls by their area */
        double area = (double)(4 << (2 * k)), box_variance = variance / area;
        NEAR(*least[k] * *least[k], box_variance, 0.01 * box_variance);
        NEAR(*raw[k] * *raw[k], box_variance, five_errors(box_variance, 3 * PIXELS / area));
        NEAR(*value[k], 0, sqrt(five_errors(box_variance, 3 * PIXELS / area)));
    }
    double spread = 5 * sqrt(variance / (3.0 * PIXELS));
    NEAR(c.floor.mae, mean_deviation, 1e-4);
    NEAR(c.raw.mae, mean_deviation, spread);
    NEAR(c.floor.coverage, mean_deviation, 1e-4);
    NEAR(c.raw.coverage, mean_deviation, 5 * sqrt(variance / PIXELS));
    NEAR(c.floor.coverage_bias, sqrt(variance / PIXELS), 1e-6);
    NEAR(c.raw.coverage_bias, 0, 5 * c.floor.coverage_bias);
    NEAR(c.floor.mean_color, sqrt(3 * variance / PIXELS), 1e-6);
    NEAR(c.raw.mean_color, 0, 5 * c.floor.mean_color);
}

static void test_noise__under_a_known_bias_is_taken_out(void **state)
{
    (void)state;
    const struct frame *reference = truth(0), *biased = truth(0.03);
    struct comparison exact = compare(biased, reference);
    struct comparison c = compare(noisy(biased, 0.05, 3, false), noisy(reference, 0.02, 4, false));
    assert_true(c.raw.rmse > 0.045); /* the noise is larger than the bias */
    NEAR(c.value.rmse, 0.03, 0.001);
    NEAR(c.value.rmse_box4, 0.03, 0.0006);
    NEAR(c.value.rmse_box8, 0.03, 0.0004);
    NEAR(c.value.mean_color, 0.03 * sqrt(3), 5 * c.floor.mean_color);
    NEAR(c.raw.coverage_bias, 0.03, 5 * c.floor.coverage_bias);
    /* Relative and display metrics of an exact reference. */
    struct comparison one = compare(noisy(biased, 0.02, 5, false), reference);
    NEAR(one.value.relmse, exact.raw.relmse, 0.02 * exact.raw.relmse);
    assert_true(one.raw.relmse > 1.15 * exact.raw.relmse);
    NEAR(one.value.psnr_db, exact.raw.psnr_db, 0.1);
    assert_true(one.raw.psnr_db < exact.raw.psnr_db - 0.5);
}

static void test_noise__alone_gives_the_floor_of_every_metric(void **state)
{
    (void)state;
    const struct frame *clean = truth(0);
    struct frame *reference = truth(0); /* exact values whose variance is that of the other */
    struct frame *test = noisy(clean, 0.04, 6, true);
    struct comparison c = compare(test, reference);
    NEAR(c.raw.rmse, c.floor.rmse, 0.02 * c.floor.rmse);
    NEAR(c.raw.relmse, c.floor.relmse, 0.03 * c.floor.relmse);
    NEAR(c.raw.psnr_db, c.floor.psnr_db, 0.15);
    NEAR(c.raw.ssim, c.floor.ssim, 0.01);
    /* FLIP blurs over some 10 pixels: the mean of 200 x 152 has a standard error of about 1 %. */
    NEAR(c.raw.flip, c.floor.flip, 0.05 * c.floor.flip);
    NEAR(c.raw.hdr_flip, c.floor.hdr_flip, 0.05 * c.floor.hdr_flip);
    assert_true(c.floor.ssim < 0.95 && c.floor.flip > 0.02 && c.floor.hdr_flip > 0.02);
    /* The reference's own noise counts as much as the test's. */
    reference->variance = test->variance;
    struct frame *same = truth(0);
    struct comparison swapped = compare(same, reference);
    NEAR(swapped.floor.flip, c.floor.flip, 0);
    NEAR(swapped.floor.rmse, c.floor.rmse, 0);
    NEAR(swapped.value.rmse, 0, 0);
}

static void test_noise__results_are_the_same_bytes_for_any_number_of_threads(void **state)
{
    (void)state;
    const struct frame *test = noisy(truth(0.02), 0.04, 7, true), *reference = truth(0);
    int before = omp_get_max_threads();
    struct comparison results[2];
    for (int k = 0; k < 2; k++) {
        omp_set_num_threads(k ? 3 : 1);
        results[k] = compare(test, reference);
    }
    omp_set_num_threads(before);
    assert_memory_equal(&results[0], &results[1], sizeof results[0]);
}

/* Flicker */

static struct flicker flicker_of(struct frame **frames, struct frame **references, size_t count)
{
    struct flicker flicker;
    struct error error;
    if (metrics_flicker(arena, (const struct frame *const *)frames,
                        (const struct frame *const *)references, count, &flicker, &error))
        fail_msg("%s", error.text);
    return flicker;
}

static void test_flicker__a_steady_bias_does_not_flicker(void **state)
{
    (void)state;
    struct frame *frames[3], *references[3];
    for (int k = 0; k < 3; k++) {
        references[k] = truth(0.05 * k);
        frames[k] = truth(0.05 * k + 0.125);
    }
    struct flicker flicker = flicker_of(frames, references, 3);
    NEAR(flicker.mean, 0, 1e-6);
    NEAR(flicker.peak, 0, 1e-6);
    struct flicker none = flicker_of(frames, references, 1);
    assert_true(none.mean == 0 && none.peak == 0 && none.floor == 0 && none.peak_frame == 0);
}

static void test_flicker__a_level_change_is_the_peak(void **state)
{
    (void)state;
    struct frame *frames[5], *references[5];
    for (int k = 0; k < 5; k++) {
        references[k] = truth(0);
        frames[k] = truth(k >= 3 ? 0.1 : 0);
    }
    struct flicker flicker = flicker_of(frames, references, 5);
    NEAR(flicker.peak, 0.1, 1e-6);
    assert_int_equal(flicker.peak_frame, 3);
    NEAR(flicker.mean, sqrt(0.01 / 4), 1e-6);
    NEAR(flicker.floor, 0, 0);
}

static void test_flicker__noise_is_taken_out_and_is_the_floor(void **state)
{
    (void)state;
    struct frame *frames[4], *references[4];
    for (int k = 0; k < 4; k++) {
        frames[k] = noisy(truth(0), 0.04, (uint64_t)(10 + k), false);
        references[k] = noisy(truth(0), 0.03, (uint64_t)(20 + k), false);
    }
    double variance = 0;
    for (int i = 0; i < 28; i++)
        variance += 2 * (pow(deviation(i, 0.04), 2) + pow(deviation(i, 0.03), 2)) / 28;
    struct flicker flicker = flicker_of(frames, references, 4);
    NEAR(flicker.floor, sqrt(variance), 1e-4);
    NEAR(flicker.mean, 0, sqrt(five_errors(variance, 2.0 * PIXELS)));
    NEAR(flicker.peak, 0, sqrt(five_errors(variance, 3.0 * PIXELS)));
}

static void test_flicker__frames_of_another_size_are_refused_by_number(void **state)
{
    (void)state;
    const struct frame *frames[] = {truth(0), frame_create(arena, 4, 4, false)};
    const struct frame *references[] = {truth(0), truth(0)};
    struct flicker flicker;
    struct error error;
    assert_int_equal(metrics_flicker(arena, frames, references, 2, &flicker, &error),
                     STATUS_INVALID);
    assert_string_equal(error.text, "frame 1 is 4 x 4, frame 0 is 200 x 152");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_noise__of_two_pictures_of_one_truth_is_taken_out),
        cmocka_unit_test(test_noise__under_a_known_bias_is_taken_out),
        cmocka_unit_test(test_noise__alone_gives_the_floor_of_every_metric),
        cmocka_unit_test(test_noise__results_are_the_same_bytes_for_any_number_of_threads),
        cmocka_unit_test(test_flicker__a_steady_bias_does_not_flicker),
        cmocka_unit_test(test_flicker__a_level_change_is_the_peak),
        cmocka_unit_test(test_flicker__noise_is_taken_out_and_is_the_floor),
        cmocka_unit_test(test_flicker__frames_of_another_size_are_refused_by_number),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
