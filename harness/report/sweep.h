/* Options that a run sweeps: rows that differ in the value of one numeric option alone. */
#ifndef TREELINE_REPORT_SWEEP_H
#define TREELINE_REPORT_SWEEP_H

#include "report/book.h"

struct sweep_point {
    size_t row;
    double value;       /* of the option, above 0 */
    const char *option; /* its name */
    const char *unit;
    const char *rest; /* the other options that differ from their defaults, canonical */
};
/* One method at one level and format: points by rising value, three values at least. */
struct sweep_curve {
    const struct sweep_point *points;
    size_t points_count;
    const char *label; /* the method and what stays the same */
};
/* An option's curves in one group; of a family's groups the one with the most trees. */
struct sweep {
    const char *option, *unit;
    size_t group;
    size_t curves_count;
    const struct sweep_curve *curves;
};
struct sweep *sweeps_find(const struct book *book, size_t *count);

#endif
