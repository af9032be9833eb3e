/* A scene from its file: terrain, trees, plants, bounds, camera, hash. And the words of the levels
 * of detail. */
#include "base/file.h"
#include "base/hash.h"
#include "scene/camera.h"
#include "scene/place.h"
#include "scene/terrain.h"

#include <dirent.h>
#include <stdlib.h>
#include <string.h>

static const char *const lod_words[] = {"low", "intermediate", "high", "auto"};
enum { LODS_COUNT = sizeof lod_words / sizeof lod_words[0] };

const char *lod_word(enum lod lod)
{
    return (unsigned)lod < LODS_COUNT ? lod_words[lod] : "unknown";
}

bool lod_from_word(const char *word, enum lod *lod)
{
    for (int k = 0; k < LODS_COUNT; k++)
        if (word && strcmp(word, lod_words[k]) == 0) {
            *lod = (enum lod)k;
            return true;
        }
    return false;
}

/* The request over the description. */
static enum status request_apply(struct description *description,
                                 const struct scene_request *request, size_t *trees_count,
                                 struct error *error)
{
    *trees_count = request->trees == SIZE_MAX ? description->default_trees : request->trees;
    if (*trees_count > TREES_MAX)
        return error_set(error, STATUS_INVALID, "%s: trees: value is %zu; allowed: 0..%d",
                         description->path, *trees_count, TREES_MAX);
    const int given[2] = {request->width_px, request->height_px};
    int *size[2] = {&description->width_px, &description->height_px};
    for (int a = 0; a < 2; a++) {
        if (given[a] < 0 || given[a] > SIDE_PX_MAX)
            return error_set(error, STATUS_INVALID, "%s: size: value is %d; allowed: 1..%d px",
                             description->path, given[a], SIDE_PX_MAX);
        if (given[a] > 0)
            *size[a] = given[a];
    }
    return STATUS_OK;
}

static enum status plant_make(struct arena *arena, const struct plant_entry *entry,
                              struct plant **plant, struct error *error)
{
    if (entry->file && entry->generator)
        return plant_lsystem(arena, entry->file, entry->options, plant, error);
    if (entry->file)
        return plant_file(arena, entry->file, &entry->import, plant, error);
    if (entry->generator)
        return plant_generated(arena, entry->generator, entry->options, plant, error);
    *plant = plant_images(arena, entry->images, &entry->coloring);
    return STATUS_OK;
}

/* Every plant is made, so that a wrong one is told; those without a tree are left out. */
static enum status species_build(struct arena *arena, const struct description *description,
                                 struct scene *scene, struct error *error)
{
    size_t plants_count = description->plants_count;
    size_t *used = ARENA_ARRAY(arena, size_t, plants_count);
    uint32_t *species_of = ARENA_ARRAY(arena, uint32_t, plants_count);
    for (size_t k = 0; k < scene->instances_count; k++)
        used[scene->instances[k].species]++;
    scene->species = ARENA_ARRAY(arena, struct species, plants_count);
    for (size_t k = 0; k < plants_count; k++) {
        const struct plant_entry *entry = &description->plants[k];
        struct plant *plant = NULL;
        enum status status = plant_make(arena, entry, &plant, error);
        if (status != STATUS_OK)
            return error_context(error, "%s: plants[%zu]", description->path, k);
        if (used[k] == 0)
            continue;
        species_of[k] = (uint32_t)scene->species_count;
        scene->species[scene->species_count++] =
            (struct species){entry->name, plant, entry->weight, entry->scale[0], entry->scale[1]};
    }
    for (size_t k = 0; k < scene->instances_count; k++)
        scene->instances[k].species = species_of[scene->instances[k].species];
    return STATUS_OK;
}

static enum status forest_build(struct arena *arena, const struct description *description,
                                size_t trees_count, uint64_t seed, struct scene *scene,
                                struct error *error)
{
    double half_m = 0;
    enum status status =
        place_trees(arena, description, trees_count, seed, &scene->instances, &half_m, error);
    if (status != STATUS_OK)
        return status;
    scene->instances_count = trees_count;
    scene->forest_half_m = (float)half_m;
    const struct ground *ground = &description->ground;
    for (int a = 0; a < 2 && ground->given; a++)
        if (2 * half_m > ground->size_m[a])
            return error_set(error, STATUS_INVALID,
                             "%s: terrain.size_m[%d]: value is %g m, but %zu trees stand on a "
                             "square of %g m; allowed: at least that",
                             description->path, a, ground->size_m[a], trees_count, 2 * half_m);
    for (size_t k = 0; k < trees_count; k++) {
        float *position_m = scene->instances[k].position_m;
        position_m[1] = terrain_height(&scene->terrain, position_m[0], position_m[2]);
        const struct instance *tree = &scene->instances[k];
        float reach_m = instance_reach(tree) * description->plants[tree->species].reach_m;
        scene->tree_reach_m = fmaxf(scene->tree_reach_m, reach_m);
    }
    return species_build(arena, description, scene, error);
}

