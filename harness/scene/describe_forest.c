/* scene.json: plants and placement. */
#include "scene/describe.h"

#include <string.h>

static const float *describe_albedo(struct arena *arena, struct json *object, const char *key)
{
    float albedo[3] = {0, 0, 0};
    if (!json_vector(object, key, albedo, 3, 0, 1))
        return NULL;
    float *kept = ARENA_ARRAY(arena, float, 3);
    memcpy(kept, albedo, sizeof albedo);
    return kept;
}

static void describe_import(struct arena *arena, struct json *plant, struct plant_entry *entry)
{
    struct json *import = json_object(plant, "import");
    entry->import.height_m = json_number(import, "height_m", 0, 0, 1000);
    entry->import.z_up = json_bool(import, "z_up", false);
    entry->import.leaf = json_text(import, "leaf", NULL);
    entry->import.leaf_albedo = describe_albedo(arena, import, "leaf_albedo");
    entry->import.bark_albedo = describe_albedo(arena, import, "bark_albedo");
    if (import && (!entry->file || entry->generator))
        json_fail(plant, "import", "stands without a file of a mesh; allowed: together with file");
}

static void describe_coloring(struct json *plant, struct plant_entry *entry)
{
    struct json *coloring = json_object(plant, "coloring");
    entry->coloring.grid = (int)json_integer(coloring, "grid", 128, 2, COLORING_GRID_MAX);
    entry->coloring.binary = json_bool(coloring, "binary", false);
    entry->coloring.agreement = (float)json_number(coloring, "agreement", 1, 0, 1);
    entry->coloring.see_through = (float)json_number(coloring, "see_through", 1, 0, 1);
    if (coloring && !entry->images)
        json_fail(plant, "coloring", "stands without images; allowed: together with images");
}

/* The least and the most of a factor that each tree draws; 1 where nothing is said. */
static void describe_range(struct json *plant, const char *key, double minimum, double maximum,
                           float range[2])
{
    range[0] = range[1] = 1;
    json_vector(plant, key, range, 2, minimum, maximum);
    if (range[0] > range[1])
        json_fail(plant, key, "value is [%g, %g]; allowed: the smaller one first", (double)range[0],
                  (double)range[1]);
}

static void describe_plant(struct arena *arena, struct json *plant, struct plant_entry *entry,
                           const char *scene_path)
{
    entry->generator = json_text(plant, "generator", NULL);
    entry->options = json_text(plant, "options", NULL);
    entry->file = describe_path(arena, scene_path, json_text(plant, "file", NULL));
    entry->images = describe_path(arena, scene_path, json_text(plant, "images", NULL));
    bool lsystem = entry->generator && strcmp(entry->generator, "lsystem") == 0;
    if (lsystem && (!entry->file || entry->images))
        json_fail(plant, "file", "%s; allowed: a grammar's file beside the generator lsystem",
                  entry->images ? "images stand beside it" : "is missing");
    else if (!lsystem && !entry->generator + !entry->file + !entry->images != 2)
        json_fail(plant, "generator", "%s; allowed: either a generator, a file or images",
                  entry->file     ? "stands beside a file"
                  : entry->images ? "stands beside images"
                                  : "is missing, and so are a file and images");
    if (!entry->generator && entry->options)
        json_fail(plant, "options", "value is '%.64s'; allowed: with a generator only",
                  entry->options);
    describe_import(arena, plant, entry);
    describe_coloring(plant, entry);
    const char *fallback = entry->file        ? json_text(plant, "file", "")
                           : entry->generator ? entry->generator
                                              : json_text(plant, "images", "");
    entry->name = json_text(plant, "name", fallback);
    entry->weight = (float)json_number(plant, "weight", 1, 0, 1e6);
    describe_range(plant, "scale", 0.001, 1000, entry->scale);
    describe_range(plant, "stretch", STRETCH_MIN, STRETCH_MAX, entry->stretch);
    double reach_m = entry->import.height_m > 0 ? 1.5 * entry->import.height_m : 40;
    entry->reach_m = (float)json_number(plant, "reach_m", reach_m, 0.01, 10000);
}

