/* treeline report: the page, plots and tables of a run. */
#include "report/report.h"
#include "cli/cli.h"

#include <stdio.h>
#include <string.h>

struct request {
    struct cli_folder folder;
    const char *run;
};

static error_t parse(int key, char *text, struct argp_state *state)
{
    struct request *request = state->input;
    switch (key) {
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &request->folder;
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

int verb_report(int argc, char **argv)
{
    const struct argp_child children[] = {{&cli_folder_argp, 0, NULL, 0}, {0}};
    const struct argp argp = {
        NULL,
        parse,
        "RUN",
        "Writes DIR/index.html (self-contained), DIR/plots and DIR/tables from the folder of a "
        "run alone, DIR being reports/NAME-OF-THE-RUN, and prints the page's path.",
        children,
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
    const char *out = request.folder.out
                          ? request.folder.out
                          : arena_printf(arena, "reports/%s", slash ? slash + 1 : run);
    enum status status = report_write(run, out, &error);
    if (!status && !request.folder.quiet)
        printf("%s/index.html\n", out);
    arena_destroy(arena);
    return status ? cli_fail(&error) : STATUS_OK;
}
