/* Reading scene.json: the root's own keys, and the order of the parts. */
#include "scene/description.h"

#include "base/file.h"
#include "base/nearest.h"
#include "scene/describe.h"

#include <stdio.h>
#include <string.h>

/* The file of a scene's name or path, STATUS_NOT_FOUND with the nearest name. */
static enum status scene_find(struct arena *arena, const char *name, const char **path,
                              struct error *error)
{
    *path = arena_strdup(arena, name);
    if (path_ends_with(name, ".json"))
        return file_exists(name)
                   ? STATUS_OK
                   : error_set(error, STATUS_NOT_FOUND, "%s: no such scene file", name);
    if (!strchr(name, '/')) {
        *path = arena_printf(arena, "%s/scenes/%s.json", data_folder(), name);
        if (file_exists(*path))
            return STATUS_OK;
    }
    char **names = NULL;
    size_t count = 0;
    enum status status = scene_names(arena, &names, &count, error);
    if (status != STATUS_OK)
        return status;
    const char *list = "", *nearest = NULL;
    for (size_t k = 0; k < count; k++) {
        nearest = nearest_of(name, nearest, names[k]);
        list = arena_printf(arena, "%s%s%s", list, k > 0 ? ", " : "", names[k]);
    }
    return error_set(error, STATUS_NOT_FOUND,
                     "no scene '%s'%s%s%s; scenes are %s, or a path that "
                     "ends in .json",
                     name, nearest ? "; did you mean '" : "", nearest ? nearest : "",
                     nearest ? "'?" : "", list);
}

const char *describe_path(struct arena *arena, const char *scene_path, const char *path)
{
    const char *slash = strrchr(scene_path, '/');
    if (!path || path[0] == '/' || !slash)
        return path;
    return arena_printf(arena, "%.*s/%s", (int)(slash - scene_path), scene_path, path);
}

static void describe_size(struct json *root, struct description *description)
{
    float size[2] = {800, 600};
    json_vector(root, "size", size, 2, 1, SIDE_PX_MAX);
    for (int a = 0; a < 2; a++)
        if (size[a] != floorf(size[a]))
            json_fail(root, "size", "value is %g; allowed: whole numbers 1..%d", (double)size[a],
                      SIDE_PX_MAX);
    description->width_px = (int)size[0];
    description->height_px = (int)size[1];
}

static void describe_trees(struct arena *arena, struct json *root, struct description *description)
{
    struct json *trees = json_object(root, "trees");
    description->default_trees = (size_t)json_integer(trees, "default", 100, 0, TREES_MAX);
    size_t count = json_array(trees, "standard");
    description->trees_count = count > 0 ? count : 1;
    description->trees = ARENA_ARRAY(arena, size_t, description->trees_count);
    description->trees[0] = description->default_trees;
    for (size_t k = 0; k < count; k++) {
        double value = json_element_number(trees, "standard", k, 0, TREES_MAX);
        if (value != floor(value))
            json_fail(trees, "standard", "value is %g; allowed: whole numbers 0..%d", value,
                      TREES_MAX);
        description->trees[k] = (size_t)value;
    }
}

static void describe_effects(struct json *root, struct description *description)
{
    static const struct {
        const char *word;
        unsigned bit;
    } effects[] = {
#define EFFECT_ROW(name, bit, word, meaning) {word, bit},
        EFFECT_LIST(EFFECT_ROW)
#undef EFFECT_ROW
    };
    enum { COUNT = sizeof effects / sizeof effects[0] };
    size_t count = json_array(root, "effects");
    for (size_t k = 0; k < count; k++) {
        const char *word = json_element_text(root, "effects", k);
        size_t e = 0;
        while (e < COUNT && strcmp(effects[e].word, word) != 0)
            e++;
        if (e < COUNT) {
            description->effects |= effects[e].bit;
            continue;
        }
        char allowed[256] = "";
        for (size_t i = 0, used = 0; i < COUNT && used < sizeof allowed; i++)
            used += (size_t)snprintf(allowed + used, sizeof allowed - used, "%s%s",
                                     i > 0 ? "|" : "", effects[i].word);
        json_fail(root, "effects", "value is '%.64s'; allowed: %s", word, allowed);
    }
}

enum status description_load(struct arena *arena, const char *name, struct description *description,
                             struct error *error)
{
    struct error local = {STATUS_OK, ""};
    error = error ? error : &local;
    *description = (struct description){0};
    enum status status = scene_find(arena, name, &description->path, error);
    if (status != STATUS_OK)
        return status;
    description->name = path_stem(arena, description->path);
    struct json_doc *doc = json_load(arena, description->path, error);
    if (!doc)
        return error->status;
    struct json *root = json_root(doc);
    description->doc = json_text(root, "doc", "");
    describe_size(root, description);
    describe_trees(arena, root, description);
    describe_effects(root, description);
    describe_plants(arena, root, description);
    describe_placement(arena, root, description);
    describe_ground(arena, root, description);
    describe_light(root, description);
    describe_camera(arena, root, description);
    return json_end(doc);
}
