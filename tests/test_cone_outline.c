/* Conifers of few pixels and less: what they cover, against the ray tracer's picture of the same
 * tree from the same place, large. And the eye within one's trunk. */
#include "conifer_world.h"

#include "bake/cone_outline.h"
#include "conform/world_conifer.h"

static const double DISTANCE_M = 3000, TREE_M = 20;

/* One tree, prepared once. */
struct lone {
    struct world world;
    struct error error;
    struct workspace workspace;
    struct cones *cones;
};

static void lone_create(struct lone *lone)
{
    *lone = (struct lone){.world = world_create(16, 16, 0.1)};
    plant_add(&lone->world, world_conifer(lone->world.arena));
    world_sun(&lone->world, 0.5, 0.7, 0.4);
    lone->workspace =
        (struct workspace){.arena = lone->world.arena, .error = &lone->error, .threads = 1};
    struct cones_options options = options_of(-1);
    options.choice.thin = 4;
    if (cones_prepare(&lone->workspace, &lone->world.scene, &options, &lone->cones))
        fail_msg("%s", lone->error.text);
}

static struct frame *lone_drawn(struct lone *lone)
{
    const struct view *view = &lone->world.view;
    struct frame *frame = frame_create(lone->world.arena, view->width_px, view->height_px, false);
    struct target target = {.width_px = view->width_px,
                            .height_px = view->height_px,
                            .format = TARGET_RGBA32F,
                            .pixels = frame->rgba};
    assert_int_equal(cones_draw(&lone->workspace, lone->cones, view, &target), STATUS_OK);
    return frame;
}

/* The tree, so high, somewhere around the picture's middle and turned somehow. */
static void lone_look(struct lone *lone, double elevation_rad, double height_px, int place)
{
    struct scene *scene = &lone->world.scene;
    const int side_px = 8 + 2 * (int)height_px;
    const double pixel_m = TREE_M / height_px, turn_rad = 2.4 * place;
    const double c = cos(elevation_rad), s = sin(elevation_rad);
    const double right_m = pixel_m * fmod(0.7548776662466927 * place, 1);
    const double up_m = pixel_m * fmod(0.5698402909980532 * place, 1);
    const double shift_m[3] = {right_m * cos(turn_rad) - up_m * s * sin(turn_rad),
                               0.5 * TREE_M + up_m * c,
                               -right_m * sin(turn_rad) - up_m * s * cos(turn_rad)};
    scene->width_px = scene->height_px = side_px;
    scene->camera.fov_y_rad = (float)(2 * atan(0.5 * pixel_m * side_px / DISTANCE_M));
    world_look(&lone->world, (float)(shift_m[0] + DISTANCE_M * c * sin(turn_rad)),
               (float)(shift_m[1] + DISTANCE_M * s),
               (float)(shift_m[2] + DISTANCE_M * c * cos(turn_rad)), (float)shift_m[0],
               (float)shift_m[1], (float)shift_m[2]);
}

/* m^2 */
static double lone_covers(struct lone *lone, double elevation_rad, double height_px, bool traced,
                          int places)
{
    const double pixel_m = TREE_M / height_px;
    const struct reference_options tracer = {.samples_min = 16, .samples_max = 16, .threads = 2};
    double sum = 0;
    for (int place = 0; place < places; place++) {
        struct reference_stats stats;
        lone_look(lone, elevation_rad, height_px, place);
        struct frame *frame =
            traced ? world_render(&lone->world, tracer, &stats) : lone_drawn(lone);
        sum += pixel_m * pixel_m * sum_of(frame, 3) / places;
    }
    return sum;
}

static void test_outline__a_tree_of_any_size_covers_what_is_traced(void **state)
{
    (void)state;
    static const double elevations_rad[] = {0, 0.35, 1.05, 1.57};
    static const double heights_px[] = {0.1, 0.25, 0.5, 0.7, 1, 1.4, 2, 3, 4, 6, 8, 12, 16, 30, 60};
    struct lone lone;
    lone_create(&lone);
    for (size_t e = 0; e < 4; e++) {
        const double traced = lone_covers(&lone, elevations_rad[e], 48, true, 3);
        double before = 0;
        for (size_t k = 0; k < sizeof heights_px / sizeof *heights_px; k++) {
            /* a small tree's few twigs are others from every side */
            const int places = heights_px[k] < 3 ? 32 : 8;
            double covered = lone_covers(&lone, elevations_rad[e], heights_px[k], false, places);
            double ratio = covered / traced;
            if (!(fabs(ratio - 1) < 0.1))
                fail_msg("%.2f rad, %.2f px: %.3f of what is traced", elevations_rad[e],
                         heights_px[k], ratio);
            if (k > 0 && !(fabs(ratio - before) < 0.08))
                fail_msg("%.2f rad, %.2f px: from %.3f to %.3f", elevations_rad[e], heights_px[k],
                         before, ratio);
            before = ratio;
        }
    }
    arena_destroy(lone.world.arena);
}

/* Halves of a body's depth within a pixel: what they leave is what the body leaves of it. */
static void test_outline__parts_of_a_body_in_a_pixel_cover_its_share_of_it(void **state)
{
    (void)state;
    static const float depth = 3, sides_px[] = {1e-4f, 0.01f, 0.3f, 1, 2};
    for (size_t k = 0; k < sizeof sides_px / sizeof *sides_px; k++) {
        const float half_m = 0.5f, eye[3] = {0, 0, 1}, middle_m[3] = {0, 0, 0};
        struct cone_outline outline = {
            .low_m = -half_m, .rows_per_m = CONE_ROWS / (2 * half_m), .half_m = half_m};
        for (int i = 0; i < CONE_ROWS; i++)
            outline.halves_m[i] = half_m;
        for (int i = 0; i < CONE_RISES; i++)
            outline.depths[i] = depth;
        const double part = (double)cone_outline_part(&outline, middle_m, 0, eye, sides_px[k]);
        /* a pixel whose square's middle is anywhere within one of the body's middle */
        const double side = (double)sides_px[k];
        const double share = side < 2 ? pow(side - side * side / 4, 2) : 1;
        const double left = exp(-part * share * (double)depth);
        assert_float_equal((1 - left) / (share * (1 - exp(-(double)depth))), 1, 1e-3);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_outline__a_tree_of_any_size_covers_what_is_traced),
        cmocka_unit_test(test_outline__parts_of_a_body_in_a_pixel_cover_its_share_of_it),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
