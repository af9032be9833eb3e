/* For benchmarks: how far a picture is from another. */
#ifndef TREELINE_TESTS_BENCH_ERROR_H
#define TREELINE_TESTS_BENCH_ERROR_H

#include "truth/frame.h"

#include <math.h>

/* Root mean square over RGB of boxes of side x side pixels. */
static inline double rmse(const struct frame *a, const struct frame *b, int side)
{
    double sum = 0;
    size_t count = 0;
    for (int y = 0; y + side <= a->height_px; y += side)
        for (int x = 0; x + side <= a->width_px; x += side, count++)
            for (int c = 0; c < 3; c++) {
                double off = 0;
                for (int k = 0; k < side * side; k++) {
                    size_t at =
                        (size_t)(y + k / side) * (size_t)a->width_px + (size_t)(x + k % side);
                    off +=
                        (double)a->rgba[4 * at + (size_t)c] - (double)b->rgba[4 * at + (size_t)c];
                }
                off /= side * side;
                sum += off * off / 3;
            }
    return sqrt(sum / (double)count);
}

#endif
