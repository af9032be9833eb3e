/* treeline reference: one view, ray traced, with the variance of every pixel. */
#include "truth/reference.h"
#include "cli/cli.h"
#include "truth/frame_image.h"

#include <stdio.h>
#include <string.h>

enum { KEY_EFFECTS = 0x200, KEY_ERROR, KEY_SAMPLES, KEY_SAMPLES_MIN, KEY_THREADS, KEY_NO_CACHE };

struct request {
    struct cli_shot shot; /* first: the child parser's input */
    const char *effects;
    struct reference_options options;
    bool no_cache;
};

static error_t parse(int key, char *text, struct argp_state *state)
{
    struct request *request = state->input;
    switch (key) {
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &request->shot;
        return 0;
    case KEY_EFFECTS:
        request->effects = text;
        return 0;
    case KEY_ERROR:
        request->options.standard_error = (float)cli_number(state, "standard-error", text, 0, 1);
        return 0;
    case KEY_SAMPLES:
        request->options.samples_max = cli_integer(state, "samples", text, 1, 1 << 20);
        return 0;
    case KEY_SAMPLES_MIN:
        request->options.samples_min = cli_integer(state, "samples-min", text, 1, 1 << 20);
        return 0;
    case KEY_THREADS:
        request->options.threads = cli_integer(state, "threads", text, 0, 1024);
        return 0;
    case KEY_NO_CACHE:
        request->no_cache = true;
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static const struct argp_option options[] = {
    {"effects", KEY_EFFECTS, "E,E,...", 0,
     "two-sided, ambient, sun-shadows, sky-occlusion, fog; all, none; the scene's own by default",
     1},
    {"standard-error", KEY_ERROR, "E", 0,
     "RMS standard error to reach, linear RGB; 0: only sample counts decide", 1},
    {"samples", KEY_SAMPLES, "N", 0, "samples a pixel at most", 1},
    {"samples-min", KEY_SAMPLES_MIN, "N", 0, "samples a pixel at least", 1},
    {"threads", KEY_THREADS, "N", 0, "threads, 0 for all", 1},
    {"no-cache", KEY_NO_CACHE, NULL, 0, "trace even when the cache has it", 1},
    {0},
};

/* "two-sided,fog", "all", "none" */
static enum status effects_parse(struct arena *arena, const char *text, unsigned *effects,
                                 struct error *error)
{
    *effects = 0;
    char *rest = arena_strdup(arena, text);
    for (char *word; (word = strsep(&rest, ","));) {
        unsigned found = !strcmp(word, "all") ? (unsigned)EFFECTS_ALL : 0u;
        bool none = !strcmp(word, "none");
#define EFFECT_FIND(name, bit, effect_word, meaning)                                               \
    found |= !strcmp(word, effect_word) ? (unsigned)(name) : 0u;
        EFFECT_LIST(EFFECT_FIND)
#undef EFFECT_FIND
        if (!found && !none)
            return error_set(error, STATUS_USAGE,
                             "effects: '%s' is not one of two-sided, ambient, sun-shadows, "
                             "sky-occlusion, fog, all, none",
                             word);
        *effects |= found;
    }
    return STATUS_OK;
}

static void stats_print(const char *out, const struct reference_stats *stats)
{
    fprintf(stderr, "treeline: %s: standard error %.5f, %.0f samples", out,
            (double)stats->standard_error, stats->samples);
    if (stats->from_cache)
        fprintf(stderr, ", from the cache\n");
    else
        fprintf(stderr, ", built in %.2f s, traced in %.2f s\n", stats->build_seconds,
                stats->trace_seconds);
}

static enum status reference_write(struct arena *arena, struct request *request,
                                   struct error *error)
{
    struct cell cell;
    struct scene *scene;
    struct view view;
    struct frame *frame;
    struct reference_stats stats = {0};
    const char *out = request->shot.out ? request->shot.out : "reference.exr";
    enum status status = cli_shot_cell(arena, &request->shot, false, &cell, error);
    if (status)
        return status;
    struct scene_request wanted = {cell.trees, cell.seed, cell.width_px, cell.height_px};
    status = scene_load(arena, cell.scene, &wanted, &scene, error);
    if (status)
        return status;
    cli_shot_view(&request->shot, scene, &view);
    request->options.effects = scene->effects;
    request->options.seed = cell.seed;
    request->options.quiet = request->shot.quiet;
    if (request->effects)
        status = effects_parse(arena, request->effects, &request->options.effects, error);
    if (!status)
        status =
            request->no_cache
                ? reference_render(arena, scene, &view, &request->options, &frame, &stats, error)
                : reference_cached(arena, scene, &view, &request->options, &frame, &stats, error);
    if (!status)
        status = frame_write_image(out, frame, error);
    if (!status && !request->shot.quiet)
        stats_print(out, &stats);
    return status;
}

int verb_reference(int argc, char **argv)
{
    const struct argp_child children[] = {{&cli_shot_argp, 0, NULL, 0}, {0}};
    const struct argp argp = {options,
                              parse,
                              "[CELL]",
                              "Ray traces one view to an EXR file with the variance of each pixel "
                              "(channels variance.R ...), or to a PNG.\v"
                              "CELL is a name as `run` prints them; its method is not looked at.",
                              children,
                              NULL,
                              NULL};
    struct request request = {.options = {.standard_error = 0.004f, .samples_max = 4096}};
    argp_parse(&argp, argc, argv, 0, NULL, &request);
    struct arena *arena = arena_create(0);
    struct error error = {0};
    enum status status = reference_write(arena, &request, &error);
    arena_destroy(arena);
    return status ? cli_fail(&error) : STATUS_OK;
}
