/* Logarithmic axes: ranges and 1-2-5 ticks. Axes of degrees: parts of a right angle. */
#include "report/axis.h"

#include <math.h>
#include <stddef.h>

struct axis axis_empty(void)
{
    return (struct axis){.low = INFINITY};
}

struct axis axis_degrees(double low, double high)
{
    return (struct axis){.low = low, .high = high, .is_degrees = true};
}

void axis_add(struct axis *axis, double value)
{
    if (!(value > 0) || isinf(value))
        return;
    axis->low = fmin(axis->low, value);
    axis->high = fmax(axis->high, value);
}

void axis_widen(struct axis *axis, double part_below, double part_above)
{
    if (axis->low > axis->high)
        *axis = (struct axis){.low = 0.1, .high = 1};
    double middle = 0.5 * (log10(axis->low) + log10(axis->high));
    double half = fmax(0.5 * (log10(axis->high) - log10(axis->low)), 0.25);
    axis->low = pow(10, middle - half - part_below * 2 * half);
    axis->high = pow(10, middle + half + part_above * 2 * half);
}

/* Ticks per decade, coarse to fine; each list ends with 0. */
static const double mantissas[][11] = {
    {1, 0},
    {1, 3, 0},
    {1, 2, 5, 0},
    {1, 1.5, 2, 3, 5, 7, 0},
    {1, 1.2, 1.5, 2, 2.5, 3, 4, 5, 6, 8, 0},
};

static int put_ticks(const struct axis *axis, size_t list, FILE *out)
{
    int count = 0;
    int first = (int)floor(log10(axis->low)), last = (int)floor(log10(axis->high));
    int step = 1 + (last - first) / 9; /* many decades: only some get a tick */
    for (int power = first; power <= last; power += step)
        for (const double *m = mantissas[list]; *m > 0; m++) {
            double value = *m * pow(10, power);
            if (value < axis->low || value > axis->high)
                continue;
            char text[32];
            snprintf(text, sizeof text, "%.3g", value);
            if (value >= 1000)
                snprintf(text, sizeof text, value < 1e6 ? "%.3gk" : "%.3gM",
                         value / (value < 1e6 ? 1e3 : 1e6));
            if (out)
                fprintf(out, "%s\"%s\" %.12g", count ? ", " : "", text, value);
            count++;
        }
    return count;
}

static void put_degrees(const struct axis *axis, const char *which, FILE *out)
{
    static const double steps[] = {1, 2, 5, 10, 15, 30, 45, 90};
    size_t last = sizeof steps / sizeof *steps - 1, i = 0;
    while (i < last && axis->high - axis->low > 9 * steps[i])
        i++;
    double margin = 0.02 * (axis->high - axis->low);
    fprintf(out, "set %srange [%.9g:%.9g]\nset %stics %g\n", which, axis->low - margin,
            axis->high + margin, which, steps[i]);
}

void axis_put(const struct axis *axis, const char *which, FILE *out)
{
    if (axis->is_degrees) {
        put_degrees(axis, which, out);
        return;
    }
    size_t lists = sizeof mantissas / sizeof *mantissas, list = 0;
    while (list + 1 < lists && put_ticks(axis, list, NULL) < 4)
        list++;
    fprintf(out, "set %srange [%.9g:%.9g]\nset %stics (", which, axis->low, axis->high, which);
    put_ticks(axis, list, out);
    fputs(")\n", out);
}
