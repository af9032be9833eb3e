/* Needles and branches in the reference: round, lit on the outside, against closed forms and
 * against prisms of many sides. */
#include "plant/conifer.h"
#include "reference_world.h"

static struct conifer *conifer_new(struct arena *arena, const struct conifer_twig *twig,
                                   float albedo)
{
    struct conifer *conifer = ARENA_NEW(arena, struct conifer);
    conifer->branches_count = conifer->twigs_count = 1;
    conifer->branches = ARENA_NEW(arena, struct conifer_branch);
    /* Below all that is looked at. */
    *conifer->branches = (struct conifer_branch){{0, -90, 0}, {0, -89, 0}, 0.1f, 0.1f, 0, 1};
    conifer->twigs = ARENA_NEW(arena, struct conifer_twig);
    *conifer->twigs = *twig;
    for (int i = 0; i < 3; i++)
        conifer->needle_albedo[i] = conifer->bark_albedo[i] = albedo;
    assert_int_equal(conifer_finish(conifer, NULL), STATUS_OK);
    return conifer;
}

static void world_plant(struct world *world, struct plant *plant)
{
    struct scene *scene = &world->scene;
    scene->species[scene->species_count] = (struct species){"test", plant, 1, 1, 1};
    scene->instances[scene->instances_count++] =
        (struct instance){{0, 0, 0}, 0, 1, (uint32_t)scene->species_count++, 1};
}

enum { SIDE_PX = 48 };
static const double distance_m = 200, seen_m = 1.6;

/* A square of seen_m metres around the origin, almost in parallel. */
static struct world world_of(double x, double y, double z)
{
    struct world world = world_create(SIDE_PX, SIDE_PX, 2 * atan(seen_m / 2 / distance_m));
    world_look(&world, (float)(x * distance_m), (float)(y * distance_m), (float)(z * distance_m), 0,
               0, 0);
    return world;
}

/* One needle of length 1 and radius 0.03 along x, the eye at +z, the sun at the angle D around it
 * and at the sine s_l to it: R_d = s_l / 4 (sin D + (pi - D) cos D), Hattab et al., Eq 2. */
static void test_needle__reflects_what_the_closed_form_of_a_cylinder_says(void **state)
{
    (void)state;
    static const double rows[][2] = {{0, 1}, {1, 0.9}, {M_PI / 2, 1}, {2.2, 0.7}, {3, 1}};
    static const unsigned effects[] = {0, EFFECT_SUN_SHADOWS};
    for (size_t k = 0; k < 5; k++)
        for (size_t e = 0; e < 2; e++) {
            struct world world = world_of(0, 0, 1);
            double angle = rows[k][0], sine = rows[k][1], error, area = seen_m * seen_m;
            struct conifer_twig twig = {.base_m = {-0.5f, 0, 0},
                                        .axis = {1, 0, 0},
                                        .length_m = 1e-4f,
                                        .axis_radius_m = 1e-5f,
                                        .cones_count = 1,
                                        .needles_count = 1,
                                        .needle_length_m = 1,
                                        .needle_radius_m = 0.03f};
            world_plant(&world, plant_from_conifer(world.arena, "needle",
                                                   conifer_new(world.arena, &twig, 0.8f)));
            world_sun(&world, sqrt(1 - sine * sine), sine * sin(angle), sine * cos(angle));
            struct frame *frame =
                world_render(&world,
                             (struct reference_options){
                                 .effects = effects[e], .samples_min = 512, .samples_max = 512},
                             NULL);
            double covered = 2 * 0.03,
                   reflected = sine / 4 * (sin(angle) + (M_PI - angle) * cos(angle));
            double alpha = frame_mean(frame, 3, &error) * area;
            assert_float_equal(alpha, covered, 4 * error * area + 1e-4 * covered);
            double light = frame_mean(frame, 0, &error) * area / 0.8 / covered;
            assert_float_equal(light, reflected, 4 * error * area / 0.8 / covered + 2e-4);
            arena_destroy(world.arena);
        }
}

