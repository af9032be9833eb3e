/* Errors: one line of text, set once, given context on the way up. */
#include "base/error.h"

#include <errno.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

/* Keeps the text one line, free of what a terminal would obey, and shows that it was cut. */
static void text_finish(char *text, size_t size, size_t needed)
{
    if (needed >= size)
        memcpy(text + size - 4, "...", 4);
    for (char *c = text; *c; c++)
        if ((unsigned char)*c < ' ' || *c == 0x7f)
            *c = ' ';
}

static void text_set(struct error *error, const char *format, va_list arguments)
{
    /* The arguments may point into error->text. */
    char text[sizeof error->text];
    int needed = vsnprintf(text, sizeof text, format, arguments);
    text_finish(text, sizeof text, needed < 0 ? 0 : (size_t)needed);
    memcpy(error->text, text, sizeof text);
}

void error_write(struct error *error, enum status status, const char *format, ...)
{
    if (!error)
        return;
    va_list arguments;
    va_start(arguments, format);
    text_set(error, format, arguments);
    va_end(arguments);
    error->status = status;
}

enum status error_context(struct error *error, const char *format, ...)
{
    if (!error)
        return STATUS_INTERNAL;
    char old[sizeof error->text], context[sizeof error->text];
    memcpy(old, error->text, sizeof old);
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(context, sizeof context, format, arguments);
    va_end(arguments);
    return error_set(error, error->status, "%s: %s", context, old);
}

enum status error_errno(struct error *error, enum status status, const char *format, ...)
{
    int number = errno;
    if (!error)
        return status;
    va_list arguments;
    va_start(arguments, format);
    text_set(error, format, arguments);
    va_end(arguments);
    char old[sizeof error->text];
    memcpy(old, error->text, sizeof old);
    return error_set(error, status, "%s: %s", old, strerror(number));
}
