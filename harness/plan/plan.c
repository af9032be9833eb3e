/* A plan: measuring settings and lists from a file and the command line, expanded into cells. */
#include "plan/plan.h"

#include "base/file.h"
#include "base/hash.h"
#include "base/pattern.h"
#include "base/random.h"
#include "plan/names.h"
#include "plan/settings.h"
#include "wall/json.h"

#include <glob.h>
#include <stdio.h>
#include <string.h>

/* What one group of a plan sweeps over. */
struct group {
    const char *const *scenes;
    size_t scenes_count;
    const char *const *methods;
    size_t methods_count;
    const char *trees, *lods, *sizes, *targets; /* NULL: the default of the scene, or of treeline */
};

/* A plan file as it stands. groups[0] is what the top level says. */
struct plan_file {
    struct group *groups;
    size_t groups_count;
    const char *const *cells;
    size_t cells_count;
    const char *backend;
    uint64_t seed;
    bool seed_given;
};

static const char *const *texts_read(struct arena *arena, struct json *object, const char *key,
                                     size_t *count)
{
    *count = json_array(object, key);
    const char **texts = ARENA_ARRAY(arena, const char *, *count + 1);
    for (size_t i = 0; i < *count; i++)
        texts[i] = json_element_text(object, key, i);
    return texts;
}

static struct group group_read(struct arena *arena, struct json *object,
                               const struct group *fallback)
{
    struct group group = {
        .trees = json_text(object, "trees", fallback->trees),
        .lods = json_text(object, "lods", fallback->lods),
        .sizes = json_text(object, "sizes", fallback->sizes),
        .targets = json_text(object, "targets", fallback->targets),
    };
    group.scenes = texts_read(arena, object, "scenes", &group.scenes_count);
    group.methods = texts_read(arena, object, "methods", &group.methods_count);
    if (!group.scenes_count) {
        group.scenes = fallback->scenes;
        group.scenes_count = fallback->scenes_count;
    }
    if (!group.methods_count) {
        group.methods = fallback->methods;
        group.methods_count = fallback->methods_count;
    }
    return group;
}

/* The path of a plan: itself with '/' or ".json", else scenes/plans/NAME.json. */
static enum status plan_path(struct arena *arena, const char *name, const char **path,
                             struct error *error)
{
    if (strchr(name, '/') || path_ends_with(name, ".json")) {
        *path = name;
        return STATUS_OK;
    }
    *path = arena_printf(arena, "%s/scenes/plans/%s.json", data_folder(), name);
    if (file_exists(*path))
        return STATUS_OK;
    glob_t found = {0};
    const char *names = "";
    glob(arena_printf(arena, "%s/scenes/plans/*.json", data_folder()), 0, NULL, &found);
    for (size_t i = 0; i < found.gl_pathc; i++)
        names = arena_printf(arena, "%s%s%s", names, i ? ", " : "",
                             path_stem(arena, found.gl_pathv[i]));
    globfree(&found);
    return error_set(error, STATUS_NOT_FOUND, "no plan '%s'; plans are %s, or a path of a .json",
                     name, *names ? names : "(none here)");
}

static enum status plan_file_read(struct arena *arena, const char *path, struct plan_file *file,
                                  struct plan_settings *settings, struct error *error)
{
    struct json_doc *doc = json_load(arena, path, error);
    if (!doc)
        return error->status;
    struct json *root = json_root(doc);
    json_text(root, "doc", "");
    struct group top = group_read(arena, root, &(struct group){0});
    size_t groups_count = json_array(root, "groups");
    file->groups_count = groups_count ? groups_count : 1;
    file->groups = ARENA_ARRAY(arena, struct group, file->groups_count);
    file->groups[0] = top;
    for (size_t i = 0; i < groups_count; i++)
        file->groups[i] = group_read(arena, json_element(root, "groups", i), &top);
    file->cells = texts_read(arena, root, "cells", &file->cells_count);
    file->backend = json_text(root, "backend", NULL);
    file->seed_given = json_has(root, "seed");
    file->seed = (uint64_t)json_integer(root, "seed", CELL_SEED, 0, (int64_t)1 << 53);
    for (const struct option *o = plan_settings_table; o->name; o++)
        if (json_has(root, o->name)) {
            double value = json_number(root, o->name, o->fallback, o->minimum, o->maximum);
            if (o->type == OPTION_INT && value != (int)value)
                json_fail(root, o->name, "%g; allowed: a whole number", value);
            else
                plan_settings_put(settings, o, value);
        }
    return json_end(doc);
}

