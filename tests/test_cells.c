/* Cells of many trees: what they hold, against the trees themselves. */
#include "random_forest.h"

#include "bake/cells.h"

#include <string.h>

enum { TREES = 5000 };

/* One in five is of the second species; all are stretched; some stand in one place. */
static struct scene *forest(struct arena *arena, struct cull_bound bounds[2])
{
    struct scene *scene = random_forest(arena, TREES, 20000, bounds);
    struct random random = random_seed(8, 1);
    for (size_t i = 0; i < TREES; i++) {
        scene->instances[i].species = random_below(&random, 5) == 0;
        scene->instances[i].stretch = 0.7f + random_float(&random);
        if (i >= 100 && i < 140)
            memcpy(scene->instances[i].position_m, scene->instances[99].position_m,
                   sizeof scene->instances[i].position_m);
    }
    return scene;
}

/* Sums over a cell's trees, one after the other, about their mean. */
static void sums_check(const struct scene *scene, const struct cells *cells, uint32_t cell)
{
    const struct cells_sums *sums = cells_sums(cells, cell);
    const uint32_t *trees;
    size_t count = cells_trees(cells, cell, &trees);
    double square = 0, fourth = 0, foot[3] = {0, 0, 0}, along = 0;
    const float way[3] = {0.6f, -0.64f, 0.48f};
    for (size_t k = 0; k < count; k++) {
        const struct instance *tree = &scene->instances[trees[k]];
        double weight = (double)tree->scale * tree->scale;
        assert_int_equal(tree->species, sums->species);
        square += weight;
        fourth += weight * weight;
        for (int i = 0; i < 3; i++)
            foot[i] += weight * (double)tree->position_m[i];
    }
    for (size_t k = 0; k < count; k++) {
        const struct instance *tree = &scene->instances[trees[k]];
        double off = 0;
        for (int i = 0; i < 3; i++)
            off += (double)way[i] * ((double)tree->position_m[i] - foot[i] / square);
        along += (double)tree->scale * tree->scale * off * off / square;
    }
    assert_true(fabs(sums->square / square - 1) < 1e-5);
    assert_true(fabs(sums->fourth / fourth - 1) < 1e-5);
    assert_true(fabs((double)sums->scale * sums->scale * (double)count / square - 1) < 1e-5);
    for (int i = 0; i < 3; i++)
        assert_true(fabs(sums->foot_m[i] - foot[i] / square) < 1e-3);
    assert_true(fabs(cells_spread_m2(sums, way) - along) < 1e-4 * along + 1e-2);
}

static void test_cells__a_cell_sums_the_trees_that_it_holds(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct cull_bound bounds[2];
    struct scene *scene = forest(arena, bounds);
    struct cells *cells = cells_create(arena, scene, bounds);
    size_t most = 0;
    for (uint32_t cell = 0; cell < cells_count(cells); cell++) {
        const uint32_t *trees;
        size_t count = cells_trees(cells, cell, &trees);
        most = count > most ? count : most;
        sums_check(scene, cells, cell);
    }
    assert_true(most > TREES / 2); /* a species whole */
    arena_destroy(arena);
}

static const float eyes[4][3] = {{0, 10, 0}, {190, 4, -20}, {0, 900, 0.1f}, {-900, 500, 6000}};
static const float targets[4][3] = {{10, 9, 30}, {0, 0, 0}, {0, 0, 0}, {0, 20, 0}};

/* How often each tree is in a list, by itself or in a cell. */
static size_t trees_listed(const struct cells *cells, const struct cells_list *list,
                           unsigned char times[TREES])
{
    size_t in_cells = 0;
    memset(times, 0, TREES);
    for (size_t k = 0; k < list->count; k++) {
        assert_true(k == 0 || list->depths_m[k] >= list->depths_m[k - 1]);
        if (list->entries[k] < TREES) {
            times[list->entries[k]]++;
            continue;
        }
        const uint32_t *trees;
        size_t count = cells_trees(cells, list->entries[k] - TREES, &trees);
        for (size_t i = 0; i < count; i++)
            times[trees[i]]++;
        in_cells += count;
    }
    return in_cells;
}

static const struct cells_limits none = {0, 0, 0}, some = {2, 5, 0};

