/* The light of scene/effects.h, case by case: sides, normals, fog, what blocks what. Values without
 * noise. */
#include "reference_world.h"

/* One pixel at the middle of the picture, all its samples alike. */
static void middle(struct world *world, unsigned effects, float rgba[4])
{
    struct frame *frame = world_render(
        world, (struct reference_options){.effects = effects, .samples_min = 16, .samples_max = 16},
        NULL);
    size_t at =
        (size_t)(frame->height_px / 2) * (size_t)frame->width_px + (size_t)(frame->width_px / 2);
    memcpy(rgba, frame->rgba + 4 * at, 4 * sizeof *rgba);
}

static float middle_red(struct world *world, unsigned effects)
{
    float rgba[4];
    middle(world, effects, rgba);
    return rgba[0];
}

#define NEAR(a, b) assert_true(fabs((double)(a) - (double)(b)) < 2e-5)

/* A disc of albedo 0.5 in the plane z = 0 that faces +z, seen from the side that eye_z says. */
static struct world leaf_world(enum material_kind kind, float eye_z)
{
    struct world world = world_create(5, 5, 0.01);
    world_add(&world, disc_mesh(world.arena, kind, 0.5f, 12, 2), 0.2f, 0.1f, 0);
    world_look(&world, 0, 0, eye_z, 0, 0, 0);
    return world;
}

static void test_light__a_leaf_is_lit_on_the_eyes_side_alone_unless_two_sided(void **state)
{
    (void)state;
    for (int front = 0; front < 2; front++)
        for (int shadows = 0; shadows < 2; shadows++) {
            struct world world = leaf_world(MATERIAL_LEAF, front ? 3 : -3);
            unsigned effects = shadows ? EFFECT_SUN_SHADOWS : 0;
            world_sun(&world, 0.6, 0, 0.8);
            NEAR(middle_red(&world, effects), front ? 0.4 : 0);
            NEAR(middle_red(&world, effects | EFFECT_TWO_SIDED), 0.4);
            world_sun(&world, 0.6, 0, -0.8);
            NEAR(middle_red(&world, effects), front ? 0 : 0.4);
            NEAR(middle_red(&world, effects | EFFECT_TWO_SIDED), 0.4);
            arena_destroy(world.arena);
        }
}

static void test_light__bark_is_never_lit_from_behind(void **state)
{
    (void)state;
    for (int front = 0; front < 2; front++) {
        struct world world = leaf_world(MATERIAL_BARK, front ? 3 : -3);
        world_sun(&world, 0.6, 0, 0.8);
        NEAR(middle_red(&world, EFFECT_TWO_SIDED), front ? 0.4 : 0);
        world_sun(&world, 0.6, 0, -0.8);
        NEAR(middle_red(&world, EFFECT_TWO_SIDED), front ? 0 : 0.4);
        arena_destroy(world.arena);
    }
}

static void test_light__smooth_normals_turn_with_the_side_of_the_triangle(void **state)
{
    (void)state;
    for (int front = 0; front < 2; front++) {
        struct world world = world_create(5, 5, 0.01);
        struct mesh *mesh = disc_mesh(world.arena, MATERIAL_BARK, 0.5f, 12, 2);
        for (size_t i = 0; i < mesh->vertices_count; i++) /* leans towards +x */
            memcpy(mesh->normals[i], (float[3]){0.6f, 0, 0.8f}, sizeof *mesh->normals);
        world_add(&world, mesh, 0.2f, 0.1f, 0);
        world_look(&world, 0, 0, front ? 3 : -3, 0, 0, 0);
        world_sun(&world, 0, 0, front ? 1 : -1);
        NEAR(middle_red(&world, 0), 0.4);
        world_sun(&world, front ? 0.6 : -0.6, 0, front ? 0.8 : -0.8);
        NEAR(middle_red(&world, EFFECT_SUN_SHADOWS), 0.5);
        /* The smooth normal faces the sun, the triangle does not: the surface itself is in the way.
         */
        world_sun(&world, front ? 0.995 : -0.995, 0, front ? -0.0999 : 0.0999);
        NEAR(middle_red(&world, 0), 0.5 * (0.6 * 0.995 - 0.8 * 0.0999));
        NEAR(middle_red(&world, EFFECT_SUN_SHADOWS), 0);
        arena_destroy(world.arena);
    }
}

