/* treeline cache: what is kept on disk between runs. */
#include "base/file.h"
#include "cli/cli.h"

#include <limits.h>
#include <stdio.h>
#include <string.h>

struct request {
    const char *action, *size;
};

static error_t parse(int key, char *text, struct argp_state *state)
{
    struct request *request = state->input;
    if (key != ARGP_KEY_ARG)
        return ARGP_ERR_UNKNOWN;
    if (state->arg_num == 0)
        request->action = text;
    else if (state->arg_num == 1)
        request->size = text;
    else
        argp_failure(state, STATUS_USAGE, 0, "'%s' is too much", text);
    return 0;
}

int verb_cache(int argc, char **argv)
{
    const struct argp argp = {
        NULL,
        parse,
        "[path|clear|trim SIZE]",
        "References, atlases and decoded images are kept by content hash; they can "
        "be thrown away at any time and are made again.\v"
        "path prints the folder, clear empties it, trim removes the oldest "
        "entries until SIZE (such as 2G) is left. $TREELINE_CACHE names another "
        "folder; the word off disables it.",
        NULL,
        NULL,
        NULL};
    struct request request = {.action = "path"};
    argp_parse(&argp, argc, argv, 0, NULL, &request);
    const struct argp_state state = {.name = argv[0], .err_stream = stderr};
    bool trim = !strcmp(request.action, "trim"), clear = !strcmp(request.action, "clear");
    if (!trim && !clear && strcmp(request.action, "path") != 0)
        argp_failure(&state, STATUS_USAGE, 0, "'%s' is not one of path, clear, trim",
                     request.action);
    if (trim != (request.size != NULL))
        argp_failure(&state, STATUS_USAGE, 0,
                     trim ? "trim: to which size? such as 2G" : "'%s' is too much", request.size);
    if (!trim && !clear) {
        char path[PATH_MAX];
        printf("%s\n", cache_folder(path) ? path : "off");
        return STATUS_OK;
    }
    struct error error = {0};
    size_t removed = 0;
    enum status status =
        cache_trim(trim ? cli_bytes(&state, "trim", request.size) : 0, &removed, &error);
    if (status)
        return cli_fail(&error);
    printf("%.1f MB removed\n", (double)removed / 1e6);
    return STATUS_OK;
}
