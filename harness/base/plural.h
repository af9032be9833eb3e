/* The s of a plural. */
#ifndef TREELINE_BASE_PLURAL_H
#define TREELINE_BASE_PLURAL_H

#include <stddef.h>

/* "1 tree", "0 trees": printf("%zu tree%s", count, plural(count)). */
static inline const char *plural(size_t count)
{
    return count == 1 ? "" : "s";
}

#endif
