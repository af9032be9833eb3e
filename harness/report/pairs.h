/* Pairs of cells that differ in the sun's shadows alone: a method without and with them. */
#ifndef TREELINE_REPORT_PAIRS_H
#define TREELINE_REPORT_PAIRS_H

#include "report/book.h"

struct shadow_pair {
    size_t without, with;  /* rows of one group, method, level and format */
    struct interval price; /* frame time with over that without, by rounds */
};

/* A row that draws the sun's shadows and one of the same method that does not. Their options are
 * alike but for the one that switches shadows, and for those that only mean something with them:
 * their text begins with the switch's name and "=", such as "shadow=map: texels along ...". One
 * pair at most for each row with shadows, in their order; methods that are not built in have no
 * table here.
 */
struct shadow_pair *shadow_pairs(const struct book *book, const struct group *group, size_t *count);

#endif
