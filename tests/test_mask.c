/* Shadow masks: the traced one against a closed form, the error against masks made by hand. */
#include "reference_world.h"
#include "truth/mask.h"

/* A mask of width x height px: red is lit, green 1. */
static struct frame *mask_of_lit(struct arena *arena, int width_px, int height_px,
                                 float (*lit)(int x, int y))
{
    struct frame *frame = frame_create(arena, width_px, height_px, false);
    for (int y = 0; y < height_px; y++)
        for (int x = 0; x < width_px; x++) {
            float *rgba = frame->rgba + 4 * (y * width_px + x);
            rgba[0] = lit(x, y);
            rgba[1] = 1;
        }
    return frame;
}

static struct mask_error compare(const struct frame *test, const struct frame *truth)
{
    struct mask_error mask;
    struct error error = {0};
    if (mask_compare(test, truth, &mask, &error))
        fail_msg("%s", error.text);
    return mask;
}

static float left_dark(int x, int y)
{
    (void)y;
    return x < 10 ? 0 : 1;
}

static float left_dark_late(int x, int y)
{
    (void)y;
    return x < 14 ? 0 : 1;
}

static float spot_missing(int x, int y)
{
    return x < 10 && !(x == 3 && y == 5) ? 0 : 1;
}

#define NEAR(a, b) assert_true(fabs((double)(a) - (double)(b)) < 1e-6)

static void test_mask__a_late_edge_is_wrong_by_its_strip(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    const struct frame *truth = mask_of_lit(arena, 40, 20, left_dark);
    struct mask_error same = compare(truth, truth);
    assert_true(same.wrong == 0 && same.leak == 0 && same.acne == 0 && same.stray == 0);
    assert_true(isnan(same.edge_px) && isnan(same.shimmer) && same.judged == 1);
    NEAR(same.dark, 10.0 / 40);
    struct mask_error late = compare(mask_of_lit(arena, 40, 20, left_dark_late), truth);
    NEAR(late.wrong, 4.0 / 40);
    NEAR(late.acne, 4.0 / 40);
    NEAR(late.leak, 0);
    NEAR(late.edge_px, (0.5 + 1.5 + 2.5 + 3.5) / 4); /* the edge is between pixels 9 and 10 */
    NEAR(late.stray, 2.0 / 40);
    arena_destroy(arena);
}

static void test_mask__a_lit_spot_in_a_shadow_leaks_where_it_is(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct mask_error spot =
        compare(mask_of_lit(arena, 40, 20, spot_missing), mask_of_lit(arena, 40, 20, left_dark));
    NEAR(spot.leak, 1.0 / 800);
    NEAR(spot.wrong, spot.leak);
    NEAR(spot.stray, spot.leak);
    NEAR(spot.edge_px, 6.5);
    arena_destroy(arena);
}

static void test_mask__pixels_that_are_no_surface_in_both_are_not_judged(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct frame *test = mask_of_lit(arena, 40, 20, left_dark_late);
    struct frame *truth = mask_of_lit(arena, 40, 20, left_dark);
    for (int i = 0; i < 200; i++) { /* the upper quarter: sky for the test */
        memset(test->rgba + 4 * i, 0, 4 * sizeof(float));
    }
    struct mask_error mask = compare(test, truth);
    NEAR(mask.judged, 0.75);
    NEAR(mask.wrong, 4.0 / 40);
    memset(test->rgba, 0, 40 * 20 * 4 * sizeof(float));
    mask = compare(test, truth);
    assert_true(mask.judged == 0 && isnan(mask.wrong) && isnan(mask.dark));
    struct error error = {0};
    assert_int_equal(mask_compare(mask_of_lit(arena, 8, 8, left_dark), truth, &mask, &error),
                     STATUS_INVALID);
    arena_destroy(arena);
}

static void test_mask__shimmer_is_what_moves_and_should_not(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    const struct frame *early = mask_of_lit(arena, 40, 20, left_dark);
    const struct frame *late = mask_of_lit(arena, 40, 20, left_dark_late);
    struct error error = {0};
    double shimmer;
    /* A constant error does not shimmer; a true motion that is followed neither. */
    assert_int_equal(mask_shimmer((const struct frame *[]){late, late},
                                  (const struct frame *[]){early, early}, &shimmer, &error),
                     STATUS_OK);
    assert_true(shimmer == 0);
    assert_int_equal(mask_shimmer((const struct frame *[]){early, late},
                                  (const struct frame *[]){early, late}, &shimmer, &error),
                     STATUS_OK);
    assert_true(shimmer == 0);
    assert_int_equal(mask_shimmer((const struct frame *[]){early, late},
                                  (const struct frame *[]){early, early}, &shimmer, &error),
                     STATUS_OK);
    NEAR(shimmer, 4.0 / 40);
    arena_destroy(arena);
}

