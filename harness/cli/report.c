/* treeline report: the page, plots and tables of a run. */
#include "report/report.h"
#include "cli/cli.h"

#include <stdio.h>
#include <string.h>

struct request {
    const char *run, *out;
    bool quiet;
};

static error_t parse(int key, char *text, struct argp_state *state)
{
    struct request *request = state->input;
    switch (key) {
    case 'o':
        request->out = text;
        return 0;
    case 'q':
        request->quiet = true;
        return 0;
    case ARGP_KEY_ARG:
        if (request->run)
            argp_failure(state, STATUS_USAGE, 0, "one run is enough: '%s' is too much", text);
        request->run = text;
        return 0;
    case ARGP_KEY_NO_ARGS:
        argp_failure(state, STATUS_USAGE, 0, "which run? give its folder");
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static const struct argp_option options[] = {
    {"out", 'o', "DIR", 0, "where to write; reports/NAME-OF-THE-RUN by default", 0},
    {"quiet", 'q', NULL, 0, "do not print the page's path", 0},
    {0},
};

int verb_report(int argc, char **argv)
{
    const struct argp argp = {
        options,
        parse,
        "RUN",
        "Writes OUT/index.html (self-contained), OUT/plots and OUT/tables from "
        "the folder of a run alone, and prints the page's path.",
        NULL,
        NULL,
        NULL};
    struct request request = {0};
    argp_parse(&argp, argc, argv, 0, NULL, &request);
    struct arena *arena = arena_create(0);
    struct error error = {0};
    char *run = arena_strdup(arena, request.run);
    for (size_t end = strlen(run); end > 1 && run[end - 1] == '/'; end--)
        run[end - 1] = 0;
    const char *slash = strrchr(run, '/');
    const char *out =
        request.out ? request.out : arena_printf(arena, "reports/%s", slash ? slash + 1 : run);
    enum status status = report_write(run, out, &error);
    if (!status && !request.quiet)
        printf("%s/index.html\n", out);
    arena_destroy(arena);
    return status ? cli_fail(&error) : STATUS_OK;
}
