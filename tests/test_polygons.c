/* The polygons method, against rays cast at pixel centres and against areas in closed form. */
#include "polygon_meshes.h"

#include <stdio.h>

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

static void test_polygons__a_leaf_texture_is_tested_at_half_alpha(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct mesh *mesh = small_tree(arena, 40);
    mesh->materials[1].texture = board(arena);
    compare_with_rays(arena, "sift=on", mesh, EFFECTS);
    arena_destroy(arena);
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
        cmocka_unit_test(test_polygons__the_back_ends_draw_the_same_bytes),
        cmocka_unit_test(test_polygons__a_plant_of_nothing_or_of_bark_alone_is_drawn),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
