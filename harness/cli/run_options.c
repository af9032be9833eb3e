/* The command line of `treeline run`. */
#include "cli/run.h"

#include "plan/settings.h"

#include <stdlib.h>
#include <string.h>

enum {
    KEY_SCENE = 0x100,
    KEY_METHOD,
    KEY_TREES,
    KEY_LOD,
    KEY_SIZE,
    KEY_TARGET,
    KEY_CELL,
    KEY_FILTER,
    KEY_SEED,
    KEY_ROUNDS,
    KEY_FRAME_SECONDS,
    KEY_FRAMES_MAX,
    KEY_VIEWS,
    KEY_TIMEOUT,
    KEY_MEMORY,
    KEY_THREADS,
    KEY_BACKEND,
    KEY_REFERENCE_ERROR,
    KEY_REFERENCE_SAMPLES,
    KEY_RESUME,
    KEY_RETRY,
    KEY_DRY_RUN,
    KEY_NO_CALIBRATE,
    KEY_REPORT,
    KEY_JSON
};

static const struct argp_option options[] = {
    {NULL, 0, NULL, 0, "What to run (lists are separated by commas, and replace the plan's):", 1},
    {"scene", KEY_SCENE, "NAME", 0, "a scene, by name or path; may stand more than once", 1},
    {"method", KEY_METHOD, "NAME[:opt=val,...]", 0,
     "a method, or names alone with commas; an option with a list sweeps it: "
     "billboards:views=8,16,alpha=test; may stand more "
     "than once",
     1},
    {"trees", KEY_TREES, "N,...", 0, "tree counts, or standard for the scene's own list", 1},
    {"lod", KEY_LOD, "L,...", 0, "levels of detail: low, intermediate, high, auto", 1},
    {"size", KEY_SIZE, "WxH,...", 0, "pictures in pixels", 1},
    {"target", KEY_TARGET, "F,...", 0, "target formats: rgba8, rgba16f, rgba32f", 1},
    {"seed", KEY_SEED, "S", 0, "seed of placement and sampling, 1 by default", 1},
    {"cell", KEY_CELL, "NAME", 0, "one cell by its name; may stand more than once", 1},
    {"filter", KEY_FILTER, "RE", 0, "only cells whose name matches the extended regular expression",
     1},
    {NULL, 0, NULL, 0, "How to measure (`treeline help plan` gives ranges and defaults):", 2},
    {"rounds", KEY_ROUNDS, "R", 0, "repetitions of each cell", 2},
    {"frame-seconds", KEY_FRAME_SECONDS, "S", 0, "measuring time of a repetition", 2},
    {"frames-max", KEY_FRAMES_MAX, "N", 0, "timed frames of a repetition at most", 2},
    {"views", KEY_VIEWS, "N", 0, "pictures compared along the camera path", 2},
    {"timeout", KEY_TIMEOUT, "S", 0, "time limit of a repetition", 2},
    {"memory", KEY_MEMORY, "SIZE", 0, "budget of a method's host memory, such as 2G; 0 for none",
     2},
    {"threads", KEY_THREADS, "N", 0, "threads of llvmpipe and of CPU methods, 0 for all", 2},
    {"backend", KEY_BACKEND, "NAME", 0, "GL back end: osmesa, egl-surfaceless, egl-device", 2},
    {"reference-error", KEY_REFERENCE_ERROR, "E", 0, "standard error of the references", 2},
    {"reference-samples", KEY_REFERENCE_SAMPLES, "N", 0, "their samples a pixel at most", 2},
    {NULL, 0, NULL, 0, "The run:", 3},
    {"out", 'o', "DIR", 0, "folder of the run; results/PLAN-TIME by default", 3},
    {"resume", KEY_RESUME, NULL, 0, "continue the run in DIR: finished repetitions are kept", 3},
    {"retry", KEY_RETRY, NULL, 0, "with --resume: failed repetitions are run again", 3},
    {"dry-run", KEY_DRY_RUN, NULL, 0, "print the names of the cells and stop", 3},
    {"no-calibrate", KEY_NO_CALIBRATE, NULL, 0,
     "do not measure the machine's limits (at most 6 s, once a run)", 3},
    {"report", KEY_REPORT, NULL, 0, "write the report to reports/NAME-OF-DIR and print its path",
     3},
    {"json", KEY_JSON, NULL, 0, "the closing table as JSON", 3},
    {"quiet", 'q', NULL, 0, "no progress and no notes", 3},
    {0},
};

struct parsing {
    struct run_request *request;
    const char **scenes, **methods, **cells;
};

/* The value of an option whose range a row of the settings says. */
static double setting(const struct argp_state *state, const char *option, const char *text,
                      const char *name)
{
    const struct option *row = plan_settings_table;
    while (strcmp(row->name, name) != 0)
        row++;
    if (row->type == OPTION_INT)
        return cli_integer(state, option, text, (int)row->minimum, (int)row->maximum);
    return cli_number(state, option, text, row->minimum, row->maximum);
}

