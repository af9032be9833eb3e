/* Conifers by one cone a pixel: needles against closed forms, levels against the ray tracer, both
 * ways against each other. */
#include "conifer_world.h"

static void test_conifers__a_needle_across_a_pixel_hides_its_width_of_it(void **state)
{
    (void)state;
    for (int k = 0; k < 6; k++) {
        struct world world = world_create(33, 33, 0.1);
        struct conifer_twig twig = twig_along(1, 0, 0);
        twig.cones_count = twig.needles_count = 1;
        twig.needle_angle_rad = 0; /* along the axis */
        twig.base_m[0] = -twig.needle_length_m / 2 - 0.01f;
        twig.needle_radius_m = 0.0001f * (float)(1 << k);
        twig.axis_radius_m = 1e-9f;
        plant_add(&world, plant_of(world.arena, &twig, 1));
        world_look(&world, 0, 0, 5, 0, 0, 0);
        struct cones_options options = options_of(CONE_NEEDLE);
        struct frame *frame = drawn(&world, &options, 0, 1);
        double pixel_m = 2 * tan(0.05) * 5 / 33;
        double expected = fmin(2 * (double)twig.needle_radius_m / pixel_m, 1);
        double alpha = frame->rgba[4 * (16 * 33 + 16) + 3];
        if (fabs(alpha - expected) > 1e-3)
            fail_msg("radius %g m: %g; expected %g", (double)twig.needle_radius_m, alpha, expected);
        /* and light: R_d of a cylinder lit from above, seen from the side, is 1/4 */
        double radiance = frame->rgba[4 * (16 * 33 + 16)];
        if (expected < 0.5 && fabs(radiance - 0.5 * 0.25 * expected) > 0.01 * expected)
            fail_msg("radius %g m: radiance %g", (double)twig.needle_radius_m, radiance);
        arena_destroy(world.arena);
    }
}

/* Coverage and light of all levels of a twig, from so far, against the tracer's. */
static void levels_check(double x, double y, double z, float distance_m)
{
    for (int level = 0; level < CONE_LEVELS; level++) {
        struct world world = world_create(48, 48, 0.05);
        struct conifer_twig twig = twig_along(x, y, z);
        plant_add(&world, plant_of(world.arena, &twig, 1));
        world_look(&world, 0, 0.05f, distance_m, 0.1f, 0.05f, 0);
        world_sun(&world, 0.5, 0.7, 0.4);
        struct cones_options options = options_of(level);
        struct reference_options traced = {
            .effects = EFFECT_SUN_SHADOWS, .samples_min = 64, .samples_max = 64, .threads = 2};
        struct reference_stats stats;
        struct frame *ours = drawn(&world, &options, EFFECT_SUN_SHADOWS, 1);
        struct frame *truth = world_render(&world, traced, &stats);
        double cover = sum_of(ours, 3) / sum_of(truth, 3);
        double light = sum_of(ours, 0) / sum_of(truth, 0);
        if (!(fabs(cover - 1) < 0.15) || !(fabs(light - 1) < 0.3))
            fail_msg("level %d along %g %g %g at %g m: cover %.3f, light %.3f of the traced", level,
                     x, y, z, (double)distance_m, cover, light);
        arena_destroy(world.arena);
    }
}

static void test_conifers__every_level_of_a_far_twig_covers_and_shines_as_traced(void **state)
{
    (void)state;
    levels_check(1, 0, 0, 12);
    levels_check(1, 0.5, 0.7, 12);
    levels_check(1, 0.2, -0.5, 20);
}

