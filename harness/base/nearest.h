/* The name that was probably meant. */
#ifndef TREELINE_BASE_NEAREST_H
#define TREELINE_BASE_NEAREST_H

/* The one of best (may be NULL) and candidate that is nearer to name by edit distance (Levenshtein
 * 1966, upper and lower case alike, names up to 63 characters); best on a tie. Fold over a list to
 * find the nearest. */
const char *nearest_of(const char *name, const char *best, const char *candidate);

#endif
