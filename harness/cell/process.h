/* Work in a child process: what it says, how it ends, and that it ends. */
#ifndef TREELINE_CELL_PROCESS_H
#define TREELINE_CELL_PROCESS_H

#include "base/arena.h"
#include "base/error.h"

#include <stdbool.h>

struct process_request {
    /* Runs in the child; what it writes to out reaches the parent; what it returns is the exit
     * code. */
    enum status (*work)(void *context, int out);
    void *context;
    double timeout_seconds; /* 0: none */
    /* In the parent, for each whole line the child wrote, without its newline; NULL: not wanted. */
    void (*heard)(void *listener, const char *line);
    void *listener;
};

struct process_outcome {
    bool interrupted;   /* this process was asked to stop by SIGINT, SIGTERM or SIGHUP; the child is
                           dead */
    bool timed_out;     /* the child was ended for its time */
    bool out_of_memory; /* the system killed a process for memory, and the child died of SIGKILL */
    int exit_code;      /* when signal is 0 */
    int signal;         /* that ended it, else 0 */
    double seconds;
    char *output;      /* all the child wrote to out, NUL behind its end */
    char errors[1024]; /* last line of text the child wrote to stdout or stderr; of a crash also
                          where it was (base/crash.h) */
};

/* Forks, works, waits. Signals that come meanwhile are consumed here. The child is the leader of a
 * process group that is killed as a whole, dies with this process, and is the first to go when
 * memory runs out. */
enum status process_run(struct arena *arena, const struct process_request *request,
                        struct process_outcome *outcome, struct error *error);

#endif
