/* A child process that may crash or hang in our stead. */
#ifndef TREELINE_BASE_CHILD_H
#define TREELINE_BASE_CHILD_H

/* To be called first in the child of a fork: signals end it (no handler of the parent's, no
 * sanitizer's), its parent's end too, and limit_seconds; it leaves no core and writes nothing to
 * stderr. It must leave by _exit: exit handlers belong to the parent's GL, threads and tests. */
void child_begin(unsigned limit_seconds);

#endif
