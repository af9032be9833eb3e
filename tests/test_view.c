/* Cameras: matrices against cglm, rays against projection, paths against geometry, culling against
 * sampling. */
#include "testing.h"

#include "base/arena.h"
#include "base/random.h"
#include "scene/camera.h"
#include "scene/terrain.h"

#include <math.h>
#include <string.h>

static struct camera_key keys[4];

/* A scene without trees, seen from key 0; 200 x 100 px, 60 degrees high. */
static struct scene scene_with(enum path_kind kind, size_t keys_count)
{
    struct scene scene = {.name = "test", .width_px = 200, .height_px = 100};
    scene.camera = (struct camera_path){.kind = kind,
                                        .keys_count = keys_count,
                                        .keys = keys,
                                        .turn_rad = 2 * GLM_PIf,
                                        .fov_y_rad = GLM_PIf / 3,
                                        .near_m = 0.5f,
                                        .far_m = 500,
                                        .frames_count = 10};
    return scene;
}

static void key_set(size_t k, float x, float y, float z, float target_x, float target_y,
                    float target_z)
{
    keys[k] = (struct camera_key){{x, y, z}, {target_x, target_y, target_z}};
}

static float uniform(struct random *random, float low, float high)
{
    return low + (high - low) * random_float(random);
}

static float distance(const float a[3], const float b[3])
{
    return sqrtf((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) +
                 (a[2] - b[2]) * (a[2] - b[2]));
}

/* Image point in pixels, from the top left, of a world point. */
static void project(const struct view *view, const float point[3], float pixel[2])
{
    vec4 world = {point[0], point[1], point[2], 1}, clip;
    glm_mat4_mulv((vec4 *)(void *)view->view_projection, world, clip);
    pixel[0] = (0.5f + 0.5f * clip[0] / clip[3]) * (float)view->width_px;
    pixel[1] = (0.5f - 0.5f * clip[1] / clip[3]) * (float)view->height_px;
}

static void test_view__matrices_are_those_of_cglm(void **state)
{
    (void)state;
    struct random random = random_seed(1, 1);
    for (int k = 0; k < 100; k++) {
        float eye[3], target[3];
        for (int i = 0; i < 3; i++) {
            eye[i] = uniform(&random, -50, 50);
            target[i] = uniform(&random, -50, 50);
        }
        key_set(0, eye[0], eye[1], eye[2], target[0], target[1], target[2]);
        struct scene scene = scene_with(PATH_STILL, 1);
        struct view view;
        view_at(&scene, 0, &view);
        mat4 look, perspective;
        glm_lookat(eye, target, (vec3){0, 1, 0}, look);
        glm_perspective(GLM_PIf / 3, 2, 0.5f, 500, perspective);
        for (int c = 0; c < 4; c++)
            for (int r = 0; r < 4; r++) {
                assert_float_equal(view.view[c][r], look[c][r], 2e-4);
                assert_float_equal(view.projection[c][r], perspective[c][r], 1e-5);
            }
    }
}

static void test_view__depths_map_to_minus_one_and_one(void **state)
{
    (void)state;
    key_set(0, 0, 0, 0, 0, 0, -1);
    struct scene scene = scene_with(PATH_STILL, 1);
    struct view view;
    view_at(&scene, 0, &view);
    const float depths[2] = {0.5f, 500}, expected[2] = {-1, 1};
    for (int k = 0; k < 2; k++) {
        vec4 clip;
        glm_mat4_mulv(view.view_projection, (vec4){0, 0, -depths[k], 1}, clip);
        assert_float_equal(clip[2] / clip[3], expected[k], 1e-4);
    }
}

