/* Fork, pipes, signals and time limits of a child process. */
#include "cell/process.h"

#include "base/clock.h"
#include "base/crash.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/signalfd.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

/* The child's own alarm ends it first; a child that blocks the alarm is killed this much later. */
#define GRACE_SECONDS 1.0

struct child {
    pid_t pid;
    int out, errors, signals; /* ends that the parent reads */
    bool reaped;
    int wait_status;
    size_t size, capacity, lines_end; /* of output; lines_end: behind the last line told */
    char tail[2048];                  /* of stdout and stderr */
    size_t tail_size;
};

static long oom_kills(void)
{
    FILE *file = fopen("/proc/vmstat", "re");
    char line[128];
    long kills = 0;
    while (file && fgets(line, sizeof line, file))
        if (sscanf(line, "oom_kill %ld", &kills) == 1)
            break;
    if (file)
        fclose(file);
    return kills;
}

static void oom_prefer_me(void)
{
    int file = open("/proc/self/oom_score_adj", O_WRONLY | O_CLOEXEC);
    if (file < 0)
        return;
    if (write(file, "1000", 4) != 4)
        errno = 0; /* only a preference */
    close(file);
}

static void alarm_set(double seconds)
{
    if (seconds <= 0)
        return;
    struct itimerval limit = {
        .it_value = {.tv_sec = (time_t)seconds,
                     .tv_usec = (suseconds_t)((seconds - floor(seconds)) * 1e6)}};
    if (!limit.it_value.tv_sec && !limit.it_value.tv_usec)
        limit.it_value.tv_usec = 1;
    setitimer(ITIMER_REAL, &limit, NULL);
}

/* What only the child does; never returns. */
_Noreturn static void child_work(const struct process_request *request, pid_t parent,
                                 const sigset_t *mask, int out, int errors)
{
    setpgid(0, 0);
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != parent)
        _exit(STATUS_INTERRUPTED);
    const int defaults[] = {SIGINT, SIGTERM, SIGHUP, SIGALRM, SIGPIPE, SIGCHLD};
    for (size_t i = 0; i < sizeof defaults / sizeof *defaults; i++)
        signal(defaults[i], SIG_DFL);
    sigset_t unblocked = *mask;
    for (size_t i = 0; i < sizeof defaults / sizeof *defaults; i++)
        sigdelset(&unblocked, defaults[i]);
    sigprocmask(SIG_SETMASK, &unblocked, NULL);
    oom_prefer_me();
    int nothing = open("/dev/null", O_RDONLY);
    dup2(nothing, STDIN_FILENO);
    dup2(errors, STDOUT_FILENO);
    dup2(errors, STDERR_FILENO);
    crash_tell();
    alarm_set(request->timeout_seconds);
    enum status status = request->work(request->context, out);
    fflush(NULL);
    _exit((int)status);
}

static void tail_add(struct child *child, const char *data, size_t size)
{
    size_t room = sizeof child->tail - 1;
    if (size > room) {
        data += size - room;
        size = room;
    }
    if (child->tail_size + size > room) {
        size_t drop = child->tail_size + size - room;
        memmove(child->tail, child->tail + drop, child->tail_size - drop);
        child->tail_size -= drop;
    }
    memcpy(child->tail + child->tail_size, data, size);
    child->tail_size += size;
    child->tail[child->tail_size] = 0;
}

static void output_add(struct arena *arena, struct child *child, struct process_outcome *outcome,
                       const char *data, size_t size)
{
    if (child->size + size + 1 > child->capacity) {
        child->capacity = 2 * (child->size + size) + 4096;
        char *more = arena_alloc(arena, child->capacity, 1);
        if (child->size)
            memcpy(more, outcome->output, child->size);
        outcome->output = more;
    }
    memcpy(outcome->output + child->size, data, size);
    child->size += size;
    outcome->output[child->size] = 0;
}

static void lines_tell(struct arena *arena, const struct process_request *request,
                       struct child *child, const struct process_outcome *outcome)
{
    if (!request->heard || !outcome->output)
        return;
    for (char *end; (end = strchr(outcome->output + child->lines_end, '\n'));) {
        const char *line = outcome->output + child->lines_end;
        request->heard(request->listener, arena_printf(arena, "%.*s", (int)(end - line), line));
        child->lines_end = (size_t)(end - outcome->output) + 1;
    }
}

/* Reads what is there; closes at the end. */
static void pipe_drain(struct arena *arena, const struct process_request *request,
                       struct child *child, struct process_outcome *outcome, int *pipe_end)
{
    char data[16384];
    ssize_t got = 1;
    while (*pipe_end >= 0 && got > 0) {
        got = read(*pipe_end, data, sizeof data);
        if (got > 0 && pipe_end == &child->out)
            output_add(arena, child, outcome, data, (size_t)got);
        else if (got > 0)
            tail_add(child, data, (size_t)got);
        if (!got) {
            close(*pipe_end);
            *pipe_end = -1;
        }
    }
    lines_tell(arena, request, child, outcome);
}

