/* Statistics against definitions, brute force, published tables, GSL and simulation. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "base/random.h"
#include "stats/stats.h"

#include <gsl/gsl_cdf.h>
#include <gsl/gsl_sort.h>
#include <gsl/gsl_statistics_double.h>
#include <math.h>
#include <stdlib.h>

#define NEAR(a, b, tolerance)                                                                      \
    do {                                                                                           \
        double a_ = (a), b_ = (b);                                                                 \
        if (!(fabs(a_ - b_) <= (tolerance)))                                                       \
            fail_msg("%s is %.17g, not %.17g", #a, a_, b_);                                        \
    } while (0)

static double gaussian(struct random *random)
{
    double radius = sqrt(-2 * log(1 - random_double(random)));
    return radius * cos(2 * M_PI * random_double(random));
}

static void test_stats__a_median_is_the_middle_or_the_mean_of_the_middle_two(void **state)
{
    (void)state;
    const double odd[] = {9, 1, 4}, even[] = {9, 1, 4, 2}, one[] = {-3};
    NEAR(stats_median(odd, 3), 4, 0);
    NEAR(stats_median(even, 4), 3, 0);
    NEAR(stats_median(one, 1), -3, 0);
    assert_true(isnan(stats_median(one, 0)));
    NEAR(odd[0], 9, 0);
}

static void test_stats__a_missing_value_does_not_count(void **state)
{
    (void)state;
    const double some[] = {NAN, 1, 4, NAN, 2}, none[] = {NAN, NAN};
    NEAR(stats_median(some, 5), 2, 0);
    assert_true(isnan(stats_median(none, 2)));
    struct interval interval = stats_median_interval(some, 5, 1);
    NEAR(interval.value, 2, 0);
}

static void test_stats__quantiles_are_those_of_gsl(void **state)
{
    (void)state;
    struct random random = random_seed(7, 0);
    for (size_t count = 1; count < 40; count++) {
        double values[40], sorted[40];
        for (size_t i = 0; i < count; i++)
            values[i] = sorted[i] = gaussian(&random);
        gsl_sort(sorted, 1, count);
        for (double q = 0; q <= 1; q += 0.0625)
            NEAR(stats_quantile(values, count, q),
                 gsl_stats_quantile_from_sorted_data(sorted, 1, count, q), 1e-12);
    }
}

/* A median of 15 log-normal times: 95 % of the intervals must hold the true median, and as many lie
 * above as below. The bounds are three standard errors of a binomial count. */
static void test_stats__the_bca_interval_covers_the_true_median(void **state)
{
    (void)state;
    enum { TRIALS = 2500, N = 15 };
    struct random random = random_seed(11, 0);
    int above = 0, below = 0;
    for (int trial = 0; trial < TRIALS; trial++) {
        double values[N];
        for (int i = 0; i < N; i++)
            values[i] = exp(0.8 * gaussian(&random));
        struct interval interval = stats_median_interval(values, N, (uint64_t)trial);
        assert_true(interval.low <= interval.value && interval.value <= interval.high);
        above += interval.low > 1;
        below += interval.high < 1;
    }
    double tail_bound = 3 * sqrt(0.025 * 0.975 / TRIALS);
    NEAR((double)above / TRIALS, 0.025, tail_bound);
    NEAR((double)below / TRIALS, 0.025, tail_bound);
    NEAR(1 - (double)(above + below) / TRIALS, 0.95, 3 * sqrt(0.95 * 0.05 / TRIALS));
}

static void test_stats__the_same_seed_gives_the_same_interval(void **state)
{
    (void)state;
    const double values[] = {1, 2, 3, 5, 8, 13, 21};
    struct interval a = stats_median_interval(values, 7, 5),
                    b = stats_median_interval(values, 7, 5);
    NEAR(a.low, b.low, 0);
    NEAR(a.high, b.high, 0);
    assert_true(a.low >= 1 && a.high <= 21 && a.low < 5 && a.high > 5);
}

static void test_stats__two_values_give_their_range_and_equal_values_a_point(void **state)
{
    (void)state;
    const double two[] = {4, 2}, same[] = {3, 3, 3, 3, 3};
    struct interval range = stats_median_interval(two, 2, 1);
    NEAR(range.value, 3, 0);
    NEAR(range.low, 2, 0);
    NEAR(range.high, 4, 0);
    struct interval point = stats_median_interval(same, 5, 1);
    NEAR(point.low, 3, 0);
    NEAR(point.high, 3, 0);
    struct interval none = stats_median_interval(two, 0, 1);
    assert_true(isnan(none.value) && isnan(none.low) && isnan(none.high));
}

