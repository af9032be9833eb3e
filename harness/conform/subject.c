/* What a check tells: announcements, notes, reasons. */
#include "conform/subject.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

void subject_say(const struct subject *subject, const char *format, ...)
{
    char text[256];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    /* A parent that went away is noticed elsewhere. */
    if (dprintf(subject->out, "#%s\n", text) < 0)
        return;
}

void subject_note(struct subject *subject, const char *format, ...)
{
    size_t used = strlen(subject->note);
    va_list arguments;
    va_start(arguments, format);
    if (used && used + 2 < sizeof subject->note)
        used += (size_t)snprintf(subject->note + used, sizeof subject->note - used, ", ");
    vsnprintf(subject->note + used, sizeof subject->note - used, format, arguments);
    va_end(arguments);
}

enum status subject_skip(struct subject *subject, const char *reason)
{
    subject->skipped = true;
    snprintf(subject->note, sizeof subject->note, "%s", reason);
    return STATUS_OK;
}

bool subject_is_treeless(struct subject *subject)
{
    if (!(subject->method->traits & TRAIT_NO_TREES))
        return false;
    subject_skip(subject, "draws no trees");
    return true;
}