static void bounds_add(struct scene *scene, const float point_m[3])
{
    for (int i = 0; i < 3; i++) {
        scene->minimum_m[i] = fminf(scene->minimum_m[i], point_m[i]);
        scene->maximum_m[i] = fmaxf(scene->maximum_m[i], point_m[i]);
    }
}

static void bounds_build(struct scene *scene)
{
    const struct terrain *terrain = &scene->terrain;
    size_t samples = (size_t)terrain->samples_x * terrain->samples_z;
    if (samples == 0 && scene->instances_count == 0)
        return;
    for (int i = 0; i < 3; i++) {
        scene->minimum_m[i] = INFINITY;
        scene->maximum_m[i] = -INFINITY;
    }
    for (size_t k = 0; k < samples; k++) {
        bounds_add(scene, (float[3]){-0.5f * terrain->size_x_m, terrain->heights_m[k],
                                     -0.5f * terrain->size_z_m});
        bounds_add(scene, (float[3]){0.5f * terrain->size_x_m, terrain->heights_m[k],
                                     0.5f * terrain->size_z_m});
    }
    for (size_t k = 0; k < scene->instances_count; k++)
        bounds_add(scene, scene->instances[k].position_m);
}

static uint64_t hash_floats(uint64_t hash, const float *values, size_t count)
{
    for (size_t k = 0; k < count; k++)
        hash = hash_double(hash, values[k]);
    return hash;
}

static uint64_t hash_light(uint64_t hash, const struct scene *scene)
{
    const struct sun *sun = &scene->sun;
    hash = hash_double(hash, sun->azimuth_rad);
    hash = hash_double(hash, sun->elevation_rad);
    hash = hash_double(hash, sun->end_azimuth_rad);
    hash = hash_double(hash, sun->end_elevation_rad);
    hash = hash_floats(hash, sun->radiance, 3);
    hash = hash_floats(hash, scene->ambient, 3);
    hash = hash_floats(hash, scene->sky.zenith, 3);
    hash = hash_floats(hash, scene->sky.horizon, 3);
    hash = hash_floats(hash, scene->sky.ground, 3);
    hash = hash_double(hash, scene->fog.density_per_m);
    return scene->fog.density_per_m > 0 ? hash_floats(hash, scene->fog.color, 3) : hash;
}

bool scene_is_stretched(const struct scene *scene)
{
    for (size_t k = 0; k < scene->instances_count; k++)
        if (scene->instances[k].stretch != 1)
            return true;
    return false;
}

/* The trees as they were before one could be stretched, so that a forest in which none is keeps its
 * hash and what was traced of it; then the stretches, where there are any. */
static uint64_t hash_trees(uint64_t hash, const struct scene *scene)
{
    enum { BEFORE = offsetof(struct instance, stretch) };
    struct arena *scratch = arena_create(0);
    char(*trees)[BEFORE] = arena_alloc(scratch, scene->instances_count, sizeof *trees);
    float *stretches = ARENA_ARRAY(scratch, float, scene->instances_count);
    for (size_t k = 0; k < scene->instances_count; k++) {
        memcpy(trees[k], &scene->instances[k], BEFORE);
        stretches[k] = scene->instances[k].stretch;
    }
    hash = hash_bytes(hash, trees, scene->instances_count * sizeof *trees);
    if (scene_is_stretched(scene))
        hash = hash_bytes(hash, stretches, scene->instances_count * sizeof *stretches);
    arena_destroy(scratch);
    return hash;
}

/* From what the pictures are made of, not from the file's text: names, docs and views do not count.
 */