static void test_view__a_ray_passes_through_the_point_that_projects_to_its_pixel(void **state)
{
    (void)state;
    struct random random = random_seed(2, 1);
    for (int k = 0; k < 1000; k++) {
        key_set(0, uniform(&random, -20, 20), uniform(&random, -20, 20), uniform(&random, -20, 20),
                uniform(&random, -20, 20), uniform(&random, -20, 20), uniform(&random, -20, 20));
        struct scene scene = scene_with(PATH_STILL, 1);
        struct view view;
        view_at(&scene, 0, &view);
        float x = uniform(&random, 0, 200), y = uniform(&random, 0, 100), ray[3], point[3];
        view_ray(&view, x, y, ray);
        assert_float_equal(ray[0] * ray[0] + ray[1] * ray[1] + ray[2] * ray[2], 1, 1e-5);
        float along = uniform(&random, 1, 100), pixel[2];
        for (int i = 0; i < 3; i++)
            point[i] = view.eye_m[i] + along * ray[i];
        project(&view, point, pixel);
        assert_float_equal(pixel[0], x, 0.02);
        assert_float_equal(pixel[1], y, 0.02);
    }
}

static void test_view__the_top_edge_is_half_the_field_of_view_above_the_middle(void **state)
{
    (void)state;
    key_set(0, 0, 0, 0, 0, 0, -1);
    struct scene scene = scene_with(PATH_STILL, 1);
    struct view view;
    float ray[3];
    view_at(&scene, 0, &view);
    view_ray(&view, 100, 0, ray);
    assert_float_equal(ray[1], sin(GLM_PI / 6), 1e-6);
    assert_float_equal(ray[2], -cos(GLM_PI / 6), 1e-6);
    view_ray(&view, 200, 50, ray);
    assert_true(ray[0] > 0);
}

static void test_view__straight_down_and_up_have_a_frame(void **state)
{
    (void)state;
    for (int sign = -1; sign <= 1; sign += 2) {
        key_set(0, 3, 10, 5, 3, 10 + 7.0f * (float)sign, 5);
        struct scene scene = scene_with(PATH_STILL, 1);
        struct view view;
        view_at(&scene, 0, &view);
        assert_float_equal(view.forward[1], sign, 1e-6);
        assert_float_equal(view.up[2], sign, 1e-6);
        assert_float_equal(view.right[0], 1, 1e-6);
    }
    /* Almost down is the same frame: no jump. */
    key_set(0, 0, 10, 0.001f, 0, 0, 0);
    struct scene scene = scene_with(PATH_STILL, 1);
    struct view view;
    view_at(&scene, 0, &view);
    assert_float_equal(view.up[2], -1, 1e-3);
    assert_float_equal(view.right[0], 1, 1e-6);
}

static void test_view__an_eye_on_its_target_still_gives_numbers(void **state)
{
    (void)state;
    struct scene scene = scene_with(PATH_STILL, 1);
    struct view view;
    view_look_at(&scene, (float[3]){1, 2, 3}, (float[3]){1, 2, 3}, &view);
    for (int c = 0; c < 4; c++)
        for (int r = 0; r < 4; r++)
            assert_true(isfinite(view.view_projection[c][r]));
}

static void test_view__the_frame_is_orthonormal_and_right_handed(void **state)
{
    (void)state;
    struct random random = random_seed(3, 1);
    struct scene scene = scene_with(PATH_STILL, 1);
    for (int k = 0; k < 1000; k++) {
        float eye[3], target[3];
        for (int i = 0; i < 3; i++) {
            eye[i] = uniform(&random, -1, 1);
            target[i] = uniform(&random, -1, 1);
        }
        struct view view;
        view_look_at(&scene, eye, target, &view);
        vec3 cross;
        glm_vec3_cross(view.right, view.up, cross);
        for (int i = 0; i < 3; i++)
            assert_float_equal(cross[i], -view.forward[i], 1e-5);
        assert_float_equal(glm_vec3_norm(view.right), 1, 1e-5);
        assert_float_equal(glm_vec3_dot(view.right, view.up), 0, 1e-5);
    }
}

static void test_view__times_outside_and_nan_are_clamped(void **state)
{
    (void)state;
    key_set(0, 0, 1, 10, 0, 1, 0);
    key_set(1, 0, 1, 2, 0, 1, 0);
    struct scene scene = scene_with(PATH_WALK, 2);
    struct view view;
    view_at(&scene, NAN, &view);
    assert_float_equal(view.eye_m[2], 10, 0);
    view_at(&scene, -5, &view);
    assert_float_equal(view.eye_m[2], 10, 0);
    view_at(&scene, 7, &view);
    assert_float_equal(view.eye_m[2], 2, 0);
    assert_true(view.time <= 1.0 && view.time >= 1.0);
}