/* What the lobe adds, against what it adds to the tracer's picture. */
static void test_conifers__needles_shine_at_every_level_as_traced(void **state)
{
    (void)state;
    double traced = 0;
    for (int level = -1; level < CONE_LEVELS; level++) {
        double light[2];
        struct world world = world_create(48, 48, 0.05);
        struct conifer_twig twig = twig_along(1, 0.5, 0.7);
        plant_add(&world, plant_of(world.arena, &twig, 1));
        world_look(&world, 0, 0.05f, 12, 0.1f, 0.05f, 0);
        world_sun(&world, 0.5, 0.7, 1.4);
        for (unsigned shines = 0; shines < 2; shines++) {
            const unsigned effects = EFFECT_SUN_SHADOWS | (shines ? EFFECT_SPECULAR : 0u);
            struct cones_options options = options_of(level);
            struct reference_options tracer = {
                .effects = effects, .samples_min = 64, .samples_max = 64, .threads = 2};
            struct reference_stats stats;
            light[shines] = sum_of(level < 0 ? world_render(&world, tracer, &stats)
                                             : drawn(&world, &options, effects, 1),
                                   0);
        }
        traced = level < 0 ? light[1] - light[0] : traced;
        if (!(fabs((light[1] - light[0]) / traced - 1) < 0.12) || !(traced > 0.1 * light[0]))
            fail_msg("level %d: shines by %.4f of %.4f, traced %.4f", level, light[1] - light[0],
                     light[0], traced);
        arena_destroy(world.arena);
    }
}

/* A disc of bark between twig and sun, beside the picture. */
static void test_conifers__needles_in_the_shade_do_not_shine(void **state)
{
    (void)state;
    for (int level = 0; level < CONE_LEVELS; level++) {
        double shines[2];
        for (int shaded = 0; shaded < 2; shaded++) {
            struct world world = world_create(48, 48, 0.05);
            struct conifer_twig twig = twig_along(1, 0.5, 0.7);
            world_look(&world, 0, 0.05f, 12, 0.1f, 0.05f, 0);
            world_sun(&world, 0.5, 0.7, 1.4);
            struct conifer_branch disc = {.radius_from_m = 0.35f, .radius_to_m = 0.35f};
            for (int i = 0; i < 3; i++) {
                const float sun = (shaded ? 1.0f : -1.0f) * world.view.sun_direction[i];
                disc.from_m[i] = 2.2f * sun;
                disc.to_m[i] = 2.3f * sun;
            }
            plant_add(&world, plant_on(world.arena, &disc, &twig, 1));
            struct cones_options options = options_of(level);
            double light[2];
            for (unsigned on = 0; on < 2; on++)
                light[on] = sum_of(
                    drawn(&world, &options, EFFECT_SUN_SHADOWS | (on ? EFFECT_SPECULAR : 0u), 1),
                    0);
            shines[shaded] = light[1] - light[0];
            arena_destroy(world.arena);
        }
        if (!(shines[0] > 0.1) || !(shines[1] < 0.02 * shines[0]))
            fail_msg("level %d: shines by %.4f in the sun, %.4f in the shade", level, shines[0],
                     shines[1]);
    }
}

/* Seen from the side (11) leaves 2 sin phi of a cone's needles, where they are the integral of
 * their sines; (19) has N r cot phi / dh of a twig opaque. */
