/* The sampler against what Sobol nets and Owen's scrambling promise. */
#include "testing.h"

#include "base/random.h"
#include "truth/sampler.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Are 2^m points one in every elementary interval of area 2^-m? */
static bool is_net(float (*points)[2], int m)
{
    int count = 1 << m;
    for (int split = 0; split <= m; split++) {
        unsigned char seen[1024] = {0};
        for (int i = 0; i < count; i++) {
            int column = (int)(points[i][0] * (float)(1 << split));
            int row = (int)(points[i][1] * (float)(1 << (m - split)));
            if (seen[(column << (m - split)) + row]++)
                return false;
        }
    }
    return true;
}

static void every_set_is_a_net(enum sampler_pair pair)
{
    float points[1024][2];
    for (uint32_t pixel = 0; pixel < 40; pixel++) {
        struct sampler sampler = sampler_create(7, pixel, pixel % 4, pair);
        for (uint32_t i = 0; i < 1024; i++)
            sampler_point(&sampler, i, points[i]);
        for (int m = 0; m <= 10; m++) {
            assert_true(is_net(points, m));
            assert_true(is_net(points + (1024 - (1 << m)), m)); /* a later block */
        }
    }
}

static void test_sampler__every_pixel_set_is_a_net_in_base_2(void **state)
{
    (void)state;
    every_set_is_a_net(SAMPLER_PIXEL);
}

static void test_sampler__every_sky_set_is_a_net_in_base_2(void **state)
{
    (void)state;
    every_set_is_a_net(SAMPLER_SKY);
}

static void test_sampler__jittered_points_are_no_net(void **state)
{
    (void)state;
    struct random random = random_seed(1, 1);
    float points[16][2];
    for (int i = 0; i < 16; i++)
        for (int k = 0; k < 2; k++)
            points[i][k] = (float)(k ? i / 4 : i % 4) / 4 + random_float(&random) / 4;
    assert_false(is_net(points, 4));
}

/* Owen: the digit k of the result depends on the digits up to k alone, and the map is one to one.
 */
static void test_sampler__the_scramble_is_nested(void **state)
{
    (void)state;
    struct random random = random_seed(3, 3);
    for (int trial = 0; trial < 10000; trial++) {
        uint32_t a = random_u32(&random), b = random_u32(&random), seed = random_u32(&random);
        int shared = (int)random_below(&random, 32);
        b = (b & ~((1u << shared) - 1)) | (a & ((1u << shared) - 1));
        b = (b & ~(1u << shared)) | (~a & (1u << shared)); /* the first digit that differs */
        uint32_t differ = sampler_scramble(a, seed) ^ sampler_scramble(b, seed);
        assert_int_equal(differ & ((2u << shared) - 1), 1u << shared);
    }
}

/* The definition: direction numbers of the second dimension, v(k + 1) = v(k) ^ v(k) >> 1. */
static uint32_t sobol_by_definition(uint32_t index)
{
    uint32_t x = 0;
    for (uint32_t v = 1u << 31; index; index >>= 1, v ^= v >> 1)
        if (index & 1)
            x ^= v;
    return x;
}

static uint32_t reversed(uint32_t x)
{
    uint32_t y = 0;
    for (int i = 0; i < 32; i++)
        y |= (x >> i & 1) << (31 - i);
    return y;
}

static void test_sampler__the_points_are_scrambled_sobol_points(void **state)
{
    (void)state;
    struct sampler sampler = sampler_create(11, 5, 2, SAMPLER_PIXEL);
    for (uint32_t i = 0; i < 4096; i++) {
        float point[2];
        sampler_point(&sampler, i, point);
        uint32_t x = reversed(sampler_scramble(i, sampler.seed_x));
        uint32_t y = reversed(sampler_scramble(reversed(sobol_by_definition(i)), sampler.seed_y));
        assert_true(point[0] == (float)(x >> 8) * 0x1p-24f);
        assert_true(point[1] == (float)(y >> 8) * 0x1p-24f);
    }
}

/* Every point alone is uniform over scrambles: chi-square over 16 x 16 boxes, 255 degrees of
 * freedom. */
