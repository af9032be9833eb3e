/* Distant trees, pictures of a few pixels drawn by the CPU: against the ray-traced reference, and
 * the cells that hold them. */
#include "testing_stacks.h"

#include "bake/distant_parts.h"

static int open_fixture(void **state)
{
    return fixture_open(state, "shaded-texels");
}

/* The mean place of a picture's coverage, px. */
static void middle_of(const struct frame *frame, double middle[2])
{
    double sum = 0;
    middle[0] = middle[1] = 0;
    for (int y = 0; y < frame->height_px; y++)
        for (int x = 0; x < frame->width_px; x++) {
            double covered = frame->rgba[4 * (y * frame->width_px + x) + 3];
            sum += covered;
            middle[0] += covered * x;
            middle[1] += covered * y;
        }
    for (int k = 0; k < 2; k++)
        middle[k] /= sum;
}

/* A forest of trees turned by all angles. */
static struct scene *turned_trees(struct fixture *f, int side, float apart_m)
{
    struct scene *scene = tree_scene(f->arena, f->plant, (size_t)(side * side), 1);
    scene->camera.far_m = 5000;
    for (int i = 0; i < side * side; i++) {
        struct instance *instance = &scene->instances[i];
        instance->position_m[0] = apart_m * ((float)(i % side) - 0.5f * (float)(side - 1));
        instance->position_m[2] = apart_m * ((float)(i / side) - 0.5f * (float)(side - 1));
        instance->rotation_rad = 2.4f * (float)i;
        instance->scale = 0.8f + 0.1f * (float)(i % 5);
    }
    return scene;
}

/* From twelve sides, a tree of 22 and one of 7 pixels: each picture nearly, all of them together
 * without a bias. */
static void test_distant__a_tree_has_the_place_size_and_light_of_the_reference(void **state)
{
    struct fixture *f = *state;
    static const float elevations[3] = {0.05f, 0.6f, 1.2f}, spans_m[2] = {30, 90};
    struct scene *scene = turned_trees(f, 1, 12);
    struct studio studio;
    studio_open(&studio, f->arena, f->method, "distant=32", LOD_AUTO, scene, lit);
    for (int s = 0; s < 2; s++) {
        double bias[3] = {0, 0, 0};
        for (int k = 0; k < 12; k++) {
            struct view view =
                tree_view(scene, 0.3f + 0.5f * (float)k, elevations[k % 3], 800, spans_m[s]);
            struct frame *truth = tree_reference(f->arena, scene, lit, &view);
            struct frame *drawn = studio_draw(&studio, &view);
            double ratio = tree_mean(drawn, 3) / tree_mean(truth, 3), places[2][2];
            double light = tree_mean(drawn, 1) / tree_mean(truth, 1) / ratio;
            middle_of(truth, places[0]);
            middle_of(drawn, places[1]);
            double x = places[1][0] - places[0][0], y = places[1][1] - places[0][1];
            bias[0] += (ratio - 1) / 12;
            bias[1] += x / 12;
            bias[2] += y / 12;
            if (fabs(ratio - 1) > 0.2 || fabs(light - 1) > 0.13 || hypot(x, y) > 0.5)
                fail_msg("span %g m, view %d: %.3f of the coverage, %.3f of the light, moved by "
                         "%.2f, %.2f px",
                         (double)spans_m[s], k, ratio, light, x, y);
        }
        if (fabs(bias[0]) > 0.04 || fabs(bias[1]) > 0.15 || fabs(bias[2]) > 0.15)
            fail_msg("span %g m: coverage %+.3f, moved by %.3f, %.3f px", (double)spans_m[s],
                     bias[0], bias[1], bias[2]);
    }
    studio_close(&studio);
}

static void test_distant__cells_hold_every_tree_once_and_all_of_it(void **state)
{
    struct fixture *f = *state;
    static const size_t counts[4] = {0, 1, 65, 5000};
    for (int k = 0; k < 4; k++) {
        struct scene *scene = tree_scene(f->arena, f->plant, counts[k], 1);
        struct random random = random_seed(5, (uint64_t)k);
        const float reach_m = 7;
        for (size_t i = 0; i < counts[k]; i++)
            for (int axis = 0; axis < 3; axis++) /* half of them in a hundredth of the ground */
                scene->instances[i].position_m[axis] =
                    (i % 2 ? 10 : 1000) * (random_float(&random) - 0.5f) * (axis == 1 ? 0.1f : 1);
        struct distant_cells *cells = distant_cells_create(f->arena, scene, reach_m);
        bool *held = ARENA_ARRAY(f->arena, bool, counts[k]);
        size_t total = 0;
        for (size_t c = 0; c < cells->cells_count; c++) {
            const struct distant_cell *cell = &cells->cells[c];
            assert_true(cell->count > 0 && cell->count <= 64);
            for (uint32_t i = cell->first; i < cell->first + cell->count; i++, total++) {
                const float *foot = scene->instances[cells->instances[i]].position_m;
                double square = 0;
                for (int axis = 0; axis < 3; axis++)
                    square += pow(foot[axis] - cell->middle_m[axis], 2);
                assert_false(held[cells->instances[i]]);
                held[cells->instances[i]] = true;
                assert_memory_equal(cells->trees[i].position_m, foot, sizeof(float[3]));
                assert_true(sqrt(square) + reach_m < cell->radius_m * 1.0001);
            }
        }
        assert_int_equal(total, counts[k]);
        assert_true(counts[k] < 1000 || cells->cells_count < counts[k] / 8);
    }
}

