/* Robust summaries with intervals, and fits. Pure functions of arrays; seeded where they
 * resample. */
#ifndef TREELINE_STATS_STATS_H
#define TREELINE_STATS_STATS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct interval {
    double value, low, high; /* estimate and 95 % interval; NaN where there is too little data */
};

/* Everywhere: NaN among the values counts as missing. */

/* Sample median (mean of the middle two); NaN for n = 0. values is not changed. */
double stats_median(const double *values, size_t count);
double stats_quantile(const double *values, size_t count, double q); /* Hyndman-Fan type 7 */

/* Median with a bias-corrected accelerated bootstrap interval (Efron 1987), seeded. count < 3: low
 * = min, high = max. */
struct interval stats_median_interval(const double *values, size_t count, uint64_t seed);
/* Two-level: the median over repetitions of each repetition's median; repetitions are resampled. */
struct interval stats_nested_median_interval(const double *const *values, const size_t *counts,
                                             size_t repetitions, uint64_t seed);
/* exp(median of log(a[i] / b[i])) over pairs, BCa interval. */
struct interval stats_ratio_interval(const double *a, const double *b, size_t count, uint64_t seed);

double stats_geometric_mean(const double *values, size_t count); /* of positive values */

/* y = a x^b by least squares of logs; interval of b by Student's t. */
struct power_law {
    double a;
    struct interval b;
    double r2;
};
/* Fewer than 2 positive pairs, or all at one x: NaN; 2: no interval (NaN). */
struct power_law stats_power_law(const double *x, const double *y, size_t count);

/* y = a + b x, a x^b or a exp(b x), each by least squares of the relative residuals, so that their
 * residuals may be compared: sqrt(sum (model / y - 1)^2 / (n - 2)). Pairs that are not positive are
 * left out; fewer than 3, or all at one x: NaN. */
enum growth_law { GROWTH_LINEAR, GROWTH_POWER, GROWTH_EXPONENTIAL };
enum { GROWTH_LAWS = GROWTH_EXPONENTIAL + 1 };
struct growth_fit {
    double a, b, residual;
};
struct growth_fit stats_growth(enum growth_law law, const double *x, const double *y, size_t count);
double growth_at(enum growth_law law, const struct growth_fit *fit, double x);
const char *growth_word(enum growth_law law);

/* Quantiles: p in [0, 1] (ends: infinite), degrees of freedom > 0; NaN outside. */
double stats_normal_quantile(double p);
double stats_student_quantile(double p, double degrees);

/* Marks the points that no other point beats in both cost and error (lower is better); ties keep
 * the first. */
void stats_pareto(const double *cost, const double *error, size_t count, bool *on_front);

#endif
