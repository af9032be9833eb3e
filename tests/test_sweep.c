/* Swept options: which curves a run holds, by the rule that all else is equal and three values are
 * needed. */
#include "tiny_result.h"

#include "report/sweep.h"

#include <stdlib.h>

struct world {
    struct arena *arena;
    struct run *run;
};

static int setup(void **state)
{
    struct world *world = calloc(1, sizeof *world);
    world->arena = arena_create(0);
    world->run = tiny_run(world->arena, 100);
    *state = world;
    return 0;
}

static int teardown(void **state)
{
    struct world *world = *state;
    arena_destroy(world->arena);
    free(world);
    return 0;
}

static struct result *add(struct world *world, const char *method, const char *options,
                          size_t trees)
{
    return tiny_result(world->arena, world->run, method, options, trees, 0);
}

static const struct sweep *found(struct world *world, size_t *count)
{
    return sweeps_find(book_make(world->arena, world->run), count);
}

static void test_sweep__a_default_not_spelled_out_is_a_value(void **state)
{
    struct world *world = *state;
    add(world, "billboards", "views=64", 4);
    add(world, "billboards", "", 4); /* views=16 */
    add(world, "billboards", "views=4", 4);
    size_t count = 0;
    const struct sweep *sweeps = found(world, &count);
    assert_int_equal(count, 1);
    assert_string_equal(sweeps->option, "views");
    assert_int_equal(sweeps->curves_count, 1);
    const struct sweep_curve *curve = sweeps->curves;
    static const double values[] = {4, 16, 64};
    assert_int_equal(curve->points_count, 3);
    for (size_t i = 0; i < 3; i++)
        assert_true(curve->points[i].value == values[i]);
    assert_string_equal(curve->label, "billboards");
}

static void test_sweep__two_values_or_the_same_one_again_are_no_sweep(void **state)
{
    struct world *world = *state;
    add(world, "billboards", "views=4", 4);
    add(world, "billboards", "views=8", 4);
    add(world, "billboards", "views=4,alpha=blend", 4); /* another curve, of one value */
    add(world, "cross-quads", "planes=3", 4);
    size_t count = 1;
    found(world, &count);
    assert_int_equal(count, 0);
}

static void test_sweep__other_options_part_curves_of_one_plot(void **state)
{
    struct world *world = *state;
    static const char *const options[] = {"resolution=32",          "resolution=64",
                                          "resolution=128",         "resolution=32,depth=on",
                                          "resolution=64,depth=on", "resolution=128,depth=on"};
    for (size_t i = 0; i < 6; i++)
        add(world, "billboards", options[i], 4);
    for (size_t i = 0; i < 3; i++)
        add(world, "cross-quads", options[i], 4);
    size_t count = 0;
    const struct sweep *sweeps = found(world, &count);
    assert_int_equal(count, 1);
    assert_string_equal(sweeps->option, "resolution");
    assert_string_equal(sweeps->unit, "px");
    assert_int_equal(sweeps->curves_count, 3);
    assert_string_equal(sweeps->curves[0].label, "billboards");
    assert_string_equal(sweeps->curves[1].label, "billboards depth=on");
    assert_string_equal(sweeps->curves[2].label, "cross-quads");
    for (size_t c = 0; c < 3; c++)
        assert_int_equal(sweeps->curves[c].points_count, 3);
}

static void test_sweep__the_most_trees_swept_are_shown(void **state)
{
    struct world *world = *state;
    static const char *const options[] = {"views=4", "views=8", "views=32"};
    for (size_t trees = 1; trees <= 100; trees *= 10)
        for (size_t i = 0; i < 3 && (trees < 100 || i < 2); i++)
            add(world, "billboards", options[i], trees);
    size_t count = 0;
    struct book *book = book_make(world->arena, world->run);
    const struct sweep *sweeps = sweeps_find(book, &count);
    assert_int_equal(count, 1);
    assert_int_equal(book->groups[sweeps->group].trees, 10);
    assert_int_equal(sweeps->curves_count, 1);
}

static void test_sweep__failed_cells_and_foreign_methods_are_left_out(void **state)
{
    struct world *world = *state;
    add(world, "billboards", "views=4", 4);
    add(world, "billboards", "views=8", 4);
    add(world, "billboards", "views=32", 4)->status = STATUS_CRASH;
    static const char *const options[] = {"leaves=1", "leaves=2", "leaves=3"};
    for (size_t i = 0; i < 3; i++)
        add(world, "./mine.so", options[i], 4);
    size_t count = 1;
    found(world, &count);
    assert_int_equal(count, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_sweep__a_default_not_spelled_out_is_a_value, setup,
                                        teardown),
        cmocka_unit_test_setup_teardown(test_sweep__two_values_or_the_same_one_again_are_no_sweep,
                                        setup, teardown),
        cmocka_unit_test_setup_teardown(test_sweep__other_options_part_curves_of_one_plot, setup,
                                        teardown),
        cmocka_unit_test_setup_teardown(test_sweep__the_most_trees_swept_are_shown, setup,
                                        teardown),
        cmocka_unit_test_setup_teardown(test_sweep__failed_cells_and_foreign_methods_are_left_out,
                                        setup, teardown),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
