/* Words and meanings of statuses, from the one list in status.h. */
#include "base/status.h"

#include <stdbool.h>
#include <stddef.h>
#include <string.h>

static const struct {
    enum status status;
    const char *word, *meaning;
} rows[] = {
#define STATUS_ROW(name, code, word, meaning) {name, word, meaning},
    STATUS_LIST(STATUS_ROW)
#undef STATUS_ROW
};
enum { ROWS_COUNT = sizeof rows / sizeof rows[0] };

const char *status_word(enum status status)
{
    for (size_t i = 0; i < ROWS_COUNT; i++)
        if (rows[i].status == status)
            return rows[i].word;
    return "unknown";
}

const char *status_meaning(enum status status)
{
    for (size_t i = 0; i < ROWS_COUNT; i++)
        if (rows[i].status == status)
            return rows[i].meaning;
    return "";
}

_Bool status_from_word(const char *word, enum status *status)
{
    for (size_t i = 0; i < ROWS_COUNT; i++)
        if (strcmp(rows[i].word, word) == 0) {
            *status = rows[i].status;
            return true;
        }
    return false;
}
