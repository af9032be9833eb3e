/* What `render` was asked for, shared by its kinds: one picture, a contact sheet, a path. */
#ifndef TREELINE_CLI_RENDER_H
#define TREELINE_CLI_RENDER_H

#include "cli/cli.h"

enum { RENDER_METHODS_MAX = 32, RENDER_DISTANCES_MAX = 16 };

struct render_request {
    struct cli_shot shot; /* first: the child parser's input */
    const char *methods[RENDER_METHODS_MAX];
    size_t methods_count;
    bool sheet;
    double distances_m[RENDER_DISTANCES_MAX];
    size_t distances_count; /* 0: a quarter, half, one and two times the view's own */
    const char *frames;     /* folder */
    int frames_count;       /* 0: the path's own */
};

enum status render_sheet(struct arena *arena, const struct render_request *request,
                         struct error *error);
enum status render_frames(struct arena *arena, const struct render_request *request,
                          struct error *error);

#endif