static void test_conifers__as_printed_a_twig_covers_what_the_paper_says(void **state)
{
    (void)state;
    for (int level = CONE_NEEDLE; level < CONE_LEVELS; level++) {
        double cover[2], pixels_m2 = pow(2 * tan(0.025) * 12 / 48, 2), seen = 0;
        struct conifer_twig twig = twig_along(1, 0, 0);
        const double phi = (double)twig.needle_angle_rad;
        twig.needle_radius_m = 2e-5f;
        twig.axis_radius_m = 1e-8f;
        for (int paper = 0; paper < 2; paper++) {
            struct world world = world_create(48, 48, 0.05);
            plant_add(&world, plant_of(world.arena, &twig, 1));
            world_look(&world, 0.12f, 0, 12, 0.12f, 0, 0);
            world_sun(&world, 0.5, 0.7, 1.4);
            struct cones_options options = options_of(level);
            options.shaders = paper ? CONE_PAPER : CONE_EXACT;
            struct frame *frame = drawn(&world, &options, EFFECT_SUN_SHADOWS | EFFECT_SPECULAR, 1);
            for (size_t i = 0; i < 48 * 48 * 4; i++)
                assert_true(frame->rgba[i] >= 0 && frame->rgba[i] <= 1);
            cover[paper] = sum_of(frame, 3) * pixels_m2;
            arena_destroy(world.arena);
        }
        for (int k = 0; k < 1000; k++) {
            double c = sin(phi) * cos(2 * M_PI * (k + 0.5) / 1000);
            seen += 2 * M_PI / 1000 * sqrt(1 - c * c);
        }
        const double twig_m2 = 2 * (double)twig.needle_length_m * sin(phi) * 0.24;
        const double printed[CONE_LEVELS] = {1, 2 * sin(phi) / seen,
                                             12 * 2e-5 / 0.02 / tan(phi) * twig_m2 / cover[0]};
        if (!(fabs(cover[1] / cover[0] / printed[level] - 1) < 0.02))
            fail_msg("level %d: covers %.3f of the exact one, printed %.3f", level,
                     cover[1] / cover[0], printed[level]);
    }
}

static void test_conifers__relief_before_half_a_pixel_leaves_half_to_what_is_behind(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct workspace workspace = {.arena = arena, .threads = 1};
    float left = 1, share = 1, limit_m = 5, rgb[3] = {0, 0, 0}, suns = 0, behind[1][3] = {{0}};
    int32_t edge = 0;
    struct cone_layer layers[CONE_LAYERS] = {
        {.depth_m = 5, .share = 0.5f, .rgb = {0.5f, 0, 0}},
        {.depth_m = INFINITY, .share = 0.5f, .rgb = {0, 0.5f, 0}}};
    struct cone_canvas canvas = {.width_px = 1,
                                 .height_px = 1,
                                 .left = &left,
                                 .share = &share,
                                 .limit_m = &limit_m,
                                 .rgb = {&rgb[0], &rgb[1], &rgb[2]},
                                 .suns = &suns,
                                 .behind = behind,
                                 .edges = &edge,
                                 .layers = layers};
    struct cone_strip strip = {.depths_m = {2, 2}, .shade = {0, 0, 1}, .mean = 1};
    const struct cone_place place = {0.5f, 0};
    float pixel[4];
    cone_canvas_put(&canvas, 0, &strip, &place, 0.25f); /* before both */
    strip.depths_m[0] = strip.depths_m[1] = 10;
    cone_canvas_put(&canvas, 0, &strip, &place, 0.6f); /* between them */
    cone_canvas_end(&workspace, &canvas, 0, pixel);
    assert_true(fabs(pixel[0] - 0.75 * 0.5) < 1e-6);                /* the relief */
    assert_true(fabs(pixel[1] - 0.75 * 0.4 * 0.5) < 1e-6);          /* the sky */
    assert_true(fabs(pixel[2] - (0.25 + 0.75 * 0.6 * 0.5)) < 1e-6); /* both strips */
    assert_true(fabs(pixel[3] - pixel[2]) < 1e-6);
    arena_destroy(arena);
}

static void test_conifers__levels_turn_into_each_other_without_a_leap(void **state)
{
    (void)state;
    struct cone_choice choice = {.forced = -1, .needle_px = 6, .twig_px = 2.5f};
    for (int limits = 0; limits < 2; limits++) {
        struct cone_mix before = {{0, 0, 0}};
        choice.limits_m[0] = limits ? 20 : 0;
        choice.limits_m[1] = limits ? 60 : 0;
        for (int step = 0; step < 1000; step++) {
            float distance_m = 2 * powf(1.005f, (float)step), sum = 0;
            struct cone_mix mix = cone_mix_of(&choice, 120 / distance_m, distance_m);
            for (int k = 0; k < CONE_LEVELS; k++) {
                assert_true(mix.shares[k] >= 0 && mix.shares[k] <= 1);
                assert_true(step == 0 || fabsf(mix.shares[k] - before.shares[k]) < 0.06f);
                sum += mix.shares[k];
            }
            assert_true(fabsf(sum - 1) < 1e-6f);
            if (step == 0)
                assert_true(mix.shares[CONE_NEEDLE] == 1);
            before = mix;
        }
        assert_true(before.shares[CONE_TWIG] == 1);
    }
}