static void test_sun__direction_moves_from_start_to_end(void **state)
{
    (void)state;
    key_set(0, 0, 1, 10, 0, 1, 0);
    struct scene scene = scene_with(PATH_STILL, 1);
    scene.sun = (struct sun){.azimuth_rad = 0, .elevation_rad = 0};
    scene.sun.end_azimuth_rad = GLM_PI_2f;
    struct view view;
    view_at(&scene, 0, &view); /* azimuth 0 is toward +z */
    assert_float_equal(view.sun_direction[2], 1, 1e-6);
    view_at(&scene, 1, &view); /* grows toward +x */
    assert_float_equal(view.sun_direction[0], 1, 1e-6);
    view_at(&scene, 0.5, &view);
    assert_float_equal(view.sun_direction[0], sqrt(0.5), 1e-6);
    scene.sun.end_elevation_rad = GLM_PI_2f;
    view_at(&scene, 1, &view);
    assert_float_equal(view.sun_direction[1], 1, 1e-6);
    assert_float_equal(glm_vec3_norm(view.sun_direction), 1, 1e-6);
}

static void test_path__an_orbit_keeps_its_distance_and_closes(void **state)
{
    (void)state;
    key_set(0, 3, 4, 10, 1, 2, -1);
    struct scene scene = scene_with(PATH_ORBIT, 1);
    struct view first, view;
    view_at(&scene, 0, &first);
    for (int k = 0; k <= 16; k++) {
        view_at(&scene, k / 16.0, &view);
        assert_float_equal(distance(view.eye_m, keys[0].target_m),
                           distance(first.eye_m, keys[0].target_m), 1e-4);
        assert_float_equal(view.eye_m[1], 4, 0);
    }
    assert_float_equal(distance(view.eye_m, first.eye_m), 0, 1e-4);
    view_at(&scene, 0.25, &view); /* from +z toward +x, seen from the target */
    assert_float_equal(view.eye_m[0], 1 + 11, 1e-4);
    assert_float_equal(view.eye_m[2], -1 - 2, 1e-4);
}

/* On the sphere about the target, as far up as the angle says; the azimuth is kept. */
static void test_path__an_orbit_rises_to_straight_above_and_no_farther(void **state)
{
    (void)state;
    key_set(0, 7, 2, 9, 1, 2, 1); /* 10 m away, level */
    struct scene scene = scene_with(PATH_ORBIT, 1);
    scene.camera.turn_rad = 0;
    scene.camera.rise_rad = GLM_PIf / 2;
    const double azimuth_deg = atan2(6, 8) * 180 / M_PI;
    for (int k = 0; k <= 18; k++) {
        struct view view;
        double elevation_deg, around_deg;
        view_at(&scene, k / 18.0, &view);
        view_angles_deg(&view, &elevation_deg, &around_deg);
        assert_float_equal(distance(view.eye_m, keys[0].target_m), 10, 1e-4);
        assert_float_equal(view.eye_m[1], 2 + 10 * sin(k * M_PI / 36), 1e-4);
        assert_float_equal(elevation_deg, 5 * k, 1e-3);
        if (k < 18)
            assert_float_equal(around_deg, azimuth_deg, 1e-3);
    }
    struct view above, beyond;
    view_at(&scene, 1, &above);
    scene.camera.rise_rad = GLM_PIf;
    view_at(&scene, 1, &beyond);
    assert_float_equal(distance(above.eye_m, beyond.eye_m), 0, 1e-4);
    assert_float_equal(path_time(&scene, 3, 4), 1, 0);
}

/* Turning, the azimuth is the angle turned by; looking up, the eye is below; straight down the
 * azimuth is known by the picture's top. */