/* A plateau between the eye, below it, and the trees; then a valley before them. */
static void test_distant__terrain_in_front_hides_and_below_does_not(void **state)
{
    struct fixture *f = *state;
    struct scene *scene = turned_trees(f, 3, 12);
    float heights[4] = {-0.01f, -0.01f, -0.01f, -5}, normals[4][3];
    for (int i = 0; i < 4; i++)
        normals[i][0] = normals[i][2] = 0, normals[i][1] = 1;
    scene->terrain =
        (struct terrain){2, 2, 100, 100, heights, normals, {0.2f, 0.2f, 0.2f}, NULL, 0};
    struct view view = tree_view(scene, 0.6f, 0.5f, 800, 60);
    struct frame *truth = tree_reference(f->arena, scene, lit, &view);
    struct frame *drawn = tree_draw_as(f->arena, f->method, "distant=16", LOD_AUTO, TARGET_RGBA32F,
                                       scene, lit, &view, NULL);
    assert_true(fabs(tree_mean(drawn, 3) / tree_mean(truth, 3) - 1) < 0.1);
    for (int i = 0; i < 4; i++)
        heights[i] = i == 3 ? 25 : 20;
    view = tree_view(scene, 0.6f, 1.2f, 800, 60);
    drawn = tree_draw_as(f->arena, f->method, "distant=16", LOD_AUTO, TARGET_RGBA32F, scene, lit,
                         &view, NULL);
    assert_true(tree_mean(drawn, 3) < 1e-3);
}

/* Rows of trees behind each other: behind the first hundreds the others are passed over, which must
 * not be seen, and columns drawn by other threads must join. */
static void test_distant__a_deep_forest_is_the_references(void **state)
{
    struct fixture *f = *state;
    struct scene *scene = turned_trees(f, 60, 4);
    struct view view = tree_view(scene, 0.3f, 0.05f, 1500, 150);
    struct frame *truth = tree_reference(f->arena, scene, lit | EFFECT_FOG, &view);
    struct frame *drawn = tree_draw_as(f->arena, f->method, "distant=16", LOD_AUTO, TARGET_RGBA32F,
                                       scene, lit | EFFECT_FOG, &view, NULL);
    struct frame *stacks = tree_draw_as(f->arena, f->method, "distant=0", LOD_AUTO, TARGET_RGBA32F,
                                        scene, lit | EFFECT_FOG, &view, NULL);
    double error = tree_rmse(drawn, truth), other = tree_rmse(stacks, truth);
    if (error > 1.1 * other || fabs(tree_mean(drawn, 3) / tree_mean(truth, 3) - 1) > 0.04)
        fail_msg("RMSE %g, of stacks %g; %.3f of the coverage", error, other,
                 tree_mean(drawn, 3) / tree_mean(truth, 3));
}

/* The picture's angle grows until all trees are distant: no step between two pictures is far above
 * the mean one, where at once they jump. */
static void test_distant__trees_become_distant_gradually_where_it_is_smooth(void **state)
{
    struct fixture *f = *state;
    struct scene *scene = turned_trees(f, 3, 12);
    enum { STEPS = 80 };
    double worst[2] = {0, 0}, mean[2] = {0, 0};
    for (int smooth = 0; smooth < 2; smooth++) {
        struct studio studio;
        struct frame *last = NULL;
        studio_open(&studio, f->arena, f->method, smooth ? "smooth=on" : "smooth=off", LOD_AUTO,
                    scene, lit);
        for (int step = 0; step < STEPS; step++) {
            struct view view =
                tree_view(scene, 0.55f, 0.2f, 800, 44 * powf(1.6f, (float)step / STEPS));
            struct frame *drawn = studio_draw(&studio, &view);
            double change = last ? tree_rmse(last, drawn) : 0;
            worst[smooth] = fmax(worst[smooth], change);
            mean[smooth] += change / (STEPS - 1);
            last = drawn;
        }
        studio_close(&studio);
    }
    if (worst[0] < 4 * mean[0] || worst[1] > 2.5 * mean[1])
        fail_msg("worst and mean change: %g %g, smooth %g %g", worst[0], mean[0], worst[1],
                 mean[1]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_distant__a_tree_has_the_place_size_and_light_of_the_reference),
        cmocka_unit_test(test_distant__cells_hold_every_tree_once_and_all_of_it),
        cmocka_unit_test(test_distant__terrain_in_front_hides_and_below_does_not),
        cmocka_unit_test(test_distant__a_deep_forest_is_the_references),
        cmocka_unit_test(test_distant__trees_become_distant_gradually_where_it_is_smooth),
    };
    return cmocka_run_group_tests_name("distant", tests, open_fixture, close_fixture);
}
