/* From a run to tables, plots and a page. Reads only what the run's folder holds. */
#ifndef TREELINE_REPORT_REPORT_H
#define TREELINE_REPORT_REPORT_H

#include "base/arena.h"
#include "base/error.h"
#include "results/limit.h"
#include "results/result.h"

/* One row of every table: a cell over its successful repetitions. */
struct summary {
    const struct result *first;    /* a successful repetition, one with compared pictures before one
                                      without; or the first failed one */
    const struct result **results; /* every repetition, in file order */
    size_t repetitions, failures;  /* of these, that succeeded; that did not */
    struct {
        double value, low, high;
    } frame_seconds;    /* median over repetitions of each one's median, with its 95 % interval */
    struct limit limit; /* what bounds the frame time, and how near the limit it comes */
    bool on_front; /* Pareto front of frame time and FLIP (same effects) among comparable cells;
                      never the method null, which draws no tree */
};
/* In the order in which the cells first occur in the run. */
struct summary *report_summaries(struct arena *arena, const struct run *run, size_t *count);

size_t report_trees(const struct result *result);
bool report_is_floor(const struct result *result); /* method null */

/* Writes OUT/index.html (self-contained, interactive), OUT/plots/NAME.{dat,gp,svg,png} of the
 * overview, OUT/tables/results.{md,csv,tex} and OUT/pictures/NAME.png (full size). A picture or
 * reference that is missing is said on the page. Without gnuplot: STATUS_UNAVAILABLE, after the
 * tables and a page that says so were written. */
enum status report_write_run(struct arena *arena, const struct run *run, const char *out_folder,
                             struct error *error);
/* The same from a run on disk: its folder or its file. */
enum status report_write(const char *run_path, const char *out_folder, struct error *error);

#endif
