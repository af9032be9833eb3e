/* An error: a status and one clear line that names the file, the thing, the value and the
 * allowance. */
#ifndef TREELINE_BASE_ERROR_H
#define TREELINE_BASE_ERROR_H

#include "base/status.h"

struct error {
    enum status status;
    char text[1024]; /* one line, no newline; over-long text ends in "..." */
};

/* Sets status and text; returns status, so that `return error_set(...)` reads well.
 * error may be NULL: then only the status is returned. Newlines in the text become spaces. */
enum status error_set(struct error *error, enum status status, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* Puts "CONTEXT: " before the text already there; returns the status already there. */
enum status error_context(struct error *error, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/* error_set with ": strerror(errno)" behind the text. */
enum status error_errno(struct error *error, enum status status, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

#endif
