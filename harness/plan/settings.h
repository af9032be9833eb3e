/* The measuring settings of a plan: one table for plan files, command line, ranges and
 * documentation. */
#ifndef TREELINE_PLAN_SETTINGS_H
#define TREELINE_PLAN_SETTINGS_H

#include "plan/plan.h"

struct plan_settings {
    int rounds;
    double frame_seconds;
    int frames_max;
    double timeout_seconds, memory_bytes, reference_error;
    int reference_samples_max, threads, views;
};

extern const struct option plan_settings_table[];

/* Sets the field of a row to a value that is in range. */
void plan_settings_put(struct plan_settings *settings, const struct option *option, double value);
/* What the request gave, checked against the table. */
enum status plan_settings_override(struct plan_settings *settings,
                                   const struct plan_request *request, struct error *error);

/* The options of `treeline run` that say what a plan's settings say, where those are not the
 * defaults: "--timeout 0.05 --threads 2"; "": none. How many rounds is left out. */
const char *plan_settings_command(struct arena *arena, const struct plan *plan);

#endif
