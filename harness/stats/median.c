/* Order statistics and means: median, quantile, median absolute deviation, geometric mean. */
#include "stats/stats.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static int compare_doubles(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* A sorted copy without NaN in *count values; the caller frees it. NULL when nothing is left. */
static double *sorted_copy(const double *values, size_t *count)
{
    double *copy = *count ? malloc(*count * sizeof *copy) : NULL;
    if (!copy) {
        *count = 0;
        return NULL;
    }
    size_t kept = 0;
    for (size_t i = 0; i < *count; i++)
        if (!isnan(values[i]))
            copy[kept++] = values[i];
    *count = kept;
    qsort(copy, kept, sizeof *copy, compare_doubles);
    if (kept == 0) {
        free(copy);
        return NULL;
    }
    return copy;
}

double stats_quantile(const double *values, size_t count, double q)
{
    double *sorted = sorted_copy(values, &count);
    if (!sorted || isnan(q)) {
        free(sorted);
        return NAN;
    }
    double place = fmin(fmax(q, 0), 1) * (double)(count - 1);
    size_t below = (size_t)place;
    size_t above = below + 1 < count ? below + 1 : below;
    double part = place - (double)below;
    /* Not a + part (b - a): infinities must not become NaN. */
    double value = part > 0 ? (1 - part) * sorted[below] + part * sorted[above] : sorted[below];
    free(sorted);
    return value;
}

double stats_median(const double *values, size_t count)
{
    return stats_quantile(values, count, 0.5);
}

double stats_geometric_mean(const double *values, size_t count)
{
    double sum = 0;
    for (size_t i = 0; i < count; i++) {
        if (!(values[i] > 0))
            return NAN;
        sum += log(values[i]);
    }
    return count ? exp(sum / (double)count) : NAN;
}
