/* The world of the conformance checks: its plant, its forest, its light. */
#include "conform/world.h"

#include "base/file.h"
#include "base/hash.h"
#include "base/random.h"
#include "conform/world_conifer.h"
#include "scene/camera.h"

#include <math.h>
#include <string.h>

enum { SIDES = 8, RINGS = 4, LEAVES = 1200, TRUNK_TRIANGLES = 2 * SIDES * RINGS + 2 * (SIDES - 2) };
static const float ROOT_M = -0.3f, TRUNK_M = 9, TRUNK_RADIUS_M = 0.5f, LEAF_M = 0.8f;
static const float CROWN_M[3] = {4, 7, 4}, CROWN_MIDDLE_M = 12.6f;
static const float ALBEDOS[2][3] = {{0.25f, 0.18f, 0.12f}, {0.2f, 0.42f, 0.1f}};

static uint32_t vertex_add(struct mesh *mesh, const float position[3], const float normal[3])
{
    size_t at = mesh->vertices_count++;
    memcpy(mesh->positions[at], position, sizeof *mesh->positions);
    memcpy(mesh->normals[at], normal, sizeof *mesh->normals);
    return (uint32_t)at;
}

static void triangle_add(struct mesh *mesh, uint32_t a, uint32_t b, uint32_t c)
{
    memcpy(mesh->triangles[mesh->triangles_count++], (uint32_t[3]){a, b, c}, sizeof(uint32_t[3]));
}

/* A closed cylinder that begins in the ground, so that an eye within it stands in the trunk. */
static void trunk_add(struct mesh *mesh)
{
    for (int ring = 0; ring <= RINGS; ring++)
        for (int side = 0; side < SIDES; side++) {
            float angle = 6.2831853f * (float)side / SIDES, x = sinf(angle), z = cosf(angle);
            float y = ROOT_M + (TRUNK_M - ROOT_M) * (float)ring / RINGS;
            vertex_add(mesh, (float[3]){TRUNK_RADIUS_M * x, y, TRUNK_RADIUS_M * z},
                       (float[3]){x, 0, z});
        }
    for (uint32_t ring = 0; ring < RINGS; ring++)
        for (uint32_t side = 0; side < SIDES; side++) {
            uint32_t a = ring * SIDES + side, b = ring * SIDES + (side + 1) % SIDES;
            triangle_add(mesh, a, b, b + SIDES);
            triangle_add(mesh, a, b + SIDES, a + SIDES);
        }
    for (uint32_t side = 1; side + 1 < SIDES; side++) {
        const uint32_t top = RINGS * SIDES;
        triangle_add(mesh, 0, side + 1, side);
        triangle_add(mesh, top, top + side, top + side + 1);
    }
}

static void unit_random(struct random *random, float v[3])
{
    float length2 = 0;
    while (!(length2 > 0.01f && length2 <= 1)) {
        length2 = 0;
        for (int i = 0; i < 3; i++) {
            v[i] = 2 * random_float(random) - 1;
            length2 += v[i] * v[i];
        }
    }
    for (int i = 0; i < 3; i++)
        v[i] /= sqrtf(length2);
}

/* A square leaf, turned anyhow, somewhere in the crown. */
static void leaf_add(struct mesh *mesh, struct random *random)
{
    float normal[3], along[3], across[3], middle[3], radius = cbrtf(random_float(random));
    unit_random(random, middle);
    for (int i = 0; i < 3; i++)
        middle[i] *= radius * CROWN_M[i];
    middle[1] += CROWN_MIDDLE_M;
    unit_random(random, normal);
    glm_vec3_ortho(normal, along);
    glm_vec3_normalize(along);
    glm_vec3_cross(normal, along, across);
    uint32_t corners[4];
    for (int corner = 0; corner < 4; corner++) {
        float s = LEAF_M * (corner == 1 || corner == 2 ? 0.5f : -0.5f);
        float t = LEAF_M * (corner >= 2 ? 0.5f : -0.5f), position[3];
        for (int i = 0; i < 3; i++)
            position[i] = middle[i] + s * along[i] + t * across[i];
        corners[corner] = vertex_add(mesh, position, normal);
    }
    triangle_add(mesh, corners[0], corners[1], corners[2]);
    triangle_add(mesh, corners[0], corners[2], corners[3]);
}

