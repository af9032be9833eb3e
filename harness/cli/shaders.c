/* treeline shaders: error maps of the shaders of needles. */
#include "report/shaders.h"
#include "cli/cli.h"

#include <stdio.h>

static error_t parse(int key, char *text, struct argp_state *state)
{
    switch (key) {
    case ARGP_KEY_INIT:
        state->child_inputs[0] = state->input;
        return 0;
    case ARGP_KEY_ARG:
        argp_failure(state, STATUS_USAGE, 0, "'%s' is too much: it takes no arguments", text);
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

int verb_shaders(int argc, char **argv)
{
    const struct argp_child children[] = {{&cli_folder_argp, 0, NULL, 0}, {0}};
    const struct argp argp = {
        NULL,
        parse,
        NULL,
        "Maps the error of the shaders of twigs of needles, in their exact form and as the paper "
        "prints them, against converged quadrature: over the angle of the eye to the twig, that of "
        "the needles, and three densities. Writes DIR/shaders.dat, shaders.gp and shaders.png, DIR "
        "being reports/shaders, and prints the picture's path.",
        children,
        NULL,
        NULL};
    struct cli_folder folder = {.out = "reports/shaders"};
    argp_parse(&argp, argc, argv, 0, NULL, &folder);
    struct error error = {0};
    enum status status = shaders_draw(folder.out, &error);
    if (!status && !folder.quiet)
        printf("%s/shaders.png\n", folder.out);
    return status ? cli_fail(&error) : STATUS_OK;
}