static enum status hash_build(struct scene *scene, struct error *error)
{
    uint64_t hash = hash_text(0, "scene 1");
    const struct terrain *terrain = &scene->terrain;
    size_t samples = (size_t)terrain->samples_x * terrain->samples_z;
    hash = hash_u64(hash, terrain->samples_x);
    hash = hash_u64(hash, terrain->samples_z);
    hash = hash_double(hash, terrain->size_x_m);
    hash = hash_double(hash, terrain->size_z_m);
    hash = hash_floats(hash, terrain->albedo, 3);
    hash = hash_bytes(hash, terrain->heights_m, samples * sizeof(float));
    if (terrain->colors)
        hash = hash_bytes(hash, terrain->colors, samples * sizeof *terrain->colors);
    hash = hash_u64(hash, scene->species_count);
    for (size_t k = 0; k < scene->species_count; k++) {
        uint64_t plant = 0;
        enum status status = plant_hash(scene->species[k].plant, &plant, error);
        if (status != STATUS_OK)
            return error_context(error, "%s: plant %s", scene->path, scene->species[k].name);
        hash = hash_u64(hash, plant);
    }
    scene->hash = hash_light(hash_trees(hash, scene), scene);
    return STATUS_OK;
}

enum status scene_load(struct arena *arena, const char *name, const struct scene_request *request,
                       struct scene **scene, struct error *error)
{
    struct description description;
    size_t trees_count = 0;
    enum status status = description_load(arena, name, &description, error);
    if (status == STATUS_OK)
        status = request_apply(&description, request, &trees_count, error);
    if (status != STATUS_OK)
        return status;
    struct scene *made = ARENA_NEW(arena, struct scene);
    made->name = description.name;
    made->path = description.path;
    made->width_px = description.width_px;
    made->height_px = description.height_px;
    made->effects = description.effects;
    made->sun = description.sun;
    made->sky = description.sky;
    made->fog = description.fog;
    memcpy(made->origin_m, description.origin_m, sizeof made->origin_m);
    memcpy(made->ambient, description.ambient, sizeof made->ambient);
    status = terrain_build(arena, &description, &made->terrain, error);
    description.placement.terrain = &made->terrain;
    if (status == STATUS_OK)
        status = forest_build(arena, &description, trees_count, request->seed, made, error);
    if (status == STATUS_OK)
        status = hash_build(made, error);
    if (status != STATUS_OK)
        return status;
    bounds_build(made);
    camera_build(arena, &description, made);
    *scene = made;
    return STATUS_OK;
}

enum status scene_summary(struct arena *arena, const char *name, struct scene_summary *summary,
                          struct error *error)
{
    struct description description;
    enum status status = description_load(arena, name, &description, error);
    if (status != STATUS_OK)
        return status;
    *summary = (struct scene_summary){.name = description.name,
                                      .doc = description.doc,
                                      .width_px = description.width_px,
                                      .height_px = description.height_px,
                                      .default_trees = description.default_trees,
                                      .trees = description.trees,
                                      .trees_count = description.trees_count,
                                      .effects = description.effects,
                                      .frames_count = description.camera.frames_count};
    return STATUS_OK;
}

static int is_scene(const struct dirent *entry)
{
    size_t length = strlen(entry->d_name);
    return entry->d_name[0] != '.' && length > 5 &&
           strcmp(entry->d_name + length - 5, ".json") == 0;
}

/* Of the names without ".json": "pines" stands before "pines-walk". */
static int by_name(const struct dirent **a, const struct dirent **b)
{
    size_t lengths[2] = {strlen((*a)->d_name) - 5, strlen((*b)->d_name) - 5};
    size_t both = lengths[0] < lengths[1] ? lengths[0] : lengths[1];
    int order = memcmp((*a)->d_name, (*b)->d_name, both);
    return order ? order : (lengths[0] > lengths[1]) - (lengths[0] < lengths[1]);
}

enum status scene_names(struct arena *arena, char ***names, size_t *count, struct error *error)
{
    const char *folder = arena_printf(arena, "%s/scenes", data_folder());
    struct dirent **entries = NULL;
    int found = scandir(folder, &entries, is_scene, by_name);
    if (found < 0)
        return error_errno(error, STATUS_NOT_FOUND, "%s", folder);
    *count = (size_t)found;
    *names = ARENA_ARRAY(arena, char *, *count);
    for (size_t k = 0; k < *count; k++) {
        (*names)[k] = path_stem(arena, entries[k]->d_name);
        free(entries[k]);
    }
    free(entries);
    return STATUS_OK;
}
