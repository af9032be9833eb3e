/* The lock of a run's folder: two runs never write into one. */
#ifndef TREELINE_RESULTS_RUN_H
#define TREELINE_RESULTS_RUN_H

#include "results/result.h"

/* Takes FOLDER/.lock for this process (children do not inherit it; it ends with the process).
 * STATUS_USAGE names the process that holds it. */
enum status run_lock(const char *folder, int *lock, struct error *error);
void run_unlock(int lock);

#endif
