/* What the verbs share: errors, numbers from the command line, one cell and one camera. */
#include "cli/cli.h"

#include "plan/names.h"
#include "wall/image.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int cli_fail(const struct error *error)
{
    fprintf(stderr, "treeline: %s\n", error->text);
    return (int)error->status;
}

double cli_number(const struct argp_state *state, const char *option, const char *text,
                  double minimum, double maximum)
{
    char *end;
    errno = 0;
    double value = strtod(text, &end);
    if (end == text || *end || errno || !(value >= minimum && value <= maximum))
        argp_failure(state, STATUS_USAGE, 0, "--%s: '%s' is not a number in %g..%g", option, text,
                     minimum, maximum);
    return value;
}

int cli_integer(const struct argp_state *state, const char *option, const char *text, int minimum,
                int maximum)
{
    char *end;
    errno = 0;
    long value = strtol(text, &end, 10);
    if (end == text || *end || errno || value < minimum || value > maximum)
        argp_failure(state, STATUS_USAGE, 0, "--%s: '%s' is not a whole number in %d..%d", option,
                     text, minimum, maximum);
    return (int)value;
}

size_t cli_bytes(const struct argp_state *state, const char *what, const char *text)
{
    char *end;
    errno = 0;
    double value = strtod(text, &end), factor = 1;
    if (*end && strchr("kMG", *end)) {
        factor = *end == 'k' ? 0x1p10 : *end == 'M' ? 0x1p20 : 0x1p30;
        end++;
    }
    if (end == text || *end || errno || !(value >= 0) || value * factor > 0x1p50)
        argp_failure(state, STATUS_USAGE, 0, "%s: '%s' is not a size such as 512M or 2G", what,
                     text);
    return (size_t)(value * factor);
}

uint64_t cli_seed(const struct argp_state *state, const char *text)
{
    uint64_t seed = 0;
    struct error error;
    if (seed_parse(text, &seed, &error))
        argp_failure(state, STATUS_USAGE, 0, "--%s", error.text); /* begins with seed: */
    return seed;
}

static void parse_vector(const struct argp_state *state, const char *option, const char *text,
                         double vector[3])
{
    char rest;
    bool good = sscanf(text, "%lf,%lf,%lf%c", &vector[0], &vector[1], &vector[2], &rest) == 3;
    for (int i = 0; i < 3 && good; i++)
        good = isfinite(vector[i]) && fabs(vector[i]) <= 1e7;
    if (!good)
        argp_failure(state, STATUS_USAGE, 0, "--%s: '%s' is not X,Y,Z in metres, each in +-1e7",
                     option, text);
}

enum { KEY_SCENE = 0x100, KEY_TREES, KEY_SIZE, KEY_SEED, KEY_TIME, KEY_EYE, KEY_TARGET };