/* The same needle, black: what shines is the mean over its width of (N.H)^n where N.L > 0. */
static void test_needle__shines_as_the_quadrature_of_its_lobe_says(void **state)
{
    (void)state;
    static const double rows[][3] = {{0, 0.6, 1}, {1, 1, 0.9}, {20, 1.5, 1}, {10000, 0.8, 1}};
    for (size_t k = 0; k < 4; k++) {
        struct world world = world_of(0, 0, 1);
        double n = rows[k][0], angle = rows[k][1], sine = rows[k][2], error, shines = 0;
        double sun[3] = {sqrt(1 - sine * sine), sine * sin(angle), sine * cos(angle)};
        struct conifer_twig twig = {.base_m = {-0.5f, 0, 0},
                                    .axis = {1, 0, 0},
                                    .length_m = 1e-4f,
                                    .axis_radius_m = 1e-5f,
                                    .cones_count = 1,
                                    .needles_count = 1,
                                    .needle_length_m = 1,
                                    .needle_radius_m = 0.03f};
        struct conifer *conifer = conifer_new(world.arena, &twig, 0);
        conifer->needle_specular = 0.7f;
        conifer->needle_exponent = (float)n;
        world_plant(&world, plant_from_conifer(world.arena, "needle", conifer));
        world_sun(&world, sun[0], sun[1], sun[2]);
        for (int i = 0; i < 20000; i++) {
            double t = M_PI * ((i + 0.5) / 20000 - 0.5), normal[2] = {sin(t), cos(t)};
            double facing = normal[0] * sun[1] + normal[1] * sun[2];
            double along = (facing + normal[1]) / sqrt(2 + 2 * sun[2]);
            shines += facing > 0 ? M_PI / 20000 * cos(t) / 2 * pow(along, n) : 0;
        }
        for (unsigned on = 0; on < 2; on++) {
            struct frame *frame = world_render(
                &world,
                (struct reference_options){
                    .effects = on ? EFFECT_SPECULAR : 0u, .samples_min = 512, .samples_max = 512},
                NULL);
            double unit = seen_m * seen_m / 0.7 / (2 * 0.03);
            double light = frame_mean(frame, 0, &error) * unit;
            assert_float_equal(light, on ? shines : 0, 4 * error * unit + 5e-3 * shines);
        }
        arena_destroy(world.arena);
    }
}

/* A cylinder with flat ends covers 2 r l s + pi r^2 |c|, and its end is lit as a plane: seen at 10
 * degrees to the axis, with the sun across the axis, only the side is; a rounded end would be too.
 */
static void test_needle__has_flat_ends(void **state)
{
    (void)state;
    static const double tilts[] = {0.15, 0.5, 1.1};
    for (size_t k = 0; k < 3; k++) {
        double s = sin(tilts[k]), c = cos(tilts[k]), error, area = seen_m * seen_m;
        struct world world = world_of(0, s, c);
        struct conifer_twig twig = {.base_m = {0, 0, -0.3f},
                                    .axis = {0, 0, 1},
                                    .length_m = 1e-4f,
                                    .axis_radius_m = 1e-5f,
                                    .cones_count = 1,
                                    .needles_count = 1,
                                    .needle_length_m = 0.6f,
                                    .needle_radius_m = 0.3f};
        world_plant(&world,
                    plant_from_conifer(world.arena, "needle", conifer_new(world.arena, &twig, 1)));
        world_sun(&world, 0, -1, 1e-6);
        struct frame *frame = world_render(
            &world, (struct reference_options){.samples_min = 512, .samples_max = 512}, NULL);
        double covered = 2 * 0.3 * 0.6 * s + M_PI * 0.09 * c;
        double alpha = frame_mean(frame, 3, &error) * area;
        assert_float_equal(alpha, covered, 4 * error * area + 1e-3 * covered);
        assert_float_equal(frame_mean(frame, 1, &error), 0, 1e-5);
        arena_destroy(world.arena);
    }
}

