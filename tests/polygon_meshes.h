/* Trees of leaf quads and boxes of bark, and how much of a picture one covers, for the tests of
 * method polygons. */
#ifndef TREELINE_TESTS_POLYGON_MESHES_H
#define TREELINE_TESTS_POLYGON_MESHES_H

#include "pictures.h"

#include "base/random.h"

enum { WIDTH = 64, HEIGHT = 48 };
#define EFFECTS (EFFECT_TWO_SIDED | EFFECT_AMBIENT | EFFECT_FOG)

/* A mesh with room; parts, materials and bounds as the caller wants them. */
static inline struct mesh *new_mesh(struct arena *arena, size_t triangles, size_t materials)
{
    struct mesh *mesh = ARENA_NEW(arena, struct mesh);
    mesh->positions = arena_alloc(arena, 3 * triangles, sizeof *mesh->positions);
    mesh->normals = arena_alloc(arena, 3 * triangles, sizeof *mesh->normals);
    mesh->colors = arena_alloc(arena, 3 * triangles, sizeof *mesh->colors);
    mesh->uvs = arena_alloc(arena, 3 * triangles, sizeof *mesh->uvs);
    mesh->triangles = arena_alloc(arena, triangles, sizeof *mesh->triangles);
    mesh->parts = ARENA_ARRAY(arena, struct mesh_part, materials);
    mesh->materials = ARENA_ARRAY(arena, struct material, materials);
    mesh->parts_count = mesh->materials_count = materials;
    return mesh;
}

