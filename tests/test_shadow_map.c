/* Shadow maps: splits, slices, biases and still texels against closed forms and brute force; masks
 * against the traced ones; settings at both ends. */
#include "shadow_world.h"

#include "bake/shadow_math.h"
#include "base/random.h"
#include "cell/cell.h"

#include <math.h>
#include <string.h>

static struct view view_of(double near_m, double far_m, const float eye_m[3],
                           const float target_m[3])
{
    struct scene scene = {.width_px = 1920, .height_px = 1080};
    scene.camera.fov_y_rad = (float)(M_PI / 3);
    scene.camera.near_m = (float)near_m;
    scene.camera.far_m = (float)far_m;
    struct view view;
    view_look_at(&scene, eye_m, target_m, &view);
    return view;
}

static void test_shadow_map__splits_are_equal_ratios_and_equal_lengths_at_their_ends(void **state)
{
    (void)state;
    double ends[5];
    shadow_splits(0.5, 500, 1, 4, ends);
    for (int i = 0; i <= 4; i++)
        assert_true(fabs(ends[i] / (0.5 * pow(1000, i / 4.0)) - 1) < 1e-12);
    shadow_splits(0.5, 500, 0, 4, ends);
    for (int i = 0; i <= 4; i++)
        assert_true(fabs(ends[i] - (0.5 + 499.5 * i / 4)) < 1e-9);
    shadow_splits(1e-3, 1e6, 0.5, 4, ends);
    for (int i = 0; i < 4; i++)
        assert_true(ends[i] < ends[i + 1]);
}

/* Texels a pixel at a cascade's near end: figures of shared/formulas.md, section 8. */
static void test_shadow_map__aliasing_at_the_near_ends_is_as_computed_apart(void **state)
{
    (void)state;
    static const double lambdas[] = {1, 0.9},
                        wanted[2][4] = {{6.05, 6.05, 6.05, 6.05}, {32, 2.8, 3.2, 4.6}};
    struct view view = view_of(0.5, 500, (float[]){0, 2, 0}, (float[]){0, 2, -1});
    for (int k = 0; k < 2; k++) {
        double ends[5];
        shadow_splits(0.5, 500, lambdas[k], 4, ends);
        for (int c = 0; c < 4; c++) {
            struct shadow_sphere sphere =
                shadow_sphere_of(ends[c], ends[c + 1], shadow_spread2(&view));
            double aliasing = 2 * sphere.radius_m / 2048 /
                              (2 * ends[c] * tan(0.5 * (double)view.fov_y_rad) / 1080);
            if (fabs(aliasing / wanted[k][c] - 1) > 0.02)
                fail_msg("lambda %g, cascade %d: %g, not %g", lambdas[k], c, aliasing,
                         wanted[k][c]);
        }
    }
}

/* The farthest corner of a slice from a point of its axis. */
static double slice_radius(double near, double far, double spread2, double depth)
{
    return sqrt(fmax((near - depth) * (near - depth) + near * near * spread2,
                     (far - depth) * (far - depth) + far * far * spread2));
}

static void test_shadow_map__no_smaller_sphere_on_the_axis_holds_the_slice(void **state)
{
    (void)state;
    struct random random = random_seed(4, 0);
    for (int i = 0; i < 200; i++) {
        double near = 0.1 + random_double(&random),
               far = near * (1.1 + 20 * random_double(&random));
        double spread2 = 3 * random_double(&random);
        struct shadow_sphere sphere = shadow_sphere_of(near, far, spread2);
        double holds = slice_radius(near, far, spread2, sphere.depth_m), least = INFINITY;
        assert_true(holds <= sphere.radius_m * (1 + 1e-9));
        for (int step = 0; step <= 4000; step++)
            least = fmin(least, slice_radius(near, far, spread2, far * step / 2000));
        assert_true(sphere.radius_m <= least * (1 + 1e-9) && sphere.radius_m > least * (1 - 1e-3));
    }
}

