/* Billboards against the ray-traced reference: silhouette, coverage, light, views, and the borders
 * of their use. */
#include "testing_stacks.h"

#include "bake/views.h"

#include <stdio.h>

static int open_fixture(void **state)
{
    return fixture_open(state, "billboards");
}

static void test_billboards__a_tree_has_its_outline_from_every_side(void **state)
{
    struct fixture *f = *state;
    for (int side = 0; side < 4; side++) {
        struct scene *scene = tree_scene(f->arena, f->plant, 1, 1);
        struct view view = tree_view(scene, (float)side * 1.5707963f, 0, 300, 9);
        struct frame *truth = tree_reference(f->arena, scene, lit, &view);
        struct frame *drawn = fixture_draw(f, "alpha=blend", scene, lit, &view, NULL);
        double covered = tree_mean(truth, 3), off = tree_difference(drawn, truth, false);
        if (off > 0.2 * covered)
            fail_msg("side %d: coverage is off by %g of %g", side, off, covered);
        double mirrored = tree_difference(drawn, truth, true);
        if (mirrored < 3 * off)
            fail_msg("side %d: a mirrored tree would do as well (%g, %g)", side, mirrored, off);
    }
}

static void test_billboards__a_turned_moved_and_scaled_tree_stands_where_it_should(void **state)
{
    struct fixture *f = *state;
    struct scene *scene = tree_scene(f->arena, f->plant, 2, 1);
    scene->instances[0] = (struct instance){{-1.5f, 0.5f, 1}, 0.7853982f, 0.8f, 0, 1};
    scene->instances[1] = (struct instance){{2, -0.5f, -2}, 3.9269908f, 0.6f, 0, 1};
    struct view view = tree_view(scene, 0.3926991f, 0, 300, 9);
    struct frame *truth = tree_reference(f->arena, scene, lit, &view);
    struct frame *drawn = fixture_draw(f, "views=64,alpha=blend", scene, lit, &view, NULL);
    assert_true(tree_difference(drawn, truth, false) < 0.25 * tree_mean(truth, 3));
    assert_true(tree_mean(drawn, 3) > 0.97 * tree_mean(truth, 3));
}

/* Every way to treat coverage, large and small in the picture (mip-maps): the mean stays within 2 %
 * when blended. */
static void test_billboards__coverage_stays_the_plants_at_any_size(void **state)
{
    struct fixture *f = *state;
    static const struct {
        const char *options;
        double within;
    } ways[] = {{"alpha=blend", 0.02},
                {"alpha=coverage", 0.05} /* chance, at 30 pixels */,
                {"alpha=test", 0.08},
                {"alpha=blend,pick=blended", 0.02},
                {"alpha=blend,layout=octahedron,views=144", 0.04},
                {"alpha=test,depth=on", 0.08},
                {"alpha=blend,depth=on", 0.02}};
    static const float spans[] = {9, 30, 80};
    for (size_t d = 0; d < 3; d++) {
        struct scene *scene = tree_scene(f->arena, f->plant, 1, 1);
        struct view view = tree_view(scene, 0, 0, 300, spans[d]);
        double truth = tree_mean(tree_reference(f->arena, scene, lit, &view), 3);
        for (size_t i = 0; i < sizeof ways / sizeof *ways; i++) {
            struct frame *drawn =
                tree_draw(f->arena, f->method, ways[i].options, scene, lit, &view, NULL);
            double ratio = tree_mean(drawn, 3) / truth;
            /* 80 m leave the tree 6 pixels high: too few for a yes or no to be fair */
            if (fabs(ratio - 1) > (d == 2 ? 2.5 : 1) * ways[i].within)
                fail_msg("%s over %g m: %.4f of the coverage", ways[i].options, spans[d], ratio);
        }
    }
}

