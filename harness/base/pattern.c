/* Regular expressions that people type. */
#include "base/pattern.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>

/* Behind a "[...]" that begins here; its end when it is not closed. */
static const char *bracket_end(const char *text)
{
    text += 1 + (text[1] == '^');
    text += *text == ']'; /* the first one stands for itself */
    while (*text && *text != ']')
        text++;
    return *text ? text + 1 : text;
}

/* The larger number of "{M,N}", at least 1; more than the most counts as one more. */
static double repeats(const char *text)
{
    double largest = 1;
    while (*text && *text != '}') {
        if (!isdigit((unsigned char)*text)) {
            text++;
            continue;
        }
        char *end;
        double value = (double)strtoul(text, &end, 10);
        largest = value > largest ? value : largest;
        text = end;
    }
    return largest;
}

/* NULL: harmless. */
static const char *danger(const char *text)
{
    double product = 1;
    if (strlen(text) > PATTERN_LENGTH_MAX)
        return "is longer than 1000 bytes";
    while (*text) {
        if (*text == '\\' && text[1] >= '1' && text[1] <= '9')
            return "refers back by \\1 to \\9";
        if (*text == '{')
            product *= repeats(text);
        if (product > PATTERN_REPEATS_MAX)
            return "repeats by {M,N} more than 1000 times in all";
        text = *text == '[' ? bracket_end(text) : text + 1 + (*text == '\\' && text[1]);
    }
    return NULL;
}

enum status pattern_compile(const char *text, const char *who, enum status wrong, regex_t *pattern,
                            struct error *error)
{
    const char *why = danger(text);
    char answer[128];
    if (why)
        return error_set(error, wrong, "%s: '%.60s%s' %s, which may take for ever", who, text,
                         strlen(text) > 60 ? "..." : "", why);
    int code = regcomp(pattern, text, REG_EXTENDED | REG_NOSUB);
    if (!code)
        return STATUS_OK;
    regerror(code, pattern, answer, sizeof answer);
    return error_set(error, wrong, "%s: '%s' is no regular expression: %s", who, text, answer);
}