static void test_light__an_instance_turns_its_normals_and_scales_its_shape(void **state)
{
    (void)state;
    struct world world = world_create(5, 5, 0.01);
    struct instance *instance =
        world_add(&world, disc_mesh(world.arena, MATERIAL_LEAF, 0.5f, 12, 2), 40, 7, -30);
    instance->rotation_rad = 0.7f;
    instance->scale = 2.5f;
    /* The normal +z becomes (sin, 0, cos). */
    float side = sinf(0.7f), front = cosf(0.7f);
    world_look(&world, 40 + 9 * side + 1.5f * front, 7, -30 + 9 * front - 1.5f * side,
               40 + 1.5f * front, 7, -30 - 1.5f * side);
    world_sun(&world, 0.3, 0.2, 0.9);
    double facing = (0.3 * side + 0.9 * front) / sqrt(0.3 * 0.3 + 0.2 * 0.2 + 0.9 * 0.9);
    NEAR(middle_red(&world, EFFECT_SUN_SHADOWS), 0.5 * facing);
    arena_destroy(world.arena);
}

/* Far from the origin the coordinates are coarse: 1 km gives steps of 0.06 mm. */
static void test_light__a_leaf_far_away_does_not_shade_itself(void **state)
{
    (void)state;
    struct random random = random_seed(6, 6);
    struct world world = world_create(24, 24, 0.002);
    struct instance *instance =
        world_add(&world, disc_mesh(world.arena, MATERIAL_LEAF, 0.5f, 12, 2), 0, 0, 0);
    for (int i = 0; i < 3; i++)
        world.scene.ambient[i] = 0.25f;
    for (int trial = 0; trial < 40; trial++) {
        float x = 4000 * random_float(&random) - 2000, z = 4000 * random_float(&random) - 2000;
        float far = 20 + 400 * random_float(&random);
        double turn = 2 * M_PI * random_double(&random), tilt = 3 * random_double(&random) - 1.5;
        memcpy(instance->position_m, (float[3]){x, 100, z}, sizeof instance->position_m);
        instance->rotation_rad = (float)turn;
        instance->scale = 0.3f + 0.5f * random_float(&random);
        world_look(&world, x + far * sinf((float)(turn + tilt)), 100 + far * 0.2f,
                   z + far * cosf((float)(turn + tilt)), x, 100, z);
        double lean = 3.1 * random_double(&random) - 1.55;
        world_sun(&world, sin(turn + lean), 0.1, cos(turn + lean));
        struct frame *frame = world_render(
            &world,
            (struct reference_options){.effects = EFFECT_SUN_SHADOWS | EFFECT_TWO_SIDED |
                                                  EFFECT_AMBIENT | EFFECT_SKY_OCCLUSION,
                                       .samples_min = 16,
                                       .samples_max = 16},
            NULL);
        double expected = 0.5 * (0.25 + fabs(cos(lean)) / sqrt(1.01));
        for (size_t pixel = 0; pixel < 24 * 24; pixel++)
            if (frame->rgba[4 * pixel + 3] == 1)
                assert_true(fabs(frame->rgba[4 * pixel] - expected) < 2e-4);
    }
    arena_destroy(world.arena);
}

