/* Plants whose slices are known in closed form. */
#ifndef TREELINE_TESTS_SLICES_MESHES_H
#define TREELINE_TESTS_SLICES_MESHES_H

#include "testing_tree.h"

/* An empty mesh with room for triangles of one material. */
static inline struct mesh *shape_new(struct arena *arena, size_t triangles, enum material_kind kind)
{
    struct mesh *mesh = ARENA_NEW(arena, struct mesh);
    mesh->positions = arena_alloc(arena, 3 * triangles, sizeof *mesh->positions);
    mesh->normals = arena_alloc(arena, 3 * triangles, sizeof *mesh->normals);
    mesh->colors = arena_alloc(arena, 3 * triangles, sizeof *mesh->colors);
    mesh->uvs = arena_alloc(arena, 3 * triangles, sizeof *mesh->uvs);
    mesh->triangles = arena_alloc(arena, triangles, sizeof *mesh->triangles);
    mesh->materials_count = mesh->parts_count = 1;
    mesh->materials = ARENA_NEW(arena, struct material);
    mesh->materials[0] =
        (struct material){arena_strdup(arena, "one"), kind, {0.5f, 0.5f, 0.5f}, NULL, false};
    mesh->parts = ARENA_NEW(arena, struct mesh_part);
    return mesh;
}

static inline void shape_quad(struct mesh *mesh, const float corners[4][3])
{
    static const float white[3] = {1, 1, 1},
                       uvs[6][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 0}, {1, 1}, {0, 1}};
    float halves[2][3][3];
    memcpy(mesh->uvs + mesh->vertices_count, uvs, sizeof uvs);
    for (int k = 0; k < 3; k++) {
        memcpy(halves[0][k], corners[k], sizeof halves[0][k]);
        memcpy(halves[1][k], corners[k == 0 ? 0 : k + 1], sizeof halves[1][k]);
    }
    tree_triangle(mesh, (const float(*)[3])halves[0], white);
    tree_triangle(mesh, (const float(*)[3])halves[1], white);
}

/* All triangles are one part and, of leaves, `each` triangles one leaf. */
static inline struct plant *shape_plant(struct arena *arena, struct mesh *mesh, uint32_t each)
{
    struct mesh_part *part = &mesh->parts[0];
    part->triangles_count = (uint32_t)mesh->triangles_count;
    if (mesh->materials[0].kind == MATERIAL_LEAF) {
        part->elements_count = part->triangles_count / each;
        part->element_first = ARENA_ARRAY(arena, uint32_t, part->elements_count + 1);
        for (uint32_t i = 0; i <= part->elements_count; i++)
            part->element_first[i] = i * each;
    }
    struct error error;
    mesh_bounds(mesh);
    if (mesh_check(mesh, &error) != STATUS_OK)
        fail_msg("%s", error.text);
    return plant_from_mesh(arena, "shape", mesh);
}

/* A square leaf of side 1 about (0, 1, 0) whose normal is turned from +z toward +x. */
static inline struct plant *shape_square(struct arena *arena, float turn_rad)
{
    struct mesh *mesh = shape_new(arena, 2, MATERIAL_LEAF);
    float c = 0.5f * cosf(turn_rad), s = 0.5f * sinf(turn_rad);
    const float corners[4][3] = {{-c, 0.5f, s}, {c, 0.5f, -s}, {c, 1.5f, -s}, {-c, 1.5f, s}};
    shape_quad(mesh, corners);
    return shape_plant(arena, mesh, 2);
}

/* A closed box [0, 2] x [0, 3] x [0, 1], sheared: z grows by so much a metre along x. */
static inline struct plant *shape_sheared_box(struct arena *arena, enum material_kind kind,
                                              float shear)
{
    static const float corners[6][4][3] = {
        {{0, 0, 1}, {2, 0, 1}, {2, 3, 1}, {0, 3, 1}}, {{2, 0, 0}, {0, 0, 0}, {0, 3, 0}, {2, 3, 0}},
        {{2, 0, 1}, {2, 0, 0}, {2, 3, 0}, {2, 3, 1}}, {{0, 0, 0}, {0, 0, 1}, {0, 3, 1}, {0, 3, 0}},
        {{0, 3, 1}, {2, 3, 1}, {2, 3, 0}, {0, 3, 0}}, {{0, 0, 0}, {2, 0, 0}, {2, 0, 1}, {0, 0, 1}}};
    struct mesh *mesh = shape_new(arena, 12, kind);
    for (int i = 0; i < 6; i++) {
        float sheared[4][3];
        memcpy(sheared, corners[i], sizeof sheared);
        for (int k = 0; k < 4; k++)
            sheared[k][2] += shear * sheared[k][0];
        shape_quad(mesh, (const float(*)[3])sheared);
    }
    return shape_plant(arena, mesh, 2);
}

static inline struct plant *shape_box(struct arena *arena, enum material_kind kind)
{
    return shape_sheared_box(arena, kind, 0);
}

/* A closed ball of radius 1 about the origin, of 96 x 48 quads. */
static inline struct plant *shape_ball(struct arena *arena)
{
    enum { AROUND = 96, DOWN = 48 };
    struct mesh *mesh = shape_new(arena, 2 * AROUND * DOWN, MATERIAL_BARK);
    for (int j = 0; j < DOWN; j++)
        for (int i = 0; i < AROUND; i++) {
            float corners[4][3], white[3] = {1, 1, 1};
            for (int k = 0; k < 4; k++) {
                int around = (i + (k == 1 || k == 2)) % AROUND, down = j + (k < 2);
                double a = 2 * M_PI * around / AROUND, b = M_PI * down / DOWN;
                double r = down == 0 || down == DOWN ? 0 : sin(b);
                corners[k][0] = (float)(r * sin(a));
                corners[k][1] = (float)(down == DOWN ? -1 : cos(b));
                corners[k][2] = (float)(r * cos(a));
            }
            float halves[2][3][3];
            for (int k = 0; k < 3; k++) {
                memcpy(halves[0][k], corners[k], sizeof halves[0][k]);
                memcpy(halves[1][k], corners[k == 0 ? 0 : k + 1], sizeof halves[1][k]);
            }
            if (j < DOWN - 1)
                tree_triangle(mesh, (const float(*)[3])halves[0], white);
            if (j > 0)
                tree_triangle(mesh, (const float(*)[3])halves[1], white);
        }
    for (size_t i = 0; i < mesh->vertices_count; i++)
        memcpy(mesh->normals[i], mesh->positions[i], sizeof mesh->normals[i]);
    return shape_plant(arena, mesh, 2);
}

#endif
