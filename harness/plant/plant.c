/* Plants: names, parameters or a file, and a mesh that is built when first asked for. */
#include "plant/plant.h"

#include "base/clock.h"
#include "base/hash.h"
#include "plant/conifer.h"
#include "plant/generator.h"
#include "plant/images.h"
#include "plant/import.h"
#include "plant/lsystem.h"

#include <stdalign.h>
#include <string.h>

struct plant {
    struct arena *arena;
    char *name;
    const struct generator *generator; /* NULL: a file or a given mesh */
    alignas(max_align_t) unsigned char options[GENERATOR_OPTIONS_SIZE];
    struct import_request *import; /* NULL: not a file */
    const char *folder;            /* of pictures; NULL: not from pictures */
    struct coloring_request coloring;
    struct lsystem *lsystem;       /* NULL: not of a grammar */
    const struct conifer *conifer; /* NULL: not a conifer, or not grown yet */
    const struct mesh *mesh;       /* NULL: not built yet */
    bool hashed;
    uint64_t hash;
    struct plant_cost cost;
};

static const struct generator *const generators[] = {&poplar_generator, &oak_generator,
                                                     &hypertexture_generator};
enum { GENERATORS_COUNT = sizeof generators / sizeof *generators };

const char *const plant_generators[] = {"poplar", "oak", "hypertexture", NULL};

static const struct generator *find(const char *name)
{
    for (size_t i = 0; i < GENERATORS_COUNT; i++)
        if (strcmp(generators[i]->name, name) == 0)
            return generators[i];
    return NULL;
}

const struct option *plant_options(const char *generator)
{
    const struct generator *found = find(generator);
    return found ? found->options : NULL;
}

static struct plant *plant_new(struct arena *arena, const char *name)
{
    struct plant *plant = ARENA_NEW(arena, struct plant);
    plant->arena = arena;
    plant->name = arena_strdup(arena, name);
    return plant;
}

enum status plant_generated(struct arena *arena, const char *generator, const char *options,
                            struct plant **plant, struct error *error)
{
    const struct generator *found = find(generator);
    if (!found)
        return error_set(
            error, STATUS_NOT_FOUND,
            "no plant '%s'; plants that can be generated are poplar, oak, hypertexture", generator);
    struct plant *made = plant_new(arena, generator);
    made->generator = found;
    options_default(found->options, made->options);
    enum status status = options_parse(found->options, options, made->options, error);
    if (status != STATUS_OK)
        return error_context(error, "plant %s", generator);
    *plant = made;
    return STATUS_OK;
}

enum status plant_file(struct arena *arena, const char *path, const struct plant_import *import,
                       struct plant **plant, struct error *error)
{
    struct import_request *request;
    enum status status = import_request(arena, path, import, &request, error);
    if (status != STATUS_OK)
        return status;
    const char *slash = strrchr(path, '/');
    *plant = plant_new(arena, slash ? slash + 1 : path);
    (*plant)->import = request;
    return STATUS_OK;
}

struct plant *plant_images(struct arena *arena, const char *folder,
                           const struct coloring_request *request)
{
    const char *slash = strrchr(folder, '/');
    struct plant *plant = plant_new(arena, slash ? slash + 1 : folder);
    plant->folder = arena_strdup(arena, folder);
    plant->coloring = *request;
    return plant;
}

struct plant *plant_from_mesh(struct arena *arena, const char *name, const struct mesh *mesh)
{
    struct plant *plant = plant_new(arena, name);
    plant->mesh = mesh;
    plant->cost = (struct plant_cost){.built = true, .triangles_count = mesh->triangles_count};
    return plant;
}

struct plant *plant_from_conifer(struct arena *arena, const char *name,
                                 const struct conifer *conifer)
{
    struct plant *plant = plant_new(arena, name);
    plant->conifer = conifer;
    return plant;
}

enum status plant_lsystem(struct arena *arena, const char *path, const char *options,
                          struct plant **plant, struct error *error)
{
    struct lsystem *lsystem = NULL;
    enum status status = lsystem_load(arena, path, &lsystem, error);
    if (status != STATUS_OK)
        return status;
    status = lsystem_set(lsystem, options, error);
    if (status != STATUS_OK)
        return error_context(error, "plant %s", path);
    const char *slash = strrchr(path, '/');
    *plant = plant_new(arena, slash ? slash + 1 : path);
    (*plant)->lsystem = lsystem;
    return STATUS_OK;
}

enum status plant_conifer(struct plant *plant, const struct conifer **conifer, struct error *error)
{
    if (plant->lsystem && !plant->conifer) {
        struct conifer *grown = NULL;
        enum status status = lsystem_conifer(plant->arena, plant->lsystem, &grown, error);
        if (status != STATUS_OK)
            return status;
        plant->conifer = grown;
    }
    *conifer = plant->conifer;
    return STATUS_OK;
}

const char *plant_name(const struct plant *plant)
{
    return plant->name;
}

struct plant_cost plant_cost(const struct plant *plant)
{
    return plant->cost;
}

