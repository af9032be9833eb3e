/* A progress bar with time left, on stderr; silent unless stderr is a terminal or lines were asked
 * for. */
#ifndef TREELINE_BASE_PROGRESS_H
#define TREELINE_BASE_PROGRESS_H

struct progress;

/* what: the unit of work ("cell"); total: in any unit, > 0. On a terminal one line is redrawn at
 * most 10 times a second; elsewhere a line is written at most every 10 seconds. quiet draws
 * nothing. */
struct progress *progress_start(const char *title, double total, _Bool quiet);
/* done: so far, in the unit of total; label: what is being done now, may be NULL. Thread-safe. */
void progress_update(struct progress *progress, double done, const char *label);
void progress_end(struct progress *progress); /* NULL is allowed */

#endif
