/* JSON text before it is parsed: how deep, whether UTF-8, whether anything stands there. */
#include "wall/json_text.h"

#include <stdbool.h>
#include <string.h>

size_t utf8_length(const char *text)
{
    const unsigned char *c = (const unsigned char *)text;
    if (c[0] < 0x80)
        return 1;
    if (c[0] < 0xc2 || c[0] > 0xf4) /* a tail, an overlong pair, above U+10FFFF */
        return 0;
    size_t length = c[0] < 0xe0 ? 2 : c[0] < 0xf0 ? 3 : 4;
    for (size_t i = 1; i < length; i++)
        if ((c[i] & 0xc0) != 0x80)
            return 0;
    bool overlong = (c[0] == 0xe0 && c[1] < 0xa0) || (c[0] == 0xf0 && c[1] < 0x90);
    bool surrogate = c[0] == 0xed && c[1] > 0x9f;
    bool above = c[0] == 0xf4 && c[1] > 0x8f;
    return overlong || surrogate || above ? 0 : length;
}

static enum status refuse(const char *text, const char *at, const char *where, const char *why,
                          struct error *error)
{
    int line = 1;
    for (const char *c = text; c < at; c++)
        line += *c == '\n';
    return error_set(error, STATUS_INVALID, "%s:%d: %s", where, line, why);
}

enum status json_text_check(const char *text, const char *where, struct error *error)
{
    int depth = 0;
    bool quoted = false;
    size_t step;
    for (const char *c = text; *c; c += step) {
        step = utf8_length(c);
        if (step == 0)
            return refuse(text, c, where, "not JSON: a byte that is not UTF-8", error);
        if (*c == '"')
            quoted = !quoted;
        if (quoted && *c == '\\' && c[1]) {
            if (strncmp(c, "\\u0000", 6) == 0)
                return refuse(text, c, where, "a text holds \\u0000; no text may", error);
            step = (unsigned char)c[1] < 0x80 ? 2 : 1; /* an escaped quote ends no text */
        }
        if (!quoted && (*c == '[' || *c == '{') && ++depth > JSON_NESTING_MAX)
            return refuse(text, c, where, "is nested deeper than 64 levels", error);
        if (!quoted && (*c == ']' || *c == '}'))
            depth--;
    }
    if (text[strspn(text, " \t\r\n")] == '\0')
        return error_set(error, STATUS_INVALID, "%s: is empty; JSON is expected", where);
    return STATUS_OK;
}
