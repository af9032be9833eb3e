/* A look at JSON text before cJSON reads it. */
#ifndef TREELINE_WALL_JSON_TEXT_H
#define TREELINE_WALL_JSON_TEXT_H

#include "base/error.h"

#include <stddef.h>

enum { JSON_NESTING_MAX = 64 };

/* STATUS_INVALID "WHERE:LINE: ..." for what cJSON would refuse without saying why, or take: a text
 * without a value, brackets nested deeper than JSON_NESTING_MAX, bytes that are not UTF-8, a NUL
 * written as \u0000. */
enum status json_text_check(const char *text, const char *where, struct error *error);

/* Bytes of the UTF-8 sequence (RFC 3629) at the start of a text that ends in a NUL; 0: it is none.
 */
size_t utf8_length(const char *text);

#endif
