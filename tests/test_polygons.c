/* The polygons method, against rays cast at pixel centres and against areas in closed form. */
#include "pictures.h"

#include "bake/detail.h"
#include "bake/prune.h"
#include "base/random.h"

#include <stdio.h>

enum { WIDTH = 64, HEIGHT = 48 };
#define EFFECTS (EFFECT_TWO_SIDED | EFFECT_AMBIENT | EFFECT_FOG)

/* A mesh with room; parts, materials and bounds as the caller wants them. */
static struct mesh *new_mesh(struct arena *arena, size_t triangles, size_t materials)
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
static void add_quad(struct mesh *mesh, const float origin[3], const float u[3], const float v[3])
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
static void add_leaves(struct arena *arena, struct mesh *mesh, size_t part, uint32_t leaves,
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
static void add_trunk(struct mesh *mesh, size_t part, float half_m, float height_m)
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
static struct mesh *small_tree(struct arena *arena, uint32_t leaves)
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

static struct mesh *leaf_ball(struct arena *arena, uint32_t leaves, float side_m)
{
    struct mesh *mesh = new_mesh(arena, 2 * leaves, 1);
    add_leaves(arena, mesh, 0, leaves, 3, 4, side_m);
    mesh_bounds(mesh);
    return mesh;
}

static const struct mesh_part *part_of(const struct mesh *mesh, size_t triangle)
{
    size_t p = 0;
    while (triangle >= mesh->parts[p].first_triangle + mesh->parts[p].triangles_count)
        p++;
    return &mesh->parts[p];
}

/* A texel is opaque in the checks of a 2 x 2 board, far from their borders; -1: too near to tell.
 */
static int board_is_opaque(const struct mesh *mesh, const struct hit *hit)
{
    const uint32_t *corners = mesh->triangles[hit->triangle];
    int checks = 0;
    for (int axis = 0; axis < 2; axis++) {
        double at = (1 - hit->p - hit->q) * mesh->uvs[corners[0]][axis] +
                    hit->p * mesh->uvs[corners[1]][axis] + hit->q * mesh->uvs[corners[2]][axis];
        at = 2 * (at - floor(at));
        if (fabs(at - round(at)) < 0.08)
            return -1;
        checks += at > 1;
    }
    return checks != 1;
}

/* The first thing seen through a pixel's centre: 1 tree, 0 sky, -1 undecided (near an edge). */
static int expected(const struct scene *scene, const struct view *view, const struct mesh *mesh,
                    unsigned effects, int column, int row, double radiance[3])
{
    float direction[3];
    struct hit best = {.distance_m = INFINITY, .margin = 1};
    mat4 matrix = GLM_MAT4_IDENTITY_INIT;
    bool near_edge = false;
    view_ray(view, (float)column + 0.5f, (float)row + 0.5f, direction);
    for (size_t i = 0; i < scene->instances_count; i++) {
        mat4 model;
        instance_matrix(&scene->instances[i], model);
        for (size_t t = 0; t < mesh->triangles_count; t++) {
            double corners[3][3];
            for (int c = 0; c < 3; c++)
                for (int axis = 0; axis < 3; axis++) {
                    const float *p = mesh->positions[mesh->triangles[t][c]];
                    corners[c][axis] = (double)model[0][axis] * p[0] +
                                       (double)model[1][axis] * p[1] +
                                       (double)model[2][axis] * p[2] + model[3][axis];
                }
            struct hit hit = {.distance_m = INFINITY};
            ray_triangle(view->eye_m, direction, (const double(*)[3])corners, t, &hit);
            if (isinf(hit.distance_m))
                continue;
            near_edge |= hit.margin < 3e-3;
            int opaque = mesh->materials[part_of(mesh, t)->material].texture
                             ? board_is_opaque(mesh, &hit)
                             : 1;
            near_edge |= opaque < 0;
            if (opaque > 0 && hit.distance_m < best.distance_m) {
                best = hit;
                memcpy(matrix, model, sizeof model);
            }
        }
    }
    if (near_edge)
        return -1;
    if (isinf(best.distance_m))
        return 0;
    const struct material *material = &mesh->materials[part_of(mesh, best.triangle)->material];
    const uint32_t *corners = mesh->triangles[best.triangle];
    double normal[3] = {0, 0, 0}, albedo[3], length = 0, weights[3], squares[3];
    weights[0] = 1 - best.p - best.q;
    weights[1] = best.p;
    weights[2] = best.q;
    for (int k = 0; k < 3;
         k++) /* M's columns are perpendicular: those of M^-T are M's over these */
        squares[k] = glm_vec3_norm2(matrix[k]);
    for (int axis = 0; axis < 3; axis++) {
        albedo[axis] = 0;
        for (int c = 0; c < 3; c++) {
            const float *n = mesh->normals[corners[c]];
            normal[axis] += weights[c] * ((double)matrix[0][axis] * n[0] / squares[0] +
                                          (double)matrix[1][axis] * n[1] / squares[1] +
                                          (double)matrix[2][axis] * n[2] / squares[2]);
            albedo[axis] += weights[c] * mesh->colors[corners[c]][axis] * material->albedo[axis];
        }
        albedo[axis] *= material->texture ? 0.5 : 1;
        length += normal[axis] * normal[axis];
    }
    for (int axis = 0; axis < 3; axis++)
        normal[axis] /= sqrt(length);
    shade(scene, view, effects, material->kind == MATERIAL_LEAF, albedo, normal, best.front,
          best.distance_m, radiance);
    return 1;
}

/* Compares a picture of three trees with rays, pixel by pixel. */
static void compare_with_rays(struct arena *arena, const char *options, const struct mesh *mesh,
                              unsigned effects)
{
    struct scene *scene = scene_by_hand(arena, WIDTH, HEIGHT);
    scene_plant(arena, scene, mesh, 3);
    scene->instances[0] = (struct instance){{0, 0, 0}, 0.7f, 1, 0, 1};
    scene->instances[1] = (struct instance){{3, 0.5f, -6}, 2.5f, 1.7f, 0, 0.6f};
    scene->instances[2] = (struct instance){{-4, -1, 2}, -1.2f, 0.8f, 0, 1.8f};
    static const float eye[3] = {1, 5, 13}, target[3] = {-0.5f, 3.5f, 0};
    struct view view;
    view_look_at(scene, eye, target, &view);
    struct setting setting = {.method = "polygons",
                              .options = options,
                              .effects = effects,
                              .lod = LOD_HIGH,
                              .format = TARGET_RGBA32F};
    struct picture picture = picture_draw(arena, scene, &view, &setting);
    size_t trees = 0, skies = 0, wrong = 0;
    for (int row = 0; row < HEIGHT; row++)
        for (int column = 0; column < WIDTH; column++) {
            double radiance[3];
            const float *pixel = picture.rgba + 4 * (row * WIDTH + column);
            int kind = expected(scene, &view, mesh, effects, column, row, radiance);
            trees += kind == 1;
            skies += kind == 0;
            bool right = kind < 0 || pixel[3] == (float)kind;
            for (int i = 0; i < 3 && kind == 1; i++)
                right = right && fabs(pixel[i] - radiance[i]) <
                                     1.5e-3; /* corners lie on a grid of 1/256 px */
            wrong += !right;
            if (!right)
                printf("px %d %d kind %d got %g %g %g %g want %g %g %g\n", column, row, kind,
                       pixel[0], pixel[1], pixel[2], pixel[3], radiance[0], radiance[1],
                       radiance[2]);
        }
    assert_true(trees > 150 && skies > 300);
    if (wrong > 0)
        fail_msg("%zu of %zu pixels of trees differ from their rays", wrong, trees);
    if (options) /* and the sky; sifted, what meets no sample is missing */
        assert_int_equal(picture.triangles, 3 * mesh->triangles_count + 1);
    else
        assert_true(picture.triangles <= 3 * mesh->triangles_count + 1);
}

static void test_polygons__every_pixel_is_what_its_ray_meets(void **state)
{
    (void)state;
    static const unsigned effects[] = {EFFECTS, 0, EFFECT_TWO_SIDED, EFFECT_FOG | EFFECT_AMBIENT};
    for (size_t i = 0; i < 2 * sizeof effects / sizeof *effects; i++) {
        struct arena *arena = arena_create(0);
        compare_with_rays(arena, i % 2 ? "sift=off" : NULL, small_tree(arena, 60), effects[i / 2]);
        arena_destroy(arena);
    }
}

/* A 2 x 2 board of grey: the checks off the diagonal are transparent. 32 texels a check keep the
 * border thin. */
static struct texture *board(struct arena *arena)
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

static void test_polygons__a_leaf_texture_is_tested_at_half_alpha(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct mesh *mesh = small_tree(arena, 40);
    mesh->materials[1].texture = board(arena);
    compare_with_rays(arena, "sift=on", mesh, EFFECTS);
    arena_destroy(arena);
}

/* Coverage of a lone tree in a square picture seen from afar. */
static double coverage_from(struct arena *arena, const struct mesh *mesh, float distance_m,
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

static void test_polygons__sixteen_samples_measure_a_quads_area(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct mesh *mesh = new_mesh(arena, 2, 1);
    add_leaves(arena, mesh, 0, 1, 1, 4, 1);
    /* upright, turned by an odd angle in its own plane, which faces the eye */
    float c = cosf(0.3f), s = sinf(0.3f);
    float corners[4][3] = {{0, 4, 0},
                           {2 * c, 4 + 2 * s, 0},
                           {2 * (c - s), 4 + 2 * (s + c), 0},
                           {-2 * s, 4 + 2 * c, 0}};
    memcpy(mesh->positions, corners, sizeof corners);
    for (int i = 0; i < 4; i++)
        memcpy(mesh->normals[i], (float[3]){0, 0, 1}, sizeof *mesh->normals);
    mesh_bounds(mesh);
    double height_m = 2 * 20 * tan(0.4), exact = 4 / (height_m * height_m * WIDTH / HEIGHT);
    static const struct {
        const char *options;
        double tolerance;
    } cases[] = {{"samples=1", 0.08}, {"samples=4", 0.03}, {"samples=16", 0.012}};
    for (int i = 0; i < 3; i++) {
        struct picture picture;
        double covered = coverage_from(arena, mesh, 20, LOD_HIGH, cases[i].options, &picture);
        if (fabs(covered / exact - 1) > cases[i].tolerance)
            fail_msg("%s: %g, not %g", cases[i].options, covered, exact);
        double steps = i == 0 ? 1 : i == 1 ? 4 : 16;
        for (int p = 0; p < WIDTH * HEIGHT; p++) {
            double alpha = picture.rgba[4 * p + 3] * steps;
            assert_true(fabs(alpha - round(alpha)) < 1e-4);
        }
    }
    arena_destroy(arena);
}

static void test_polygons__pruned_elements_keep_the_plants_area(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct mesh *mesh = leaf_ball(arena, 3000, 0.1f);
    struct prune *prune = prune_create(arena, mesh, 1);
    assert_int_equal(prune->count, 3000);
    assert_true(fabs(prune->area_m2 / (3000 * 0.01) - 1) < 1e-4);
    double area = 0;
    for (size_t e = 0; e < prune->count; e++) {
        const struct prune_vertex *v = &prune->vertices[3 * e];
        double a[3], b[3], n2 = 0;
        for (int i = 0; i < 3; i++) {
            a[i] = (double)v[1].position_m[i] - v[0].position_m[i];
            b[i] = (double)v[2].position_m[i] - v[0].position_m[i];
        }
        for (int i = 0; i < 3; i++) {
            double n = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
            n2 += n * n;
        }
        area += 0.5 * sqrt(n2);
    }
    assert_true(fabs(area / (3000 * 0.01) - 1) < 1e-3);
    mesh->materials[0].texture = board(arena); /* half of each leaf is opaque */
    prune = prune_create(arena, mesh, 1);
    assert_true(fabs(prune->area_m2 / (3000 * 0.005) - 1) < 0.05);
    assert_true(fabs(prune->vertices[0].albedo[1] / 65535.0 - 0.5 * 0.9 * 0.6) < 0.1);
    arena_destroy(arena);
}

static void test_polygons__every_level_covers_what_all_triangles_cover(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct mesh *mesh = leaf_ball(arena, 3000, 0.06f);
    static const float distances_m[] = {15, 30, 60, 120};
    for (int i = 0; i < 4; i++) {
        struct picture high, picture;
        double exact = coverage_from(arena, mesh, distances_m[i], LOD_HIGH, "samples=16", &high);
        static const enum lod lods[] = {LOD_AUTO, LOD_INTERMEDIATE, LOD_LOW};
        uint64_t last = high.triangles;
        for (int l = 0; l < 3; l++) {
            double covered =
                coverage_from(arena, mesh, distances_m[i], lods[l], "samples=16", &picture);
            /* few large leaves: their own scatter, about 0.5 / sqrt(n), is allowed for */
            double tolerance = 0.05 + 1.5 / sqrt((double)picture.triangles);
            if (fabs(covered / exact - 1) > tolerance)
                fail_msg("%g m, level %d: %g, not %g (%d triangles)", distances_m[i], l, covered,
                         exact, (int)picture.triangles);
            assert_true(picture.triangles < last || picture.triangles <= 4); /* two, sky, samples */
            last = picture.triangles;
        }
    }
    arena_destroy(arena);
}

static void test_polygons__a_far_tree_costs_two_triangles_and_keeps_its_cover(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct mesh *mesh = leaf_ball(arena, 500, 0.1f); /* 5 square metres */
    struct scene *scene = scene_by_hand(arena, WIDTH, HEIGHT);
    enum { TREES = 20000 };
    struct random random = random_seed(5, 5);
    struct view view;
    static const float eye[3] = {0, 4000, 1}, target[3] = {0, 0, 0};
    scene->camera.far_m = 1e5f;
    scene_plant(arena, scene, mesh, TREES);
    for (size_t i = 0; i < TREES; i++)
        scene->instances[i] = (struct instance){
            {2000 * random_float(&random) - 1000, 0, 2000 * random_float(&random) - 1000},
            6 * random_float(&random),
            1,
            0,
            1};
    view_look_at(scene, eye, target, &view);
    struct setting setting = {
        .method = "polygons", .effects = EFFECTS, .lod = LOD_AUTO, .format = TARGET_RGBA32F};
    setting.options = "samples=16,sift=off";
    struct picture picture = picture_draw(arena, scene, &view, &setting);
    assert_int_equal(picture.triangles, 2 * TREES + 2); /* sky, and the end of 16 samples */
    assert_true(picture.draw_calls <= 3);
    /* A leaf of random direction shows half of its area (Cauchy); trees cover so little that none
     * hides another. */
    double height_m = 2 * 4000 * tan(0.4), picture_m2 = height_m * height_m * WIDTH / HEIGHT;
    double exact = TREES * 5 * 0.5 / picture_m2;
    double covered = picture_coverage(&picture);
    if (fabs(covered / exact - 1) > 0.06)
        fail_msg("coverage %g, not %g", covered, exact);
    arena_destroy(arena);
}

/* A still view while the allowed error grows by 2 % at a time, over more than one step of pruning.
 */
static void test_polygons__leaves_shrink_away_without_a_jump(void **state)
{
    (void)state;
    double worst[2] = {0, 0};
    for (int smooth = 0; smooth < 2; smooth++) {
        struct arena *arena = arena_create(0);
        struct mesh *mesh = leaf_ball(arena, 3000, 0.06f);
        struct picture last = {0};
        for (int i = 0; i < 20; i++) {
            struct picture picture;
            char options[64];
            snprintf(options, sizeof options, "samples=16,smooth=%d,error_px=%g", smooth,
                     pow(1.02, i));
            coverage_from(arena, mesh, 12, LOD_AUTO, options, &picture);
            double change = 0;
            for (int p = 3; last.rgba && p < WIDTH * HEIGHT * 4; p += 4)
                change += fabs((double)picture.rgba[p] - last.rgba[p]);
            worst[smooth] = fmax(worst[smooth], change);
            last = picture;
        }
        arena_destroy(arena);
    }
    if (!(worst[1] > 0 && worst[1] < 0.5 * worst[0]))
        fail_msg("the picture jumps by %g px, in steps by %g px", worst[1], worst[0]);
}

static void test_polygons__a_trunk_of_two_pixels_is_solid_under_pruned_leaves(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct mesh *mesh = new_mesh(arena, 12 + 2 * 2000, 2);
    add_trunk(mesh, 0, 0.5f, 8);
    add_leaves(arena, mesh, 1, 2000, 2, 10, 0.05f);
    mesh_bounds(mesh);
    struct picture picture;
    coverage_from(arena, mesh, 30, LOD_AUTO, "samples=16", &picture);
    assert_true(picture.triangles < 1000); /* of 4,012: pruned */
    double focal_px = HEIGHT / 2 / tan(0.4), width_px = focal_px / 29.5;
    int low = (int)(HEIGHT / 2 + 3 * focal_px / 29.5),
        high = (int)(HEIGHT / 2 - 3 * focal_px / 29.5);
    assert_true(low - high > 8);
    for (int row = high; row < low; row++) {
        double sum = 0;
        for (int column = 0; column < WIDTH; column++)
            sum += picture.rgba[4 * (row * WIDTH + column) + 3];
        if (fabs(sum / width_px - 1) > 0.15)
            fail_msg("row %d: the trunk is %g px wide, not %g", row, sum, width_px);
    }
    arena_destroy(arena);
}

static void test_polygons__the_back_ends_draw_the_same_bytes(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct mesh *mesh = small_tree(arena, 200);
    struct scene *scene = scene_by_hand(arena, WIDTH, HEIGHT);
    scene_plant(arena, scene, mesh, 40);
    for (size_t i = 0; i < 40; i++)
        scene->instances[i] =
            (struct instance){{(float)(i % 8) * 5 - 17, 0, -6 * (float)(i / 8)}, (float)i, 1, 0, 1};
    static const float eye[3] = {0, 12, 20}, target[3] = {0, 2, -5};
    struct view view;
    view_look_at(scene, eye, target, &view);
    struct picture first = {0};
    for (size_t b = 0; gl_backends[b]; b++) {
        struct gl *gl;
        struct error error;
        if (gl_context_create(gl_backends[b], 2, &gl, &error) != STATUS_OK)
            continue;
        bool software = gl->software;
        gl_context_destroy(gl);
        struct setting setting = {.method = "polygons",
                                  .options = "samples=4,error_px=2",
                                  .backend = gl_backends[b],
                                  .effects = EFFECTS,
                                  .lod = LOD_AUTO,
                                  .format = TARGET_RGBA16F};
        struct picture picture = picture_draw(arena, scene, &view, &setting);
        assert_true(picture_coverage(&picture) > 0.1);
        if (software && first.rgba)
            assert_memory_equal(picture.rgba, first.rgba, WIDTH * HEIGHT * 4 * sizeof(float));
        if (software)
            first = picture;
    }
    arena_destroy(arena);
}

static void test_polygons__only_closed_bark_that_faces_outward_is_culled(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct mesh *mesh = new_mesh(arena, 12, 1);
    add_trunk(mesh, 0, 1, 2);
    const float(*positions)[3] = (const float(*)[3])mesh->positions;
    uint32_t *indices = mesh->triangles[0];
    assert_true(detail_is_closed(arena, positions, 8, indices, 36));
    assert_false(detail_is_closed(arena, positions, 8, indices, 33));
    assert_false(detail_is_closed(arena, positions, 8, indices, 0));
    for (int t = 0; t < 12; t++) {
        uint32_t swap = mesh->triangles[t][0];
        mesh->triangles[t][0] = mesh->triangles[t][1];
        mesh->triangles[t][1] = swap;
    }
    assert_false(detail_is_closed(arena, positions, 8, indices, 36)); /* inside out */
    arena_destroy(arena);
}

/* A tube of many rings: simplified it has to stay within its error and keep its leaves. */
static void test_polygons__bark_levels_have_fewer_triangles_and_leaves_stay(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct plant *plant;
    struct error error;
    const struct mesh *mesh;
    assert_int_equal(plant_generated(arena, "poplar", NULL, &plant, &error), STATUS_OK);
    assert_int_equal(plant_mesh(plant, &mesh, &error), STATUS_OK);
    struct detail *detail = detail_create(arena, mesh, true);
    assert_int_equal(detail->triangles_count[0], mesh->triangles_count);
    assert_true(detail->levels_count >= 3);
    for (size_t l = 1; l < detail->levels_count; l++) {
        assert_true(detail->triangles_count[l] < detail->triangles_count[l - 1]);
        assert_true(detail->errors_m[l] > detail->errors_m[l - 1] && detail->errors_m[l] < 2);
        for (size_t b = 0; b < detail->batches_count; b++)
            if (detail->batches[b].kind == MATERIAL_LEAF)
                assert_int_equal(detail->batches[b].levels[l].indices_count,
                                 detail->batches[b].levels[0].indices_count);
    }
    for (size_t i = 0; i < detail->indices_count; i++)
        assert_true(detail->indices[i] < detail->vertices_count);
    arena_destroy(arena);
}

static void test_polygons__a_plant_of_nothing_or_of_bark_alone_is_drawn(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct mesh *empty = new_mesh(arena, 1, 1), *bark = new_mesh(arena, 12, 1);
    struct picture picture;
    empty->materials[0].kind = MATERIAL_LEAF;
    empty->parts[0].element_first = ARENA_ARRAY(arena, uint32_t, 1);
    assert_true(coverage_from(arena, empty, 20, LOD_AUTO, NULL, &picture) == 0);
    add_trunk(bark, 0, 1, 6);
    mesh_bounds(bark);
    static const float distances_m[] = {20, 100, 20000};
    for (int i = 0; i < 3; i++) {
        double covered =
            coverage_from(arena, bark, distances_m[i], LOD_AUTO, "samples=16", &picture);
        /* the front, 2 x 6 m */
        double height_m = 2 * (distances_m[i] - 1) * tan(0.4);
        double exact = 12 / (height_m * height_m * WIDTH / HEIGHT);
        assert_true(i == 2 || fabs(covered / exact - 1) < (i == 0 ? 0.02 : 0.6));
        for (int p = 0; p < WIDTH * HEIGHT * 4; p++)
            assert_true(isfinite(picture.rgba[p]));
    }
    arena_destroy(arena);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_polygons__every_pixel_is_what_its_ray_meets),
        cmocka_unit_test(test_polygons__a_leaf_texture_is_tested_at_half_alpha),
        cmocka_unit_test(test_polygons__sixteen_samples_measure_a_quads_area),
        cmocka_unit_test(test_polygons__pruned_elements_keep_the_plants_area),
        cmocka_unit_test(test_polygons__every_level_covers_what_all_triangles_cover),
        cmocka_unit_test(test_polygons__a_far_tree_costs_two_triangles_and_keeps_its_cover),
        cmocka_unit_test(test_polygons__leaves_shrink_away_without_a_jump),
        cmocka_unit_test(test_polygons__a_trunk_of_two_pixels_is_solid_under_pruned_leaves),
        cmocka_unit_test(test_polygons__the_back_ends_draw_the_same_bytes),
        cmocka_unit_test(test_polygons__only_closed_bark_that_faces_outward_is_culled),
        cmocka_unit_test(test_polygons__bark_levels_have_fewer_triangles_and_leaves_stay),
        cmocka_unit_test(test_polygons__a_plant_of_nothing_or_of_bark_alone_is_drawn),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