/* Takes the waiting signals: a child's end, or the wish to stop. */
static void signals_take(struct child *child, struct process_outcome *outcome)
{
    struct signalfd_siginfo info;
    while (read(child->signals, &info, sizeof info) == (ssize_t)sizeof info)
        if (info.ssi_signo != SIGCHLD)
            outcome->interrupted = true;
    if (!child->reaped && waitpid(child->pid, &child->wait_status, WNOHANG) == child->pid)
        child->reaped = true;
}

static void watch(struct arena *arena, const struct process_request *request, struct child *child,
                  struct process_outcome *outcome)
{
    double start = clock_wall_seconds();
    double limit = request->timeout_seconds > 0 ? request->timeout_seconds + GRACE_SECONDS : 1e300;
    while (!child->reaped && !outcome->interrupted && !outcome->timed_out) {
        struct pollfd ends[] = {{.fd = child->signals, .events = POLLIN},
                                {.fd = child->out, .events = POLLIN},
                                {.fd = child->errors, .events = POLLIN}};
        double left = limit - (clock_wall_seconds() - start);
        poll(ends, 3, left > 60 ? 60000 : left > 0 ? (int)ceil(left * 1000) : 0);
        pipe_drain(arena, request, child, outcome, &child->out);
        pipe_drain(arena, request, child, outcome, &child->errors);
        signals_take(child, outcome);
        if (!child->reaped && clock_wall_seconds() - start > limit)
            outcome->timed_out = true;
    }
    kill(-child->pid, SIGKILL); /* also whatever the child itself started */
    if (!child->reaped)
        waitpid(child->pid, &child->wait_status, 0);
    pipe_drain(arena, request, child, outcome, &child->out);
    pipe_drain(arena, request, child, outcome, &child->errors);
    outcome->seconds = clock_wall_seconds() - start;
}

/* The last line that holds anything before `end` of the tail: where it starts. */
static size_t line_before(const struct child *child, size_t *end)
{
    while (*end && (unsigned char)child->tail[*end - 1] <= ' ')
        --*end;
    size_t start = *end;
    while (start && child->tail[start - 1] != '\n')
        start--;
    return start;
}

/* The last line, and of a crash what was said before it too; control characters and what is no
 * ASCII made blanks. */
static void last_words(const struct child *child, char *line, size_t size)
{
    size_t end = child->tail_size, start = line_before(child, &end), said_end = start;
    bool crash = !strncmp(child->tail + start, CRASH_WORD, strlen(CRASH_WORD));
    size_t said = crash ? line_before(child, &said_end) : said_end;
    snprintf(line, size, "%.*s%s%.*s", (int)(said_end - said), child->tail + said,
             said_end > said ? "; " : "", (int)(end - start), child->tail + start);
    for (char *c = line; *c; c++)
        if ((unsigned char)*c < ' ' || (unsigned char)*c > '~')
            *c = ' ';
}

static void outcome_fill(const struct child *child, long kills_before,
                         struct process_outcome *outcome)
{
    last_words(child, outcome->errors, sizeof outcome->errors);
    if (!WIFSIGNALED(child->wait_status)) {
        outcome->exit_code = WEXITSTATUS(child->wait_status);
        return;
    }
    outcome->signal = WTERMSIG(child->wait_status);
    outcome->timed_out |= outcome->signal == SIGALRM;
    outcome->out_of_memory = !outcome->timed_out && !outcome->interrupted &&
                             outcome->signal == SIGKILL && oom_kills() > kills_before;
}

enum status process_run(struct arena *arena, const struct process_request *request,
                        struct process_outcome *outcome, struct error *error)
{
    sigset_t watched, before;
    sigemptyset(&watched);
    const int numbers[] = {SIGINT, SIGTERM, SIGHUP, SIGCHLD};
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++)
        sigaddset(&watched, numbers[i]);
    *outcome = (struct process_outcome){.output = arena_strdup(arena, "")};
    int out[2], errors[2];
    if (pipe2(out, O_CLOEXEC))
        return error_errno(error, STATUS_INTERNAL, "no pipe for a cell");
    if (pipe2(errors, O_CLOEXEC)) {
        close(out[0]);
        close(out[1]);
        return error_errno(error, STATUS_INTERNAL, "no pipe for a cell");
    }
    signal(SIGCHLD, SIG_DFL);
    sigprocmask(SIG_BLOCK, &watched, &before);
    fflush(NULL);
    long kills_before = oom_kills();
    pid_t parent = getpid(), pid = fork();
    if (!pid)
        child_work(request, parent, &before, out[1], errors[1]);
    close(out[1]);
    close(errors[1]);
    struct child child = {.pid = pid, .out = out[0], .errors = errors[0]};
    child.signals = signalfd(-1, &watched, SFD_CLOEXEC | SFD_NONBLOCK);
    fcntl(child.out, F_SETFL, O_NONBLOCK);
    fcntl(child.errors, F_SETFL, O_NONBLOCK);
    enum status status = STATUS_OK;
    if (pid < 0) {
        status = error_errno(error, STATUS_INTERNAL, "no process for a cell");
    } else {
        setpgid(pid, pid);
        watch(arena, request, &child, outcome);
        outcome_fill(&child, kills_before, outcome);
    }
    if (child.out >= 0)
        close(child.out);
    if (child.errors >= 0)
        close(child.errors);
    close(child.signals);
    sigprocmask(SIG_SETMASK, &before, NULL);
    return status;
}
