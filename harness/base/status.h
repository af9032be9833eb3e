/* The outcome of an operation. Every value is also the exit code of the process that ends with it.
 */
#ifndef TREELINE_BASE_STATUS_H
#define TREELINE_BASE_STATUS_H

/* X(NAME, exit code, word in results and messages, what it means).
 * From 64, so that a library's own exit(1) reads as a crash; generated into `treeline help exit`.
 */
#define STATUS_LIST(X)                                                                             \
    X(STATUS_OK, 0, "ok", "everything asked for was done")                                         \
    X(STATUS_USAGE, 64, "usage", "the command line is wrong")                                      \
    X(STATUS_INVALID, 65, "invalid",                                                               \
      "a scene, plan, mesh, image, results file or option is wrong")                               \
    X(STATUS_NOT_FOUND, 66, "not-found", "a file, method, scene, plant or cell does not exist")    \
    X(STATUS_UNSUPPORTED, 67, "unsupported", "the method cannot draw this scene, and says why")    \
    X(STATUS_UNAVAILABLE, 69, "unavailable", "a library, GL context or device is missing here")    \
    X(STATUS_INTERNAL, 70, "internal", "treeline itself is at fault")                              \
    X(STATUS_MEMORY, 71, "memory", "over the memory budget, or the system has none left")          \
    X(STATUS_GL, 72, "gl-error", "OpenGL reported an error")                                       \
    X(STATUS_BAD_PICTURE, 73, "bad-picture", "a picture holds NaN or infinity, or was not drawn")  \
    X(STATUS_IO, 74, "io", "reading or writing failed, for example on a full disk")                \
    X(STATUS_TIMEOUT, 75, "timeout", "a cell ran past its time limit")                             \
    X(STATUS_CRASH, 76, "crash",                                                                   \
      "a cell died of a signal or left by an exit code not listed here")                           \
    X(STATUS_CELLS_FAILED, 77, "cells-failed", "the run finished; at least one cell failed")       \
    X(STATUS_NONCONFORMING, 78, "nonconforming",                                                   \
      "a method breaks its contract: a check of `treeline conform` failed")                        \
    X(STATUS_INTERRUPTED, 130, "interrupted",                                                      \
      "stopped by Ctrl-C or SIGTERM; finished cells are kept")

enum status {
#define STATUS_ENUM(name, code, word, meaning) name = code,
    STATUS_LIST(STATUS_ENUM)
#undef STATUS_ENUM
};

/* The word for a status ("timeout"), or "unknown". */
const char *status_word(enum status status);
/* What a status means, one sentence without a full stop; "" for a code not listed. */
const char *status_meaning(enum status status);
/* The status with this word; false when there is none. */
_Bool status_from_word(const char *word, enum status *status);

#endif
