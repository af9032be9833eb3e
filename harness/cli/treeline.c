/* treeline: dispatches to a verb. */
#include "base/nearest.h"
#include "cli/cli.h"

#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* OpenMP reads its waiting policy when it is loaded, before main: threads that spin would take the
 * CPU from the method that is timed. So the program starts itself once more. */
static void wait_passively(char **argv)
{
    if (getenv("OMP_WAIT_POLICY"))
        return;
    char program[PATH_MAX];
    ssize_t length = readlink("/proc/self/exe", program, sizeof program - 1);
    if (length < 0 || setenv("OMP_WAIT_POLICY", "passive", 1))
        return;
    program[length] = 0;
    execv(program, argv);
}

static int overview(FILE *out)
{
    fprintf(out,
            "treeline compares ways to draw a tree and a forest against a ray-traced reference.\n\n"
            "usage: treeline VERB [OPTION...]\n\n");
    for (const struct verb *verb = verbs; verb->name; verb++)
        fprintf(out, "  %-11s%s\n", verb->name, verb->summary);
    fprintf(out, "\n`treeline help VERB` explains one. To begin: treeline run quick --report\n");
    return out == stdout ? STATUS_OK : STATUS_USAGE;
}

static int dispatch(int argc, char **argv)
{
    const char *nearest = NULL;
    if (argc < 2)
        return overview(stderr);
    if (!strcmp(argv[1], "--help") || !strcmp(argv[1], "-h"))
        return overview(stdout);
    if (!strcmp(argv[1], "--version"))
        return verb_help(2, (char *[]){"treeline help", "version", NULL});
    for (const struct verb *verb = verbs; verb->name; verb++) {
        nearest = nearest_of(argv[1], nearest, verb->name);
        if (strcmp(argv[1], verb->name) != 0)
            continue;
        char name[64];
        snprintf(name, sizeof name, "treeline %s", verb->name);
        argv[1] = name;
        return verb->run(argc - 1, argv + 1);
    }
    fprintf(stderr, "treeline: no verb '%s'; did you mean '%s'? `treeline help` lists them\n",
            argv[1], nearest);
    return STATUS_USAGE;
}

/* A full disk behind stdout must not look like success. */
static int finish(int code)
{
    if (!fflush(stdout) && !ferror(stdout))
        return code;
    fprintf(stderr, "treeline: stdout: %s\n", strerror(errno));
    return code ? code : STATUS_IO;
}

int main(int argc, char **argv)
{
    wait_passively(argv);
    argp_err_exit_status = STATUS_USAGE;
    return finish(dispatch(argc, argv));
}