static void test_view__angles_are_those_of_the_eye_around_its_target(void **state)
{
    (void)state;
    key_set(0, 0, 5, 12, 0, 0, 0);
    struct scene scene = scene_with(PATH_ORBIT, 1);
    double elevation_deg, azimuth_deg;
    struct view view;
    for (int k = 0; k < 12; k++) {
        view_at(&scene, k / 12.0, &view);
        view_angles_deg(&view, &elevation_deg, &azimuth_deg);
        assert_float_equal(elevation_deg, atan2(5, 12) * 180 / M_PI, 1e-3);
        assert_float_equal(fmod(azimuth_deg + 1, 360), 30 * k + 1, 1e-3);
    }
    view_look_at(&scene, (float[3]){0, 1, 3}, (float[3]){0, 4, 0}, &view);
    view_angles_deg(&view, &elevation_deg, &azimuth_deg);
    assert_float_equal(elevation_deg, -45, 1e-3);
    assert_float_equal(fmod(azimuth_deg + 1, 360), 1, 1e-3);
    view_look_at(&scene, (float[3]){0, 9, 0}, (float[3]){0, 4, 0}, &view);
    view_angles_deg(&view, &elevation_deg, &azimuth_deg);
    assert_float_equal(elevation_deg, 90, 1e-3);
    assert_float_equal(fmod(azimuth_deg + 1, 360), 1, 1e-3); /* its top is -z: the limit from +z */
}

static void test_path__an_approach_shrinks_the_distance_in_equal_ratios(void **state)
{
    (void)state;
    key_set(0, 0, 5, 600, 0, 5, 0);
    key_set(1, 0, 5, 6, 0, 5, 0);
    struct scene scene = scene_with(PATH_APPROACH, 2);
    struct view view;
    for (int k = 0; k <= 10; k++) {
        view_at(&scene, k / 10.0, &view);
        float expected = 600 * powf(0.01f, (float)k / 10);
        assert_float_equal(distance(view.eye_m, keys[0].target_m), expected, 1e-3f * expected);
    }
}

static void test_path__keys_are_passed_and_a_straight_line_stays_straight(void **state)
{
    (void)state;
    key_set(0, 0, 1, 0, 0, 1, -10);
    key_set(1, 10, 2, 5, 0, 1, -10);
    key_set(2, 20, 9, -5, 3, 1, -10);
    key_set(3, 5, 1, 1, 0, 1, -10);
    struct scene scene = scene_with(PATH_KEYS, 4);
    struct view view;
    for (size_t k = 0; k < 4; k++) {
        view_at(&scene, (double)k / 3, &view);
        assert_float_equal(distance(view.eye_m, keys[k].eye_m), 0, 1e-4);
    }
    for (size_t k = 0; k < 4; k++)
        key_set(k, 2.0f * (float)k, 1, -3.0f * (float)k, 0, 1, -20);
    for (int k = 0; k <= 20; k++) {
        view_at(&scene, k / 20.0, &view);
        assert_float_equal(view.eye_m[2], -1.5f * view.eye_m[0], 1e-5);
    }
    /* Continuous: a small step in time is a small step in space, also over a key. */
    struct view before, after;
    view_at(&scene, 1.0 / 3 - 1e-6, &before);
    view_at(&scene, 1.0 / 3 + 1e-6, &after);
    assert_float_equal(distance(before.eye_m, after.eye_m), 0, 1e-3);
}

static void test_path__frames_of_a_closed_orbit_do_not_repeat_the_first(void **state)
{
    (void)state;
    struct scene scene = scene_with(PATH_ORBIT, 1);
    assert_float_equal(path_time(&scene, 3, 4), 0.75, 0);
    scene.camera.turn_rad = 1;
    assert_float_equal(path_time(&scene, 3, 4), 1, 0);
    scene.camera.kind = PATH_WALK;
    assert_float_equal(path_time(&scene, 3, 4), 1, 0);
    assert_float_equal(path_time(&scene, 0, 1), 0, 0);
    assert_float_equal(path_time(&scene, 0, 0), 0, 0);
}

/* A slope of 1:2 along x, 200 m square. */
static struct terrain slope_terrain(struct arena *arena)
{
    struct terrain terrain = {.samples_x = 2, .samples_z = 2, .size_x_m = 200, .size_z_m = 200};
    terrain.heights_m = ARENA_ARRAY(arena, float, 4);
    terrain.heights_m[1] = terrain.heights_m[3] = 100;
    terrain_normals(arena, &terrain);
    return terrain;
}

