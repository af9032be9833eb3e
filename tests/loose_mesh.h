/* Meshes of one part and one material that are put together triangle by triangle. */
#ifndef TREELINE_TESTS_LOOSE_MESH_H
#define TREELINE_TESTS_LOOSE_MESH_H

#include "testing.h"

#include "base/arena.h"
#include "plant/plant.h"

#include <math.h>

/* A mesh of one part that can hold so many triangles. */
static inline struct mesh *mesh_new(struct arena *arena, enum material_kind kind, float albedo,
                                    size_t capacity)
{
    struct mesh *mesh = ARENA_NEW(arena, struct mesh);
    mesh->positions = arena_alloc(arena, 3 * capacity, sizeof *mesh->positions);
    mesh->normals = arena_alloc(arena, 3 * capacity, sizeof *mesh->normals);
    mesh->triangles = arena_alloc(arena, capacity, sizeof *mesh->triangles);
    mesh->parts_count = mesh->materials_count = 1;
    mesh->parts = ARENA_NEW(arena, struct mesh_part);
    mesh->materials = ARENA_NEW(arena, struct material);
    *mesh->materials =
        (struct material){.name = "test", .kind = kind, .albedo = {albedo, albedo, albedo}};
    return mesh;
}

/* Adds a triangle with its own normal; a, b, c counter-clockwise seen from outside. */
static inline void mesh_triangle(struct mesh *mesh, const double a[3], const double b[3],
                                 const double c[3])
{
    const double *corners[3] = {a, b, c};
    double first[3], second[3], normal[3], length = 0;
    for (int i = 0; i < 3; i++) {
        first[i] = b[i] - a[i];
        second[i] = c[i] - a[i];
    }
    for (int i = 0; i < 3; i++) {
        normal[i] =
            first[(i + 1) % 3] * second[(i + 2) % 3] - first[(i + 2) % 3] * second[(i + 1) % 3];
        length += normal[i] * normal[i];
    }
    for (int k = 0; k < 3; k++) {
        size_t vertex = mesh->vertices_count++;
        mesh->triangles[mesh->triangles_count][k] = (uint32_t)vertex;
        for (int i = 0; i < 3; i++) {
            mesh->positions[vertex][i] = (float)corners[k][i];
            mesh->normals[vertex][i] = (float)(normal[i] / sqrt(length));
        }
    }
    mesh->triangles_count++;
}

static inline void mesh_quad(struct mesh *mesh, const double a[3], const double b[3],
                             const double c[3], const double d[3])
{
    mesh_triangle(mesh, a, b, c);
    mesh_triangle(mesh, a, c, d);
}

/* Closes the part (every leaf is one triangle) and checks the mesh. */
static inline struct mesh *mesh_finish(struct arena *arena, struct mesh *mesh)
{
    struct mesh_part *part = mesh->parts;
    part->triangles_count = (uint32_t)mesh->triangles_count;
    if (mesh->materials->kind == MATERIAL_LEAF) {
        part->elements_count = part->triangles_count;
        part->element_first = ARENA_ARRAY(arena, uint32_t, part->elements_count + 1);
        for (uint32_t i = 0; i <= part->elements_count; i++)
            part->element_first[i] = i;
    }
    mesh_bounds(mesh);
    struct error error = {0};
    if (mesh_check(mesh, &error))
        fail_msg("%s", error.text);
    return mesh;
}

#endif