static void test_light__only_the_effects_asked_for_are_traced(void **state)
{
    (void)state;
    struct world world = world_create(8, 8, 0.01);
    struct reference_stats stats;
    struct reference_options options = {.samples_min = 4, .samples_max = 4};
    world_add(&world, disc_mesh(world.arena, MATERIAL_LEAF, 0.5f, 12, 2), 0.2f, 0.1f, 0);
    world_look(&world, 0, 0, 3, 0, 0, 0);
    world_sun(&world, 0, 0.1, 1);
    world.scene.ambient[1] = 0.3f;
    world.scene.fog = (struct fog){{1, 1, 1}, 0.5f};
    static const struct {
        unsigned effects;
        double shadow, occlusion, green;
    } cases[] = {
        {0, 0, 0, 0.5},
        {EFFECT_AMBIENT, 0, 0, 0.65},
        {EFFECT_SKY_OCCLUSION, 0, 0, 0.5},
        {EFFECT_SUN_SHADOWS, 1, 0, 0.5},
        {EFFECT_AMBIENT | EFFECT_SKY_OCCLUSION, 0, 1, 0.65},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        options.effects = cases[i].effects;
        struct frame *frame = world_render(&world, options, &stats);
        assert_true(stats.samples == 8 * 8 * 4 && stats.primary_rays == stats.samples);
        assert_true(stats.shadow_rays == cases[i].shadow * stats.samples);
        assert_true(stats.occlusion_rays == cases[i].occlusion * stats.samples);
        double sun = 1 / sqrt(1.01) - 1;
        NEAR(frame->rgba[1], cases[i].green + 0.5 * sun);
        NEAR(frame->rgba[0], 0.5 + 0.5 * sun);
        NEAR(frame->rgba[3], 1);
    }
    arena_destroy(world.arena);
}

static void test_light__fog_hides_plants_and_not_the_sky(void **state)
{
    (void)state;
    struct world world = leaf_world(MATERIAL_LEAF, 3);
    float rgba[4];
    world.scene.fog = (struct fog){{0.1f, 0.2f, 0.3f}, 0.4f};
    world.scene.sky = (struct sky){{0.7f, 0.7f, 0.7f}, {0.7f, 0.7f, 0.7f}, {0.7f, 0.7f, 0.7f}};
    world_sun(&world, 0, 0, 1);
    middle(&world, EFFECT_FOG, rgba);
    NEAR(rgba[2], 0.5 * exp(-0.4 * 3) + 0.3 * (1 - exp(-0.4 * 3)));
    NEAR(rgba[3], 1);
    world_look(&world, 0, 5, 3, 0, 5, 0);
    middle(&world, EFFECT_FOG, rgba);
    NEAR(rgba[0], 0.7);
    NEAR(rgba[3], 0);
    arena_destroy(world.arena);
}

static void test_light__what_is_before_the_near_plane_is_not_seen(void **state)
{
    (void)state;
    struct world world = world_create(9, 9, 1.2);
    world_add(&world, disc_mesh(world.arena, MATERIAL_LEAF, 0.5f, 40, 2), 0, 0, -2)->scale = 50;
    world_look(&world, 0, 0, 0, 0, 0, -1);
    world.view.near_m = 1.99f;
    struct frame *frame =
        world_render(&world, (struct reference_options){.samples_min = 4, .samples_max = 4}, NULL);
    for (size_t i = 0; i < 81; i++) /* also in the corners, where the distance is larger */
        assert_true(frame->rgba[4 * i + 3] == 1);
    world.view.near_m = 2.01f;
    frame =
        world_render(&world, (struct reference_options){.samples_min = 4, .samples_max = 4}, NULL);
    for (size_t i = 0; i < 81; i++)
        assert_true(frame->rgba[4 * i + 3] == 0);
    arena_destroy(world.arena);
}

