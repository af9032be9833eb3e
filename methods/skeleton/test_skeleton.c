/* skeleton: its picture against what can be worked out by hand. */
#include "testing.h"

#include "cell/cell.h"

#include <math.h>

/* From afar a double cone is a rhombus: radius times height, each seen at the distance. */
static void test_skeleton__a_far_tree_covers_a_double_cones_rhombus(void **unused)
{
    (void)unused;
    struct arena *arena = arena_create(0);
    struct error error = {0};
    struct cell cell;
    struct scene *scene;
    const struct mesh *mesh;
    struct frame *frame;
    struct view view;
    assert_int_equal(cell_parse(arena, "tiny/skeleton/trees=1/size=500x500", &cell, &error), 0);
    struct scene_request request = {cell.trees, cell.seed, cell.width_px, cell.height_px};
    assert_int_equal(scene_load(arena, cell.scene, &request, &scene, &error), 0);
    assert_int_equal(plant_mesh(scene->species[0].plant, &mesh, &error), 0);

    const struct instance *tree = &scene->instances[0];
    const double height_m = tree->scale * tree->stretch * mesh->maximum_m[1], distance_m = 150;
    const double radius_m = tree->scale * mesh->radius_m;
    const float x = tree->position_m[0], z = tree->position_m[2];
    const float middle_m = tree->position_m[1] + 0.5f * (float)height_m;
    view_look_at(scene, (float[3]){x, middle_m, z + (float)distance_m}, (float[3]){x, middle_m, z},
                 &view);
    if (cell_render(arena, &cell, 0, &view, NULL, &frame, &error))
        fail_msg("%s", error.text);

    double covered_px = 0, focal_px = 250 / tan(0.5 * view.fov_y_rad);
    for (size_t i = 0; i < (size_t)500 * 500; i++)
        covered_px += frame->rgba[4 * i + 3];
    double wanted_px = radius_m * height_m * pow(focal_px / distance_m, 2);
    assert_float_equal(covered_px / wanted_px, 1, 0.06);
    arena_destroy(arena);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_skeleton__a_far_tree_covers_a_double_cones_rhombus),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
