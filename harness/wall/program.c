/* Runs a foreign program by fork and exec, with its stderr in a pipe and a deadline. */
#include "wall/program.h"

#include "base/clock.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

enum { NO_FOLDER = 126, NO_PROGRAM = 127, SAID_MAX = 4096 };

static void child(const char *folder, const char *const *arguments, int complaints)
{
    int nothing = open("/dev/null", O_RDWR);
    if (nothing >= 0) {
        dup2(nothing, STDIN_FILENO);
        dup2(nothing, STDOUT_FILENO);
    }
    dup2(complaints, STDERR_FILENO);
    if (chdir(folder) != 0)
        _exit(NO_FOLDER);
    execvp(arguments[0], (char *const *)(uintptr_t)arguments);
    _exit(NO_PROGRAM);
}

/* Collects what the child says until it closes its stderr; false when the deadline passed. Keeps
 * the end. */
static bool listen_until(int complaints, double deadline, char said[SAID_MAX])
{
    size_t length = 0;
    for (;;) {
        double left = deadline - clock_wall_seconds();
        if (left <= 0)
            return false;
        struct pollfd wait = {.fd = complaints, .events = POLLIN};
        int ready = poll(&wait, 1, (int)(left * 1000) + 1);
        if (ready < 0 && errno != EINTR)
            return true;
        if (ready <= 0)
            continue;
        if (length > SAID_MAX / 2) {
            memmove(said, said + SAID_MAX / 4, length - SAID_MAX / 4);
            length -= SAID_MAX / 4;
        }
        ssize_t got = read(complaints, said + length, SAID_MAX / 4);
        if (got == 0 || (got < 0 && errno != EINTR))
            return true;
        length += got > 0 ? (size_t)got : 0;
        said[length] = 0;
    }
}

/* The last line that is not empty; the text is cut there. */
static const char *last_line(char *said)
{
    size_t length = strlen(said);
    while (length && strchr("\n\r \t", said[length - 1]))
        said[--length] = 0;
    const char *newline = strrchr(said, '\n');
    const char *line = newline ? newline + 1 : said;
    return *line ? line + strspn(line, " \t") : "it said nothing";
}

enum status program_run(const char *folder, const char *const *arguments, double timeout_seconds,
                        const char *package, struct error *error)
{
    const char *program = arguments[0];
    int pipe_ends[2];
    if (pipe2(pipe_ends, O_CLOEXEC) != 0)
        return error_errno(error, STATUS_IO, "%s: pipe", program);
    pid_t pid = fork();
    if (pid == 0)
        child(folder, arguments, pipe_ends[1]);
    close(pipe_ends[1]);
    if (pid < 0) {
        close(pipe_ends[0]);
        return error_errno(error, STATUS_IO, "%s: fork", program);
    }
    char said[SAID_MAX] = "";
    bool in_time = listen_until(pipe_ends[0], clock_wall_seconds() + timeout_seconds, said);
    close(pipe_ends[0]);
    if (!in_time)
        kill(pid, SIGKILL);
    int outcome = 0;
    while (waitpid(pid, &outcome, 0) < 0 && errno == EINTR)
        continue;
    if (!in_time)
        return error_set(error, STATUS_TIMEOUT, "%s in %s: ran past %g s", program, folder,
                         timeout_seconds);
    int code = WIFEXITED(outcome) ? WEXITSTATUS(outcome) : -1;
    if (code == NO_PROGRAM)
        return error_set(error, STATUS_UNAVAILABLE,
                         "%s: not found on the PATH; `apt install %s` brings it", program, package);
    if (code == NO_FOLDER)
        return error_set(error, STATUS_IO, "%s: cannot be entered by %s", folder, program);
    if (code != 0)
        return error_set(error, STATUS_IO, "%s in %s: %s", program, folder, last_line(said));
    return STATUS_OK;
}