static void test_path__a_walk_follows_the_ground_and_clearance_lifts_a_flight(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    key_set(0, -50, 27, 0, 60, 80, 0); /* 2 m above the ground */
    key_set(1, 50, 79, 0, 60, 80, 0);  /* 4 m above it */
    struct scene scene = scene_with(PATH_WALK, 2);
    scene.terrain = slope_terrain(arena);
    struct view view;
    for (int k = 0; k <= 10; k++) {
        view_at(&scene, k / 10.0, &view);
        float ground = 0.5f * (view.eye_m[0] + 100);
        assert_float_equal(view.eye_m[1] - ground, 2 + 2 * k / 10.0, 1e-3);
    }
    scene.camera.kind = PATH_FLY_OVER;
    scene.camera.clearance_m = 3;
    for (int k = 0; k <= 10; k++) {
        view_at(&scene, k / 10.0, &view);
        assert_true(view.eye_m[1] >= 0.5f * (view.eye_m[0] + 100) + 3 - 1e-3f);
    }
    arena_destroy(arena);
}

/* True when a point is in front of all six planes. */
static bool holds(const struct view *view, const float point[3])
{
    vec4 clip;
    glm_mat4_mulv((vec4 *)(void *)view->view_projection, (vec4){point[0], point[1], point[2], 1},
                  clip);
    for (int i = 0; i < 3; i++)
        if (fabsf(clip[i]) > clip[3])
            return false;
    return true;
}

static void test_sphere__one_that_reaches_into_the_frustum_is_never_culled(void **state)
{
    (void)state;
    struct random random = random_seed(4, 1);
    key_set(0, 5, 6, 7, -3, 2, -8);
    struct scene scene = scene_with(PATH_STILL, 1);
    scene.camera.far_m = 60;
    struct view view;
    view_at(&scene, 0, &view);
    int inside = 0, culled = 0;
    for (int k = 0; k < 20000; k++) {
        float center[3], radius = uniform(&random, 0.1f, 10);
        for (int i = 0; i < 3; i++)
            center[i] = view.eye_m[i] + uniform(&random, -80, 80);
        bool touches = holds(&view, center);
        for (int s = 0; s < 40 && !touches; s++) {
            float offset[3], point[3];
            for (int i = 0; i < 3; i++)
                offset[i] = uniform(&random, -1, 1);
            float length = glm_vec3_norm(offset);
            for (int i = 0; i < 3; i++)
                point[i] = center[i] + radius * offset[i] / length;
            touches = holds(&view, point);
        }
        bool seen = view_sees_sphere(&view, center, radius);
        if (touches)
            assert_true(seen);
        inside += touches;
        culled += !seen;
    }
    /* And it culls: most spheres around the eye are outside. */
    assert_true(inside > 500);
    assert_true(culled > 10000);
    /* Six spheres just outside, one beyond each plane. */
    float angle_y = GLM_PIf / 6, angle_x = atanf(2 * tanf(angle_y));
    const float far_away = 30;
    for (int plane = 0; plane < 6; plane++) {
        float local[3] = {0, 0, plane == 4 ? 0.5f - 1.01f : plane == 5 ? 61.01f : far_away};
        float angle = plane < 2 ? angle_x : angle_y, sign = plane % 2 ? 1.0f : -1.0f;
        if (plane < 4) {
            local[plane < 2 ? 0 : 1] = sign * (far_away * tanf(angle) + 1.01f / cosf(angle));
        }
        float center[3];
        for (int i = 0; i < 3; i++)
            center[i] = view.eye_m[i] + local[0] * view.right[i] + local[1] * view.up[i] +
                        local[2] * view.forward[i];
        assert_false(view_sees_sphere(&view, center, 1));
        assert_true(view_sees_sphere(&view, center, 1.03f));
    }
}

