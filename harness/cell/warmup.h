/* When a cell is warm: its frame time has stopped falling. */
#ifndef TREELINE_CELL_WARMUP_H
#define TREELINE_CELL_WARMUP_H

#include <stdbool.h>
#include <stddef.h>

#define WARMUP_WINDOW 5
#define WARMUP_FRAMES_MAX 64

/* seconds: the frames drawn so far, without the first. True when the median of the newest
 * WARMUP_WINDOW is not more than 2 % below the median of the WARMUP_WINDOW before them, so that one
 * outlier neither starts nor stops the measurement; also when limit_seconds were spent or
 * WARMUP_FRAMES_MAX frames drawn. */
bool warmup_done(const double *seconds, size_t count, double limit_seconds);

#endif