/* What the command line says replaces what the file says, in every group. */
static void group_override(struct group *group, const struct plan_request *request)
{
    if (request->scenes_count) {
        group->scenes = request->scenes;
        group->scenes_count = request->scenes_count;
    }
    if (request->methods_count) {
        group->methods = request->methods;
        group->methods_count = request->methods_count;
    }
    group->trees = request->trees ? request->trees : group->trees;
    group->lods = request->lods ? request->lods : group->lods;
    group->sizes = request->sizes ? request->sizes : group->sizes;
    group->targets = request->targets ? request->targets : group->targets;
}

/* A list of texts, or of one NULL that stands for the default. */
static enum status list_items(struct arena *arena, const char *what, const char *text,
                              char ***items, size_t *count, struct error *error)
{
    if (text)
        return text_split(arena, what, text, items, count, error);
    *items = ARENA_ARRAY(arena, char *, 1);
    *count = 1;
    return STATUS_OK;
}

/* The tree counts of a group: numbers, or "standard" for the scene's own list. */
static enum status trees_items(struct arena *arena, const char *text,
                               const struct scene_summary *summary, size_t **trees, size_t *count,
                               struct error *error)
{
    char **items;
    size_t items_count;
    enum status status = list_items(arena, "trees", text, &items, &items_count, error);
    if (status)
        return status;
    *trees = ARENA_ARRAY(arena, size_t, items_count + items_count * summary->trees_count);
    *count = 0;
    for (size_t i = 0; i < items_count && !status; i++) {
        if (!items[i]) {
            (*trees)[(*count)++] = SIZE_MAX;
        } else if (!strcmp(items[i], "standard")) {
            for (size_t k = 0; k < summary->trees_count; k++)
                (*trees)[(*count)++] = summary->trees[k];
        } else {
            status = trees_parse(items[i], &(*trees)[(*count)++], error);
        }
    }
    return status;
}

/* Every combination of level, size and target of one scene and tree count. */
static enum status patterns_expand(struct cell_set *set, const struct group *group,
                                   struct cell pattern, const struct scene_summary *summary,
                                   struct error *error)
{
    char **lods, **sizes, **targets;
    size_t lods_count, sizes_count, targets_count;
    enum status status = list_items(set->arena, "lods", group->lods, &lods, &lods_count, error);
    if (!status)
        status = list_items(set->arena, "sizes", group->sizes, &sizes, &sizes_count, error);
    if (!status)
        status = list_items(set->arena, "targets", group->targets, &targets, &targets_count, error);
    if (status)
        return status;
    for (size_t i = 0; i < lods_count * sizes_count * targets_count; i++) {
        const char *lod = lods[i / sizes_count / targets_count];
        const char *size = sizes[i / targets_count % sizes_count];
        const char *target = targets[i % targets_count];
        if (lod && (status = lod_parse(lod, &pattern.lod, error)))
            return status;
        if (size && (status = size_parse(size, &pattern.width_px, &pattern.height_px, error)))
            return status;
        if (target && (status = target_parse(target, &pattern.format, error)))
            return status;
        for (size_t m = 0; m < group->methods_count; m++)
            if ((status = method_expand(set, group->methods[m], &pattern, summary, error)))
                return status;
    }
    return STATUS_OK;
}

static enum status group_expand(struct cell_set *set, const struct group *group, uint64_t seed,
                                struct error *error)
{
    for (size_t s = 0; s < group->scenes_count; s++) {
        const struct scene_summary *summary;
        size_t *trees, trees_count;
        enum status status = cell_set_scene(set, group->scenes[s], &summary, error);
        if (!status)
            status = trees_items(set->arena, group->trees, summary, &trees, &trees_count, error);
        for (size_t t = 0; !status && t < trees_count; t++) {
            struct cell pattern = {.scene = group->scenes[s],
                                   .trees = trees[t],
                                   .lod = LOD_AUTO,
                                   .format = TARGET_RGBA16F,
                                   .seed = seed};
            status = patterns_expand(set, group, pattern, summary, error);
        }
        if (status)
            return status;
    }
    return STATUS_OK;
}

static enum status cells_filter(struct cell_set *set, const char *filter, struct error *error)
{
    regex_t expression;
    enum status status = pattern_compile(filter, "filter", STATUS_INVALID, &expression, error);
    if (status)
        return status;
    size_t kept = 0, before = set->count;
    for (size_t i = 0; i < before; i++)
        if (!regexec(&expression, set->cells[i].name, 0, NULL, 0))
            set->cells[kept++] = set->cells[i];
    regfree(&expression);
    set->count = kept;
    if (!kept && before)
        return error_set(error, STATUS_INVALID, "filter: '%s' matches none of the %zu cells",
                         filter, before);
    return STATUS_OK;
}

