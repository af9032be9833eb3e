/* Runs gnuplot on a script. */
#include "wall/gnuplot.h"

#include "wall/program.h"

#include <stddef.h>

enum status gnuplot_run(const char *folder, const char *script, double timeout_seconds,
                        struct error *error)
{
    const char *const arguments[] = {"gnuplot", script, NULL};
    enum status status = program_run(folder, arguments, timeout_seconds, "gnuplot-nox", error);
    return status ? error_context(error, "%s", script) : STATUS_OK;
}
