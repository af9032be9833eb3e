/* An error: a status and one clear line that names the file, the thing, the value and the
 * allowance. */
#ifndef TREELINE_BASE_ERROR_H
#define TREELINE_BASE_ERROR_H

#include "base/status.h"

struct error {
    enum status status;
    char text[1024]; /* one line, no newline; over-long text ends in "..." */
};

/* Sets status and text, printf's way; error may be NULL. Newlines in the text become spaces. */
void error_write(struct error *error, enum status status, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* error_write that returns its status, so that `return error_set(...)` reads well. A macro, so that
 * compilers and analysers see which status comes back; status is evaluated twice. */
#define error_set(error, status, ...)                                                              \
    error_returns((error_write((error), (status), __VA_ARGS__), (status)))
static inline enum status error_returns(enum status status)
{
    return status;
}

/* Puts "CONTEXT: " before the text already there; returns the status already there. */
enum status error_context(struct error *error, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/* error_set with ": strerror(errno)" behind the text. */
enum status error_errno(struct error *error, enum status status, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

#endif