/* A trunk, 1 m thick, and leaves of 0.8 m in an egg. */
static const struct mesh *world_mesh(struct arena *arena)
{
    static const char *const names[2] = {"bark", "leaf"};
    struct mesh *mesh = ARENA_NEW(arena, struct mesh);
    size_t vertices = SIDES * (RINGS + 1) + 4 * LEAVES;
    mesh->positions = arena_alloc(arena, vertices, sizeof *mesh->positions);
    mesh->normals = arena_alloc(arena, vertices, sizeof *mesh->normals);
    mesh->triangles = arena_alloc(arena, TRUNK_TRIANGLES + 2 * LEAVES, sizeof *mesh->triangles);
    trunk_add(mesh);
    struct random random = random_seed(1, 1);
    for (int leaf = 0; leaf < LEAVES; leaf++)
        leaf_add(mesh, &random);
    mesh->materials_count = mesh->parts_count = 2;
    mesh->materials = ARENA_ARRAY(arena, struct material, 2);
    mesh->parts = ARENA_ARRAY(arena, struct mesh_part, 2);
    for (uint32_t k = 0; k < 2; k++) {
        mesh->materials[k].name = arena_strdup(arena, names[k]);
        mesh->materials[k].kind = k ? MATERIAL_LEAF : MATERIAL_BARK;
        memcpy(mesh->materials[k].albedo, ALBEDOS[k], sizeof ALBEDOS[k]);
        mesh->parts[k].material = k;
    }
    struct mesh_part *bark = &mesh->parts[0], *leaf = &mesh->parts[1];
    bark->triangles_count = leaf->first_triangle = TRUNK_TRIANGLES;
    leaf->triangles_count = 2 * LEAVES;
    leaf->elements_count = LEAVES;
    leaf->element_first = ARENA_ARRAY(arena, uint32_t, LEAVES + 1);
    for (uint32_t i = 0; i <= LEAVES; i++)
        leaf->element_first[i] = TRUNK_TRIANGLES + 2 * i;
    mesh_bounds(mesh);
    return mesh;
}

static enum status scene_write(struct arena *arena, const char *folder, double offset_m,
                               const char **path, struct error *error)
{
    const char *scene = arena_printf(
        arena,
        "{\"plants\": [{\"file\": \"tree.obj\", \"reach_m\": 25, \"import\": {\"height_m\": 20, "
        "\"z_up\": true, \"leaf_albedo\": [0.2, 0.42, 0.1], \"bark_albedo\": [0.25, 0.18, 0.12]}}],"
        "\"placement\": {\"kind\": \"file\", \"file\": \"tree-%.0f.txt\"},"
        "\"trees\": {\"default\": 1}, \"effects\": [\"two-sided\", \"ambient\"],"
        "\"camera\": {\"kind\": \"still\", \"keys\": [{\"eye\": [%.3f, 12.1, %.3f], "
        "\"target\": [%.3f, 10, %.3f]}]}}",
        offset_m, offset_m + 9.013, -offset_m + 34.507, offset_m + 0.101, -offset_m);
    const char *tree = arena_printf(arena, "%.3f %.3f 30 1\n", offset_m + 0.203, -offset_m + 0.307);
    const char *list = arena_printf(arena, "%s/tree-%.0f.txt", folder, offset_m);
    *path = arena_printf(arena, "%s/tree-%.0f.json", folder, offset_m);
    enum status status = file_write(list, tree, strlen(tree), error);
    return status ? status : file_write(*path, scene, strlen(scene), error);
}

enum status world_write(struct arena *arena, const char *folder, double offset_m, const char **path,
                        struct error *error)
{
    enum { LINE = 64 };
    static const float unit = 39.37f; /* inches */
    const struct mesh *mesh = world_mesh(arena);
    size_t room = LINE * (mesh->vertices_count + mesh->triangles_count + 4), size = 0;
    char *text = arena_alloc(arena, room, 1);
    for (size_t v = 0; v < mesh->vertices_count; v++)
        size += (size_t)snprintf(
            text + size, room - size, "v %.5g %.5g %.5g\n", (double)(unit * mesh->positions[v][0]),
            (double)(unit * -mesh->positions[v][2]), (double)(unit * mesh->positions[v][1]));
    for (size_t p = 0; p < mesh->parts_count; p++) {
        const struct mesh_part *part = &mesh->parts[p];
        size += (size_t)snprintf(text + size, room - size, "usemtl %s\n",
                                 mesh->materials[part->material].name);
        for (uint32_t t = 0; t < part->triangles_count; t++) {
            const uint32_t *corner = mesh->triangles[part->first_triangle + t];
            size += (size_t)snprintf(text + size, room - size, "f %u %u %u\n", corner[0] + 1,
                                     corner[1] + 1, corner[2] + 1);
        }
    }
    enum status status = file_write(arena_printf(arena, "%s/tree.obj", folder), text, size, error);
    return status ? status : scene_write(arena, folder, offset_m, path, error);
}

