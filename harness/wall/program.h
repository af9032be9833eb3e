/* A foreign program, run apart: its complaints kept, its time limited. */
#ifndef TREELINE_WALL_PROGRAM_H
#define TREELINE_WALL_PROGRAM_H

#include "base/error.h"

/* Runs arguments[0] from the PATH inside folder, without input or output; arguments end with NULL.
 * STATUS_UNAVAILABLE, naming the Debian package, when there is no such program; STATUS_TIMEOUT past
 * the limit; STATUS_IO with the program's last line when it failed. */
enum status program_run(const char *folder, const char *const *arguments, double timeout_seconds,
                        const char *package, struct error *error);

#endif
