/* The manual page: every verb's own --help, the exit codes, files and environment. */
#include "cli/cli.h"

#include "build_facts.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

/* Text inside .nf: backslashes and leading dots made harmless. */
static void roff_print(FILE *in)
{
    char line[1024];
    while (fgets(line, sizeof line, in)) {
        if (*line == '.' || *line == '\'')
            printf("\\&");
        for (const char *c = line; *c; c++)
            if (*c == '\\')
                printf("\\e");
            else if (*c == '-')
                printf("\\-");
            else
                putchar(*c);
    }
}

/* The verb's --help, as the verb itself prints it, from a child. */
static int verb_print(const struct verb *verb)
{
    int ends[2];
    fflush(stdout);
    if (pipe(ends))
        return STATUS_INTERNAL;
    pid_t pid = fork();
    if (!pid) {
        char name[64];
        dup2(ends[1], STDOUT_FILENO);
        close(ends[0]);
        close(ends[1]);
        snprintf(name, sizeof name, "treeline %s", verb->name);
        exit(verb->run(2, (char *[]){name, "--help", NULL}));
    }
    close(ends[1]);
    FILE *help = fdopen(ends[0], "r");
    if (pid < 0 || !help)
        return STATUS_INTERNAL;
    printf(".SS %s\n.nf\n", verb->name);
    roff_print(help);
    printf(".fi\n");
    fclose(help);
    int status = 0;
    waitpid(pid, &status, 0);
    return WIFEXITED(status) && !WEXITSTATUS(status) ? STATUS_OK : STATUS_INTERNAL;
}

int man_page(void)
{
    printf(".TH TREELINE 1 " TREELINE_DATE " " TREELINE_REVISION
           "\n.SH NAME\ntreeline \\- compare ways to draw a tree and a forest\n"
           ".SH SYNOPSIS\n.B treeline\n.I VERB\n[OPTION...]\n.SH DESCRIPTION\n"
           "Draws, times and judges representations of trees against a ray\\-traced\nreference.\n"
           "Tables and JSON go to standard output, everything else to standard error.\n"
           ".SH VERBS\n");
    for (const struct verb *verb = verbs; verb->name; verb++) {
        int code = verb_print(verb);
        if (code)
            return code;
    }
    printf(".SH EXIT STATUS\n");
#define STATUS_ROW(name, code, word, meaning) printf(".TP\n%d %s\n%s\n", code, word, meaning);
    STATUS_LIST(STATUS_ROW)
#undef STATUS_ROW
    printf(".SH ENVIRONMENT\n"
           ".TP\nTREELINE_CACHE\nfolder of the cache of built things; off disables it\n"
           ".TP\nTREELINE_DATA\nfolder that holds scenes/\n"
           ".TP\nTREELINE_GL\nGL back end: osmesa, egl\\-surfaceless or egl\\-device\n"
           ".SH FILES\n.TP\nRUN/cells.jsonl\nresults, one line a repetition (results/README.md)\n"
           ".TP\nscenes/, scenes/plans/\nscenes and plans by name\n");
    return STATUS_OK;
}