static void forest_make(struct arena *arena, struct scene *scene, const struct world *world,
                        float scale)
{
    size_t trees = world->trees, side = (size_t)ceil(sqrt((double)trees));
    double spacing_m = world->spacing_m > 0 ? world->spacing_m : 12;
    struct random random = random_seed(2, 1);
    scene->instances_count = trees;
    scene->instances = ARENA_ARRAY(arena, struct instance, trees);
    for (size_t k = 0; k < trees; k++) {
        struct instance *tree = &scene->instances[k];
        double middle = 0.5 * ((double)side - 1);
        tree->position_m[0] = scale * (float)(spacing_m * ((double)(k % side) - middle));
        tree->position_m[2] = scale * (float)(spacing_m * ((double)(k / side) - middle));
        tree->rotation_rad = 6.2831853f * random_float(&random);
        tree->scale = scale * (0.9f + 0.2f * random_float(&random));
        tree->stretch = world->stretch > 0 ? (float)world->stretch : 1;
    }
    scene->forest_half_m = scale * (float)(0.5 * spacing_m * (double)side);
    scene->tree_reach_m = scale * 25 * fmaxf(1, (float)world->stretch);
}

/* Flat, wide enough for the forest. */
static void ground_make(struct arena *arena, struct scene *scene, float scale)
{
    struct terrain *terrain = &scene->terrain;
    float half_m = scene->forest_half_m + 200 * scale;
    terrain->samples_x = terrain->samples_z = 2;
    terrain->size_x_m = terrain->size_z_m = 2 * half_m;
    terrain->heights_m = ARENA_ARRAY(arena, float, 4);
    terrain->normals = arena_alloc(arena, 4, sizeof *terrain->normals);
    for (int i = 0; i < 4; i++)
        terrain->normals[i][1] = 1;
    memcpy(terrain->albedo, (float[3]){0.06f, 0.08f, 0.03f}, sizeof terrain->albedo);
    for (int i = 0; i < 3; i += 2) {
        scene->minimum_m[i] = -half_m;
        scene->maximum_m[i] = half_m;
    }
}

enum status world_make(struct arena *arena, const struct world *world, struct scene **result,
                       struct error *error)
{
    int width_px = world->width_px ? world->width_px : 64;
    int height_px = world->height_px ? world->height_px : 48;
    struct scene_request request = {SIZE_MAX, 1, width_px, height_px};
    if (world->file)
        return scene_load(arena, world->file, &request, result, error);
    float scale = world->scale > 0 ? (float)world->scale : 1;
    struct scene *scene = *result = ARENA_NEW(arena, struct scene);
    *scene = (struct scene){
        .name = "conformance",
        .path = "conformance",
        .width_px = width_px,
        .height_px = height_px,
        .effects = EFFECTS_ALL,
        .species_count = world->trees > 0,
        .sun = {0.7f, 0.8f, 0.7f, 0.8f, {3.2f, 3.05f, 2.7f}},
        .ambient = {0.55f, 0.68f, 0.9f},
        .sky = {{0.16f, 0.32f, 0.7f}, {0.62f, 0.74f, 0.88f}, {0.17f, 0.23f, 0.09f}},
        .fog = {{0.25f, 0.3f, 0.5f}, 0.015f / scale},
    };
    struct plant *plant =
        world->conifers ? world_conifer(arena) : plant_from_mesh(arena, "tree", world_mesh(arena));
    scene->species = ARENA_NEW(arena, struct species);
    *scene->species = (struct species){"tree", plant, 1, 0.9f * scale, 1.1f * scale};
    forest_make(arena, scene, world, scale);
    ground_make(arena, scene, scale);
    scene->camera = (struct camera_path){.kind = PATH_STILL,
                                         .keys_count = 1,
                                         .keys = ARENA_NEW(arena, struct camera_key),
                                         .fov_y_rad = 0.7f,
                                         .frames_count = 1};
    struct camera_key *key = scene->camera.keys;
    memcpy(key->eye_m, (float[3]){9 * scale, 14 * scale, 34 * scale}, sizeof key->eye_m);
    memcpy(key->target_m, (float[3]){0, 10 * scale, 0}, sizeof key->target_m);
    camera_depths(scene, &key->eye_m, 1, &scene->camera.near_m, &scene->camera.far_m);
    scene->hash = hash_double(hash_double(hash_u64(1, world->trees), scale), world->spacing_m);
    scene->hash = hash_u64(scene->hash, world->conifers);
    return STATUS_OK;
}

void world_view(const struct scene *scene, const struct world *world, const double eye_m[3],
                const double target_m[3], struct view *view)
{
    double scale = world->scale > 0 ? world->scale : 1;
    float eye[3], target[3];
    for (int i = 0; i < 3; i++) {
        eye[i] = (float)(scale * eye_m[i]);
        target[i] = (float)(scale * target_m[i]);
    }
    view_look_at(scene, eye, target, view);
}

void world_view_near(const struct scene *scene, const struct world *world, struct view *view)
{
    world_view(scene, world, (double[3]){9, 14, 34}, (double[3]){0, 10, 0}, view);
}
