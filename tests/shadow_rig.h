/* A plant of few triangles on the ground, with the rays that tell what its sun reaches: for tests
 * of shadows. */
#ifndef TREELINE_TESTS_SHADOW_RIG_H
#define TREELINE_TESTS_SHADOW_RIG_H

#include "loose_mesh.h"
#include "pictures.h"

#include "wall/embree.h"

#include <math.h>

enum { WIDTH = 64, HEIGHT = 48 };

/* A scene with its rays: the plant's mesh and the ground. */
struct rig {
    struct arena *arena;
    struct scene *scene;
    struct view view;
    struct embree *embree;
    const struct mesh *plant;
    struct error error;
};

/* Closed, with a hole and sides that shade each other: radii 2 m and 0.7 m, upright, 3 m high. */
static inline struct mesh *ring(struct arena *arena, int around, int along)
{
    struct mesh *mesh = mesh_new(arena, MATERIAL_BARK, 0.5f, 2 * (size_t)(around * along));
    for (int i = 0; i < around; i++)
        for (int j = 0; j < along; j++) {
            double corner[4][3];
            for (int k = 0; k < 4; k++) {
                double a = 2 * M_PI * ((i + (k & 1)) % around) / around;
                double b = 2 * M_PI * ((j + k / 2) % along) / along;
                double out = 2 + 0.7 * cos(b);
                corner[k][0] = out * cos(a);
                corner[k][1] = 3 + out * sin(a);
                corner[k][2] = 0.7 * sin(b);
            }
            mesh_quad(mesh, corner[0], corner[1], corner[3], corner[2]);
        }
    return mesh_finish(arena, mesh);
}

static inline void add_to_embree(struct rig *rig, const struct mesh *mesh,
                                 const struct instance *instance)
{
    struct embree_part part = {0, (uint32_t)mesh->triangles_count, NULL, NULL};
    struct embree_mesh copy = {mesh->positions[0],
                               mesh->vertices_count,
                               mesh->triangles[0],
                               mesh->triangles_count,
                               &part,
                               1};
    mat4 matrix = GLM_MAT4_IDENTITY_INIT;
    float to_world[12];
    if (instance)
        instance_matrix(instance, matrix);
    for (int i = 0; i < 12; i++)
        to_world[i] = matrix[i / 3][i % 3];
    if (embree_add_mesh(rig->embree, &copy, &rig->error) != STATUS_OK)
        fail_msg("%s", rig->error.text);
    embree_add_instance(rig->embree, instance ? 0 : 1, to_world);
}

/* height: of the terrain at x, z in [-1, 1] of it. */
static inline struct rig *rig_open(struct mesh *plant, struct arena *arena,
                                   float (*height)(float, float))
{
    enum { SIDE = 41 };
    struct rig *rig = ARENA_NEW(arena, struct rig);
    struct scene *scene = rig->scene = scene_by_hand(arena, WIDTH, HEIGHT);
    struct terrain *ground = &scene->terrain;
    rig->arena = arena;
    rig->plant = plant;
    scene_plant(arena, scene, plant, 1);
    scene->sky = (struct sky){{0}, {0}, {0}};
    scene->tree_reach_m = 40; /* maps are as wide as the ground */
    for (int i = 0; i < 3; i++) {
        scene->minimum_m[i] = i == 1 ? -15 : -40;
        scene->maximum_m[i] = i == 1 ? 10 : 40;
    }
    *ground =
        (struct terrain){.samples_x = SIDE, .samples_z = SIDE, .size_x_m = 80, .size_z_m = 80};
    ground->heights_m = ARENA_ARRAY(arena, float, SIDE *SIDE);
    ground->normals = arena_alloc(arena, SIDE * SIDE, sizeof *ground->normals);
    for (int i = 0; i < SIDE * SIDE; i++) {
        float x = (float)(i % SIDE) / 20 - 1, z = (float)(i / SIDE) / 20 - 1, step = 0.05f;
        float slope_x = (height(x + step, z) - height(x - step, z)) / 4;
        float slope_z = (height(x, z + step) - height(x, z - step)) / 4;
        float length = sqrtf(slope_x * slope_x + slope_z * slope_z + 1);
        ground->heights_m[i] = height(x, z);
        ground->normals[i][0] = -slope_x / length;
        ground->normals[i][1] = 1 / length;
        ground->normals[i][2] = -slope_z / length;
    }
    for (int i = 0; i < 3; i++)
        ground->albedo[i] = 0.5f;
    return rig;
}

