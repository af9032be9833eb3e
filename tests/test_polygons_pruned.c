/* Fewer triangles for trees that are far: pruned leaves keep their cover, simplified bark its
 * shape. */
#include "polygon_meshes.h"

#include "bake/detail.h"
#include "bake/prune.h"

#include <stdio.h>

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

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_polygons__pruned_elements_keep_the_plants_area),
        cmocka_unit_test(test_polygons__every_level_covers_what_all_triangles_cover),
        cmocka_unit_test(test_polygons__a_far_tree_costs_two_triangles_and_keeps_its_cover),
        cmocka_unit_test(test_polygons__leaves_shrink_away_without_a_jump),
        cmocka_unit_test(test_polygons__a_trunk_of_two_pixels_is_solid_under_pruned_leaves),
        cmocka_unit_test(test_polygons__only_closed_bark_that_faces_outward_is_culled),
        cmocka_unit_test(test_polygons__bark_levels_have_fewer_triangles_and_leaves_stay),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