static error_t parse_measuring(int key, const char *text, const struct argp_state *state,
                               struct plan_request *plan)
{
    switch (key) {
    case KEY_ROUNDS:
        plan->rounds = (int)setting(state, "rounds", text, "rounds");
        return 0;
    case KEY_FRAME_SECONDS:
        plan->frame_seconds = setting(state, "frame-seconds", text, "frame_seconds");
        return 0;
    case KEY_FRAMES_MAX:
        plan->frames_max = (int)setting(state, "frames-max", text, "frames_max");
        return 0;
    case KEY_VIEWS:
        plan->views_count = (size_t)setting(state, "views", text, "views");
        return 0;
    case KEY_TIMEOUT:
        plan->timeout_seconds = setting(state, "timeout", text, "timeout_seconds");
        return 0;
    case KEY_MEMORY:
        plan->memory_bytes = cli_bytes(state, "--memory", text);
        plan->memory_given = true;
        return 0;
    case KEY_THREADS:
        plan->threads = (int)setting(state, "threads", text, "threads");
        plan->threads_given = true;
        return 0;
    case KEY_BACKEND:
        plan->backend = text;
        return 0;
    case KEY_REFERENCE_ERROR:
        plan->reference_error = setting(state, "reference-error", text, "reference_error");
        return 0;
    case KEY_REFERENCE_SAMPLES:
        plan->reference_samples_max =
            (int)setting(state, "reference-samples", text, "reference_samples_max");
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static error_t parse_run(int key, char *text, const struct argp_state *state,
                         struct run_request *request)
{
    switch (key) {
    case KEY_RESUME:
        request->resume = true;
        return 0;
    case KEY_RETRY:
        request->retry = true;
        return 0;
    case KEY_DRY_RUN:
        request->dry_run = true;
        return 0;
    case KEY_NO_CALIBRATE:
        request->no_calibrate = true;
        return 0;
    case KEY_REPORT:
        request->report = true;
        return 0;
    case KEY_JSON:
        request->json = true;
        return 0;
    case 'o':
        if (!*text)
            argp_failure(state, STATUS_USAGE, 0, "--out: '' is not the name of a folder");
        request->out = text;
        return 0;
    case 'q':
        request->quiet = true;
        return 0;
    default:
        return parse_measuring(key, text, state, &request->plan);
    }
}

/* Names alone may stand in one list; behind a colon a comma belongs to the options. */
static void methods_add(struct parsing *parsing, char *text)
{
    size_t *count = &parsing->request->plan.methods_count;
    char *rest = strchr(text, ':') ? NULL : text;
    if (!rest)
        parsing->methods[(*count)++] = text;
    for (char *name; (name = strsep(&rest, ","));)
        parsing->methods[(*count)++] = name;
}

static error_t parse_argument(const char *text, const struct argp_state *state,
                              struct parsing *parsing)
{
    struct plan_request *plan = &parsing->request->plan;
    if (strchr(text, '/') && strstr(text, "trees="))
        parsing->cells[plan->cells_count++] = text;
    else if (!plan->plan_path)
        plan->plan_path = text;
    else
        argp_failure(state, STATUS_USAGE, 0, "one plan at a time: '%s' is too much", text);
    return 0;
}

static error_t parse(int key, char *text, struct argp_state *state)
{
    struct parsing *parsing = state->input;
    struct run_request *request = parsing->request;
    struct plan_request *plan = &request->plan;
    switch (key) {
    case KEY_SCENE:
        parsing->scenes[plan->scenes_count++] = text;
        return 0;
    case KEY_METHOD:
        methods_add(parsing, text);
        return 0;
    case KEY_CELL:
        parsing->cells[plan->cells_count++] = text;
        return 0;
    case KEY_TREES:
        plan->trees = text;
        return 0;
    case KEY_LOD:
        plan->lods = text;
        return 0;
    case KEY_SIZE:
        plan->sizes = text;
        return 0;
    case KEY_TARGET:
        plan->targets = text;
        return 0;
    case KEY_FILTER:
        plan->filter = text;
        return 0;
    case KEY_SEED:
        plan->seed = cli_seed(state, text);
        plan->seed_given = true;
        return 0;
    case ARGP_KEY_ARG:
        return parse_argument(text, state, parsing);
    case ARGP_KEY_END:
        if (request->resume && !request->out)
            argp_failure(state, STATUS_USAGE, 0, "--resume: which run? give its folder with --out");
        if (request->retry && !request->resume)
            argp_failure(state, STATUS_USAGE, 0, "--retry goes with --resume");
        return 0;
    default:
        return parse_run(key, text, state, request);
    }
}

void run_request_parse(struct arena *arena, int argc, char **argv, struct run_request *request)
{
    const struct argp argp = {
        options,
        parse,
        "[PLAN|CELL...]",
        "Times cells in fresh processes in random order, then draws their pictures and judges them "
        "against the ray-traced reference.\v"
        "PLAN is a name in scenes/plans/ (quick, smoke, ...) or a JSON file "
        "(harness/plan/README.md). "
        "CELL is SCENE/METHOD[:opt=val,...]/trees=N/..., as printed by --dry-run. Finished "
        "repetitions survive Ctrl-C and kill -9. Exit codes: treeline help exit.",
        NULL,
        NULL,
        NULL};
    size_t most = (size_t)argc + 1;
    for (int i = 1; i < argc; i++)
        for (const char *c = argv[i]; *c; c++)
            most += *c == ',';
    struct parsing parsing = {
        .request = request,
        .scenes = ARENA_ARRAY(arena, const char *, most),
        .methods = ARENA_ARRAY(arena, const char *, most),
        .cells = ARENA_ARRAY(arena, const char *, most),
    };
    argp_parse(&argp, argc, argv, 0, NULL, &parsing);
    request->plan.scenes = parsing.scenes;
    request->plan.methods = parsing.methods;
    request->plan.cells = parsing.cells;
}
