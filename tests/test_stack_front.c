/* Stacks drawn front to back: the same picture as back to front. */
#include "testing_stacks.h"

static int open_fixture(void **state)
{
    return fixture_open(state, "shaded-texels");
}

/* A grove of 12 x 12 trees, six and more behind each other. */
static struct scene *grove(struct fixture *f)
{
    enum { SIDE = 12 };
    struct scene *scene = tree_scene(f->arena, f->plant, SIDE * SIDE, 1);
    for (int i = 0; i < SIDE * SIDE; i++) {
        struct instance *instance = &scene->instances[i];
        instance->position_m[0] = 2.5f * ((float)(i % SIDE) - 5.5f);
        instance->position_m[2] = 2.5f * ((float)(i / SIDE) - 5.5f);
        instance->rotation_rad = 1.3f * (float)i;
    }
    return scene;
}

static double largest_difference(const struct frame *a, const struct frame *b)
{
    double most = 0;
    for (int i = 0; i < 4 * TREE_PIXELS; i++)
        most = fmax(most, fabs(a->rgba[i] - b->rgba[i]));
    return most;
}

/* Pixels are closed at 1/256 of transmittance: what was behind is missed, with its light. */
static void test_stack_front__groups_draw_the_picture_of_back_to_front(void **state)
{
    struct fixture *f = *state;
    struct scene *scene = grove(f);
    struct view view = tree_view(scene, 0.4f, 0.15f, 120, 24);
    static const char *const options[4] = {
        "resolution=64,slices=32", "resolution=64,slices=32,front=1",
        "resolution=64,slices=32,front=7", "resolution=64,slices=32,front=64"};
    static const double limits[4] = {0, 1e-5, 2.0 / 256, 2.0 / 256};
    struct frame *behind = NULL;
    for (int i = 0; i < 4; i++) {
        struct frame *drawn =
            tree_draw(f->arena, f->method, options[i], scene, lit | EFFECT_FOG, &view, NULL);
        behind = behind ? behind : drawn;
        double most = largest_difference(drawn, behind);
        if (most > limits[i])
            fail_msg("%s: differs by %g", options[i], most);
    }
    assert_true(tree_mean(behind, 3) > 0.4);
}

static void test_stack_front__near_trees_of_triangles_stand_before_the_others(void **state)
{
    struct fixture *f = *state;
    struct scene *scene = grove(f);
    struct view view = tree_view(scene, 0.4f, 0.05f, 14, 14);
    struct frame *behind =
        tree_draw(f->arena, f->method, "resolution=64,slices=16,near=3", scene, lit, &view, NULL);
    struct frame *front = tree_draw(f->arena, f->method, "resolution=64,slices=16,near=3,front=5",
                                    scene, lit, &view, NULL);
    if (largest_difference(front, behind) > 2.0 / 256)
        fail_msg("differs by %g", largest_difference(front, behind));
}

/* A picture of 8 bits is filled once, from one of 16. */
static void test_stack_front__eight_bits_do_not_darken(void **state)
{
    struct fixture *f = *state;
    struct scene *scene = grove(f);
    struct view view = tree_view(scene, 0.4f, 0.15f, 120, 24);
    struct frame *exact =
        tree_draw(f->arena, f->method, "resolution=64,front=4", scene, lit, &view, NULL);
    struct frame *drawn = tree_draw_as(f->arena, f->method, "resolution=64,front=4", LOD_HIGH,
                                       TARGET_RGBA8, scene, lit, &view, NULL);
    double light = tree_mean(drawn, 1) / tree_mean(exact, 1);
    if (fabs(light - 1) > 0.006)
        fail_msg("%.4f of the light", light);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_stack_front__groups_draw_the_picture_of_back_to_front),
        cmocka_unit_test(test_stack_front__near_trees_of_triangles_stand_before_the_others),
        cmocka_unit_test(test_stack_front__eight_bits_do_not_darken),
    };
    return cmocka_run_group_tests_name("stack_front", tests, open_fixture, close_fixture);
}