/* A box of 2 x 3 x 2 m on the plane y = 0, about the origin. */
static struct mesh *box_mesh(struct arena *arena)
{
    static const int faces[6][4] = {{0, 1, 3, 2}, {4, 6, 7, 5}, {0, 4, 5, 1},
                                    {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 5, 7, 3}};
    double corners[8][3];
    for (int i = 0; i < 8; i++) {
        corners[i][0] = i & 4 ? 1 : -1;
        corners[i][1] = i & 2 ? 3 : 0;
        corners[i][2] = i & 1 ? 1 : -1;
    }
    struct mesh *mesh = mesh_new(arena, MATERIAL_BARK, 0.5f, 12);
    for (int f = 0; f < 6; f++)
        mesh_quad(mesh, corners[faces[f][0]], corners[faces[f][1]], corners[faces[f][2]],
                  corners[faces[f][3]]);
    return mesh_finish(arena, mesh);
}

/* Whether the way from a point of the plane to the sun meets the box: its slabs. */
static bool box_shades(double x, double z, const float sun[3])
{
    const double low[3] = {-1, 0, -1}, high[3] = {1, 3, 1}, from[3] = {x, 0, z};
    double near = 0, far = INFINITY;
    for (int i = 0; i < 3; i++) {
        double a = (low[i] - from[i]) / (double)sun[i], b = (high[i] - from[i]) / (double)sun[i];
        near = fmax(near, fmin(a, b));
        far = fmin(far, fmax(a, b));
    }
    return near < far;
}

/* Seen from straight above, a box's shadow is a closed form, and so is its share of the ground. */
static void test_mask__a_box_on_a_plane_shades_what_its_slabs_say(void **state)
{
    (void)state;
    enum { SIDE = 48 };
    struct world world = world_create(SIDE, SIDE, 0.4);
    world.scene.terrain = level_ground(world.arena, 100, 0.5f);
    world_add(&world, box_mesh(world.arena), 0, 0, 0);
    world_look(&world, -2, 30, -2, -2, 0, -2);
    world_sun(&world, 0.48, 0.6, 0.64);
    struct frame *mask = world_render(
        &world,
        (struct reference_options){.effects = EFFECT_SUN_SHADOWS | EFFECT_AMBIENT | EFFECT_FOG,
                                   .masked = true,
                                   .samples_min = 16,
                                   .samples_max = 16},
        NULL);
    double dark = 0, traced = 0;
    for (int y = 0; y < SIDE; y++)
        for (int x = 0; x < SIDE; x++) {
            const float *rgba = mask->rgba + 4 * (y * SIDE + x);
            int shaded = 0;
            assert_true(rgba[1] == 1 && rgba[2] == 0);
            if (rgba[3] > 0)
                continue; /* the box itself */
            for (int k = 0; k < 64; k++) {
                float ray[3];
                view_ray(&world.view, (float)x + ((float)(k % 8) + 0.5f) / 8,
                         (float)y + ((float)(k / 8) + 0.5f) / 8, ray);
                double far = -30.0 / (double)ray[1];
                shaded += box_shades(-2 + far * (double)ray[0], -2 + far * (double)ray[2],
                                     world.view.sun_direction);
            }
            dark += shaded / 64.0;
            traced += 1 - (double)rgba[0];
            assert_true(shaded != 0 || rgba[0] > 0.9f);
            assert_true(shaded != 64 || rgba[0] < 0.1f);
        }
    if (!(dark > 100 && fabs(dark - traced) < 0.01 * dark))
        fail_msg("%g px are dark, %g traced", dark, traced);
    arena_destroy(world.arena);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_mask__a_late_edge_is_wrong_by_its_strip),
        cmocka_unit_test(test_mask__a_lit_spot_in_a_shadow_leaks_where_it_is),
        cmocka_unit_test(test_mask__pixels_that_are_no_surface_in_both_are_not_judged),
        cmocka_unit_test(test_mask__shimmer_is_what_moves_and_should_not),
        cmocka_unit_test(test_mask__a_box_on_a_plane_shades_what_its_slabs_say),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