/* The sun goes round the tree; leaves lit on both sides and on one, with and without fog. */
static void test_billboards__light_follows_the_sun_as_the_reference_does(void **state)
{
    struct fixture *f = *state;
    static const unsigned effects[] = {EFFECT_TWO_SIDED, 0, EFFECT_TWO_SIDED | EFFECT_AMBIENT,
                                       EFFECT_AMBIENT | EFFECT_FOG};
    for (int k = 0; k < 8; k++) {
        struct scene *scene = tree_scene(f->arena, f->plant, 1, (float)k * 0.7853982f);
        struct view view = tree_view(scene, 0, 0, 300, 9);
        unsigned wanted = effects[k % 4];
        struct frame *truth = tree_reference(f->arena, scene, wanted, &view);
        struct frame *drawn = fixture_draw(f, "alpha=blend", scene, wanted, &view, NULL);
        /* Mean radiance of what is covered. Where light is scarce (turned away from the sun, one
         * side, no ambient) the expansion's own error of up to 1/16 shows, so there it is held
         * against the albedo. */
        static const double albedo[3] = {0.2, 0.5, 0.08};
        for (int channel = 0; channel < 3; channel++) {
            double wants = tree_mean(truth, channel) / tree_mean(truth, 3);
            double has = tree_mean(drawn, channel) / tree_mean(drawn, 3);
            double allowed = fmax(0.03 * wants, wanted == lit ? 0 : 0.05 * albedo[channel]);
            if (fabs(has - wants) > allowed)
                fail_msg("effects %u, sun %d, channel %d: %.4f, the reference %.4f", wanted, k,
                         channel, has, wants);
        }
    }
}

static void test_billboards__more_views_err_less(void **state)
{
    struct fixture *f = *state;
    double error[2] = {0, 0};
    for (int k = 0; k < 3; k++) {
        struct scene *scene = tree_scene(f->arena, f->plant, 1, 1);
        struct view view = tree_view(scene, 0.5f + 1.1f * (float)k, 0, 300, 9);
        struct frame *truth = tree_reference(f->arena, scene, lit, &view);
        static const char *const options[2] = {"views=4,alpha=blend", "views=32,alpha=blend"};
        for (int i = 0; i < 2; i++)
            error[i] += tree_rmse(
                truth, tree_draw(f->arena, f->method, options[i], scene, lit, &view, NULL));
    }
    if (error[1] > 0.7 * error[0])
        fail_msg("32 views err by %g, 4 views by %g", error[1], error[0]);
}

/* In the direction of a picture of the square layouts. */
static struct view grid_view(const struct scene *scene, enum views_layout layout, size_t side,
                             size_t column, size_t row)
{
    float v[3];
    views_direction(layout, side, row * side + column, v);
    return tree_view(scene, atan2f(v[0], v[2]), asinf(v[1]), 300, 9);
}

static void test_billboards__views_from_above_are_right_from_above(void **state)
{
    struct fixture *f = *state;
    struct scene *scene = tree_scene(f->arena, f->plant, 1, 1);
    static const size_t places[][2] = {{6, 4}, {5, 5}, {3, 5}, {8, 4}};
    for (int k = 0; k < 4; k++) {
        struct view view = grid_view(scene, VIEWS_HEMISPHERE, 11, places[k][0], places[k][1]);
        struct frame *truth = tree_reference(f->arena, scene, lit, &view);
        double circle =
            tree_rmse(truth, fixture_draw(f, "views=64,alpha=blend", scene, lit, &view, NULL));
        static const char *const options[] = {
            "alpha=blend,layout=hemisphere,views=121",
            "alpha=blend,layout=hemisphere,views=121,pick=blended"};
        for (int i = 0; i < 2; i++) {
            struct frame *drawn = fixture_draw(f, options[i], scene, lit, &view, NULL);
            double error = tree_rmse(truth, drawn), mean = tree_mean(drawn, 3);
            if (error > 0.6 * circle || fabs(mean / tree_mean(truth, 3) - 1) > 0.02)
                fail_msg("%s at %d: error %g, circle %g, coverage %.4f", options[i], k, error,
                         circle, mean / tree_mean(truth, 3));
        }
    }
}