/* A flat quad from an origin along two edges; two triangles, normal u x v. */
static inline void add_quad(struct mesh *mesh, const float origin[3], const float u[3],
                            const float v[3])
{
    static const float uvs[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    uint32_t first = (uint32_t)mesh->vertices_count;
    float n[3] = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
    float length = sqrtf(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    for (uint32_t i = 0; i < 4; i++)
        for (int axis = 0; axis < 3; axis++) {
            mesh->positions[first + i][axis] =
                origin[axis] + uvs[i][0] * u[axis] + uvs[i][1] * v[axis];
            mesh->normals[first + i][axis] = n[axis] / length;
            mesh->colors[first + i][axis] = 0.3f + 0.2f * (float)((first + i + axis * 2) % 4);
            if (axis < 2)
                mesh->uvs[first + i][axis] = uvs[i][axis];
        }
    mesh->vertices_count += 4;
    uint32_t corners[2][3] = {{first, first + 1, first + 2}, {first, first + 2, first + 3}};
    memcpy(mesh->triangles[mesh->triangles_count], corners, sizeof corners);
    mesh->triangles_count += 2;
}

/* Leaf quads at random in a ball about (0, height, 0), as the part at hand, which begins where the
 * mesh ends. */
static inline void add_leaves(struct arena *arena, struct mesh *mesh, size_t part, uint32_t leaves,
                              float radius_m, float height_m, float side_m)
{
    struct random random = random_seed(3, part);
    struct mesh_part *made = &mesh->parts[part];
    made->first_triangle = (uint32_t)mesh->triangles_count;
    made->triangles_count = 2 * leaves;
    made->material = (uint32_t)part;
    made->elements_count = leaves;
    made->element_first = ARENA_ARRAY(arena, uint32_t, leaves + 1);
    for (uint32_t i = 0; i <= leaves; i++)
        made->element_first[i] = made->first_triangle + 2 * i;
    for (uint32_t i = 0; i < leaves; i++) {
        float at[3], u[3], v[3], dot = 0, uu = 0, vv = 0;
        do
            for (int axis = 0; axis < 3; axis++)
                at[axis] = 2 * random_float(&random) - 1;
        while (at[0] * at[0] + at[1] * at[1] + at[2] * at[2] > 1);
        for (int axis = 0; axis < 3; axis++) {
            at[axis] = at[axis] * radius_m + (axis == 1 ? height_m : 0);
            u[axis] = 2 * random_float(&random) - 1;
            v[axis] = 2 * random_float(&random) - 1;
            dot += u[axis] * v[axis];
            uu += u[axis] * u[axis];
        }
        for (int axis = 0; axis < 3; axis++) {
            v[axis] -= dot / uu * u[axis];
            vv += v[axis] * v[axis];
        }
        for (int axis = 0; axis < 3; axis++) {
            u[axis] *= side_m / sqrtf(uu);
            v[axis] *= side_m / sqrtf(vv);
        }
        add_quad(mesh, at, u, v);
    }
    mesh->materials[part] =
        (struct material){"leaf", MATERIAL_LEAF, {0.5f, 0.9f, 0.4f}, NULL, false};
}

/* A box of bark about the axis, closed and smooth: normals point from the axis, corners are shared.
 */
static inline void add_trunk(struct mesh *mesh, size_t part, float half_m, float height_m)
{
    static const uint32_t faces[6][4] = {{0, 4, 5, 1}, {1, 5, 7, 3}, {3, 7, 6, 2},
                                         {2, 6, 4, 0}, {0, 1, 3, 2}, {4, 6, 7, 5}};
    uint32_t first = (uint32_t)mesh->vertices_count;
    mesh->parts[part] =
        (struct mesh_part){(uint32_t)mesh->triangles_count, 12, (uint32_t)part, NULL, 0};
    for (uint32_t i = 0; i < 8; i++) {
        float corner[3] = {i & 1 ? half_m : -half_m, i & 4 ? height_m : 0,
                           i & 2 ? half_m : -half_m};
        float normal[3] = {i & 1 ? 0.70710678f : -0.70710678f, 0,
                           i & 2 ? 0.70710678f : -0.70710678f};
        memcpy(mesh->positions[first + i], corner, sizeof corner);
        memcpy(mesh->normals[first + i], normal, sizeof normal);
        for (int axis = 0; axis < 3; axis++)
            mesh->colors[first + i][axis] = 0.5f + 0.05f * (float)i;
    }
    for (int f = 0; f < 6; f++) {
        uint32_t corners[2][3] = {{first + faces[f][0], first + faces[f][1], first + faces[f][2]},
                                  {first + faces[f][0], first + faces[f][2], first + faces[f][3]}};
        memcpy(mesh->triangles[mesh->triangles_count], corners, sizeof corners);
        mesh->triangles_count += 2;
    }
    mesh->vertices_count += 8;
    mesh->materials[part] =
        (struct material){"bark", MATERIAL_BARK, {0.6f, 0.5f, 0.4f}, NULL, false};
}

/* A trunk and leaves. */
static inline struct mesh *small_tree(struct arena *arena, uint32_t leaves)
{
    struct mesh *mesh = new_mesh(arena, 12 + 2 * leaves, 2);
    add_trunk(mesh, 0, 0.4f, 4);
    add_leaves(arena, mesh, 1, leaves, 2, 4, 0.5f);
    mesh_bounds(mesh);
    struct error error;
    if (mesh_check(mesh, &error) != STATUS_OK)
        fail_msg("%s", error.text);
    return mesh;
}

static inline struct mesh *leaf_ball(struct arena *arena, uint32_t leaves, float side_m)
{
    struct mesh *mesh = new_mesh(arena, 2 * leaves, 1);
    add_leaves(arena, mesh, 0, leaves, 3, 4, side_m);
    mesh_bounds(mesh);
    return mesh;
}

/* A 2 x 2 board of grey: the checks off the diagonal are transparent. 32 texels a check keep the
 * border thin. */
static inline struct texture *board(struct arena *arena)
{
    enum { SIDE = 64 };
    struct texture *texture = ARENA_NEW(arena, struct texture);
    *texture = (struct texture){SIDE, SIDE, ARENA_ARRAY(arena, float, SIDE *SIDE * 4)};
    for (int y = 0; y < SIDE; y++)
        for (int x = 0; x < SIDE; x++)
            for (int i = 0; i < 4; i++)
                texture->rgba[4 * (y * SIDE + x) + i] = i < 3                              ? 0.5f
                                                        : (x < SIDE / 2) == (y < SIDE / 2) ? 0.55f
                                                                                           : 0.45f;
    return texture;
}

/* Coverage of a lone tree in a square picture seen from afar. */
static inline double coverage_from(struct arena *arena, const struct mesh *mesh, float distance_m,
                                   enum lod lod, const char *options, struct picture *picture)
{
    struct scene *scene = scene_by_hand(arena, WIDTH, HEIGHT);
    scene->camera.far_m = 1e5f;
    scene_plant(arena, scene, mesh, 1);
    float eye[3] = {0, 4, distance_m}, target[3] = {0, 4, 0};
    struct view view;
    view_look_at(scene, eye, target, &view);
    struct setting setting = {.method = "polygons",
                              .options = options,
                              .effects = EFFECTS,
                              .lod = lod,
                              .format = TARGET_RGBA32F};
    *picture = picture_draw(arena, scene, &view, &setting);
    return picture_coverage(picture);
}

#endif
