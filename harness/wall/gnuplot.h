/* gnuplot, a foreign program: run apart, its complaints kept, its time limited. */
#ifndef TREELINE_WALL_GNUPLOT_H
#define TREELINE_WALL_GNUPLOT_H

#include "base/error.h"

/* Runs `gnuplot SCRIPT` inside folder; script is a file name there. STATUS_UNAVAILABLE when there
 * is no gnuplot on the PATH, STATUS_TIMEOUT past the limit, STATUS_IO with gnuplot's last line when
 * it failed. */
enum status gnuplot_run(const char *folder, const char *script, double timeout_seconds,
                        struct error *error);

#endif