static void test_light__terrain_is_seen_and_is_no_plant(void **state)
{
    (void)state;
    struct world world = world_create(5, 5, 0.01);
    float rgba[4];
    world.scene.terrain = level_ground(world.arena, 10, 0.8f);
    world_look(&world, 0, 5, 0.1f, 0, 0, 0);
    world_sun(&world, 0, 1, 0);
    middle(&world, EFFECT_SUN_SHADOWS, rgba);
    NEAR(rgba[0], 0.8);
    assert_true(rgba[3] == 0);
    world_sun(&world, 0, -1, 0.1);
    middle(&world, EFFECT_SUN_SHADOWS, rgba);
    assert_true(rgba[0] == 0);
    arena_destroy(world.arena);
}

/* Vertex colours and texture multiply the material's albedo. */
static void test_light__colours_multiply(void **state)
{
    (void)state;
    static const float texels[4] = {0.5f, 0.25f, 1, 1};
    static const struct texture texture = {1, 1, (float *)texels};
    for (int mixed = 0; mixed < 2; mixed++) {
        struct world world = world_create(5, 5, 0.001);
        struct mesh *mesh = disc_mesh(world.arena, MATERIAL_LEAF, 0.8f, 12, 2);
        float rgba[4];
        mesh->colors = arena_alloc(world.arena, mesh->vertices_count, sizeof *mesh->colors);
        mesh->uvs = arena_alloc(world.arena, mesh->vertices_count, sizeof *mesh->uvs);
        for (size_t i = 0; i < mesh->vertices_count; i++) {
            /* The same at the point that is seen: grows along x, or not at all. */
            mesh->colors[i][0] = mixed ? 0.5f + 0.4f * mesh->positions[i][0] : 0.5f;
            mesh->colors[i][1] = 1;
            mesh->colors[i][2] = 0.1f;
        }
        mesh->materials->texture = &texture;
        world_add(&world, mesh, 0, -0.3f, 0);
        world_look(&world, 0, 0, 3, 0, 0, 0);
        world_sun(&world, 0, 0, 1);
        middle(&world, 0, rgba);
        assert_true(fabsf(rgba[0] - 0.8f * 0.5f * 0.5f) < 1e-4f);
        NEAR(rgba[1], 0.8 * 0.25);
        NEAR(rgba[2], 0.8 * 0.1);
        arena_destroy(world.arena);
    }
}

static void test_light__an_empty_scene_is_sky_without_noise(void **state)
{
    (void)state;
    struct world world = world_create(7, 3, 0.9);
    world.scene.sky = (struct sky){{0.2f, 0.4f, 0.6f}, {0.2f, 0.4f, 0.6f}, {0.2f, 0.4f, 0.6f}};
    world_look(&world, 0, 0, 0, 0, 0, -1);
    struct frame *frame = world_render(
        &world, (struct reference_options){.effects = EFFECTS_ALL, .standard_error = 0.001f}, NULL);
    for (size_t i = 0; i < 21; i++) {
        NEAR(frame->rgba[4 * i], 0.2);
        NEAR(frame->rgba[4 * i + 2], 0.6);
        assert_true(frame->rgba[4 * i + 3] == 0);
        assert_true(frame->variance[4 * i] < 1e-12f);
    }
    arena_destroy(world.arena);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_light__a_leaf_is_lit_on_the_eyes_side_alone_unless_two_sided),
        cmocka_unit_test(test_light__bark_is_never_lit_from_behind),
        cmocka_unit_test(test_light__smooth_normals_turn_with_the_side_of_the_triangle),
        cmocka_unit_test(test_light__an_instance_turns_its_normals_and_scales_its_shape),
        cmocka_unit_test(test_light__a_leaf_far_away_does_not_shade_itself),
        cmocka_unit_test(test_light__only_the_effects_asked_for_are_traced),
        cmocka_unit_test(test_light__fog_hides_plants_and_not_the_sky),
        cmocka_unit_test(test_light__what_is_before_the_near_plane_is_not_seen),
        cmocka_unit_test(test_light__terrain_is_seen_and_is_no_plant),
        cmocka_unit_test(test_light__colours_multiply),
        cmocka_unit_test(test_light__an_empty_scene_is_sky_without_noise),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
