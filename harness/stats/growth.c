/* Which law a series grows by: straight lines, powers and exponentials, fitted alike. */
#include "stats/stats.h"

#include <math.h>

/* The model's value at x and its derivatives by the two parameters: p + q x, e^p x^q, e^(p + q x).
 */
static double model(enum growth_law law, const double parameters[2], double x, double slopes[2])
{
    double p = parameters[0], q = parameters[1];
    double value = law == GROWTH_LINEAR  ? p + q * x
                   : law == GROWTH_POWER ? exp(p) * pow(x, q)
                                         : exp(p + q * x);
    slopes[0] = law == GROWTH_LINEAR ? 1 : value;
    slopes[1] = law == GROWTH_LINEAR ? x : law == GROWTH_POWER ? value * log(x) : value * x;
    return value;
}

static double squares(enum growth_law law, const double parameters[2], const double *x,
                      const double *y, size_t count)
{
    double sum = 0, slopes[2];
    for (size_t i = 0; i < count; i++)
        if (x[i] > 0 && y[i] > 0)
            sum += pow(model(law, parameters, x[i], slopes) / y[i] - 1, 2);
    return sum;
}

/* One step of Gauss and Newton, halved until the sum of squares falls; false: it falls no more. */
static bool improve(enum growth_law law, double parameters[2], const double *x, const double *y,
                    size_t count, double *sum)
{
    double a00 = 0, a01 = 0, a11 = 0, b0 = 0, b1 = 0, slopes[2];
    for (size_t i = 0; i < count; i++) {
        if (!(x[i] > 0 && y[i] > 0))
            continue;
        double away = 1 - model(law, parameters, x[i], slopes) / y[i];
        double s0 = slopes[0] / y[i], s1 = slopes[1] / y[i];
        a00 += s0 * s0;
        a01 += s0 * s1;
        a11 += s1 * s1;
        b0 += s0 * away;
        b1 += s1 * away;
    }
    double determinant = a00 * a11 - a01 * a01;
    if (!(determinant > 1e-14 * a00 * a11))
        return false;
    double step[2] = {(a11 * b0 - a01 * b1) / determinant, (a00 * b1 - a01 * b0) / determinant};
    for (int halvings = 0; halvings < 20; halvings++) {
        double part = ldexp(1, -halvings);
        double tried[2] = {parameters[0] + part * step[0], parameters[1] + part * step[1]};
        double next = squares(law, tried, x, y, count);
        if (!(next < *sum))
            continue;
        bool more = *sum - next > 1e-12 * *sum;
        parameters[0] = tried[0];
        parameters[1] = tried[1];
        *sum = next;
        return more;
    }
    return false;
}

struct growth_fit stats_growth(enum growth_law law, const double *x, const double *y, size_t count)
{
    enum { STEPS_MAX = 200 };
    struct growth_fit fit = {NAN, NAN, NAN};
    size_t n = 0;
    double low = INFINITY, high = -INFINITY, logs = 0, sum_y = 0;
    for (size_t i = 0; i < count; i++) {
        if (!(x[i] > 0 && y[i] > 0))
            continue;
        n++;
        low = fmin(low, x[i]);
        high = fmax(high, x[i]);
        logs += log(y[i]);
        sum_y += y[i];
    }
    if (n < 3 || !(high > low))
        return fit;
    double mean = law == GROWTH_LINEAR ? sum_y / (double)n : logs / (double)n;
    double parameters[2] = {mean, 0};
    double sum = squares(law, parameters, x, y, count);
    for (int i = 0; i < STEPS_MAX && improve(law, parameters, x, y, count, &sum); i++)
        ;
    fit.a = law == GROWTH_LINEAR ? parameters[0] : exp(parameters[0]);
    fit.b = parameters[1];
    fit.residual = sqrt(sum / ((double)n - 2));
    return fit;
}

double growth_at(enum growth_law law, const struct growth_fit *fit, double x)
{
    double slopes[2];
    double parameters[2] = {law == GROWTH_LINEAR ? fit->a : log(fit->a), fit->b};
    return model(law, parameters, x, slopes);
}

const char *growth_word(enum growth_law law)
{
    static const char *const words[] = {"linear", "power law", "exponential"};
    return words[law];
}