static void test_billboards__views_from_below_need_the_whole_octahedron(void **state)
{
    struct fixture *f = *state;
    struct scene *scene = tree_scene(f->arena, f->plant, 1, 1);
    struct view view = grid_view(scene, VIEWS_OCTAHEDRON, 16, 14, 11);
    assert_true(view.eye_m[1] < -100);
    struct frame *truth = tree_reference(f->arena, scene, lit, &view);
    double half = tree_rmse(
        truth, fixture_draw(f, "alpha=blend,layout=hemisphere,views=121", scene, lit, &view, NULL));
    static const char *const options[] = {"alpha=blend,layout=octahedron,views=256",
                                          "alpha=blend,layout=octahedron,views=256,pick=blended"};
    for (int i = 0; i < 2; i++) {
        double whole = tree_rmse(truth, fixture_draw(f, options[i], scene, lit, &view, NULL));
        if (whole > 0.6 * half)
            fail_msg("%s: error %g, hemisphere %g", options[i], whole, half);
    }
}

/* Two trees of different light behind each other: the nearer one must win whatever the order in the
 * scene. */
static void test_billboards__nearer_trees_hide_farther_ones(void **state)
{
    struct fixture *f = *state;
    static const char *const options[] = {"alpha=blend", "alpha=test", "alpha=coverage"};
    for (int i = 0; i < 3; i++) {
        struct frame *drawn[2];
        for (int k = 0; k < 2; k++) {
            struct scene *scene = tree_scene(f->arena, f->plant, 2, 1);
            scene->instances[k].position_m[2] = -30;
            scene->instances[k].rotation_rad = 2;
            struct view view = tree_view(scene, 0, 0, 300, 9);
            drawn[k] = fixture_draw(f, options[i], scene, lit, &view, NULL);
        }
        if (i < 2)
            assert_memory_equal(drawn[0]->rgba, drawn[1]->rgba, TREE_PIXELS * 16);
        else /* the pattern of samples belongs to the tree's number */
            assert_true(tree_rmse(drawn[0], drawn[1]) < 0.05);
    }
}

static void test_billboards__ten_thousand_trees_take_a_few_draw_calls(void **state)
{
    struct fixture *f = *state;
    struct scene *scene = tree_scene(f->arena, f->plant, 10000, 1);
    for (size_t i = 0; i < 10000; i++) {
        scene->instances[i].position_m[0] = ((float)(i % 100) - 50) * 2;
        scene->instances[i].position_m[2] = ((float)(i / 100) - 50) * 2;
    }
    struct view view = tree_view(scene, 0.3f, 0.4f, 150, 60);
    struct gl_counters counters;
    fixture_draw(f, "resolution=64", scene, lit, &view, &counters);
    assert_true(counters.draw_calls <= 4);
    assert_true(counters.triangles > 2000);
}

static void test_billboards__an_eye_in_the_crown_is_drawn(void **state)
{
    struct fixture *f = *state;
    static const char *const options[] = {"", "alpha=blend,layout=octahedron,pick=blended",
                                          "depth=on", "alpha=coverage"};
    for (int i = 0; i < 4; i++)
        for (int k = 0; k < 3; k++) {
            struct scene *scene = tree_scene(f->arena, f->plant, 1, 1);
            float distance = k == 0 ? 0.5f : k == 1 ? 1e-3f : 1e-7f;
            struct view view = tree_view(scene, 0, k == 2 ? 1.5707963f : 0, distance, distance);
            fixture_draw(f, options[i], scene, lit, &view, NULL);
        }
}

