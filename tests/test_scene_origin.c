/* Scenes far from the origin: their own coordinates begin near the camera. */
#include "testing.h"

#include "base/file.h"
#include "scene/scene.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const double EYE_M[3] = {9.013, 12.1, 34.507}, TARGET_M[3] = {0.101, 10, 0};
static const double TREE_M[2] = {0.203, 0.307};

/* cmocka compares floats, which is what is in question here. */
static void near_to(double value, double wanted, double tolerance)
{
    if (!(fabs(value - wanted) <= tolerance))
        fail_msg("%.9g is not %.9g", value, wanted);
}

/* One poplar and a still camera, all moved along x and -z; more stands in the root object. */
static struct scene *load(struct arena *arena, double away_m, const char *more, const char *camera)
{
    char folder[] = "/tmp/treeline-origin-XXXXXX";
    assert_non_null(mkdtemp(folder));
    const char *list = arena_printf(arena, "%s/trees.txt", folder);
    const char *path = arena_printf(arena, "%s/scene.json", folder);
    char *rows = arena_printf(arena, "%.3f %.3f 0 1\n", TREE_M[0] + away_m, TREE_M[1] - away_m);
    char *text = arena_printf(
        arena,
        "{\"plants\": [{\"generator\": \"poplar\"}], \"trees\": {\"default\": 1}, %s"
        "\"placement\": {\"kind\": \"file\", \"file\": \"trees.txt\"},"
        "\"camera\": {\"kind\": \"still\", %s \"keys\": [{\"eye\": [%.3f, %.3f, %.3f], "
        "\"target\": [%.3f, %.3f, %.3f]}]}}",
        more, camera, EYE_M[0] + away_m, EYE_M[1], EYE_M[2] - away_m, TARGET_M[0] + away_m,
        TARGET_M[1], TARGET_M[2] - away_m);
    struct error error = {0};
    struct scene *scene = NULL;
    struct scene_request request = {.trees = SIZE_MAX, .seed = 1};
    if (file_write(list, rows, strlen(rows), &error) ||
        file_write(path, text, strlen(text), &error) ||
        scene_load(arena, path, &request, &scene, &error))
        fail_msg("%s", error.text);
    unlink(list);
    unlink(path);
    rmdir(folder);
    return scene;
}

static void test_origin__a_far_scene_keeps_its_millimetres(void **unused)
{
    (void)unused;
    static const double aways_m[] = {0, 5000, 20000, 999900.5, -654321.9};
    for (size_t i = 0; i < sizeof aways_m / sizeof *aways_m; i++) {
        struct arena *arena = arena_create(0);
        struct scene *scene = load(arena, aways_m[i], "", "");
        struct view view;
        view_at(scene, 0, &view);
        const float *tree = scene->instances[0].position_m;
        /* the differences as the decimals of the file give them */
        near_to(view.eye_m[0] - tree[0], EYE_M[0] - TREE_M[0], 1e-3);
        near_to(view.eye_m[2] - tree[2], EYE_M[2] - TREE_M[1], 1e-3);
        near_to(view.eye_m[1], EYE_M[1], 1e-5);
        /* and all of it where the file says */
        for (int axis = 0; axis < 3; axis += 2) {
            double sign = axis ? -1 : 1;
            near_to(scene->origin_m[axis] + view.eye_m[axis] - sign * aways_m[i], EYE_M[axis],
                    1e-3);
            assert_true(fabsf(view.eye_m[axis]) <= 8192);
        }
        double forward = 0, length = 0;
        for (int axis = 0; axis < 3; axis++) {
            forward += view.forward[axis] * (TARGET_M[axis] - EYE_M[axis]);
            length += pow(TARGET_M[axis] - EYE_M[axis], 2);
        }
        near_to(forward / sqrt(length), 1, 1e-6);
        arena_destroy(arena);
    }
}

static void test_origin__a_near_scene_and_one_with_a_terrain_stay_where_they_are(void **unused)
{
    (void)unused;
    struct arena *arena = arena_create(0);
    struct scene *near = load(arena, 8000, "", "");
    assert_true(near->origin_m[0] == 0 && near->origin_m[2] == 0);
    near_to(near->instances[0].position_m[0], 8000 + TREE_M[0], 1e-3);
    struct scene *ground =
        load(arena, 200000, "\"terrain\": {\"size_m\": [1000000, 1000000]},", "");
    assert_true(ground->origin_m[0] == 0 && ground->origin_m[2] == 0);
    near_to(ground->instances[0].position_m[0], 200000 + TREE_M[0], 0.02);
    struct scene *extents = load(arena, 90000, "", "\"unit\": \"extent\",");
    assert_true(extents->origin_m[0] == 0 && extents->origin_m[2] == 0);
    arena_destroy(arena);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_origin__a_far_scene_keeps_its_millimetres),
        cmocka_unit_test(test_origin__a_near_scene_and_one_with_a_terrain_stay_where_they_are),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