static void place(const struct shadow_fit *fit, const double world[3], double at[3])
{
    double clip[4];
    for (int row = 0; row < 4; row++) {
        clip[row] = fit->matrix[3][row];
        for (int i = 0; i < 3; i++)
            clip[row] += fit->matrix[i][row] * world[i];
    }
    for (int i = 0; i < 3; i++)
        at[i] = clip[i] / clip[3];
}

static const struct shadow_box everything = {{-1e4, -1e4, -1e3}, {1e4, 1e4, 1e3}};

/* The same points of the world lie at the same places within their texels, of the same size. */
static void test_shadow_map__stable_texels_stand_still_while_the_eye_moves(void **state)
{
    (void)state;
    enum { SIZE = 512 };
    struct random random = random_seed(9, 0);
    double axes[3][3], worst = 0, moving = 0;
    shadow_axes((float[]){0.48f, 0.6f, 0.64f}, axes);
    struct shadow_fit first[2];
    for (int i = 0; i < 60; i++) {
        float eye[3], target[3];
        for (int k = 0; k < 3; k++) {
            eye[k] = 30 * random_float(&random);
            target[k] = eye[k] + random_float(&random) - 0.5f;
        }
        struct view view = view_of(1, 200, eye, target);
        for (int stable = 0; stable < 2; stable++) {
            struct shadow_request request = {.view = &view,
                                             .near_m = 5,
                                             .far_m = 40,
                                             .size_px = SIZE,
                                             .stable = stable == 1,
                                             .casters = everything};
            struct shadow_fit fit;
            shadow_fit(&request, (const double(*)[3])axes, &fit);
            if (i == 0)
                first[stable] = fit;
            double world[3] = {3.7, 1.9, -11.3}, a[3], b[3];
            place(&first[stable], world, a);
            place(&fit, world, b);
            for (int k = 0; k < 2; k++) {
                double shift = 0.5 * SIZE * (b[k] - a[k]);
                double away =
                    fabs(shift - rint(shift)) + fabs(fit.texel_m[k] / first[stable].texel_m[k] - 1);
                *(stable ? &worst : &moving) = fmax(stable ? worst : moving, away);
            }
        }
    }
    assert_true(worst < 1e-6 && moving > 0.1);
}

/* Whatever the sun: every corner of the slice within the map, what is nearer to the sun is nearer
 * in the map; the perspective map is finer near the eye. */
static void test_shadow_map__every_fit_holds_its_slice_under_any_sun(void **state)
{
    (void)state;
    static const float suns[][3] = {{0, 1, 0}, {0, -1, 0}, {1, 0, 0},       {-1, 0, 0},
                                    {0, 0, 1}, {0, 0, -1}, {0.6f, 0, 0.8f}, {0.0349f, 0.9994f, 0}};
    struct view view = view_of(0.1, 1e5, (float[]){10, 3, 4}, (float[]){11, 2.5f, -9});
    for (int way = 0; way < 3; way++)
        for (size_t s = 0; s < sizeof suns / sizeof *suns; s++) {
            double axes[3][3];
            struct shadow_fit fit;
            shadow_axes(suns[s], axes);
            struct shadow_request request = {.view = &view,
                                             .near_m = 0.5,
                                             .far_m = 90,
                                             .size_px = 256,
                                             .stable = way == 1,
                                             .perspective = way == 2,
                                             .casters = everything};
            shadow_fit(&request, (const double(*)[3])axes, &fit);
            for (int k = 0; k < 8; k++) {
                double depth = k & 4 ? 90 : 0.5, up = tan(M_PI / 6), at[3], before[3];
                double across = (k & 1 ? 1 : -1) * up * 16 / 9 * depth;
                double along = (k & 2 ? 1 : -1) * up * depth, world[3], toward[3];
                for (int i = 0; i < 3; i++) {
                    world[i] = (double)view.eye_m[i] + depth * (double)view.forward[i] +
                               across * (double)view.right[i] + along * (double)view.up[i];
                    toward[i] = world[i] + (double)suns[s][i];
                }
                place(&fit, world, at);
                place(&fit, toward, before);
                assert_true(fabs(at[0]) < 1 + 1e-5 && fabs(at[1]) < 1 + 1e-5);
                assert_true(before[2] < at[2] && fabs(before[0] - at[0]) < 1e-5);
            }
        }
}

