/* Wilcoxon's signed-rank test, Benjamini-Hochberg's q values, the Pareto front. */
#include "stats/stats.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { EXACT_MAX = 50 };

struct signed_rank {
    double magnitude;
    bool positive;
    unsigned twice_rank; /* midranks are halves */
};

static int compare_magnitudes(const void *a, const void *b)
{
    double x = ((const struct signed_rank *)a)->magnitude;
    double y = ((const struct signed_rank *)b)->magnitude;
    return (x > y) - (x < y);
}

/* Gives sorted entries their midranks; returns the sum over ties of t^3 - t. */
static double assign_midranks(struct signed_rank *ranks, size_t count)
{
    double ties = 0;
    for (size_t i = 0; i < count;) {
        size_t end = i;
        while (end < count && ranks[end].magnitude == ranks[i].magnitude)
            end++;
        double t = (double)(end - i);
        ties += t * t * t - t;
        for (size_t k = i; k < end; k++)
            ranks[k].twice_rank = (unsigned)(i + end + 1);
        i = end;
    }
    return ties;
}

/* Counts the 2^n sign patterns by their rank sum (doubled): the null distribution, ties included.
 */
static double exact_p(const struct signed_rank *ranks, size_t count, unsigned observed)
{
    unsigned total = 0;
    for (size_t i = 0; i < count; i++)
        total += ranks[i].twice_rank;
    double *patterns = calloc(total + 1, sizeof *patterns);
    if (!patterns)
        return NAN;
    patterns[0] = 1;
    unsigned reached = 0;
    for (size_t i = 0; i < count; i++) {
        unsigned rank = ranks[i].twice_rank;
        reached += rank;
        for (unsigned sum = reached; sum >= rank; sum--)
            patterns[sum] += patterns[sum - rank];
    }
    double low = 0, high = 0;
    for (unsigned sum = 0; sum <= total; sum++) {
        low += sum <= observed ? patterns[sum] : 0;
        high += sum >= observed ? patterns[sum] : 0;
    }
    free(patterns);
    return fmin(1, 2 * fmin(low, high) / ldexp(1, (int)count));
}

static double normal_p(size_t count, double ties, double observed)
{
    double n = (double)count;
    double mean = n * (n + 1) / 4;
    double variance = n * (n + 1) * (2 * n + 1) / 24 - ties / 48;
    double away = fmax(fabs(observed - mean) - 0.5, 0); /* continuity */
    return variance > 0 ? fmin(1, erfc(away / sqrt(2 * variance))) : 1;
}

double stats_signed_rank_p(const double *differences, size_t count)
{
    struct signed_rank *ranks = calloc(count + 1, sizeof *ranks);
    if (!ranks)
        return NAN;
    size_t kept = 0;
    for (size_t i = 0; i < count; i++)
        if (differences[i] < 0 || differences[i] > 0)
            ranks[kept++] = (struct signed_rank){fabs(differences[i]), differences[i] > 0, 0};
    qsort(ranks, kept, sizeof *ranks, compare_magnitudes);
    double ties = assign_midranks(ranks, kept);
    double twice_sum = 0;
    for (size_t i = 0; i < kept; i++)
        twice_sum += ranks[i].positive ? ranks[i].twice_rank : 0;
    double p = kept == 0           ? 1
               : kept <= EXACT_MAX ? exact_p(ranks, kept, (unsigned)twice_sum)
                                   : normal_p(kept, ties, 0.5 * twice_sum);
    free(ranks);
    return p;
}

struct place {
    double first, second;
    size_t index;
};

static int compare_places(const void *a, const void *b)
{
    const struct place *x = a, *y = b;
    if (x->first != y->first)
        return x->first < y->first ? -1 : 1;
    if (x->second != y->second)
        return x->second < y->second ? -1 : 1;
    return (x->index > y->index) - (x->index < y->index);
}

void stats_benjamini_hochberg(double *p, size_t count)
{
    struct place *places = malloc((count + 1) * sizeof *places);
    if (!places)
        return;
    size_t kept = 0;
    for (size_t i = 0; i < count; i++)
        if (!isnan(p[i]))
            places[kept++] = (struct place){p[i], 0, i};
    qsort(places, kept, sizeof *places, compare_places);
    double smallest = 1;
    for (size_t rank = kept; rank > 0; rank--) {
        double q = places[rank - 1].first * (double)kept / (double)rank;
        smallest = fmin(smallest, q);
        p[places[rank - 1].index] = smallest;
    }
    free(places);
}

void stats_pareto(const double *cost, const double *error, size_t count, bool *on_front)
{
    struct place *places = malloc((count + 1) * sizeof *places);
    size_t kept = 0;
    for (size_t i = 0; i < count; i++) {
        on_front[i] = false;
        if (places && !isnan(cost[i]) && !isnan(error[i]))
            places[kept++] = (struct place){cost[i], error[i], i};
    }
    if (places)
        qsort(places, kept, sizeof *places, compare_places);
    /* By rising cost, a point is beaten unless its error is below all before it. */
    for (size_t i = 0, best = 0; i < kept; i++) {
        if (i > 0 && !(places[i].second < places[best].second))
            continue;
        best = i;
        on_front[places[i].index] = true;
    }
    free(places);
}