static error_t shot_option(int key, char *text, struct argp_state *state)
{
    struct cli_shot *shot = state->input;
    switch (key) {
    case KEY_SCENE:
        shot->scene = text;
        return 0;
    case KEY_TREES:
        shot->trees = text;
        return 0;
    case KEY_SIZE:
        shot->size = text;
        return 0;
    case 'o':
        shot->out = text;
        return 0;
    case 'q':
        shot->quiet = true;
        return 0;
    case KEY_SEED:
        shot->seed = cli_seed(state, text);
        shot->seed_given = true;
        return 0;
    case KEY_TIME:
        shot->time = cli_number(state, "time", text, 0, 1);
        return 0;
    case KEY_EYE:
        parse_vector(state, "eye", text, shot->eye_m);
        shot->has_eye = true;
        return 0;
    case KEY_TARGET:
        parse_vector(state, "target", text, shot->target_m);
        shot->has_target = true;
        return 0;
    case ARGP_KEY_ARG:
        if (shot->cell)
            argp_failure(state, STATUS_USAGE, 0, "one cell is enough: '%s' is too much", text);
        shot->cell = text;
        return 0;
    case ARGP_KEY_END:
        if (shot->has_eye != shot->has_target)
            argp_failure(state, STATUS_USAGE, 0, "--eye and --target go together");
        if (shot->has_eye && memcmp(shot->eye_m, shot->target_m, sizeof shot->eye_m) == 0)
            argp_failure(state, STATUS_USAGE, 0,
                         "--target: the eye is 0 m from the target; which way does it look?");
        if (!shot->cell && !shot->scene)
            argp_failure(state, STATUS_USAGE, 0, "which scene? give a CELL or --scene");
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static const struct argp_option shot_options[] = {
    {"scene", KEY_SCENE, "NAME", 0, "scene: a name or a path of a .json", 0},
    {"trees", KEY_TREES, "N", 0, "number of trees; the scene's own by default", 0},
    {"size", KEY_SIZE, "WxH", 0, "picture in pixels; the scene's own by default", 0},
    {"seed", KEY_SEED, "S", 0, "placement and sampling, 1 by default", 0},
    {"time", KEY_TIME, "T", 0, "time along the camera path, 0..1", 0},
    {"eye", KEY_EYE, "X,Y,Z", 0, "look from here (m) instead of the path", 0},
    {"target", KEY_TARGET, "X,Y,Z", 0, "look at this point (m)", 0},
    {"output", 'o', "FILE", 0, "file to write, .exr or .png", 0},
    {"quiet", 'q', NULL, 0, "no progress and no notes", 0},
    {0},
};

const struct argp cli_shot_argp = {shot_options, shot_option, NULL, NULL, NULL, NULL, NULL};

static error_t folder_option(int key, char *text, struct argp_state *state)
{
    struct cli_folder *folder = state->input;
    switch (key) {
    case 'o':
        folder->out = text;
        return 0;
    case 'q':
        folder->quiet = true;
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static const struct argp_option folder_options[] = {
    {"out", 'o', "DIR", 0, "where to write, instead of the folder that the text above names", 0},
    {"quiet", 'q', NULL, 0, "do not print the path", 0},
    {0},
};

const struct argp cli_folder_argp = {folder_options, folder_option, NULL, NULL, NULL, NULL, NULL};

enum status cli_shot_cell(struct arena *arena, const struct cli_shot *shot, bool with_method,
                          struct cell *cell, struct error *error)
{
    const char *name = shot->cell;
    if (!name && with_method && !shot->method)
        return error_set(error, STATUS_USAGE, "which method? give a CELL or --method");
    if (shot->out && image_path_check(shot->out, error))
        return error->status;
    if (!name)
        name = arena_printf(arena, "%s/%s", shot->scene, with_method ? shot->method : "null");
    struct cell parsed;
    enum status status = cell_parse(arena, name, &parsed, error);
    if (status)
        return status;
    char *text = arena_printf(arena, "%s/%s%s%s", parsed.scene, parsed.method_name,
                              *parsed.options ? ":" : "", parsed.options);
    bool sized = shot->size != NULL;
    text =
        arena_printf(arena, "%s/trees=%s/lod=%s/target=%s", text,
                     shot->trees ? shot->trees : arena_printf(arena, "%zu", parsed.trees),
                     shot->lod ? shot->lod : lod_word(parsed.lod),
                     shot->target_format ? shot->target_format : target_format_word(parsed.format));
    text = arena_printf(arena, "%s/size=%s/seed=%llu", text,
                        sized ? shot->size
                              : arena_printf(arena, "%dx%d", parsed.width_px, parsed.height_px),
                        (unsigned long long)(shot->seed_given ? shot->seed : parsed.seed));
    return cell_parse(arena, text, cell, error);
}

void cli_shot_view(const struct cli_shot *shot, const struct scene *scene, struct view *view)
{
    view_at(scene, shot->time, view);
    if (shot->has_eye) {
        double time = view->time;
        float sun[3], eye_m[3], target_m[3];
        for (int i = 0; i < 3; i++) {
            eye_m[i] = (float)(shot->eye_m[i] - scene->origin_m[i]);
            target_m[i] = (float)(shot->target_m[i] - scene->origin_m[i]);
        }
        memcpy(sun, view->sun_direction, sizeof sun);
        view_look_at(scene, eye_m, target_m, view);
        memcpy(view->sun_direction, sun, sizeof sun);
        view->time = time;
    }
}
