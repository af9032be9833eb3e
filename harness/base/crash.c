/* A handler of fatal signals that needs no memory: the calls in one line. */
#include "base/crash.h"

#include <dlfcn.h>
#include <execinfo.h>
#include <signal.h>
#include <stdint.h>
#include <string.h>
#include <unistd.h>

/* Calls told, and those of the handler itself: the handler and the kernel's frame. */
enum { CALLS = 14, OWN = 2 };

struct line {
    char text[960];
    size_t size;
};

static void add(struct line *line, const char *text)
{
    for (; *text && line->size < sizeof line->text - 1; text++)
        line->text[line->size++] = *text;
}

static void add_hex(struct line *line, uintptr_t value)
{
    char digits[2 + 2 * sizeof value + 1], *first = digits + sizeof digits - 1;
    *first = 0;
    do
        *--first = "0123456789abcdef"[value & 15];
    while (value >>= 4);
    *--first = 'x';
    *--first = '0';
    add(line, first);
}

static void add_call(struct line *line, uintptr_t place)
{
    Dl_info info;
    if (!dladdr((void *)place, &info) || !info.dli_fname) {
        add_hex(line, place);
        return;
    }
    const char *slash = strrchr(info.dli_fname, '/');
    add(line, slash ? slash + 1 : info.dli_fname);
    add(line, "+");
    add_hex(line, place - (uintptr_t)info.dli_fbase);
    if (info.dli_sname) {
        add(line, " (");
        add(line, info.dli_sname);
        add(line, ")");
    }
}

static void tell(int number, siginfo_t *info, void *context)
{
    (void)context;
    void *calls[CALLS + OWN];
    struct line line = {.size = 0};
    add(&line, CRASH_WORD);
    if (number != SIGABRT) {
        add(&line, "at address ");
        add_hex(&line, (uintptr_t)info->si_addr);
        add(&line, " ");
    }
    add(&line, "in ");
    int count = backtrace(calls, CALLS + OWN);
    for (int i = OWN; i < count; i++) {
        add(&line, i > OWN ? ", " : "");
        add_call(&line, (uintptr_t)calls[i] - (i > OWN)); /* a call is before where it returns to */
    }
    line.text[line.size++] = '\n';
    if (write(STDERR_FILENO, line.text, line.size) < 0)
        add(&line, ""); /* nobody listens */
    signal(number, SIG_DFL);
    raise(number);
}

void crash_tell(void)
{
    static const int numbers[] = {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT};
    void *call;
    backtrace(&call, 1); /* loads what it needs now, not in the handler */
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) {
        struct sigaction action = {.sa_sigaction = tell, .sa_flags = SA_SIGINFO}, before;
        sigemptyset(&action.sa_mask);
        if (!sigaction(numbers[i], NULL, &before) && !(before.sa_flags & SA_SIGINFO) &&
            before.sa_handler == SIG_DFL)
            sigaction(numbers[i], &action, NULL);
    }
}
