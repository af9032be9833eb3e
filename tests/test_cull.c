/* Culling, sorting and grouping of instances, against the slow way. */
#include "random_forest.h"

#include <stdlib.h>
#include <string.h>

enum { TREES = 3000 };

static struct scene *forest(struct arena *arena, struct cull_bound bounds[2])
{
    return random_forest(arena, TREES, 150, bounds);
}

static const float eyes[4][3] = {{0, 10, 0}, {190, 4, -20}, {0, 300, 0.1f}, {-30, -5, 60}};
static const float targets[4][3] = {{10, 9, 30}, {0, 0, 0}, {0, 0, 0}, {0, 20, 0}};

static void test_cull__a_tree_is_listed_exactly_when_its_sphere_is_seen(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct cull_bound bounds[2];
    struct scene *scene = forest(arena, bounds);
    struct cull *cull = cull_create(arena, scene, bounds);
    for (int k = 0; k < 4; k++) {
        struct view view;
        view_look_at(scene, eyes[k], targets[k], &view);
        struct cull_list list = cull_view(cull, &view, CULL_AS_PLACED);
        size_t at = 0;
        for (size_t i = 0; i < TREES; i++) {
            const struct instance *tree = &scene->instances[i];
            const struct cull_bound *bound = &bounds[tree->species];
            float center[3] = {tree->position_m[0],
                               tree->position_m[1] + tree->scale * bound->center_y_m,
                               tree->position_m[2]};
            float radius = tree->scale * bound->radius_m;
            bool listed = at < list.count && list.instances[at] == i;
            /* both answers are right within rounding */
            if (view_sees_sphere(&view, center, radius * 0.9999f))
                assert_true(listed);
            if (!view_sees_sphere(&view, center, radius * 1.0001f))
                assert_false(listed);
            if (listed) {
                double depth = 0;
                for (int axis = 0; axis < 3; axis++)
                    depth += (double)view.forward[axis] * (center[axis] - view.eye_m[axis]);
                assert_true(fabs(depth - list.depths_m[at]) < 1e-3);
                at++;
            }
        }
        assert_int_equal(at, list.count);
        assert_true(list.count > 0 && list.count < TREES);
    }
    arena_destroy(arena);
}

static void test_cull__the_list_is_sorted_either_way_and_holds_the_same_trees(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct cull_bound bounds[2];
    struct scene *scene = forest(arena, bounds);
    struct cull *cull = cull_create(arena, scene, bounds);
    struct view view;
    view_look_at(scene, eyes[0], targets[0], &view);
    size_t count = cull_view(cull, &view, CULL_AS_PLACED).count;
    uint64_t sums[2] = {0, 0};
    for (int down = 0; down < 2; down++) {
        struct cull_list list =
            cull_view(cull, &view, down ? CULL_BACK_TO_FRONT : CULL_FRONT_TO_BACK);
        assert_int_equal(list.count, count);
        for (size_t i = 0; i < count; i++) {
            sums[down] += random_mix(list.instances[i]);
            if (i > 0 && down)
                assert_true(list.depths_m[i] <= list.depths_m[i - 1]);
            if (i > 0 && !down)
                assert_true(list.depths_m[i] >= list.depths_m[i - 1]);
        }
    }
    assert_true(sums[0] == sums[1] && sums[0] != 0);
    arena_destroy(arena);
}

static void test_cull__the_sort_is_stable_and_puts_nan_last(void **state)
{
    (void)state;
    float keys[9] = {2, -1, NAN, 2, 0, -0.0f, -INFINITY, 2, INFINITY}, scratch[9];
    uint32_t values[9] = {0, 1, 2, 3, 4, 5, 6, 7, 8}, scratch_values[9];
    static const uint32_t up[9] = {6, 1, 5, 4, 0, 3, 7, 8, 2};
    cull_sort(keys, values, scratch, scratch_values, 9, false);
    assert_memory_equal(values, up, sizeof up);
    float again[9] = {2, -1, NAN, 2, 1, 1, -INFINITY, 2, INFINITY};
    uint32_t order[9] = {0, 1, 2, 3, 4, 5, 6, 7, 8};
    static const uint32_t down[9] = {8, 0, 3, 7, 4, 5, 1, 6, 2};
    cull_sort(again, order, scratch, scratch_values, 9, true);
    assert_memory_equal(order, down, sizeof down);
    cull_sort(again, order, scratch, scratch_values, 0, true);
}

static void test_cull__groups_are_runs_that_keep_the_order_within(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct cull_bound bounds[2];
    struct scene *scene = forest(arena, bounds);
    struct cull *cull = cull_create(arena, scene, bounds);
    struct view view;
    uint32_t groups[TREES], group_of[TREES], first[6];
    view_look_at(scene, eyes[1], targets[1], &view);
    struct cull_list list = cull_view(cull, &view, CULL_FRONT_TO_BACK);
    for (size_t i = 0; i < list.count; i++)
        group_of[list.instances[i]] = groups[i] =
            list.instances[i] % 4 + (list.instances[i] % 4 > 1);
    cull_group(cull, &list, groups, 5, first);
    assert_int_equal(first[0], 0);
    assert_int_equal(first[5], list.count);
    assert_int_equal(first[2], first[3]); /* nobody is in group 2 */
    for (uint32_t g = 0; g < 5; g++)
        for (uint32_t i = first[g]; i < first[g + 1]; i++) {
            assert_int_equal(group_of[list.instances[i]], g);
            assert_true(i == first[g] || list.depths_m[i] >= list.depths_m[i - 1]);
        }
    arena_destroy(arena);
}

static void test_cull__an_empty_scene_gives_an_empty_list(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct cull_bound bounds[2];
    struct scene *scene = forest(arena, bounds);
    uint32_t first[2];
    struct view view;
    scene->instances_count = 0;
    struct cull *cull = cull_create(arena, scene, bounds);
    view_look_at(scene, eyes[0], targets[0], &view);
    struct cull_list list = cull_view(cull, &view, CULL_BACK_TO_FRONT);
    assert_int_equal(list.count, 0);
    cull_group(cull, &list, NULL, 1, first);
    assert_int_equal(first[1], 0);
    arena_destroy(arena);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_cull__a_tree_is_listed_exactly_when_its_sphere_is_seen),
        cmocka_unit_test(test_cull__the_list_is_sorted_either_way_and_holds_the_same_trees),
        cmocka_unit_test(test_cull__the_sort_is_stable_and_puts_nan_last),
        cmocka_unit_test(test_cull__groups_are_runs_that_keep_the_order_within),
        cmocka_unit_test(test_cull__an_empty_scene_gives_an_empty_list),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
