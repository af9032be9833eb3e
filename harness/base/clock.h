/* The clocks: monotonic wall time and CPU time, in seconds. */
#ifndef TREELINE_BASE_CLOCK_H
#define TREELINE_BASE_CLOCK_H

double clock_wall_seconds(void); /* CLOCK_MONOTONIC; only differences mean something */
double clock_cpu_seconds(void);  /* CPU time of the whole process, all threads */
/* CPUs this process may run on (sched affinity), at least 1. */
int clock_cpu_count(void);

#endif
