/* treeline render: one picture of a cell, drawn by its method. */
#include "cell/cell.h"
#include "cli/cli.h"
#include "truth/frame_image.h"

#include <stdio.h>

enum { KEY_METHOD = 0x200, KEY_LOD, KEY_TARGET_FORMAT, KEY_BACKEND };

static error_t parse(int key, char *text, struct argp_state *state)
{
    struct cli_shot *shot = state->input;
    switch (key) {
    case ARGP_KEY_INIT:
        state->child_inputs[0] = shot;
        return 0;
    case KEY_METHOD:
        shot->method = text;
        return 0;
    case KEY_LOD:
        shot->lod = text;
        return 0;
    case KEY_TARGET_FORMAT:
        shot->target_format = text;
        return 0;
    case KEY_BACKEND:
        shot->backend = text;
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static const struct argp_option options[] = {
    {"method", KEY_METHOD, "NAME[:opt=val,...]", 0, "the method", 1},
    {"lod", KEY_LOD, "L", 0, "low, intermediate, high or auto, the default", 1},
    {"target-format", KEY_TARGET_FORMAT, "F", 0, "rgba8, rgba16f, the default, or rgba32f", 1},
    {"backend", KEY_BACKEND, "NAME", 0, "GL back end", 1},
    {0},
};

int verb_render(int argc, char **argv)
{
    const struct argp_child children[] = {{&cli_shot_argp, 0, NULL, 0}, {0}};
    const struct argp argp = {options,
                              parse,
                              "[CELL]",
                              "Draws one view of a cell to an EXR (linear) or PNG (sRGB) file.\v"
                              "CELL is a name as `run` prints them, "
                              "SCENE/METHOD[:opt=val,...]/trees=N/...; options replace its parts.",
                              children,
                              NULL,
                              NULL};
    struct cli_shot shot = {0};
    argp_parse(&argp, argc, argv, 0, NULL, &shot);
    struct arena *arena = arena_create(0);
    struct error error = {0};
    struct cell cell;
    struct frame *frame;
    struct scene *scene;
    struct view view;
    const char *out = shot.out ? shot.out : "render.png";
    enum status status = cli_shot_cell(arena, &shot, true, &cell, &error);
    if (!status && shot.has_eye) {
        struct scene_request request = {cell.trees, cell.seed, cell.width_px, cell.height_px};
        status = scene_load(arena, cell.scene, &request, &scene, &error);
        if (!status)
            cli_shot_view(&shot, scene, &view);
    }
    if (!status)
        status = cell_render(arena, &cell, shot.time, shot.has_eye ? &view : NULL, shot.backend,
                             &frame, &error);
    if (!status)
        status = frame_write_image(out, frame, &error);
    if (!status && !shot.quiet)
        fprintf(stderr, "treeline: %s: %s\n", out, cell.name);
    arena_destroy(arena);
    return status ? cli_fail(&error) : STATUS_OK;
}
