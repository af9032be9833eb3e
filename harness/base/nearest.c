/* Edit distance. */
#include "base/nearest.h"

#include <ctype.h>
#include <stddef.h>
#include <string.h>

enum { LENGTH_MAX = 63 };

static size_t distance(const char *a, const char *b)
{
    size_t row[LENGTH_MAX + 1];
    size_t width = strnlen(b, LENGTH_MAX), height = strnlen(a, LENGTH_MAX);
    for (size_t j = 0; j <= width; j++)
        row[j] = j;
    for (size_t i = 1; i <= height; i++) {
        size_t diagonal = row[0];
        row[0] = i;
        for (size_t j = 1; j <= width; j++) {
            int same = tolower((unsigned char)a[i - 1]) == tolower((unsigned char)b[j - 1]);
            size_t best = diagonal + !same;
            diagonal = row[j];
            if (row[j] + 1 < best)
                best = row[j] + 1;
            if (row[j - 1] + 1 < best)
                best = row[j - 1] + 1;
            row[j] = best;
        }
    }
    return row[width];
}

const char *nearest_of(const char *name, const char *best, const char *candidate)
{
    return best && distance(name, best) <= distance(name, candidate) ? best : candidate;
}
