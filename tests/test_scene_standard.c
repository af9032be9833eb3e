/* The standard scenes: each of their sizes, what their cameras see; words of levels of detail. */
#include "testing.h"

#include "scene/scene.h"

#include <math.h>
#include <string.h>

static void test_standard_scenes__load_at_each_of_their_sizes_and_see_the_forest(void **state)
{
    (void)state;
    struct arena *list = arena_create(0);
    char **names = NULL;
    size_t count = 0;
    assert_int_equal(scene_names(list, &names, &count, NULL), STATUS_OK);
    assert_true(count >= 7);
    for (size_t k = 0; k < count; k++) {
        struct arena *arena = arena_create(0);
        struct scene_summary summary;
        struct error error = {STATUS_OK, ""};
        scene_summary(arena, names[k], &summary, &error);
        assert_string_equal(error.text, "");
        assert_string_equal(summary.name, names[k]);
        assert_true(strlen(summary.doc) > 10 && summary.frames_count >= 1);
        assert_true(k == 0 || strcmp(names[k - 1], names[k]) < 0);
        for (size_t t = 0; t < summary.trees_count && summary.trees[t] <= 100000; t++) {
            struct scene *scene = NULL;
            struct scene_request request = {.trees = summary.trees[t], .seed = 1};
            scene_load(arena, names[k], &request, &scene, &error);
            assert_string_equal(error.text, "");
            assert_int_equal(scene->instances_count, summary.trees[t]);
            for (double time = 0; time <= 1; time += 0.5) {
                struct view view;
                view_at(scene, time, &view);
                float middle[3] = {0, 8 + terrain_height(&scene->terrain, 0, 0), 0};
                assert_true(strcmp(names[k], "forest-ground") == 0 ||
                            view_sees_sphere(&view, middle, 8));
                float above =
                    view.eye_m[1] - terrain_height(&scene->terrain, view.eye_m[0], view.eye_m[2]);
                assert_true(above >= scene->camera.clearance_m - 1e-2f);
            }
        }
        arena_destroy(arena);
    }
    arena_destroy(list);
}

/* Foot, half height and top of a tree of 21 m (the poplar's 20 m and some leaves), scaled, lie
 * within the picture. */
static void test_forest_views__hold_every_tree_at_each_standard_number(void **state)
{
    (void)state;
    static const char *const names[] = {"poplar-forest", "forest-aerial"};
    for (int n = 0; n < 2; n++) {
        struct arena *arena = arena_create(0);
        struct scene_summary summary;
        assert_int_equal(scene_summary(arena, names[n], &summary, NULL), STATUS_OK);
        for (size_t t = 0; t < summary.trees_count; t++) {
            struct scene *scene = NULL;
            struct scene_request request = {.trees = summary.trees[t], .seed = 1};
            assert_int_equal(scene_load(arena, names[n], &request, &scene, NULL), STATUS_OK);
            struct view view;
            view_at(scene, 0, &view);
            float widest = 0;
            for (size_t k = 0; k < scene->instances_count; k++)
                for (int part = 0; part < 3; part++) {
                    const struct instance *tree = &scene->instances[k];
                    vec4 clip, point = {tree->position_m[0],
                                        tree->position_m[1] + 10.5f * tree->scale * (float)part,
                                        tree->position_m[2], 1};
                    glm_mat4_mulv(view.view_projection, point, clip);
                    for (int i = 0; i < 3; i++)
                        if (fabsf(clip[i]) > clip[3])
                            fail_msg("%s, %zu trees: tree %zu is cut (%d: %g)", names[n],
                                     summary.trees[t], k, i, (double)(clip[i] / clip[3]));
                    widest = fmaxf(widest, fabsf(clip[0] / clip[3]));
                }
            assert_true(summary.trees[t] < 100 || widest > 0.6f);
        }
        arena_destroy(arena);
    }
}

static void test_lod__words_and_values_are_pairs(void **state)
{
    (void)state;
    static const char *const words[] = {"low", "intermediate", "high", "auto"};
    for (int k = 0; k < 4; k++) {
        enum lod lod = LOD_LOW;
        assert_string_equal(lod_word((enum lod)k), words[k]);
        assert_true(lod_from_word(words[k], &lod));
        assert_int_equal(lod, k);
    }
    enum lod lod;
    assert_false(lod_from_word("medium", &lod));
    assert_false(lod_from_word(NULL, &lod));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_standard_scenes__load_at_each_of_their_sizes_and_see_the_forest),
        cmocka_unit_test(test_forest_views__hold_every_tree_at_each_standard_number),
        cmocka_unit_test(test_lod__words_and_values_are_pairs),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
