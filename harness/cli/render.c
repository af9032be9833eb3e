/* treeline render: one picture of a cell, drawn by its method; or a contact sheet; or a path. */
#include "cli/render.h"
#include "cell/cell.h"
#include "truth/frame_image.h"

#include <stdio.h>
#include <string.h>

enum {
    KEY_METHOD = 0x200,
    KEY_LOD,
    KEY_TARGET_FORMAT,
    KEY_BACKEND,
    KEY_SHEET,
    KEY_DISTANCES,
    KEY_FRAMES,
    KEY_FRAMES_COUNT
};

static void parse_distances(const struct argp_state *state, const char *text,
                            struct render_request *request)
{
    struct arena *scratch = arena_create(0);
    char *rest = arena_strdup(scratch, text);
    request->distances_count = 0;
    for (char *word; (word = strsep(&rest, ","));) {
        if (request->distances_count == RENDER_DISTANCES_MAX)
            argp_failure(state, STATUS_USAGE, 0, "--distances: '%s' has more than %d", text,
                         RENDER_DISTANCES_MAX);
        request->distances_m[request->distances_count++] =
            cli_number(state, "distances", word, 0.01, 1e6);
    }
    arena_destroy(scratch);
}

static void add_method(const struct argp_state *state, const char *text,
                       struct render_request *request)
{
    if (request->methods_count == RENDER_METHODS_MAX)
        argp_failure(state, STATUS_USAGE, 0, "--method: more than %d", RENDER_METHODS_MAX);
    request->methods[request->methods_count++] = text;
    request->shot.method = text;
}

/* Options that go together. */
static void check(const struct argp_state *state, const struct render_request *request)
{
    if (request->sheet && request->frames)
        argp_failure(state, STATUS_USAGE, 0, "--sheet and --frames exclude each other");
    if (!request->sheet && request->methods_count > 1)
        argp_failure(state, STATUS_USAGE, 0, "several methods need --sheet");
    if (!request->sheet && request->distances_count)
        argp_failure(state, STATUS_USAGE, 0, "--distances needs --sheet");
    if (request->sheet && request->shot.cell && request->methods_count)
        argp_failure(state, STATUS_USAGE, 0, "--sheet: give a CELL or methods, not both");
    if (!request->frames && request->frames_count)
        argp_failure(state, STATUS_USAGE, 0, "--frames-count needs --frames");
    if (request->frames && (request->shot.out || request->shot.has_eye || request->shot.time > 0))
        argp_failure(state, STATUS_USAGE, 0,
                     "--frames follows the path: it takes no --output, --eye or --time");
}

static error_t parse(int key, char *text, struct argp_state *state)
{
    struct render_request *request = state->input;
    struct cli_shot *shot = &request->shot;
    switch (key) {
    case ARGP_KEY_INIT:
        state->child_inputs[0] = shot;
        return 0;
    case KEY_METHOD:
        add_method(state, text, request);
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
    case KEY_SHEET:
        request->sheet = true;
        return 0;
    case KEY_DISTANCES:
        parse_distances(state, text, request);
        return 0;
    case KEY_FRAMES:
        request->frames = text;
        return 0;
    case KEY_FRAMES_COUNT:
        request->frames_count = cli_integer(state, "frames-count", text, 1, 99999);
        return 0;
    case ARGP_KEY_END:
        check(state, request);
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static const struct argp_option options[] = {
    {"method", KEY_METHOD, "NAME[:opt=val,...]", 0,
     "the method; with --sheet it may stand more than once", 1},
    {"lod", KEY_LOD, "L", 0, "low, intermediate, high or auto, the default", 1},
    {"target-format", KEY_TARGET_FORMAT, "F", 0, "rgba8, rgba16f, the default, or rgba32f", 1},
    {"backend", KEY_BACKEND, "NAME", 0, "GL back end", 1},
    {"sheet", KEY_SHEET, NULL, 0,
     "a labelled contact sheet: the ray-traced reference and each method at several distances, "
     "with their FLIP error; 320x240 a picture by default",
     2},
    {"distances", KEY_DISTANCES, "M,...", 0,
     "its distances to the target in metres; a quarter, half, one and two times the view's own by "
     "default",
     2},
    {"frames", KEY_FRAMES, "DIR", 0,
     "the pictures along the camera path, DIR/frame-00001.png and on, and DIR/path.mp4 where "
     "ffmpeg is installed",
     3},
    {"frames-count", KEY_FRAMES_COUNT, "N", 0, "how many; the path's own number by default", 3},
    {0},
};

static enum status render_one(struct arena *arena, const struct render_request *request,
                              struct error *error)
{
    const struct cli_shot *shot = &request->shot;
    struct cell cell;
    struct frame *frame;
    struct scene *scene;
    struct view view;
    const char *out = shot->out ? shot->out : "render.png";
    enum status status = cli_shot_cell(arena, shot, true, &cell, error);
    if (!status && shot->has_eye) {
        struct scene_request wanted = {cell.trees, cell.seed, cell.width_px, cell.height_px};
        status = scene_load(arena, cell.scene, &wanted, &scene, error);
        if (!status)
            cli_shot_view(shot, scene, &view);
    }
    if (!status)
        status = cell_render(arena, &cell, shot->time, shot->has_eye ? &view : NULL, shot->backend,
                             &frame, error);
    if (!status)
        status = frame_write_image(out, frame, error);
    if (!status && !shot->quiet)
        fprintf(stderr, "treeline: %s: %s\n", out, cell.name);
    return status;
}

int verb_render(int argc, char **argv)
{
    const struct argp_child children[] = {{&cli_shot_argp, 0, NULL, 0}, {0}};
    const struct argp argp = {options,
                              parse,
                              "[CELL]",
                              "Draws one view of a cell to an EXR (linear) or PNG (sRGB) file; or "
                              "a contact sheet of methods, or a camera path.\v"
                              "CELL is a name as `run` prints them, "
                              "SCENE/METHOD[:opt=val,...]/trees=N/...; options replace its parts.",
                              children,
                              NULL,
                              NULL};
    struct render_request request = {0};
    argp_parse(&argp, argc, argv, 0, NULL, &request);
    struct arena *arena = arena_create(0);
    struct error error = {0};
    enum status status = request.sheet    ? render_sheet(arena, &request, &error)
                         : request.frames ? render_frames(arena, &request, &error)
                                          : render_one(arena, &request, &error);
    arena_destroy(arena);
    return status ? cli_fail(&error) : STATUS_OK;
}
