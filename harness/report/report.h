/* From a run to tables, plots and a page. Reads only what the run's folder holds. */
#ifndef TREELINE_REPORT_REPORT_H
#define TREELINE_REPORT_REPORT_H

#include "base/arena.h"
#include "base/error.h"
#include "results/result.h"

/* One row of every table: a cell over its successful repetitions. */
struct summary {
    const struct result *first; /* a successful repetition, or the first failed one */
    size_t repetitions, failures;
    struct {
        double value, low, high;
    } frame_seconds; /* median over repetitions of each one's median, with its 95 % interval */
    bool on_front;   /* Pareto front of frame time and FLIP within its scene and tree count */
};
struct summary *report_summaries(struct arena *arena, const struct run *run, size_t *count);

/* Writes OUT/index.html (self-contained), OUT/plots/NAME.{dat,gp,svg,png}, OUT/tables/results.{md,csv,tex}.
 * Without gnuplot: STATUS_UNAVAILABLE after the tables were written. */
enum status report_write(const char *run_path, const char *out_folder, struct error *error);

#endif
