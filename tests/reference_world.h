/* Small scenes made in code for the tests of the reference. */
#ifndef TREELINE_TESTS_REFERENCE_WORLD_H
#define TREELINE_TESTS_REFERENCE_WORLD_H

#include "testing.h"

#include "base/random.h"
#include "truth/reference.h"

#include <float.h>
#include <math.h>
#include <string.h>

#define WORLD_TREES 64

struct world {
    struct arena *arena;
    struct scene scene;
    struct view view;
};

/* Black sky, a white sun at the zenith, a picture of width x height px. */
static inline struct world world_create(int width_px, int height_px, double fov_y_rad)
{
    struct world world = {.arena = arena_create(0)};
    struct scene *scene = &world.scene;
    scene->name = scene->path = "test";
    scene->width_px = width_px;
    scene->height_px = height_px;
    scene->camera.fov_y_rad = (float)fov_y_rad;
    scene->camera.near_m = 0.01f;
    scene->camera.far_m = 1e5f;
    scene->sun.elevation_rad = scene->sun.end_elevation_rad = (float)(M_PI / 2);
    for (int i = 0; i < 3; i++)
        scene->sun.radiance[i] = 1;
    scene->species = ARENA_ARRAY(world.arena, struct species, WORLD_TREES);
    scene->instances = ARENA_ARRAY(world.arena, struct instance, WORLD_TREES);
    return world;
}

static inline void world_look(struct world *world, float ex, float ey, float ez, float tx, float ty,
                              float tz)
{
    view_look_at(&world->scene, (float[3]){ex, ey, ez}, (float[3]){tx, ty, tz}, &world->view);
}

static inline void world_sun(struct world *world, double x, double y, double z)
{
    double length = sqrt(x * x + y * y + z * z);
    world->view.sun_direction[0] = (float)(x / length);
    world->view.sun_direction[1] = (float)(y / length);
    world->view.sun_direction[2] = (float)(z / length);
}

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

/* Adds the mesh as a species and one instance of it. */
static inline struct instance *world_add(struct world *world, const struct mesh *mesh, float x,
                                         float y, float z)
{
    struct scene *scene = &world->scene;
    assert_true(scene->instances_count < WORLD_TREES);
    struct species *species = &scene->species[scene->species_count];
    *species = (struct species){"test", plant_from_mesh(world->arena, "test", mesh), 1, 1, 1};
    struct instance *instance = &scene->instances[scene->instances_count++];
    *instance = (struct instance){{x, y, z}, 0, 1, (uint32_t)scene->species_count++, 1};
    return instance;
}

/* A horizontal polygon of `sides` corners, radius 1, that faces up; facing: 1 up, -1 down, 2 toward
 * +z. */
static inline struct mesh *disc_mesh(struct arena *arena, enum material_kind kind, float albedo,
                                     int sides, int facing)
{
    struct mesh *mesh = mesh_new(arena, kind, albedo, (size_t)sides);
    for (int i = 0; i < sides; i++) {
        double from = 2 * M_PI * i / sides, to = 2 * M_PI * (i + 1) / sides;
        double middle[3] = {0, 0, 0};
        double a[3] = {cos(from), 0, -sin(from)}, b[3] = {cos(to), 0, -sin(to)};
        if (facing == 2) {
            a[1] = sin(from), a[2] = 0;
            b[1] = sin(to), b[2] = 0;
        }
        mesh_triangle(mesh, middle, facing < 0 ? b : a, facing < 0 ? a : b);
    }
    return mesh_finish(arena, mesh);
}

static inline double disc_area(int sides)
{
    return 0.5 * sides * sin(2 * M_PI / sides);
}

/* Flat bark ground of albedo 1 that is a part of the terrain. */
static inline void world_ground(struct world *world, float size_m, float albedo)
{
    struct terrain *terrain = &world->scene.terrain;
    terrain->samples_x = terrain->samples_z = 2;
    terrain->size_x_m = terrain->size_z_m = size_m;
    terrain->heights_m = ARENA_ARRAY(world->arena, float, 4);
    terrain->normals = arena_alloc(world->arena, 4, sizeof *terrain->normals);
    for (int i = 0; i < 4; i++)
        terrain->normals[i][1] = 1;
    for (int i = 0; i < 3; i++)
        terrain->albedo[i] = albedo;
}

static inline struct frame *world_render(struct world *world, struct reference_options options,
                                         struct reference_stats *stats)
{
    struct error error = {0};
    struct frame *frame = NULL;
    options.quiet = true;
    if (reference_render(world->arena, &world->scene, &world->view, &options, &frame, stats,
                         &error))
        fail_msg("%s", error.text);
    return frame;
}

/* Mean of a channel over the picture, and its stated standard error: pixels are independent. */
static inline double frame_mean(const struct frame *frame, int channel, double *error)
{
    size_t pixels = (size_t)frame->width_px * (size_t)frame->height_px;
    double sum = 0, variance = 0;
    for (size_t i = 0; i < pixels; i++) {
        sum += frame->rgba[4 * i + (size_t)channel];
        variance += frame->variance[4 * i + (size_t)channel];
    }
    *error = sqrt(variance) / (double)pixels;
    return sum / (double)pixels;
}

#endif
