/* Logarithmic axes whose ticks are chosen here, so that narrow ranges still have some; and axes of
 * degrees. */
#ifndef TREELINE_REPORT_AXIS_H
#define TREELINE_REPORT_AXIS_H

#include <stdbool.h>
#include <stdio.h>

struct axis {
    double low, high; /* of the positive values seen; low > high: none yet */
    bool is_degrees;  /* linear */
};
struct axis axis_empty(void);
struct axis axis_degrees(double low, double high);
void axis_add(struct axis *axis, double value); /* only finite values above 0 count */
/* Widens by factors of the span in decades, to at least half a decade; an empty axis becomes
 * 0.1..1. */
void axis_widen(struct axis *axis, double part_below, double part_above);
/* Writes "set xrange [...]" and "set xtics (...)": which is "x" or "y". */
void axis_put(const struct axis *axis, const char *which, FILE *out);

#endif