static void test_billboards__only_species_with_a_tree_are_built(void **state)
{
    struct fixture *f = *state;
    struct error error = {0};
    struct plant *idle;
    assert_int_equal(plant_generated(f->arena, "poplar", NULL, &idle, &error), STATUS_OK);
    struct scene *scene = tree_scene(f->arena, f->plant, 1, 1);
    struct species both[2] = {{"poplar", idle, 1, 1, 1}, scene->species[0]};
    scene->species = both;
    scene->species_count = 2;
    scene->instances[0].species = 1;
    struct view view = tree_view(scene, 0, 0, 300, 9);
    struct frame *drawn = fixture_draw(f, "alpha=blend", scene, lit, &view, NULL);
    assert_true(tree_mean(drawn, 3) > 0.05);
    assert_false(plant_cost(idle).built);
}

static void test_billboards__terrain_in_front_hides_and_behind_does_not(void **state)
{
    struct fixture *f = *state;
    struct mesh *bush = tree_mesh(f->arena, 400); /* so broad that a quad through its middle dips */
    for (size_t i = 0; i < bush->vertices_count; i++) {
        bush->positions[i][0] *= 1.5f;
        bush->positions[i][1] *= 0.4f;
        bush->positions[i][2] *= 3;
    }
    mesh_bounds(bush);
    struct plant *plant = plant_from_mesh(f->arena, "bush", bush);
    struct scene *scene = tree_scene(f->arena, plant, 1, 1);
    float heights[4] = {-0.01f, -0.01f, -0.01f, -0.01f}, normals[4][3];
    for (int i = 0; i < 4; i++)
        normals[i][0] = normals[i][2] = 0, normals[i][1] = 1;
    scene->terrain =
        (struct terrain){2, 2, 100, 100, heights, normals, {0.2f, 0.2f, 0.2f}, NULL, 0};
    static const size_t columns[] = {8, 7};
    static const char *const options[] = {"alpha=blend,layout=hemisphere,views=121",
                                          "alpha=blend,layout=hemisphere,views=121,depth=on"};
    for (int i = 0; i < 4; i++) {
        struct view view = grid_view(scene, VIEWS_HEMISPHERE, 11, columns[i % 2], 4);
        struct frame *truth = tree_reference(f->arena, scene, lit, &view);
        struct frame *drawn = fixture_draw(f, options[i / 2], scene, lit, &view, NULL);
        double ratio = tree_mean(drawn, 3) / tree_mean(truth, 3);
        if (fabs(ratio - 1) > 0.03)
            fail_msg("%s, column %zu: %.4f of the coverage", options[i / 2], columns[i % 2], ratio);
    }
    for (int i = 0; i < 4; i++)
        heights[i] = 12; /* a plateau between the eye below it and the tree */
    struct view view = tree_view(scene, 0.6f, 1.2f, 300, 9);
    struct frame *drawn = fixture_draw(f, "alpha=blend", scene, lit, &view, NULL);
    assert_true(tree_mean(drawn, 3) == 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_billboards__a_tree_has_its_outline_from_every_side),
        cmocka_unit_test(test_billboards__a_turned_moved_and_scaled_tree_stands_where_it_should),
        cmocka_unit_test(test_billboards__coverage_stays_the_plants_at_any_size),
        cmocka_unit_test(test_billboards__light_follows_the_sun_as_the_reference_does),
        cmocka_unit_test(test_billboards__more_views_err_less),
        cmocka_unit_test(test_billboards__views_from_above_are_right_from_above),
        cmocka_unit_test(test_billboards__views_from_below_need_the_whole_octahedron),
        cmocka_unit_test(test_billboards__nearer_trees_hide_farther_ones),
        cmocka_unit_test(test_billboards__ten_thousand_trees_take_a_few_draw_calls),
        cmocka_unit_test(test_billboards__an_eye_in_the_crown_is_drawn),
        cmocka_unit_test(test_billboards__only_species_with_a_tree_are_built),
        cmocka_unit_test(test_billboards__terrain_in_front_hides_and_behind_does_not),
    };
    return cmocka_run_group_tests_name("billboards", tests, open_fixture, close_fixture);
}