/* The needed bias by brute force: a plane is stored at its texels' centres, points of it look at
 * (2k + 1)^2 of them. */
static void test_shadow_map__the_bias_of_the_closed_form_is_enough_and_none_less_is(void **state)
{
    (void)state;
    struct random random = random_seed(5, 0);
    const double texel_m[2] = {0.3, 0.3};
    for (int k = 0; k < 3; k++)
        for (int turn = 0; turn < 5; turn++) {
            double angle = 0.3 * turn, gx = 2 * cos(angle), gy = 2 * sin(angle), needed = 0;
            for (int i = 0; i < 20000; i++) {
                double x = random_double(&random), y = random_double(&random);
                for (int dy = -k; dy <= k; dy++)
                    for (int dx = -k; dx <= k; dx++) /* towards the light: minus */
                        needed =
                            fmax(needed, gx * 0.3 * (x - dx - 0.5) + gy * 0.3 * (y - dy - 0.5));
            }
            double bound = shadow_bias_m(k + 0.5, texel_m, gx, gy);
            assert_true(needed <= bound && needed > 0.97 * bound);
            assert_true(bound <= (k + 0.5) * sqrt(2) * 0.3 * 2 * (1 + 1e-12));
        }
}

/* The lit height of a valley of two slopes, along x of a map's texels. */
static double valley(double x, const double slopes[2])
{
    return fmax(slopes[0] * x, slopes[1] * x);
}

/* The rule is of planes. Where two meet in a valley, taps beyond the fold rise by the other's
 * slope: a bias by the receiver's own is too small beside it, the steeper one's is enough. */
static void test_shadow_map__in_a_valley_the_steeper_side_says_what_bias_is_enough(void **state)
{
    (void)state;
    static const double slopes[2] = {0.2, 1.1}, texel_m[2] = {0.3, 0.3};
    struct random random = random_seed(6, 0);
    for (int k = 0; k < 3; k++) {
        double needed = 0; /* where the slope is the smaller one */
        for (int i = 0; i < 50000; i++) {
            double at = -1 * random_double(&random), fold = 0.3 * random_double(&random);
            double first = 0.3 * floor((at - fold) / 0.3) + fold + 0.15;
            for (int dx = -k; dx <= k; dx++)
                needed = fmax(needed, valley(first + 0.3 * dx, slopes) - valley(at, slopes));
        }
        double own = shadow_bias_m(k + 0.5, texel_m, slopes[0], 0);
        double steeper = shadow_bias_m(k + 0.5, texel_m, slopes[1], 0);
        if (!(needed > 2 * own && needed <= steeper && needed > 0.97 * steeper))
            fail_msg("%d taps: needed %g, own %g, steeper %g", 2 * k + 1, needed, own, steeper);
    }
}

#define STAIRS "/trees=1/size=64x48"

static void test_shadow_map__a_closed_mesh_has_no_acne_with_bias_and_much_without(void **state)
{
    (void)state;
    struct mask_error right, none, much;
    cell_masks("stairs/shadow-map:size=256,linear=off,reach_m=40" STAIRS, 1, &right);
    cell_masks("stairs/shadow-map:bias=none,size=256,linear=off,reach_m=40" STAIRS, 1, &none);
    cell_masks("stairs/shadow-map:bias_scale=60,size=256,linear=off,reach_m=40" STAIRS, 1, &much);
    if (!(right.judged > 0.95 && right.wrong < 0.03 && right.stray < 0.01))
        fail_msg("wrong %g, leak %g, acne %g, stray %g, judged %g", right.wrong, right.leak,
                 right.acne, right.stray, right.judged);
    if (!(none.acne > 4 * right.acne + 0.02 && none.leak < right.leak + 0.005))
        fail_msg("without bias: leak %g, acne %g", none.leak, none.acne);
    if (!(much.leak > 2 * right.leak + 0.01 && much.acne < right.acne + 0.005))
        fail_msg("with much bias: leak %g, acne %g", much.leak, much.acne);
}

