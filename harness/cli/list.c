/* treeline list: methods, scenes, metrics, plants, grammars; as tables or JSON. */
#include "base/file.h"
#include "cli/cli.h"
#include "plant/lsystem.h"
#include "plant/plant.h"
#include "scene/scene.h"
#include "truth/mask.h"
#include "wall/json.h"

#include <glob.h>
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

enum { KEY_PLUGIN = 0x100, PLUGINS_MAX = 64 };

struct request {
    const char *what;
    bool json;
    const char *plugins[PLUGINS_MAX];
    size_t plugins_count;
};

static error_t parse(int key, char *text, struct argp_state *state)
{
    struct request *request = state->input;
    switch (key) {
    case 'j':
        request->json = true;
        return 0;
    case KEY_PLUGIN:
        if (request->plugins_count == PLUGINS_MAX)
            argp_failure(state, STATUS_USAGE, 0, "more than %d plugins: '%s' is too much",
                         PLUGINS_MAX, text);
        request->plugins[request->plugins_count++] = text;
        return 0;
    case ARGP_KEY_ARG:
        if (request->what)
            argp_failure(state, STATUS_USAGE, 0, "one list at a time: '%s' is too much", text);
        request->what = text;
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static const struct argp_option options[] = {
    {"json", 'j', NULL, 0, "one JSON object instead of a table", 0},
    {"plugin", KEY_PLUGIN, "PATH", 0, "also this method; may be repeated", 0},
    {0},
};

static char *effects_text(struct arena *arena, unsigned effects)
{
    char *text = arena_strdup(arena, "");
#define EFFECT_NAME(name, bit, word, meaning)                                                      \
    if (effects & (name))                                                                          \
        text = arena_printf(arena, "%s%s%s", text, *text ? "," : "", word);
    EFFECT_LIST(EFFECT_NAME)
#undef EFFECT_NAME
    return *text ? text : "none";
}

static void option_put(struct json_out *out, const struct option *option)
{
    char allowed[256];
    option_allowed(option, allowed, sizeof allowed);
    json_open(out, NULL, '{');
    json_put_text(out, "name", option->name);
    json_put_number(out, "default", option->fallback);
    json_put_text(out, "allowed", allowed);
    json_put_text(out, "unit", option->unit);
    json_put_text(out, "doc", option->doc);
    json_close(out);
}

static void method_put(struct arena *arena, struct json_out *out, const struct method *method)
{
    const char *kind = method->traits & TRAIT_CPU ? "CPU" : "GL";
    const char *effects = effects_text(arena, method->traits & EFFECTS_ALL);
    if (!out) {
        printf("%-14s %-6s %-42s %s\n", method->name, kind, effects, method->summary);
        return;
    }
    json_open(out, NULL, '{');
    json_put_text(out, "name", method->name);
    json_put_text(out, "kind", kind);
    json_put_text(out, "effects", effects);
    json_put_bool(out, "stochastic", method->traits & TRAIT_STOCHASTIC);
    json_put_text(out, "summary", method->summary);
    json_put_text(out, "source", method->source);
    json_open(out, "options", '[');
    for (const struct option *o = method->options; o && o->name; o++)
        option_put(out, o);
    json_close(out);
    json_close(out);
}

static enum status list_methods(const struct request *request, struct arena *arena,
                                struct json_out *out, struct error *error)
{
    const struct method *plugins[PLUGINS_MAX];
    for (size_t i = 0; i < request->plugins_count; i++)
        if (method_find(request->plugins[i], &plugins[i], error))
            return error->status;
    if (!out)
        printf("%-14s %-6s %-42s %s\n", "method", "kind", "effects", "summary");
    for (const struct method *const *each = methods_builtin; *each; each++)
        method_put(arena, out, *each);
    for (size_t i = 0; i < request->plugins_count; i++)
        method_put(arena, out, plugins[i]);
    return STATUS_OK;
}

static void scene_put(struct json_out *out, const struct scene_summary *scene, const char *effects)
{
    json_open(out, NULL, '{');
    json_put_text(out, "name", scene->name);
    json_put_text(out, "doc", scene->doc);
    json_put_number(out, "width_px", scene->width_px);
    json_put_number(out, "height_px", scene->height_px);
    json_put_number(out, "default_trees", (double)scene->default_trees);
    json_open(out, "trees", '[');
    for (size_t k = 0; k < scene->trees_count; k++)
        json_put_number(out, NULL, (double)scene->trees[k]);
    json_close(out);
    json_put_text(out, "effects", effects);
    json_put_number(out, "frames", (double)scene->frames_count);
    json_close(out);
}

static enum status list_scenes(const struct request *request, struct arena *arena,
                               struct json_out *out, struct error *error)
{
    (void)request;
    char **names;
    size_t count;
    enum status status = scene_names(arena, &names, &count, error);
    if (!status && !out)
        printf("%-16s %9s  %-34s %s\n", "scene", "size", "trees", "what it shows");
    for (size_t i = 0; i < count && !status; i++) {
        struct scene_summary scene;
        status = scene_summary(arena, names[i], &scene, error);
        if (status)
            break;
        const char *effects = effects_text(arena, scene.effects), *trees = "";
        for (size_t k = 0; k < scene.trees_count; k++)
            trees = arena_printf(arena, "%s%s%zu", trees, k ? "," : "", scene.trees[k]);
        if (out)
            scene_put(out, &scene, effects);
        else
            printf("%-16s %4dx%-4d  %-34s %s\n", scene.name, scene.width_px, scene.height_px, trees,
                   scene.doc);
    }
    return status;
}

static void metrics_put(const struct metric_info *metric, struct json_out *out)
{
    for (; metric->field; metric++) {
        const char *better = metric->better < 0 ? "lower" : metric->better > 0 ? "higher" : "zero";
        if (!out) {
            printf("%-15s %-8s %-7s %s\n", metric->word, metric->domain, better, metric->doc);
            continue;
        }
        json_open(out, NULL, '{');
        json_put_text(out, "name", metric->word);
        json_put_text(out, "domain", metric->domain);
        json_put_text(out, "better", better);
        json_put_text(out, "doc", metric->doc);
        json_close(out);
    }
}

static enum status list_metrics(const struct request *request, struct arena *arena,
                                struct json_out *out, struct error *error)
{
    (void)request;
    (void)arena;
    (void)error;
    if (!out)
        printf("%-15s %-8s %-7s %s\n", "metric", "domain", "better", "definition");
    metrics_put(metric_table, out);
    metrics_put(flicker_table, out);
    metrics_put(mask_table, out);
    return STATUS_OK;
}

static enum status list_plants(const struct request *request, struct arena *arena,
                               struct json_out *out, struct error *error)
{
    (void)request;
    if (!out)
        printf("%-10s %10s %10s %9s %9s %8s %9s\n", "plant", "triangles", "vertices", "height_m",
               "radius_m", "MB", "build_ms");
    for (const char *const *name = plant_generators; *name; name++) {
        struct plant *plant;
        const struct mesh *mesh;
        enum status status = plant_generated(arena, *name, NULL, &plant, error);
        if (!status)
            status = plant_mesh(plant, &mesh, error);
        if (status)
            return status;
        struct plant_cost cost = plant_cost(plant);
        double height_m = (double)mesh->maximum_m[1] - (double)mesh->minimum_m[1];
        if (!out) {
            printf("%-10s %10zu %10zu %9.2f %9.2f %8.2f %9.1f\n", *name, mesh->triangles_count,
                   mesh->vertices_count, height_m, (double)mesh->radius_m,
                   (double)cost.build_bytes / 1e6, cost.build_seconds * 1e3);
            continue;
        }
        json_open(out, NULL, '{');
        json_put_text(out, "name", *name);
        json_put_number(out, "triangles", (double)mesh->triangles_count);
        json_put_number(out, "vertices", (double)mesh->vertices_count);
        json_put_number(out, "height_m", height_m);
        json_put_number(out, "radius_m", (double)mesh->radius_m);
        json_put_number(out, "build_bytes", (double)cost.build_bytes);
        json_put_number(out, "build_seconds", cost.build_seconds);
        json_open(out, "options", '[');
        for (const struct option *o = plant_options(*name); o && o->name; o++)
            option_put(out, o);
        json_close(out);
        json_close(out);
    }
    return STATUS_OK;
}

static void grammar_put(struct json_out *out, const char *name, const struct lsystem *lsystem,
                        const struct conifer *conifer)
{
    double height_m = (double)conifer->maximum_m[1] - (double)conifer->minimum_m[1];
    const char *comma = "";
    if (!out) {
        printf("%-14s %9zu %9zu %9" PRIu64 " %9.2f  ", name, conifer->branches_count,
               conifer->twigs_count, conifer->needles_count, height_m);
        for (const struct option *o = lsystem_options(lsystem); o && o->name; o++) {
            printf("%s%s=%g", comma, o->name, o->fallback);
            comma = ",";
        }
        printf("\n");
        return;
    }
    json_open(out, NULL, '{');
    json_put_text(out, "name", name);
    json_put_number(out, "branches", (double)conifer->branches_count);
    json_put_number(out, "twigs", (double)conifer->twigs_count);
    json_put_number(out, "needles", (double)conifer->needles_count);
    json_put_number(out, "height_m", height_m);
    json_open(out, "options", '[');
    for (const struct option *o = lsystem_options(lsystem); o && o->name; o++)
        option_put(out, o);
    json_close(out);
    json_close(out);
}

/* The conifers of scenes/plants, grown with their files' parameters. */
static enum status list_grammars(const struct request *request, struct arena *arena,
                                 struct json_out *out, struct error *error)
{
    glob_t found = {0};
    enum status status = STATUS_OK;
    (void)request;
    glob(arena_printf(arena, "%s/scenes/plants/*.json", data_folder()), 0, NULL, &found);
    if (!out)
        printf("%-14s %9s %9s %9s %9s  %s\n", "grammar", "branches", "twigs", "needles", "height_m",
               "parameters");
    for (size_t i = 0; i < found.gl_pathc && !status; i++) {
        struct lsystem *lsystem;
        struct conifer *conifer;
        status = lsystem_load(arena, found.gl_pathv[i], &lsystem, error);
        if (!status)
            status = lsystem_conifer(arena, lsystem, &conifer, error);
        if (!status)
            grammar_put(out, path_stem(arena, found.gl_pathv[i]), lsystem, conifer);
    }
    globfree(&found);
    return status;
}

struct listing {
    const char *name;
    enum status (*print)(const struct request *request, struct arena *arena, struct json_out *out,
                         struct error *error);
};

static const struct listing listings[] = {
    {"methods", list_methods}, {"scenes", list_scenes},     {"metrics", list_metrics},
    {"plants", list_plants},   {"grammars", list_grammars},
};

/* Grammars are plants. */
static bool is_wanted(const char *what, const char *listing)
{
    return !what || strcmp(what, listing) == 0 ||
           (strcmp(what, "plants") == 0 && strcmp(listing, "grammars") == 0);
}

int verb_list(int argc, char **argv)
{
    const struct argp argp = {options,
                              parse,
                              "[methods|scenes|metrics|plants|grammars]",
                              "Lists what there is; without an argument, everything.",
                              NULL,
                              NULL,
                              NULL};
    struct request request = {0};
    argp_parse(&argp, argc, argv, 0, NULL, &request);
    struct arena *arena = arena_create(0);
    struct error error = {0};
    struct json_out *out = request.json ? json_out(arena) : NULL;
    enum status status = STATUS_OK;
    size_t printed = 0;
    if (out)
        json_open(out, NULL, '{');
    for (size_t i = 0; i < sizeof listings / sizeof *listings && !status; i++) {
        if (!is_wanted(request.what, listings[i].name))
            continue;
        if (out)
            json_open(out, listings[i].name, '[');
        else if (printed)
            printf("\n");
        status = listings[i].print(&request, arena, out, &error);
        if (out)
            json_close(out);
        printed++;
    }
    if (!printed)
        status = error_set(&error, STATUS_USAGE,
                           "list: '%s' is not one of methods, scenes, metrics, plants, grammars",
                           request.what);
    if (!status && out) {
        json_close(out);
        printf("%s\n", json_out_text(out));
    }
    arena_destroy(arena);
    return status ? cli_fail(&error) : STATUS_OK;
}