/* Twigs every way around a stem. */
static struct plant *bush(struct arena *arena)
{
    enum { COUNT = 40 };
    struct conifer_twig twigs[COUNT];
    struct random random = random_seed(3, 1);
    for (int k = 0; k < COUNT; k++) {
        double turn = 2.4 * k, rise = 0.6 * random_double(&random);
        twigs[k] = twig_along(cos(turn), rise, sin(turn));
        twigs[k].base_m[1] = 0.02f * (float)k;
        twigs[k].axis_radius_m = 0.002f;
    }
    return plant_of(arena, twigs, COUNT);
}

static void test_conifers__the_fast_way_draws_what_the_straightforward_one_does(void **state)
{
    (void)state;
    const unsigned effects = EFFECT_SUN_SHADOWS | EFFECT_AMBIENT | EFFECT_FOG;
    for (int level = -1; level < CONE_LEVELS; level++) {
        struct world world = world_create(40, 36, 0.5);
        struct scene *scene = &world.scene;
        plant_add(&world, bush(world.arena));
        scene->instances[scene->instances_count++] =
            (struct instance){{0.4f, 0.1f, -2}, 1, 1.3f, 0, 1};
        scene->fog = (struct fog){{0.2f, 0.3f, 0.4f}, 0.02f};
        world.scene.terrain = level_ground(world.arena, 30, 0.4f);
        scene->ambient[0] = scene->ambient[1] = scene->ambient[2] = 0.3f;
        world_look(&world, 0, 1, level == CONE_NEEDLE ? 2.0f : 3.5f, 0, 0.4f, 0);
        world_sun(&world, 0.5, 0.7, 0.3);
        struct cones_options options = options_of(level);
        options.choice.thin = 1;
        struct frame *fast = drawn(&world, &options, effects, 2);
        struct frame *other = drawn(&world, &options, effects, 1);
        options.is_naive = true;
        struct frame *naive = drawn(&world, &options, effects, 2);
        assert_memory_equal(fast->rgba, other->rgba, 40 * 36 * 4 * sizeof(float));
        assert_true(sum_of(fast, 3) > 50);
        for (size_t i = 0; i < 40 * 36 * 4; i++)
            if (!(fabsf(fast->rgba[i] - naive->rgba[i]) < 1e-3f))
                fail_msg("level %d, pixel %zu: %g, straightforward %g", level, i / 4,
                         (double)fast->rgba[i], (double)naive->rgba[i]);
        arena_destroy(world.arena);
    }
}

/* A ridge across the picture, higher than half of the trees behind it. */
static void test_conifers__what_relief_hides_is_left_out_without_a_trace(void **state)
{
    (void)state;
    struct world world = world_create(72, 70, 0.5);
    struct scene *scene = &world.scene;
    struct terrain *terrain = &scene->terrain;
    plant_add(&world, bush(world.arena));
    scene->instances[scene->instances_count++] = (struct instance){{0.4f, 0, -1}, 1, 1.3f, 0, 1};
    scene->instances[scene->instances_count++] = (struct instance){{-0.5f, -1.2f, -3}, 2, 1, 0, 1};
    world.scene.terrain = level_ground(world.arena, 8, 0.4f);
    terrain->samples_z = 5;
    terrain->heights_m = ARENA_ARRAY(world.arena, float, 10);
    terrain->normals = arena_alloc(world.arena, 10, sizeof *terrain->normals);
    for (int i = 0; i < 10; i++) {
        terrain->heights_m[i] = i / 2 == 3 ? 0.6f : i < 4 ? -1.5f : 0;
        terrain->normals[i][1] = 1;
    }
    world_look(&world, 0, 0.9f, 3.5f, 0, 0.5f, 0);
    world_sun(&world, 0.5, 0.7, 0.3);
    struct cones_options options = options_of(-1);
    struct frame *fast = drawn(&world, &options, EFFECT_SUN_SHADOWS, 2);
    options.is_naive = true;
    struct frame *naive = drawn(&world, &options, EFFECT_SUN_SHADOWS, 2);
    assert_true(sum_of(fast, 3) > 50);
    for (size_t i = 0; i < 72 * 70 * 4; i++)
        if (!(fabsf(fast->rgba[i] - naive->rgba[i]) < 1e-3f))
            fail_msg("pixel %zu: %g, straightforward %g", i / 4, (double)fast->rgba[i],
                     (double)naive->rgba[i]);
    arena_destroy(world.arena);
}