static void test_stats__a_nested_median_does_not_count_frames_twice(void **state)
{
    (void)state;
    /* One repetition with many slow frames must not outvote two quick ones. */
    const double slow[] = {9, 9, 9, 9, 9, 9, 9}, quick[] = {1, 2, 3}, other[] = {3};
    const double *values[] = {slow, quick, other};
    const size_t counts[] = {7, 3, 1};
    struct interval interval = stats_nested_median_interval(values, counts, 3, 1);
    NEAR(interval.value, 3, 0);
    assert_true(interval.low >= 2 && interval.high <= 9);
}

static void test_stats__a_ratio_interval_turns_over_with_its_arguments(void **state)
{
    (void)state;
    struct random random = random_seed(5, 0);
    double a[21], b[21];
    for (int i = 0; i < 21; i++) {
        b[i] = exp(gaussian(&random));
        a[i] = 2 * b[i] * exp(0.1 * gaussian(&random));
    }
    struct interval up = stats_ratio_interval(a, b, 21, 1),
                    down = stats_ratio_interval(b, a, 21, 1);
    NEAR(up.value, 2, 0.2);
    NEAR(up.value * down.value, 1, 1e-12);
    assert_true(up.low < 2 && up.high > 2 && up.low > 1.7 && up.high < 2.3);
}

static void test_stats__a_geometric_mean_undoes_a_ratio_and_its_inverse(void **state)
{
    (void)state;
    const double ratios[] = {4, 0.25, 3}, bad[] = {1, 0};
    NEAR(stats_geometric_mean(ratios, 2), 1, 1e-15);
    NEAR(stats_geometric_mean(ratios, 3), cbrt(3), 1e-12);
    assert_true(isnan(stats_geometric_mean(bad, 2)));
    assert_true(isnan(stats_geometric_mean(ratios, 0)));
}

static void test_stats__quantiles_of_normal_and_student_are_those_of_gsl(void **state)
{
    (void)state;
    const double ps[] = {1e-8, 0.001, 0.025, 0.2, 0.5, 0.6, 0.9, 0.975, 0.9999};
    const double degrees[] = {1, 2, 3, 4.5, 7, 30, 200, 10000};
    for (size_t i = 0; i < sizeof ps / sizeof *ps; i++) {
        double z = gsl_cdf_ugaussian_Pinv(ps[i]);
        NEAR(stats_normal_quantile(ps[i]), z, 1e-9 * (1 + fabs(z)));
        for (size_t k = 0; k < sizeof degrees / sizeof *degrees; k++) {
            double t = gsl_cdf_tdist_Pinv(ps[i], degrees[k]);
            NEAR(stats_student_quantile(ps[i], degrees[k]), t, 1e-7 * (1 + fabs(t)));
        }
    }
    assert_true(isnan(stats_student_quantile(0.5, 0)) && isnan(stats_normal_quantile(2)));
}

static void test_stats__a_power_law_is_found_again(void **state)
{
    (void)state;
    const double x[] = {1, 10, 100, 1000, 0, 50}, bad[] = {1, 1, 1};
    double y[6];
    for (int i = 0; i < 6; i++)
        y[i] = 3 * pow(x[i], 0.7);
    y[5] = NAN; /* x = 0 and this one do not count */
    struct power_law law = stats_power_law(x, y, 6);
    NEAR(law.a, 3, 1e-12);
    NEAR(law.b.value, 0.7, 1e-12);
    NEAR(law.r2, 1, 1e-12);
    assert_true(isnan(stats_power_law(bad, x, 3).b.value));
    assert_true(isnan(stats_power_law(x, y, 2).b.low));
}

static void test_stats__a_power_laws_interval_covers_the_true_exponent(void **state)
{
    (void)state;
    enum { TRIALS = 4000 };
    struct random random = random_seed(29, 0);
    int covered = 0;
    for (int trial = 0; trial < TRIALS; trial++) {
        double x[5], y[5];
        for (int i = 0; i < 5; i++) {
            x[i] = pow(10, i);
            y[i] = 2 * pow(x[i], -0.5) * exp(0.3 * gaussian(&random));
        }
        struct power_law law = stats_power_law(x, y, 5);
        covered += law.b.low <= -0.5 && -0.5 <= law.b.high;
    }
    NEAR((double)covered / TRIALS, 0.95, 3 * sqrt(0.95 * 0.05 / TRIALS));
}