static enum status cells_make(struct cell_set *set, const struct plan_request *request,
                              const struct plan_file *file, struct error *error)
{
    uint64_t seed = request->seed_given ? request->seed : file->seed;
    enum status status = STATUS_OK;
    bool only_cells = request->cells_count && !request->scenes_count && !request->plan_path;
    for (size_t g = 0; g < file->groups_count && !only_cells && !status; g++) {
        group_override(&file->groups[g], request);
        const struct group *group = &file->groups[g];
        bool empty = !group->scenes_count && !group->methods_count;
        if (empty && (request->cells_count || file->cells_count))
            continue;
        if (!group->scenes_count || !group->methods_count)
            return error_set(error, request->plan_path ? STATUS_INVALID : STATUS_USAGE,
                             "%sno %s; name a plan, or a scene and a method, or a cell",
                             request->plan_path ? "" : "nothing to run: ",
                             group->scenes_count ? "method" : "scene");
        status = group_expand(set, group, seed, error);
    }
    const char *const *lists[] = {file->cells, request->cells};
    const size_t counts[] = {file->cells_count, request->cells_count};
    for (int l = 0; l < 2; l++)
        for (size_t i = 0; i < counts[l] && !status; i++) {
            struct cell cell;
            status = cell_set_parse(set, lists[l][i], &cell, error);
            if (!status)
                status = cell_set_add(set, &cell, error);
        }
    if (!status && request->filter)
        status = cells_filter(set, request->filter, error);
    if (!status && !set->count)
        return error_set(error, STATUS_INVALID, "the plan has no cells");
    return status;
}

static void plan_fill(struct plan *plan, const struct plan_settings *settings)
{
    plan->rounds = settings->rounds;
    plan->frame_seconds = settings->frame_seconds;
    plan->frames_max = settings->frames_max;
    plan->timeout_seconds = settings->timeout_seconds;
    plan->memory_bytes = (size_t)settings->memory_bytes;
    plan->reference_error = settings->reference_error;
    plan->reference_samples_max = settings->reference_samples_max;
    plan->threads = settings->threads;
    plan->views_count = (size_t)settings->views;
    uint64_t hash = 0;
    for (size_t i = 0; i < plan->cells_count; i++)
        hash = hash_text(hash, plan->cells[i].name);
    const double values[] = {settings->rounds,
                             settings->frame_seconds,
                             settings->frames_max,
                             settings->timeout_seconds,
                             settings->memory_bytes,
                             settings->reference_error,
                             settings->reference_samples_max,
                             settings->threads,
                             settings->views};
    for (size_t i = 0; i < sizeof values / sizeof *values; i++)
        hash = hash_double(hash, values[i]);
    plan->hash = hash_text(hash, plan->backend);
}

enum status plan_load(struct arena *arena, const struct plan_request *request, struct plan **plan,
                      struct error *error)
{
    struct plan_settings settings;
    options_default(plan_settings_table, &settings);
    struct plan_file file = {
        .groups = ARENA_NEW(arena, struct group), .groups_count = 1, .seed = CELL_SEED};
    enum status status = STATUS_OK;
    const char *path = NULL;
    if (request->plan_path) {
        status = plan_path(arena, request->plan_path, &path, error);
        if (!status)
            status = plan_file_read(arena, path, &file, &settings, error);
    }
    if (!status)
        status = plan_settings_override(&settings, request, error);
    const char *backend = request->backend ? request->backend : file.backend;
    if (!status && backend)
        status = gl_backend_check(backend, "backend", error);
    struct cell_set set = {.arena = arena};
    if (status)
        return status;
    status = cells_make(&set, request, &file, error);
    if (status)
        return path ? error_context(error, "plan %s", path) : status;
    struct plan *made = ARENA_NEW(arena, struct plan);
    made->name = path ? path_stem(arena, path) : "command-line";
    made->cells = set.cells;
    made->cells_count = set.count;
    made->backend = backend;
    plan_fill(made, &settings);
    *plan = made;
    return STATUS_OK;
}

void plan_order(const struct plan *plan, int round, size_t *order)
{
    struct random random = random_seed(plan->hash, (uint64_t)round);
    for (size_t i = 0; i < plan->cells_count; i++)
        order[i] = i;
    /* Fisher and Yates 1938, Durstenfeld 1964 (doi:10.1145/364520.364540). */
    for (size_t i = plan->cells_count; i > 1; i--) {
        size_t k = random_below(&random, (uint32_t)i), swap = order[i - 1];
        order[i - 1] = order[k];
        order[k] = swap;
    }
}
