/* Between the files of `treeline run`. */
#ifndef TREELINE_CLI_RUN_H
#define TREELINE_CLI_RUN_H

#include "cli/cli.h"
#include "results/result.h"

struct run_request {
    struct plan_request plan;
    const char *out; /* NULL: results/PLAN-TIME */
    bool resume, retry, dry_run, report, quiet, json, no_calibrate;
};

/* The command line; ends the process on a wrong one. Lists are allocated in the arena. */
void run_request_parse(struct arena *arena, int argc, char **argv, struct run_request *request);

/* Per cell: median frame time with its interval, error, status; on stdout. */
enum status run_table(struct arena *arena, const char *folder, bool json, struct error *error);

#endif