static void test_sampler__every_point_is_uniform_over_the_scrambles(void **state)
{
    (void)state;
    for (uint32_t index = 0; index < 6; index++)
        for (int pair = 0; pair < 2; pair++) {
            int boxes[256] = {0}, trials = 256 * 200;
            for (int i = 0; i < trials; i++) {
                struct sampler sampler =
                    sampler_create(0, (uint32_t)i, index % 4, (enum sampler_pair)pair);
                float point[2];
                sampler_point(&sampler, index, point);
                assert_true(point[0] >= 0 && point[0] < 1 && point[1] >= 0 && point[1] < 1);
                boxes[(int)(point[0] * 16) * 16 + (int)(point[1] * 16)]++;
            }
            double chi2 = 0;
            for (int i = 0; i < 256; i++)
                chi2 += (boxes[i] - 200.0) * (boxes[i] - 200.0) / 200.0;
            assert_true(chi2 > 255 - 5 * sqrt(510) && chi2 < 255 + 5 * sqrt(510));
        }
}

/* Mean and variance of the mean of f over many scrambled sets of n points. */
static double spread(double (*f)(const float *), uint32_t count, double *mean)
{
    double sum = 0, squares = 0;
    int trials = 4000;
    for (int i = 0; i < trials; i++) {
        struct sampler sampler = sampler_create(99, (uint32_t)i, 0, SAMPLER_PIXEL);
        double total = 0;
        for (uint32_t k = 0; k < count; k++) {
            float point[2];
            sampler_point(&sampler, k, point);
            total += f(point) / count;
        }
        sum += total;
        squares += total * total;
    }
    *mean = sum / trials;
    return squares / trials - *mean * *mean;
}

static double smooth(const float *p)
{
    return exp((double)p[0]) * p[1];
}

static double corner(const float *p)
{
    return p[0] + 0.7f * p[1] < 0.4f;
}

static void test_sampler__means_are_unbiased_and_fall_faster_than_random(void **state)
{
    (void)state;
    double mean;
    double random_smooth = (exp(2) - 1) / 6 - (exp(1) - 1) * (exp(1) - 1) / 4;
    double area = 0.4 * 0.4 / 0.7 / 2, random_corner = area * (1 - area);
    for (uint32_t count = 1; count <= 256; count *= 16) {
        double variance = spread(smooth, count, &mean);
        assert_true(fabs(mean - (exp(1) - 1) / 2) < 4 * sqrt(variance / 4000));
        assert_true(variance < 1.1 * random_smooth / pow(count, count > 1 ? 2 : 1));
        variance = spread(corner, count, &mean);
        assert_true(fabs(mean - area) < 4 * sqrt(variance / 4000));
        assert_true(variance < 1.1 * random_corner / pow(count, 1.3));
    }
}

static void test_sampler__pixels_replicates_and_pairs_are_independent(void **state)
{
    (void)state;
    double sums[3] = {0};
    int trials = 20000;
    for (int i = 0; i < trials; i++) {
        float a[2], b[2], c[2], d[2];
        struct sampler sampler = sampler_create(5, (uint32_t)i, 0, SAMPLER_PIXEL);
        sampler_point(&sampler, 3, a);
        sampler = sampler_create(5, (uint32_t)i + 1, 0, SAMPLER_PIXEL);
        sampler_point(&sampler, 3, b);
        sampler = sampler_create(5, (uint32_t)i, 1, SAMPLER_PIXEL);
        sampler_point(&sampler, 3, c);
        sampler = sampler_create(5, (uint32_t)i, 0, SAMPLER_SKY);
        sampler_point(&sampler, 3, d);
        sums[0] += (a[0] - 0.5) * (b[0] - 0.5);
        sums[1] += (a[0] - 0.5) * (c[0] - 0.5);
        sums[2] += (a[0] - 0.5) * (d[0] - 0.5);
    }
    for (int i = 0; i < 3; i++)
        assert_true(fabs(sums[i] / trials) < 4 / 12.0 / sqrt(trials));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_sampler__every_pixel_set_is_a_net_in_base_2),
        cmocka_unit_test(test_sampler__every_sky_set_is_a_net_in_base_2),
        cmocka_unit_test(test_sampler__jittered_points_are_no_net),
        cmocka_unit_test(test_sampler__the_scramble_is_nested),
        cmocka_unit_test(test_sampler__the_points_are_scrambled_sobol_points),
        cmocka_unit_test(test_sampler__every_point_is_uniform_over_the_scrambles),
        cmocka_unit_test(test_sampler__means_are_unbiased_and_fall_faster_than_random),
        cmocka_unit_test(test_sampler__pixels_replicates_and_pairs_are_independent),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