void describe_plants(struct arena *arena, struct json *root, struct description *description)
{
    enum { PLANTS_MAX = 256 };
    size_t count = json_array(root, "plants");
    if (count < 1 || count > PLANTS_MAX) {
        json_fail(root, "plants", "has %zu elements; allowed: 1..%d", count, PLANTS_MAX);
        return;
    }
    description->plants_count = count;
    description->plants = ARENA_ARRAY(arena, struct plant_entry, count);
    double total = 0;
    for (size_t k = 0; k < count; k++) {
        struct json *plant = json_element(root, "plants", k);
        if (!plant)
            return;
        describe_plant(arena, plant, &description->plants[k], description->path);
        for (size_t i = 0; i < k; i++)
            if (strcmp(description->plants[i].name, description->plants[k].name) == 0)
                json_fail(plant, "name",
                          "value is '%.64s', the name of plants[%zu]; allowed: "
                          "one not yet taken",
                          description->plants[k].name, i);
        total += description->plants[k].weight;
    }
    if (!(total > 0))
        json_fail(root, "plants", "the sum of the weights is 0; allowed: above 0");
}

static void describe_square(struct json *object, struct placement *placement)
{
    placement->extent_m = json_number(object, "extent_m", 0, 0.1, 100000);
    placement->spacing_m = json_number(object, "spacing_m", 0, 0.01, 10000);
    if (!object || placement->kind == PLACEMENT_FILE)
        return;
    if ((placement->extent_m > 0) == (placement->spacing_m > 0))
        json_fail(object, "spacing_m", "%s; allowed: either spacing_m or extent_m",
                  placement->extent_m > 0 ? "stands beside extent_m"
                                          : "is missing, and so is extent_m");
}

/* Where trees may stand. */
static void describe_bounds(struct json *root, struct json *object, struct placement *placement)
{
    static const char *const keys[2] = {"slope_max_deg", "heights_m"};
    float heights_m[2] = {-HEIGHT_M_MAX, HEIGHT_M_MAX};
    placement->slope_max_deg = json_number(object, keys[0], 90, 0, 90);
    json_vector(object, keys[1], heights_m, 2, -HEIGHT_M_MAX, HEIGHT_M_MAX);
    for (int k = 0; k < 2; k++) {
        placement->heights_m[k] = (double)heights_m[k];
        if (!json_has(object, keys[k]))
            continue;
        placement->bounded = true;
        if (placement->kind == PLACEMENT_FILE)
            describe_refuse(object, keys[k], "grid|poisson");
        if (!json_has(root, "terrain"))
            json_fail(object, keys[k], "means nothing without a terrain; allowed: beside one");
    }
    if (heights_m[0] > heights_m[1])
        json_fail(object, keys[1], "value is [%g, %g]; allowed: the lower one first",
                  (double)heights_m[0], (double)heights_m[1]);
}

void describe_placement(struct arena *arena, struct json *root, struct description *description)
{
    struct placement *placement = &description->placement;
    struct json *object = json_object(root, "placement");
    if (!object) {
        json_fail(root, "placement", "is missing; allowed: an object with a kind");
        return;
    }
    placement->kind = (enum placement_kind)json_word(object, "kind", "grid|poisson|file", -1);
    describe_square(object, placement);
    placement->jitter = json_number(object, "jitter", 1, 0, 1);
    placement->min_distance_m = json_number(object, "min_distance_m", 0, 0.001, 10000);
    placement->clearing_m = json_number(object, "clearing_m", 0, 0, 10000);
    placement->rotate = json_bool(object, "rotate", true);
    placement->file = describe_path(arena, description->path, json_text(object, "file", NULL));
    if (placement->kind != PLACEMENT_GRID)
        describe_refuse(object, "jitter", "grid");
    if (placement->kind != PLACEMENT_POISSON)
        describe_refuse(object, "min_distance_m", "poisson");
    describe_bounds(root, object, placement);
    if (placement->kind == PLACEMENT_FILE) {
        describe_refuse(object, "spacing_m", "grid|poisson");
        describe_refuse(object, "clearing_m", "grid|poisson");
        if (!placement->file)
            json_fail(object, "file", "is missing; allowed: a file of positions");
    } else {
        describe_refuse(object, "file", "file");
    }
}