static void test_cells__what_culling_lists_is_listed_once_alone_or_in_a_cell(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct cull_bound bounds[2];
    struct scene *scene = forest(arena, bounds);
    struct cells *cells = cells_create(arena, scene, bounds);
    struct cull *cull = cull_create(arena, scene, bounds);
    unsigned char times[TREES], culled[TREES];
    size_t in_cells = 0;
    for (int k = 0; k < 4; k++) {
        struct view view;
        view_look_at(scene, eyes[k], targets[k], &view);
        struct cull_list all = cull_view(cull, &view, CULL_AS_PLACED);
        memset(culled, 0, sizeof culled);
        for (size_t i = 0; i < all.count; i++)
            culled[all.instances[i]] = 1;
        struct cells_list alone = cells_view(cells, &view, &none, 2);
        assert_int_equal(trees_listed(cells, &alone, times), 0);
        assert_memory_equal(times, culled, TREES);
        struct cells_list list = cells_view(cells, &view, &some, 2);
        in_cells += trees_listed(cells, &list, times);
        for (size_t i = 0; i < TREES; i++) /* a cell may hold some that are outside */
            assert_true(times[i] == 1 || (times[i] == 0 && !culled[i]));
    }
    assert_true(in_cells > TREES);
    arena_destroy(arena);
}

static void test_cells__shares_of_what_turns_into_cells_sum_to_a_whole(void **state)
{
    (void)state;
    static const struct cells_limits gradual = {2, 5, 1};
    static int shares[TREES];
    struct arena *arena = arena_create(0);
    struct cull_bound bounds[2];
    struct scene *scene = forest(arena, bounds);
    struct cells *cells = cells_create(arena, scene, bounds);
    struct cull *cull = cull_create(arena, scene, bounds);
    size_t parts = 0;
    for (int k = 0; k < 4; k++) {
        struct view view;
        view_look_at(scene, eyes[k], targets[k], &view);
        struct cells_list list = cells_view(cells, &view, &gradual, 2);
        memset(shares, 0, sizeof shares);
        for (size_t i = 0; i < list.count; i++) {
            const uint32_t *trees = &list.entries[i];
            size_t count = 1;
            if (list.entries[i] >= TREES)
                count = cells_trees(cells, list.entries[i] - TREES, &trees);
            for (size_t t = 0; t < count; t++)
                shares[trees[t]] += list.shares[i];
            parts += list.shares[i] < 255;
            assert_true(i == 0 || list.depths_m[i - 1] <= list.depths_m[i]);
        }
        struct cull_list all = cull_view(cull, &view, CULL_AS_PLACED);
        for (size_t i = 0; i < all.count; i++)
            assert_in_range(shares[all.instances[i]], 252, 258);
    }
    assert_true(parts > TREES / 10);
    arena_destroy(arena);
}

static void test_cells__a_forest_behind_the_eye_lists_nothing(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct cull_bound bounds[2];
    struct scene *scene = forest(arena, bounds);
    struct cells *cells = cells_create(arena, scene, bounds);
    struct view view;
    view_look_at(scene, (float[3]){0, 50, 400}, (float[3]){0, 50, 900}, &view);
    assert_int_equal(cells_view(cells, &view, &some, 1).count, 0);
    scene->instances_count = 0;
    assert_int_equal(cells_view(cells_create(arena, scene, bounds), &view, &some, 1).count, 0);
    arena_destroy(arena);
}

static void test_cells__threads_change_no_entry(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct cull_bound bounds[2];
    struct scene *scene = forest(arena, bounds);
    struct cells *cells = cells_create(arena, scene, bounds);
    static uint32_t kept[TREES];
    for (int k = 0; k < 4; k++) {
        struct view view;
        view_look_at(scene, eyes[k], targets[k], &view);
        struct cells_list one = cells_view(cells, &view, &some, 1);
        memcpy(kept, one.entries, one.count * sizeof *kept);
        struct cells_list three = cells_view(cells, &view, &some, 3);
        assert_int_equal(three.count, one.count);
        assert_memory_equal(three.entries, kept, one.count * sizeof *kept);
    }
    arena_destroy(arena);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_cells__a_cell_sums_the_trees_that_it_holds),
        cmocka_unit_test(test_cells__what_culling_lists_is_listed_once_alone_or_in_a_cell),
        cmocka_unit_test(test_cells__shares_of_what_turns_into_cells_sum_to_a_whole),
        cmocka_unit_test(test_cells__a_forest_behind_the_eye_lists_nothing),
        cmocka_unit_test(test_cells__threads_change_no_entry),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