static inline void rig_look(struct rig *rig, const float eye[3], const float target[3],
                            const float sun[3])
{
    float length = sqrtf(sun[0] * sun[0] + sun[1] * sun[1] + sun[2] * sun[2]);
    view_look_at(rig->scene, eye, target, &rig->view);
    for (int i = 0; i < 3; i++)
        rig->view.sun_direction[i] = sun[i] / length;
    if (rig->embree)
        return;
    if (embree_create(rig->arena, 1, &rig->embree, &rig->error) != STATUS_OK)
        fail_msg("%s", rig->error.text);
    add_to_embree(rig, rig->plant, &rig->scene->instances[0]);
    add_to_embree(rig, terrain_mesh(rig->arena, &rig->scene->terrain), NULL);
    if (embree_commit(rig->embree, &rig->error) != STATUS_OK)
        fail_msg("%s", rig->error.text);
}

static inline float flat(float x, float z)
{
    return 0 * x * z;
}

static inline float hills(float x, float z)
{
    return 4 * cosf(9 * x) * cosf(7 * z) - 4;
}

/* The sun's share of what a ray sees: 0 or 1; -1 in the sky, and where the smooth normal nearly
 * says otherwise than the triangle, which is not the shadow's business. */
static inline int sun_at(struct rig *rig, const float direction[3])
{
    struct embree_packet packet = {0};
    const float *sun = rig->view.sun_direction;
    for (int i = 0; i < 3; i++) {
        packet.origin[i][0] = rig->view.eye_m[i];
        packet.direction[i][0] = direction[i];
    }
    packet.far[0] = INFINITY;
    embree_intersect(rig->embree, &packet, 1, false);
    if (packet.geometry[0] == EMBREE_NONE)
        return -1;
    bool ground = packet.instance[0] == 1;
    const struct instance *at = &rig->scene->instances[0];
    float c = cosf(at->rotation_rad), s = sinf(at->rotation_rad), n[3];
    for (int i = 0; i < 3; i++)
        n[i] = packet.normal[i][0];
    if (!ground) {
        n[1] /= at->stretch;
        float x = n[0] * c + n[2] * s, z = n[2] * c - n[0] * s;
        n[0] = x;
        n[2] = z;
    }
    float length = sqrtf(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    float facing = 0, seen = 0, distance = packet.far[0];
    for (int i = 0; i < 3; i++) {
        n[i] /= length;
        facing += n[i] * sun[i];
        seen -= n[i] * direction[i];
    }
    if (seen < 0)
        facing = -facing;
    bool leaf = !ground && rig->plant->materials->kind == MATERIAL_LEAF;
    if (ground) {
        float x = rig->view.eye_m[0] + distance * direction[0];
        float z = rig->view.eye_m[2] + distance * direction[2];
        const struct terrain *terrain = &rig->scene->terrain;
        int i = (int)(x / 2 + 20), j = (int)(z / 2 + 20);
        float least = 1;
        for (int k = 0; k < 4; k++) {
            const float *m = terrain->normals[(j + k / 2 > 40 ? 40 : j + k / 2) * 41 +
                                              (i + k % 2 > 40 ? 40 : i + k % 2)];
            least = fminf(least, m[0] * sun[0] + m[1] * sun[1] + m[2] * sun[2]);
        }
        if (least < 0.02f)
            return -1;
    }
    if (facing <= 0 && !leaf)
        return 0;
    float side = (facing > 0 ? 1.0f : -1.0f) * (seen < 0 ? -1.0f : 1.0f) * 1e-4f;
    for (int i = 0; i < 3; i++) {
        packet.origin[i][0] += distance * direction[i] + side * n[i];
        packet.direction[i][0] = sun[i];
    }
    packet.far[0] = INFINITY;
    return !embree_occluded(rig->embree, &packet, 1);
}

/* Pixels whose sun is wrong and that have no neighbour where it would be right; edge: all wrong. */
static inline int wrong_pixels(struct rig *rig, const char *method, const char *options, int *edge)
{
    struct setting setting = {.method = method,
                              .options = options,
                              .backend = "osmesa",
                              .effects = EFFECT_SUN_SHADOWS | EFFECT_TWO_SIDED,
                              .format = TARGET_RGBA32F};
    struct picture picture = picture_draw(rig->arena, rig->scene, &rig->view, &setting);
    static int truth[HEIGHT][WIDTH];
    int wrong = 0;
    *edge = 0;
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++) {
            float direction[3];
            view_ray(&rig->view, (float)x + 0.5f, (float)y + 0.5f, direction);
            truth[y][x] = sun_at(rig, direction);
        }
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++) {
            float red = picture.rgba[4 * (y * WIDTH + x)];
            assert_true(isfinite(red));
            bool near = false;
            for (int v = y > 0 ? y - 1 : 0; v <= y + 1 && v < HEIGHT; v++)
                for (int u = x > 0 ? x - 1 : 0; u <= x + 1 && u < WIDTH; u++)
                    near = near || truth[v][u] == (red > 0) || truth[v][u] < 0;
            *edge += truth[y][x] >= 0 && truth[y][x] != (red > 0);
            wrong += !near;
        }
    return wrong;
}

#endif
