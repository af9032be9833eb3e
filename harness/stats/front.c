/* The Pareto front. */
#include "stats/stats.h"

#include <math.h>
#include <stdlib.h>

struct place {
    double cost, error;
    size_t index;
};

static int compare_places(const void *a, const void *b)
{
    const struct place *x = a, *y = b;
    if (x->cost != y->cost)
        return x->cost < y->cost ? -1 : 1;
    if (x->error != y->error)
        return x->error < y->error ? -1 : 1;
    return (x->index > y->index) - (x->index < y->index);
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
        if (i > 0 && !(places[i].error < places[best].error))
            continue;
        best = i;
        on_front[places[i].index] = true;
    }
    free(places);
}