static void test_instance__matrix_is_shift_turn_and_scale_of_cglm(void **state)
{
    (void)state;
    struct instance instance = {{3, 4, 5}, 0.7f, 1.5f, 0, 2.5f};
    mat4 matrix, expected = GLM_MAT4_IDENTITY_INIT;
    instance_matrix(&instance, matrix);
    glm_translate(expected, instance.position_m);
    glm_rotate_y(expected, 0.7f, expected);
    glm_scale(expected, (vec3){1.5f, 2.5f * 1.5f, 1.5f});
    for (int c = 0; c < 4; c++)
        for (int r = 0; r < 4; r++)
            assert_float_equal(matrix[c][r], expected[c][r], 1e-6);
    /* x' = x cos + z sin */
    vec4 moved;
    glm_mat4_mulv(matrix, (vec4){0, 0, 1, 1}, moved);
    assert_float_equal(moved[0], 3 + 1.5 * sin(0.7), 1e-6);
}

static void test_depths__hold_every_tree_and_lose_nothing_near(void **state)
{
    (void)state;
    struct instance trees[] = {{{0, 0, 0}, 0, 1, 0, 1}, {{40, 0, -30}, 0, 1, 0, 1}};
    struct scene scene = scene_with(PATH_STILL, 1);
    scene.instances = trees;
    scene.instances_count = 2;
    scene.tree_reach_m = 20;
    memcpy(scene.minimum_m, (float[3]){0, 0, -30}, sizeof scene.minimum_m);
    memcpy(scene.maximum_m, (float[3]){40, 0, 0}, sizeof scene.maximum_m);
    float eyes[1][3] = {{0, 10, 100}}, near_m, far_m;
    camera_depths(&scene, eyes, 1, &near_m, &far_m);
    float farthest = distance(eyes[0], trees[1].position_m) + 20;
    assert_true(far_m >= farthest);
    assert_true(far_m < 3 * farthest);
    float nearest = distance(eyes[0], trees[0].position_m) - 20;
    assert_true(near_m < nearest);
    assert_true(near_m > 0.1f * nearest);
    float within[1][3] = {{0, 10, 10}};
    camera_depths(&scene, within, 1, &near_m, &far_m);
    assert_float_equal(near_m, 0.1, 1e-6);
    scene.instances_count = 0;
    memset(scene.minimum_m, 0, sizeof scene.minimum_m);
    memset(scene.maximum_m, 0, sizeof scene.maximum_m);
    scene.tree_reach_m = 0;
    camera_depths(&scene, within, 1, &near_m, &far_m);
    assert_true(near_m > 0 && near_m < far_m && isfinite(far_m));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_view__matrices_are_those_of_cglm),
        cmocka_unit_test(test_view__depths_map_to_minus_one_and_one),
        cmocka_unit_test(test_view__a_ray_passes_through_the_point_that_projects_to_its_pixel),
        cmocka_unit_test(test_view__the_top_edge_is_half_the_field_of_view_above_the_middle),
        cmocka_unit_test(test_view__straight_down_and_up_have_a_frame),
        cmocka_unit_test(test_view__an_eye_on_its_target_still_gives_numbers),
        cmocka_unit_test(test_view__the_frame_is_orthonormal_and_right_handed),
        cmocka_unit_test(test_view__times_outside_and_nan_are_clamped),
        cmocka_unit_test(test_sun__direction_moves_from_start_to_end),
        cmocka_unit_test(test_path__an_orbit_keeps_its_distance_and_closes),
        cmocka_unit_test(test_path__an_orbit_rises_to_straight_above_and_no_farther),
        cmocka_unit_test(test_view__angles_are_those_of_the_eye_around_its_target),
        cmocka_unit_test(test_path__an_approach_shrinks_the_distance_in_equal_ratios),
        cmocka_unit_test(test_path__keys_are_passed_and_a_straight_line_stays_straight),
        cmocka_unit_test(test_path__frames_of_a_closed_orbit_do_not_repeat_the_first),
        cmocka_unit_test(test_path__a_walk_follows_the_ground_and_clearance_lifts_a_flight),
        cmocka_unit_test(test_sphere__one_that_reaches_into_the_frustum_is_never_culled),
        cmocka_unit_test(test_instance__matrix_is_shift_turn_and_scale_of_cglm),
        cmocka_unit_test(test_depths__hold_every_tree_and_lose_nothing_near),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