/* Each law's own data, with three percent of noise; the parameters that made them are found again,
 * the other laws fit worse, and no neighbour of the parameters fits better. */
static void test_stats__each_law_of_growth_is_told_from_the_others(void **state)
{
    (void)state;
    enum { COUNT = 40 };
    const struct growth_fit made[GROWTH_LAWS] = {{-3, 0.5, 0}, {0.02, 1.7, 0}, {2, 0.015, 0}};
    struct random random = random_seed(7, 1);
    for (int law = 0; law < GROWTH_LAWS; law++) {
        double x[COUNT], y[COUNT], least = 0;
        for (int i = 0; i < COUNT; i++) {
            x[i] = 10 + 5 * i;
            y[i] = growth_at(law, &made[law], x[i]) * (1 + 0.03 * gaussian(&random));
        }
        struct growth_fit fit = stats_growth(law, x, y, COUNT);
        NEAR(fit.a / made[law].a, 1, 0.15);
        NEAR(fit.b / made[law].b, 1, 0.05);
        NEAR(fit.residual, 0.03, 0.012);
        for (int i = 0; i < COUNT; i++)
            least += pow(growth_at(law, &fit, x[i]) / y[i] - 1, 2);
        NEAR(sqrt(least / (COUNT - 2)), fit.residual, 1e-12);
        for (int k = 0; k < 4; k++) {
            struct growth_fit near = fit;
            *(k < 2 ? &near.a : &near.b) *= k % 2 ? 1.001 : 0.999;
            double sum = 0;
            for (int i = 0; i < COUNT; i++)
                sum += pow(growth_at(law, &near, x[i]) / y[i] - 1, 2);
            assert_true(sum > least);
        }
        for (int other = 0; other < GROWTH_LAWS; other++)
            if (other != law)
                assert_true(stats_growth(other, x, y, COUNT).residual > 2 * fit.residual);
        assert_true(isnan(stats_growth(law, x, y, 2).residual));
    }
}

static void test_stats__the_front_is_what_no_other_point_beats(void **state)
{
    (void)state;
    struct random random = random_seed(31, 0);
    for (int trial = 0; trial < 200; trial++) {
        double cost[20], error[20];
        bool front[20];
        size_t n = random_below(&random, 21);
        for (size_t i = 0; i < n; i++) { /* small integers: many ties */
            cost[i] = random_below(&random, 9) ? random_below(&random, 6) : NAN;
            error[i] = random_below(&random, 6);
        }
        stats_pareto(cost, error, n, front);
        for (size_t i = 0; i < n; i++) {
            bool beaten = isnan(cost[i]);
            for (size_t k = 0; k < n; k++) {
                bool no_worse = cost[k] <= cost[i] && error[k] <= error[i];
                bool same = cost[k] == cost[i] && error[k] == error[i];
                beaten = beaten || (no_worse && (!same || k < i));
            }
            assert_int_equal(front[i], !beaten);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_stats__a_median_is_the_middle_or_the_mean_of_the_middle_two),
        cmocka_unit_test(test_stats__a_missing_value_does_not_count),
        cmocka_unit_test(test_stats__quantiles_are_those_of_gsl),
        cmocka_unit_test(test_stats__the_bca_interval_covers_the_true_median),
        cmocka_unit_test(test_stats__the_same_seed_gives_the_same_interval),
        cmocka_unit_test(test_stats__two_values_give_their_range_and_equal_values_a_point),
        cmocka_unit_test(test_stats__a_nested_median_does_not_count_frames_twice),
        cmocka_unit_test(test_stats__a_ratio_interval_turns_over_with_its_arguments),
        cmocka_unit_test(test_stats__a_geometric_mean_undoes_a_ratio_and_its_inverse),
        cmocka_unit_test(test_stats__quantiles_of_normal_and_student_are_those_of_gsl),
        cmocka_unit_test(test_stats__a_power_law_is_found_again),
        cmocka_unit_test(test_stats__a_power_laws_interval_covers_the_true_exponent),
        cmocka_unit_test(test_stats__each_law_of_growth_is_told_from_the_others),
        cmocka_unit_test(test_stats__the_front_is_what_no_other_point_beats),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
