/* Levels of detail against every triangle, and what they are made from against closed forms. */
#include "loose_mesh.h"
#include "pictures.h"

#include "bake/cover.h"
#include "bake/levels.h"
#include "bake/stout.h"
#include "base/random.h"

enum { WIDTH = 128, HEIGHT = 96 };

/* A tube of quads around the vertical; its sides are one piece. */
static void add_tube(struct mesh *mesh, float x_m, float radius_m, float length_m)
{
    enum { SIDES = 24 };
    for (int side = 0; side < SIDES; side++) {
        double p[2][2][3];
        for (int end = 0; end < 2; end++)
            for (int top = 0; top < 2; top++) {
                /* the same number gives the same corner */
                double turn = 2 * M_PI / SIDES * ((side + end) % SIDES);
                p[end][top][0] = x_m + radius_m * cos(turn);
                p[end][top][1] = top ? length_m : 0;
                p[end][top][2] = radius_m * sin(turn);
            }
        mesh_quad(mesh, p[0][0], p[1][0], p[1][1], p[0][1]);
    }
}

static void test_levels__a_tube_is_as_wide_as_it_is(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct mesh *mesh = mesh_new(arena, MATERIAL_BARK, 0.5f, 3 * 48);
    static const float radii_m[3] = {0.05f, 0.4f, 0.2f};
    for (int i = 0; i < 3; i++)
        add_tube(mesh, 5 * (float)i, radii_m[i], 20);
    mesh_finish(arena, mesh);
    const uint16_t *widths = stout_widths(arena, mesh);
    for (size_t i = 0; i < mesh->vertices_count; i++) {
        double width_m = widths[i] / 16384.0, exact = 2 * (double)radii_m[i / 144];
        if (fabs(width_m / exact - 1) > 0.01) /* 24 sides: 0.3 % less round */
            fail_msg("vertex %zu: %g m wide, not %g", i, width_m, exact);
    }
    const struct detail *detail = detail_create(arena, mesh, false);
    assert_int_equal(detail_stout(detail, 0, 0, stout_pack(0.81f)).indices_count, 0);
    assert_int_equal(detail_stout(detail, 0, 0, stout_pack(0.5f)).indices_count, 144);
    assert_int_equal(detail_stout(detail, 0, 0, stout_pack(0.3f)).indices_count, 288);
    assert_int_equal(detail_stout(detail, 0, 0, 0).indices_count, 432);
    arena_destroy(arena);
}

static void test_levels__the_cover_of_boards_is_their_projected_area(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct mesh *mesh = mesh_new(arena, MATERIAL_LEAF, 0.5f, 4);
    static const double a[3] = {-1, 3, -1}, b[3] = {1, 3, -1}, c[3] = {1, 3, 1}, d[3] = {-1, 3, 1};
    for (int twice = 0; twice < 2; twice++) /* one board behind the other covers no more */
        mesh_quad(mesh, a, b, c, d);
    mesh_finish(arena, mesh);
    const struct detail *detail = detail_create(arena, mesh, true);
    struct cover *cover = cover_create(arena, mesh, detail);
    cover_look(cover, 0.35f, 0);
    double exact = 4 * sin(0.35); /* 4 square metres level, seen from 0.35 rad above */
    if (fabs(cover_plant(cover) / exact - 1) > 0.03)
        fail_msg("%g square metres, not %g", cover_plant(cover), exact);
    /* each triangle scaled to a quarter of its area about its centre; those of a pair coincide */
    const struct prune *prune = prune_create(arena, mesh, 1);
    struct cover_run run = {.prune = prune, .kept = 4, .growth = 0.5f, .stout = 1};
    double quarter = cover_of_run(cover, &run);
    if (fabs(quarter / exact - 0.25) > 0.02)
        fail_msg("%g of the board, not a quarter", quarter / exact);
    arena_destroy(arena);
}

/* Poplars that stand apart, seen so far away that none of their leaves is a pixel. */
static double forest_cover(struct arena *arena, float distance_m, enum lod lod)
{
    enum { TREES = 24 };
    struct error error;
    struct plant *plant;
    const struct mesh *mesh;
    struct scene *scene = scene_by_hand(arena, WIDTH, HEIGHT);
    if (plant_generated(arena, "poplar", NULL, &plant, &error) != STATUS_OK ||
        plant_mesh(plant, &mesh, &error) != STATUS_OK)
        fail_msg("%s", error.text);
    scene_plant(arena, scene, mesh, TREES);
    for (int i = 0; i < TREES; i++) {
        float *at = scene->instances[i].position_m;
        at[0] = 0.05f * distance_m * (float)(i % 8 - 3.5f);
        at[1] = 0.2f * distance_m * (float)(i / 8 - 1) - 10;
        scene->instances[i].rotation_rad = (float)i;
    }
    scene->camera.far_m = 10000;
    float eye[3] = {0, 0.1f * distance_m, distance_m}, target[3] = {0, 0, 0};
    struct view view;
    view_look_at(scene, eye, target, &view);
    struct setting setting = {
        .method = "polygons", .options = "samples=16", .lod = lod, .format = TARGET_RGBA32F};
    struct picture picture = picture_draw(arena, scene, &view, &setting);
    return picture_coverage(&picture);
}

static void test_levels__pruned_poplars_cover_what_poplars_cover(void **state)
{
    (void)state;
    static const float distances_m[] = {100, 250, 500};
    for (int i = 0; i < 3; i++) {
        struct arena *arena = arena_create(0);
        double exact = forest_cover(arena, distances_m[i], LOD_HIGH);
        double pruned = forest_cover(arena, distances_m[i], LOD_AUTO);
        if (!(exact > 1e-4 && fabs(pruned / exact - 1) < 0.05))
            fail_msg("from %g m: %g, not %g", (double)distances_m[i], pruned, exact);
        arena_destroy(arena);
    }
}

static void test_levels__a_nearer_tree_never_has_fewer_elements(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct mesh *mesh = mesh_new(arena, MATERIAL_LEAF, 0.5f, 5000);
    struct random random = random_seed(4, 4);
    for (uint32_t i = 0; i < 5000; i++) {
        double p[3][3];
        for (int k = 0; k < 9; k++)
            p[k / 3][k % 3] =
                (k < 3 ? 4 * random_double(&random) : p[0][k % 3]) + 0.1 * random_double(&random);
        mesh_triangle(mesh, p[0], p[1], p[2]);
    }
    mesh_finish(arena, mesh);
    struct levels levels;
    levels_fill(&levels, mesh, detail_create(arena, mesh, true), prune_create(arena, mesh, 1),
                0.5f);
    float last = INFINITY;
    for (float per_m = 1000; per_m > 1e-3f; per_m *= 0.97f) {
        struct levels_choice choice = levels_choose(&levels, per_m);
        float kept = 5000;
        if (choice.step >= 0) {
            struct levels_seen seen = {per_m, 0.3f};
            struct levels_run run = levels_run_of(&levels, choice.step, &seen, 0.5f);
            kept = run.kept;
            assert_true(kept >= 2 && isfinite(run.growth) && run.growth > 0);
        }
        assert_true(kept <= last);
        last = kept;
    }
    assert_true(last == 2);
    arena_destroy(arena);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_levels__a_tube_is_as_wide_as_it_is),
        cmocka_unit_test(test_levels__the_cover_of_boards_is_their_projected_area),
        cmocka_unit_test(test_levels__pruned_poplars_cover_what_poplars_cover),
        cmocka_unit_test(test_levels__a_nearer_tree_never_has_fewer_elements),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