enum status plant_mesh(struct plant *plant, const struct mesh **mesh, struct error *error)
{
    if (!plant->mesh) {
        double start = clock_wall_seconds();
        size_t bytes = arena_used_bytes(plant->arena);
        struct mesh *built = NULL;
        enum status status;
        if (plant->generator) {
            status = plant->generator->build(plant->arena, plant->options, &built, error);
            if (status != STATUS_OK)
                return error_context(error, "plant %s", plant->name);
        } else if (plant->conifer || plant->lsystem) {
            const struct conifer *conifer = NULL;
            status = plant_conifer(plant, &conifer, error);
            if (status != STATUS_OK)
                return status;
            built = conifer_mesh(plant->arena, conifer);
        } else {
            status = plant->folder
                         ? images_mesh(plant->arena, plant->folder, &plant->coloring, &built, error)
                         : import_mesh(plant->arena, plant->import, &built, error);
            if (status != STATUS_OK)
                return status;
        }
        plant->mesh = built;
        plant->cost.built = true;
        plant->cost.build_seconds = clock_wall_seconds() - start;
        plant->cost.build_bytes = arena_used_bytes(plant->arena) - bytes;
        plant->cost.triangles_count = built->triangles_count;
    }
    *mesh = plant->mesh;
    return STATUS_OK;
}

static uint64_t hash_mesh(const struct mesh *mesh)
{
    size_t n = mesh->vertices_count;
    uint64_t hash = hash_bytes(hash_text(0, "mesh"), mesh->positions, n * sizeof(float[3]));
    hash = hash_bytes(hash, mesh->normals, n * sizeof(float[3]));
    hash = hash_bytes(hash, mesh->uvs, mesh->uvs ? n * sizeof(float[2]) : 0);
    hash = hash_bytes(hash, mesh->colors, mesh->colors ? n * sizeof(float[3]) : 0);
    hash = hash_bytes(hash, mesh->triangles, mesh->triangles_count * sizeof(uint32_t[3]));
    for (size_t i = 0; i < mesh->parts_count; i++) {
        const struct mesh_part *part = &mesh->parts[i];
        hash = hash_u64(hash_u64(hash, part->triangles_count), part->material);
        hash = hash_bytes(hash, part->element_first, part->elements_count * sizeof(uint32_t));
    }
    for (size_t i = 0; i < mesh->materials_count; i++) {
        const struct material *m = &mesh->materials[i];
        hash = hash_bytes(hash_u64(hash, m->kind), m->albedo, sizeof m->albedo);
        hash = m->solid ? hash_text(hash, "solid") : hash;
        const struct texture *t = m->texture;
        if (t) {
            hash = hash_u64(hash_u64(hash, (uint64_t)t->width_px), (uint64_t)t->height_px);
            hash = hash_bytes(hash, t->rgba,
                              (size_t)t->width_px * (size_t)t->height_px * sizeof(float[4]));
        }
    }
    return hash;
}

static uint64_t hash_conifer(const struct conifer *conifer)
{
    uint64_t hash = hash_text(0, "conifer 3");
    hash = hash_bytes(hash, conifer->branches, conifer->branches_count * sizeof *conifer->branches);
    hash = hash_bytes(hash, conifer->twigs, conifer->twigs_count * sizeof *conifer->twigs);
    hash = hash_bytes(hash, conifer->needle_albedo, sizeof conifer->needle_albedo);
    hash = hash_bytes(hash, conifer->bark_albedo, sizeof conifer->bark_albedo);
    hash = hash_double(hash_double(hash, conifer->needle_specular), conifer->needle_exponent);
    return hash_u64(hash_u64(hash, conifer->needle_sides), conifer->branch_sides);
}

static uint64_t hash_generated(const struct plant *plant)
{
    char text[64];
    uint64_t hash = hash_text(hash_text(0, "generated"), plant->generator->name);
    hash = hash_u64(hash, plant->generator->version);
    for (const struct option *o = plant->generator->options; o->name; o++) {
        option_value(o, plant->options, text, sizeof text);
        hash = hash_text(hash_text(hash, o->name), text);
    }
    return hash;
}

enum status plant_hash(struct plant *plant, uint64_t *hash, struct error *error)
{
    if (!plant->hashed) {
        if (plant->generator) {
            plant->hash = hash_generated(plant);
        } else if (plant->import) {
            enum status status = import_hash(plant->import, &plant->hash, error);
            if (status != STATUS_OK)
                return status;
        } else if (plant->folder) {
            enum status status = images_hash(plant->folder, &plant->coloring, &plant->hash, error);
            if (status != STATUS_OK)
                return status;
        } else if (plant->lsystem) {
            plant->hash = lsystem_hash(plant->lsystem);
        } else if (plant->conifer) {
            plant->hash = hash_conifer(plant->conifer);
        } else {
            plant->hash = hash_mesh(plant->mesh);
        }
        plant->hashed = true;
    }
    *hash = plant->hash;
    return STATUS_OK;
}
