/* Regular expressions that people type, bounded before the system's compiler sees them. */
#ifndef TREELINE_BASE_PATTERN_H
#define TREELINE_BASE_PATTERN_H

#include "base/error.h"

#include <regex.h>

#define PATTERN_LENGTH_MAX 1000
#define PATTERN_REPEATS_MAX 1000

/* Compiles a POSIX extended regular expression for whole-or-part matches; who: the option's name in
 * errors. The given status for what is none, for one longer than PATTERN_LENGTH_MAX bytes, for
 * counts {M,N} whose product is above PATTERN_REPEATS_MAX, and for \1 to \9: the last three can
 * take memory and time without end. regfree it. */
enum status pattern_compile(const char *text, const char *who, enum status wrong, regex_t *pattern,
                            struct error *error);

#endif