static const struct conifer_twig bushy_twig = {.base_m = {0, -0.3f, 0},
                                               .axis = {0, 1, 0},
                                               .length_m = 0.6f,
                                               .axis_radius_m = 0.02f,
                                               .cones_count = 6,
                                               .spacing_m = 0.1f,
                                               .needles_count = 12,
                                               .needle_length_m = 0.3f,
                                               .needle_radius_m = 0.012f,
                                               .needle_angle_rad = 0.8f,
                                               .azimuth_rad = 0.1f,
                                               .azimuth_step_rad = 0.7f};

static void twig_picture(double x, double y, double z, uint32_t sides, double sums[2])
{
    struct world world = world_of(x, y, z);
    struct conifer *conifer = conifer_new(world.arena, &bushy_twig, 1);
    struct plant *plant = plant_from_conifer(world.arena, "twig", conifer);
    if (sides) {
        conifer->needle_sides = conifer->branch_sides = sides;
        plant = plant_from_mesh(world.arena, "twig", conifer_mesh(world.arena, conifer));
    }
    world_plant(&world, plant);
    world_sun(&world, 1, 2, 1.5);
    struct frame *frame =
        world_render(&world,
                     (struct reference_options){
                         .effects = EFFECT_SUN_SHADOWS, .samples_min = 256, .samples_max = 256},
                     NULL);
    double error;
    sums[0] = frame_mean(frame, 3, &error);
    sums[1] = frame_mean(frame, 0, &error);
    arena_destroy(world.arena);
}

static void test_twig__of_prisms_converges_to_the_round_one(void **state)
{
    (void)state;
    static const double eyes[][3] = {{0, 0, 1}, {0.6, 0.64, 0.48}, {0, -0.8, 0.6}};
    for (size_t k = 0; k < 3; k++) {
        double round[2], fine[2];
        twig_picture(eyes[k][0], eyes[k][1], eyes[k][2], 0, round);
        twig_picture(eyes[k][0], eyes[k][1], eyes[k][2], 48, fine);
        assert_true(round[0] > 0.05);
        assert_float_equal(fine[0] / round[0], 1, 0.003);
        assert_float_equal(fine[1] / round[1], 1, 0.006);
    }
}

/* A tree is an instance of its plant, of any size, height and turn: the picture of a twig that is s
 * times as large, s times as far, is the same. */
static void test_twig__of_any_scale_looks_alike_from_as_many_times_as_far(void **state)
{
    (void)state;
    static const float scales[] = {1, 0.3f, 0.55f, 0.9f, 1.2f, 4};
    double alike = 0, lit = 0;
    for (size_t k = 0; k < 6; k++) {
        struct world world = world_create(SIDE_PX, SIDE_PX, 2 * atan(seen_m / 2 / distance_m));
        double error, far_m = distance_m * (double)scales[k];
        world_look(&world, 0, (float)(0.6 * far_m), (float)(0.8 * far_m), 0, 0, 0);
        world_plant(&world, plant_from_conifer(world.arena, "twig",
                                               conifer_new(world.arena, &bushy_twig, 1)));
        world.scene.instances[0].scale = scales[k];
        world_sun(&world, 1, 2, 1.5);
        struct frame *frame =
            world_render(&world,
                         (struct reference_options){
                             .effects = EFFECT_SUN_SHADOWS, .samples_min = 256, .samples_max = 256},
                         NULL);
        double alpha = frame_mean(frame, 3, &error), light = frame_mean(frame, 0, &error);
        alike = k ? alike : alpha;
        lit = k ? lit : light;
        assert_float_equal(alpha / alike, 1, 0.003);
        assert_float_equal(light / lit, 1, 0.006);
        arena_destroy(world.arena);
    }
}

/* clang-format off */
int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_needle__reflects_what_the_closed_form_of_a_cylinder_says),
        cmocka_unit_test(test_needle__shines_as_the_quadrature_of_its_lobe_says),
        cmocka_unit_test(test_needle__has_flat_ends),
        cmocka_unit_test(test_twig__of_any_scale_looks_alike_from_as_many_times_as_far),
        cmocka_unit_test(test_twig__of_prisms_converges_to_the_round_one),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
