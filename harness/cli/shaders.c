/* treeline shaders: error maps of the shaders of needles. */
#include "report/shaders.h"
#include "cli/cli.h"

#include <stdio.h>

struct request {
    const char *out;
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
        argp_failure(state, STATUS_USAGE, 0, "'%s' is too much: it takes no arguments", text);
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static const struct argp_option options[] = {
    {"out", 'o', "DIR", 0, "where to write; reports/shaders by default", 0},
    {"quiet", 'q', NULL, 0, "do not print the picture's path", 0},
    {0},
};

int verb_shaders(int argc, char **argv)
{
    const struct argp argp = {
        options,
        parse,
        NULL,
        "Maps the error of the shaders of twigs of needles, in their exact form and as the paper "
        "prints them, against converged quadrature: over the angle of the eye to the twig, that of "
        "the needles, and three densities. Writes OUT/shaders.dat, shaders.gp and shaders.png, and "
        "prints the picture's path.",
        NULL,
        NULL,
        NULL};
    struct request request = {.out = "reports/shaders"};
    argp_parse(&argp, argc, argv, 0, NULL, &request);
    struct error error = {0};
    enum status status = shaders_draw(request.out, &error);
    if (!status && !request.quiet)
        printf("%s/shaders.png\n", request.out);
    return status ? cli_fail(&error) : STATUS_OK;
}