/* The light that a bush takes from the ground beside it, seen from above. */
static void test_conifers__twigs_take_as_much_light_from_the_ground_as_traced(void **state)
{
    (void)state;
    static const double suns[3][3] = {{0.9, 0.8, 0.1}, {-0.6, 0.5, 0.8}, {0.3, 0.5, -1}};
    for (int k = 0; k < 3; k++) {
        const double *sun = suns[k];
        struct world world = world_create(48, 48, 0.1);
        plant_add(&world, bush(world.arena));
        world.scene.instances->position_m[1] = 1.5f;
        world.scene.terrain = level_ground(world.arena, 30, 0.5f);
        const float x = (float)(-1.9 / sun[1] * sun[0]), z = (float)(-1.9 / sun[1] * sun[2]);
        world_look(&world, x, 16, z + 0.01f, x, 0, z);
        world_sun(&world, sun[0], sun[1], sun[2]);
        struct cones_options options = options_of(-1);
        struct reference_options tracer = {
            .effects = EFFECT_SUN_SHADOWS, .samples_min = 64, .samples_max = 64, .threads = 2};
        struct reference_stats stats;
        const double lit = 48 * 48 * 0.5 * (double)world.view.sun_direction[1];
        const double taken = lit - sum_of(drawn(&world, &options, EFFECT_SUN_SHADOWS, 1), 0);
        const double traced = lit - sum_of(world_render(&world, tracer, &stats), 0);
        if (!(fabs(taken / traced - 1) < 0.06) || !(traced > 0.05 * lit))
            fail_msg("sun %d: %.2f taken, %.2f traced, of %.1f", k, taken, traced, lit);
        arena_destroy(world.arena);
    }
}

/* A bough or a trunk by itself: its far side is dark by its own cosine alone. */
static void test_conifers__bark_by_itself_is_as_bright_with_shadows_as_without(void **state)
{
    (void)state;
    static const struct conifer_branch barks[3] = {{{0, 0, 0}, {0, 8, 0}, 0.15f, 0.1f, 0, 0},
                                                   {{0, 2, 0}, {3, 3.5f, 0.6f}, 0.03f, 0.02f, 0, 0},
                                                   {{0, 2, 0}, {-1, 3, 4}, 0.05f, 0.02f, 0, 0}};
    for (int k = 0; k < 3; k++) {
        double light[2];
        for (int shadows = 0; shadows < 2; shadows++) {
            struct world world = world_create(48, 48, 0.5);
            struct conifer_twig twig = twig_along(0, 1, 0);
            twig.base_m[1] = 20; /* out of sight */
            plant_add(&world, plant_on(world.arena, &barks[k], &twig, 1));
            world_look(&world, 0, 4, 14, 0, 3, 0);
            world_sun(&world, 0.6, 0.7, 0.5);
            struct cones_options options = options_of(-1);
            light[shadows] =
                sum_of(drawn(&world, &options, shadows ? EFFECT_SUN_SHADOWS : 0, 1), 0);
            arena_destroy(world.arena);
        }
        if (!(light[1] > 0.97 * light[0]) || !(light[1] <= 1.001 * light[0]) || !(light[0] > 1))
            fail_msg("bark %d: %.3f of %.3f", k, light[1], light[0]);
    }
}