/* Where a pixel reaches over many texels of the map, those between the taps count as well. */
static void test_shadow_map__a_finer_map_is_no_worse_than_a_coarse_one(void **state)
{
    (void)state;
    struct mask_error coarse, fine;
    cell_masks("stairs/shadow-map:size=512/trees=2/size=64x48", 1, &coarse); /* an oak, too */
    cell_masks("stairs/shadow-map:size=2048/trees=2/size=64x48", 1, &fine);
    if (!(fine.wrong < 1.1 * coarse.wrong))
        fail_msg("wrong with 512 texels %g, with 2048 %g", coarse.wrong, fine.wrong);
}

static enum status take_nothing(void *context, size_t index, const struct frame *frame,
                                struct error *error)
{
    (void)context, (void)index, (void)frame, (void)error;
    return STATUS_OK;
}

/* Everything at both ends draws a finite picture. */
static void test_shadow_map__settings_at_both_ends_draw_finite_pictures(void **state)
{
    (void)state;
    static const char *const settings[] = {
        "size=256,cascades=4,depth=16,bias=none,split=0,taps=7",
        "size=256,cascades=4,depth=24,bias=constant,bias_scale=100,split=1,stable=off",
        "size=256,cascades=3,depth=32,bias=plane,perspective=on,taps=5",
        "size=256,cascades=2,bias=normal,foliage=deep,layer_m=0.001,reach_m=1000000",
        "size=256,foliage=alpha,bias_scale=0,caster_tx=64,reach_m=0.001"};
    struct arena *arena = arena_create(0);
    struct scene *scene;
    struct error error = {0};
    struct scene_request wanted = {.trees = 2, .width_px = 32, .height_px = 24};
    if (scene_load(arena, "tiny", &wanted, &scene, &error))
        fail_msg("%s", error.text);
    for (size_t i = 0; i < sizeof settings / sizeof *settings; i++) {
        const char *cell =
            arena_printf(arena, "tiny/shadow-map:%s/trees=2/size=32x24", settings[i]);
        struct plan *plan;
        struct plan_request request = {.cells = &cell, .cells_count = 1, .rounds = 1};
        if (plan_load(arena, &request, &plan, &error))
            fail_msg("%s", error.text);
        struct view views[5];
        static const float suns[5][3] = {
            {0, 1, 0}, {1, 0, 0}, {0, 0, -1}, {0, -1, 0}, {0.6f, 0.8f, 0}};
        for (int k = 0; k < 5; k++) {
            view_at(scene, 0.2 * k, &views[k]);
            memcpy(views[k].sun_direction, suns[k], sizeof suns[k]);
        }
        struct cell_taker taker = {.take = take_nothing}; /* the pictures are checked before */
        if (cell_render_views(plan->cells, views, 5, NULL, &taker, &error))
            fail_msg("%s: %s", settings[i], error.text);
    }
    arena_destroy(arena);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_shadow_map__splits_are_equal_ratios_and_equal_lengths_at_their_ends),
        cmocka_unit_test(test_shadow_map__aliasing_at_the_near_ends_is_as_computed_apart),
        cmocka_unit_test(test_shadow_map__no_smaller_sphere_on_the_axis_holds_the_slice),
        cmocka_unit_test(test_shadow_map__stable_texels_stand_still_while_the_eye_moves),
        cmocka_unit_test(test_shadow_map__every_fit_holds_its_slice_under_any_sun),
        cmocka_unit_test(test_shadow_map__the_bias_of_the_closed_form_is_enough_and_none_less_is),
        cmocka_unit_test(test_shadow_map__in_a_valley_the_steeper_side_says_what_bias_is_enough),
        cmocka_unit_test(test_shadow_map__a_closed_mesh_has_no_acne_with_bias_and_much_without),
        cmocka_unit_test(test_shadow_map__a_finer_map_is_no_worse_than_a_coarse_one),
        cmocka_unit_test(test_shadow_map__settings_at_both_ends_draw_finite_pictures),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
