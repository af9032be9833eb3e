/* Power laws by least squares of logs, and the quantiles of the normal's and Student's
 * distributions. */
#include "stats/stats.h"

#include <math.h>

double stats_normal_quantile(double p)
{
    if (isnan(p) || p < 0 || p > 1)
        return NAN;
    if (p == 0 || p == 1)
        return p > 0 ? INFINITY : -INFINITY;
    /* Newton on the tail below 1/2, from the crude 26.2.23 of Abramowitz and Stegun (error
     * < 4.5e-4). */
    double tail = fmin(p, 1 - p);
    double t = sqrt(-2 * log(tail));
    double z = t - (2.515517 + t * (0.802853 + t * 0.010328)) /
                       (1 + t * (1.432788 + t * (0.189269 + t * 0.001308)));
    for (int i = 0; i < 4; i++) {
        double density = exp(-0.5 * z * z) / sqrt(2 * M_PI);
        double error = 0.5 * erfc(z / sqrt(2)) - tail;
        double step = error / density;
        z += step / (1 - 0.5 * z * step); /* Halley */
    }
    return p < 0.5 ? -z : z;
}

/* Continued fraction of the incomplete beta function; DLMF 8.17.22, by Lentz's method. */
static double beta_fraction(double a, double b, double x)
{
    const double tiny = 1e-300;
    double c = 1, d = 1 - (a + b) * x / (a + 1);
    d = 1 / (fabs(d) < tiny ? tiny : d);
    double h = d;
    for (int m = 1; m < 1000; m++) {
        double even = m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m));
        double odd = -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1));
        double before = h;
        for (int k = 0; k < 2; k++) {
            double term = k ? odd : even;
            d = 1 + term * d;
            c = 1 + term / c;
            d = 1 / (fabs(d) < tiny ? tiny : d);
            c = fabs(c) < tiny ? tiny : c;
            h *= c * d;
        }
        if (fabs(h - before) <= 1e-15 * fabs(h))
            break;
    }
    return h;
}

/* P(T > t) for t >= 0: half the regularised incomplete beta I_x(v/2, 1/2), x = v / (v + t^2). */
static double student_tail(double t, double degrees)
{
    double a = 0.5 * degrees, b = 0.5;
    double x = degrees / (degrees + t * t), rest = t * t / (degrees + t * t);
    double log_front =
        lgamma(a + b) - lgamma(a) - lgamma(b) + a * log(x) + (rest > 0 ? b * log(rest) : 0);
    if (rest == 0)
        return 0.5;
    if (x < (a + 1) / (a + b + 2))
        return 0.5 * exp(log_front) * beta_fraction(a, b, x) / a;
    return 0.5 * (1 - exp(log_front) * beta_fraction(b, a, rest) / b);
}

double stats_student_quantile(double p, double degrees)
{
    if (isnan(p) || p < 0 || p > 1 || !(degrees > 0))
        return NAN;
    if (p == 0 || p == 1)
        return p > 0 ? INFINITY : -INFINITY;
    double tail = fmin(p, 1 - p), low = 0, high = 1;
    while (student_tail(high, degrees) > tail && high < 1e300)
        high *= 2;
    for (int i = 0; i < 200 && high - low > 1e-15 * high; i++) {
        double middle = 0.5 * (low + high);
        *(student_tail(middle, degrees) > tail ? &low : &high) = middle;
    }
    double t = 0.5 * (low + high);
    return p == 0.5 ? 0 : p < 0.5 ? -t : t;
}

struct power_law stats_power_law(const double *x, const double *y, size_t count)
{
    struct power_law law = {NAN, {NAN, NAN, NAN}, NAN};
    double n = 0, mean_x = 0, mean_y = 0, sxx = 0, sxy = 0, syy = 0;
    for (size_t i = 0; i < count; i++)
        if (x[i] > 0 && y[i] > 0 && isfinite(x[i]) && isfinite(y[i])) {
            n += 1;
            mean_x += log(x[i]);
            mean_y += log(y[i]);
        }
    mean_x /= n;
    mean_y /= n;
    for (size_t i = 0; i < count; i++)
        if (x[i] > 0 && y[i] > 0 && isfinite(x[i]) && isfinite(y[i])) {
            double dx = log(x[i]) - mean_x, dy = log(y[i]) - mean_y;
            sxx += dx * dx;
            sxy += dx * dy;
            syy += dy * dy;
        }
    if (n < 2 || !(sxx > 0))
        return law;
    law.b.value = sxy / sxx;
    law.a = exp(mean_y - law.b.value * mean_x);
    double residual = fmax(syy - sxy * sxy / sxx, 0);
    law.r2 = syy > 0 ? 1 - residual / syy : 1;
    if (n >= 3) {
        double half = stats_student_quantile(0.975, n - 2) * sqrt(residual / (n - 2) / sxx);
        law.b.low = law.b.value - half;
        law.b.high = law.b.value + half;
    }
    return law;
}