static void test_conifers__fewer_and_larger_twigs_cover_as_much(void **state)
{
    (void)state;
    double covers[2];
    for (int thin = 0; thin < 2; thin++) {
        struct world world = world_create(40, 36, 0.04);
        plant_add(&world, bush(world.arena));
        world_look(&world, 0, 0.5f, 200, 0, 0.4f, 0);
        struct cones_options options = options_of(CONE_TWIG);
        options.choice.thin = thin ? 2.0f : 0;
        covers[thin] = sum_of(drawn(&world, &options, 0, 1), 3);
        arena_destroy(world.arena);
    }
    assert_true(fabs(covers[1] / covers[0] - 1) < 0.15);
}

static void test_conifers__a_hundred_thousand_trees_take_less_than_640_bytes_each(void **state)
{
    (void)state;
    size_t used[2];
    for (int many = 0; many < 2; many++) {
        struct world world = world_create(40, 36, 0.5);
        struct error error = {0};
        plant_add(&world, bush(world.arena));
        const size_t count = many ? 100000 : 1;
        struct workspace workspace = {
            .arena = world.arena, .error = &error, .effects = EFFECT_SUN_SHADOWS, .threads = 1};
        world.scene.instances_count = count;
        world.scene.instances = ARENA_ARRAY(world.arena, struct instance, count);
        for (size_t i = 0; i < count; i++)
            world.scene.instances[i] =
                (struct instance){{(float)(i % 317), 0, (float)(i / 317)}, 0, 1, 0, 1};
        used[many] = arena_used_bytes(world.arena);
        struct cones_options options = options_of(-1);
        struct cones *cones;
        struct target target = {.width_px = 40, .height_px = 36, .format = TARGET_RGBA32F};
        target.pixels = ARENA_ARRAY(world.arena, float, 4 * 40 * 36);
        world_look(&world, 160, 20, 300, 160, 0, 100);
        assert_int_equal(cones_prepare(&workspace, &world.scene, &options, &cones), STATUS_OK);
        assert_int_equal(cones_draw(&workspace, cones, &world.view, &target), STATUS_OK);
        used[many] = arena_used_bytes(world.arena) - used[many];
        arena_destroy(world.arena);
    }
    const size_t each = (used[1] - used[0]) / 100000;
    if (each >= 640)
        fail_msg("%zu bytes a tree", each);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_conifers__a_needle_across_a_pixel_hides_its_width_of_it),
        cmocka_unit_test(test_conifers__every_level_of_a_far_twig_covers_and_shines_as_traced),
        cmocka_unit_test(test_conifers__needles_shine_at_every_level_as_traced),
        cmocka_unit_test(test_conifers__needles_in_the_shade_do_not_shine),
        cmocka_unit_test(test_conifers__as_printed_a_twig_covers_what_the_paper_says),
        cmocka_unit_test(test_conifers__relief_before_half_a_pixel_leaves_half_to_what_is_behind),
        cmocka_unit_test(test_conifers__levels_turn_into_each_other_without_a_leap),
        cmocka_unit_test(test_conifers__the_fast_way_draws_what_the_straightforward_one_does),
        cmocka_unit_test(test_conifers__what_relief_hides_is_left_out_without_a_trace),
        cmocka_unit_test(test_conifers__twigs_take_as_much_light_from_the_ground_as_traced),
        cmocka_unit_test(test_conifers__bark_by_itself_is_as_bright_with_shadows_as_without),
        cmocka_unit_test(test_conifers__fewer_and_larger_twigs_cover_as_much),
        cmocka_unit_test(test_conifers__a_hundred_thousand_trees_take_less_than_640_bytes_each),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
