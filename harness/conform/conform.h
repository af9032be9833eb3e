/* The conformance suite: what method.h promises, checked on any method, each check in a process of
 * its own. */
#ifndef TREELINE_CONFORM_CONFORM_H
#define TREELINE_CONFORM_CONFORM_H

#include "base/arena.h"
#include "base/error.h"

#include <stdbool.h>

enum conform_result { CONFORM_OK, CONFORM_SKIPPED, CONFORM_REFUSED, CONFORM_FAILED };
const char *conform_word(enum conform_result result); /* "ok", "skipped", "refused", "FAILED" */

struct conform_row {
    const char *method, *check;
    enum conform_result result;
    enum status status;  /* the cause of a failure or a refusal, else STATUS_OK */
    const char *message; /* why, or figures; one line */
    double seconds;
};

struct conform_request {
    const char *method;     /* a name, or a plugin's path */
    const char *pattern;    /* POSIX extended regular expression on the checks' names; NULL: all */
    double timeout_seconds; /* of a check; 0: CONFORM_TIMEOUT_SECONDS */
    const char *backend;    /* NULL: chosen by gl_context_create */
    void (*heard)(void *listener, const struct conform_row *row);
    void *listener;
};
#define CONFORM_TIMEOUT_SECONDS 60.0

/* Runs the checks of one method and tells each row as it is known. *status: STATUS_OK; what a
 * method that cannot be loaded is refused with (then no other check is run); else
 * STATUS_NONCONFORMING. Returns an error only for what is not the method's fault:
 * STATUS_INTERRUPTED, STATUS_UNAVAILABLE without OpenGL, a wrong pattern, no process. This process
 * loads no plugin and touches no GL. */
enum status conform_run(struct arena *arena, const struct conform_request *request,
                        enum status *status, struct error *error);

/* The checks' names and meanings in order; false behind the last. */
bool conform_check_at(size_t index, const char **name, const char **doc);

#endif
