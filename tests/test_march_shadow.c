/* Sun shadows of the march: volumes, map and terrain against closed forms, pictures against the
 * reference. */
#include "testing.h"

#include "march_world.h"
#include "shadow_world.h"

#include "bake/march_shadow_parts.h"

enum { BLOCK = 16 };
static const float block_m = 0.25f; /* a voxel's side */

/* A cube of BLOCK voxels a side, turned everywhere alike: its optical depth is per voxel's side the
 * same in each direction. Its lowest corner is at the origin. */
struct block {
    struct voxels voxels;
    struct voxel voxel;
    uint32_t cells[BLOCK * BLOCK * BLOCK];
};

static void block_fill(struct block *block, float depth_per_voxel)
{
    struct voxel_optics optics = {.extinction = depth_per_voxel * sqrtf(3),
                                  .shape = {1.0f / 3, 1.0f / 3, 1.0f / 3},
                                  .evenness = 1};
    memset(block, 0, sizeof *block);
    block->voxel = voxel_pack(&optics, (const float[3]){1, 1, 1});
    for (int i = 0; i < BLOCK * BLOCK * BLOCK; i++)
        block->cells[i] = VOXELS_FIRST;
    block->voxels.levels_count = 1;
    block->voxels.levels[0] = (struct voxels_level){{BLOCK, BLOCK, BLOCK}, block_m, block->cells};
    block->voxels.voxels = &block->voxel;
    block->voxels.voxels_count = 1;
}

static struct shadow_volume volume_of(struct arena *arena, const struct block *block,
                                      const float toward_sun[3], float cell_m)
{
    struct shadow_volume volume = {.cell_m = 0};
    struct shadow_axes frame = shadow_axes_of(toward_sun);
    shadow_volume_size(arena, &block->voxels, &frame, 1, cell_m, &volume);
    shadow_volume_sweep(&block->voxels, MARCH_SGGX, &volume);
    return volume;
}

static float sun_unit(float x, float y, float z, float toward_sun[3])
{
    float length = sqrtf(x * x + y * y + z * z);
    toward_sun[0] = x / length;
    toward_sun[1] = y / length;
    toward_sun[2] = z / length;
    return length;
}

static void test_march_shadow__axes_are_at_right_angles_and_turn_little_at_the_zenith(void **state)
{
    (void)state;
    struct random random = random_seed(3, 1);
    for (int n = 0; n < 200; n++) {
        float sun[3], near[2][3];
        sun_unit(random_float(&random) - 0.5f, random_float(&random) - 0.5f,
                 random_float(&random) - 0.5f, sun);
        struct shadow_axes frame = shadow_axes_of(sun);
        for (int a = 0; a < 3; a++)
            for (int b = 0; b < 3; b++) {
                float product = 0;
                for (int i = 0; i < 3; i++)
                    product += frame.axes[a][i] * frame.axes[b][i];
                assert_true(fabsf(product - (a == b)) < 1e-5f);
            }
        for (int i = 0; i < 3; i++)
            assert_true(fabsf(frame.axes[2][i] + sun[i]) < 1e-6f);
        for (int k = 0; k < 2; k++)
            sun_unit(0.01f * (random_float(&random) - 0.5f), 1,
                     0.01f * (random_float(&random) - 0.5f), near[k]);
        struct shadow_axes first = shadow_axes_of(near[0]), second = shadow_axes_of(near[1]);
        for (int i = 0; i < 9; i++)
            assert_true(fabsf((&first.axes[0][0])[i] - (&second.axes[0][0])[i]) < 0.02f);
    }
}

/* A slab of random leaves that is lit from one side: the mean of exp(-x) over its depth tau. */
static void test_march_shadow__a_slab_sees_one_minus_exp_of_its_depth_over_it(void **state)
{
    (void)state;
    static const float depths[] = {0.05f, 0.3f, 0.8f};
    struct arena *arena = arena_create(0);
    struct block *block = ARENA_NEW(arena, struct block);
    for (size_t d = 0; d < sizeof depths / sizeof *depths; d++)
        for (int axis = 0; axis < 3; axis++) {
            float sun[3] = {0, 0, 0};
            sun[axis] = axis == 2 ? -1 : 1;
            block_fill(block, depths[d]);
            struct shadow_volume volume = volume_of(arena, block, sun, block_m);
            double sum = 0, tau = (double)BLOCK * (double)depths[d];
            assert_int_equal(volume.size[0], BLOCK);
            assert_int_equal(volume.size[2], BLOCK + 1);
            const uint8_t *passes = volume.passes;
            for (int column = 0; column < BLOCK * BLOCK; column++, passes += volume.size[2])
                for (int k = 0; k < BLOCK; k++) {
                    assert_true(fabs(passes[k] / 255.0 - exp(-(double)depths[d] * k)) < 0.003);
                    sum += (passes[k] + passes[k + 1]) / 510.0;
                }
            double mean = sum / (BLOCK * BLOCK * BLOCK), expected = (1 - exp(-tau)) / tau;
            /* the trapezium rule is off by depth^2 / 12 of it */
            double rule = 1 + (double)depths[d] * (double)depths[d] / 12;
            assert_true(fabs(mean / (expected * rule) - 1) < 0.01);
        }
    arena_destroy(arena);
}

/* Metres of the block between a place in it and the sun. */
static double metres_before(const double place_m[3], const float sun[3])
{
    double least = INFINITY;
    for (int i = 0; i < 3; i++) {
        double end = sun[i] > 0 ? (double)block_m * BLOCK : 0;
        if (fabsf(sun[i]) > 1e-6f)
            least = fmin(least, (end - place_m[i]) / (double)sun[i]);
    }
    return least;
}

static void test_march_shadow__light_falls_by_exp_of_the_way_through_from_any_side(void **state)
{
    (void)state;
    const float depth = 0.1f;
    struct arena *arena = arena_create(0);
    struct block *block = ARENA_NEW(arena, struct block);
    struct random random = random_seed(5, 1);
    block_fill(block, depth);
    for (int n = 0; n < 20; n++) {
        float sun[3];
        sun_unit(random_float(&random) - 0.5f, random_float(&random) - 0.5f,
                 random_float(&random) - 0.5f, sun);
        struct shadow_volume volume = volume_of(arena, block, sun, block_m);
        double bias = 0, worst = 0;
        enum { PLACES = 300 };
        for (int p = 0; p < PLACES; p++) {
            double place_m[3], cells[3];
            for (int i = 0; i < 3; i++)
                place_m[i] = (double)block_m * BLOCK * (0.1 + 0.8 * random_double(&random));
            for (int k = 0; k < 3; k++) {
                cells[k] = -(double)volume.low_m[k];
                for (int i = 0; i < 3; i++)
                    cells[k] += (double)volume.frame.axes[k][i] * place_m[i];
                cells[k] /= (double)volume.cell_m;
                assert_true(cells[k] >= 0 && cells[k] < volume.size[k] - (k == 2));
            }
            const uint8_t *pass =
                volume.passes + ((int)cells[1] * volume.size[0] + (int)cells[0]) * volume.size[2] +
                (int)cells[2];
            double share = cells[2] - floor(cells[2]);
            double light = ((1 - share) * pass[0] + share * pass[1]) / 255;
            double expected = exp(-(double)depth * metres_before(place_m, sun) / (double)block_m);
            worst = fmax(worst, fabs(light - expected));
            bias += (light - expected) / PLACES;
        }
        /* a column stands for what is within half of its side */
        if (!(worst < 0.15 && fabs(bias) < 0.01))
            fail_msg("worst %g, mean %g", worst, bias);
    }
    arena_destroy(arena);
}

/* Casters one behind the other: their transmittances multiply, before them all is light. */
static void test_march_shadow__trees_behind_each_other_multiply_however_many(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct block *block = ARENA_NEW(arena, struct block);
    const float sun[3] = {0, 1, 0}, middle_m = 0.5f * BLOCK * block_m;
    block_fill(block, 0.02f); /* exp(-.32) = .726 each */
    struct shadow_volume volume = volume_of(arena, block, sun, block_m);
    struct shadow_axes frame = shadow_axes_of(sun);
    for (size_t count = 1; count <= 7; count++) {
        struct shadow_caster casters[7];
        struct shadow_map map = {.capacity = 0};
        float center_m[3] = {middle_m, 0, middle_m}, place_m[3];
        for (size_t i = 0; i < count; i++)
            casters[i] = (struct shadow_caster){{0, 0, 10 * (float)i}, 1, &volume};
        shadow_map_fill(arena, &map, casters, count, 1 << 16, block_m, 2);
        for (int k = 0; k < 2; k++)
            place_m[k] = frame.axes[k][0] * center_m[0] + frame.axes[k][2] * center_m[2];
        /* the last box of a texel holds all that come after it */
        size_t single = count <= SHADOW_BOXES ? count : SHADOW_BOXES - 1;
        for (size_t behind = 0; behind <= single; behind++) {
            place_m[2] = 10 * (float)behind - 5;
            double light = (double)shadow_map_at(&map, place_m);
            if (!(fabs(light - exp(-0.32 * (double)behind)) < 0.02))
                fail_msg("%zu of %zu: %g", behind, count, light);
        }
        place_m[2] = 200; /* behind all */
        double light = (double)shadow_map_at(&map, place_m);
        if (!(fabs(light - exp(-0.32 * (double)count)) < 0.02))
            fail_msg("%zu: %g behind all", count, light);
        place_m[0] += 3 * middle_m; /* beside them */
        assert_true(shadow_map_at(&map, place_m) == 1);
    }
    arena_destroy(arena);
}

static void test_march_shadow__a_ridge_shades_as_far_as_the_sun_is_low(void **state)
{
    (void)state;
    enum { SIDE = 41 };
    const float ridge_m = 30;
    struct arena *arena = arena_create(0);
    struct terrain terrain = {
        .samples_x = SIDE, .samples_z = SIDE, .size_x_m = 400, .size_z_m = 400};
    float *dark_m = ARENA_ARRAY(arena, float, SIDE *SIDE);
    terrain.heights_m = ARENA_ARRAY(arena, float, SIDE *SIDE);
    for (int along = 0; along < 2; along++)
        for (int from = -1; from <= 1; from += 2)
            for (float tangent = 0.2f; tangent < 1; tangent += 0.25f) {
                float sun[3];
                for (int i = 0; i < SIDE * SIDE; i++)
                    terrain.heights_m[i] = (along ? i / SIDE : i % SIDE) == SIDE / 2 ? ridge_m : 0;
                sun_unit(along ? 0.2f : (float)from, tangent, along ? (float)from : 0.2f, sun);
                shadow_terrain_sweep(&terrain, sun, dark_m);
                /* along the ridge nothing changes: the sun's slope across it counts */
                for (float away_m = 10; away_m < 100; away_m += 10)
                    for (float height_m = 0.5f; height_m < ridge_m; height_m += 3) {
                        float edge_m = ridge_m - away_m * tangent;
                        if (fabsf(height_m - edge_m) < 0.01f)
                            continue;
                        float place_m[3] = {0, height_m, 0};
                        place_m[along ? 2 : 0] = -(float)from * away_m;
                        float light = shadow_terrain_at(&terrain, dark_m, place_m);
                        assert_true(light == (height_m > edge_m));
                        place_m[along ? 2 : 0] = (float)from * away_m;
                        assert_true(shadow_terrain_at(&terrain, dark_m, place_m) == 1);
                    }
            }
    arena_destroy(arena);
}

static const unsigned lit = EFFECT_TWO_SIDED | EFFECT_AMBIENT;

/* The same trees with shadows and without. */
struct both {
    struct ready *shaded, *plain;
};

static struct both both_ready(struct world *world)
{
    return (struct both){march_ready(world, &usual, lit | EFFECT_SUN_SHADOWS, 2),
                         march_ready(world, &usual, lit, 2)};
}

/* Error against the reference, and that of leaving shadows out. */
static void shadows_check(struct world *world, const struct both *both, const char *name)
{
    const struct frame *shaded = traced(world, lit | EFFECT_SUN_SHADOWS);
    double error = boxes_apart(ready_picture(world, both->shaded), shaded);
    double ignored = boxes_apart(ready_picture(world, both->plain), shaded);
    if (!(error < 0.2 * ignored))
        fail_msg("%s: error %g, without shadows %g", name, error, ignored);
}

static void test_march_shadow__pictures_are_as_traced_from_low_sun_to_zenith(void **state)
{
    (void)state;
    static const float elevations_deg[] = {6, 45, 90};
    struct world world = world_of_balls(2, 3000, 0.25);
    world.scene.terrain = level_ground(world.arena, 200, 0.4f);
    struct both both = both_ready(&world);
    for (size_t i = 0; i < sizeof elevations_deg / sizeof *elevations_deg; i++) {
        char name[32];
        double elevation = (double)elevations_deg[i] * M_PI / 180;
        world_sun(&world, cos(elevation) * 0.8, sin(elevation), cos(elevation) * 0.6);
        snprintf(name, sizeof name, "%g degrees", (double)elevations_deg[i]);
        shadows_check(&world, &both, name);
    }
    arena_destroy(world.arena);
}

/* Leaves as large as several voxels lie across them: each must not shade itself. */
static void test_march_shadow__large_leaves_do_not_shade_themselves(void **state)
{
    (void)state;
    struct world world = world_of_balls(1, 150, 1.6);
    double drawn[4], true_means[4];
    const unsigned effects = EFFECT_TWO_SIDED | EFFECT_SUN_SHADOWS;
    means_of(march_picture(&world, &usual, effects, 2), drawn);
    means_of(traced(&world, effects), true_means);
    if (!(fabs(drawn[1] / true_means[1] - 1) < 0.06))
        fail_msg("%g, reference %g", drawn[1], true_means[1]);
    arena_destroy(world.arena);
}

/* Trees that shade each other and the ground; their crowns are beside their feet, so that it
 * matters how a tree is turned. */
static struct world world_of_forest(float apart_m)
{
    struct world world = world_of_balls(1, 3000, 0.25);
    struct scene *scene = &world.scene;
    struct random random = random_seed(8, 1);
    struct mesh *mesh = ball_of_leaves(world.arena, 3000, 0.25);
    for (size_t i = 0; i < mesh->vertices_count; i++)
        mesh->positions[i][0] += 3;
    mesh_bounds(mesh);
    scene->species[0].plant = plant_from_mesh(world.arena, "beside", mesh);
    world.scene.terrain = level_ground(world.arena, 200, 0.4f);
    for (scene->instances_count = 0; scene->instances_count < 40; scene->instances_count++) {
        struct instance *tree = &scene->instances[scene->instances_count];
        *tree = scene->instances[0];
        tree->position_m[0] = apart_m * ((float)(scene->instances_count % 8) - 3.5f);
        tree->position_m[1] = -2;
        tree->position_m[2] = apart_m * ((float)(scene->instances_count / 8) - 2);
        tree->rotation_rad = 6.28f * random_float(&random);
        tree->scale = 0.8f + 0.4f * random_float(&random);
    }
    world_look(&world, 30, 40, 80, 0, 2, 0);
    world_sun(&world, 0.7, 0.35, -0.5);
    return world;
}

static void test_march_shadow__a_forest_is_as_traced(void **state)
{
    (void)state;
    struct world world = world_of_forest(11);
    struct both both = both_ready(&world);
    shadows_check(&world, &both, "forest");
    arena_destroy(world.arena);
}

static const unsigned below_effects[2] = {EFFECT_TWO_SIDED, EFFECT_TWO_SIDED | EFFECT_SUN_SHADOWS};

/* What shadows leave of the forest's light, traced through a long lens. */
static double light_traced(struct world *world)
{
    const struct view wide = world->view;
    double means[2][4];
    world->view.width_px = 48;
    world->view.height_px = 40;
    world->view.fov_y_rad = 0.04f;
    for (int shaded = 0; shaded < 2; shaded++)
        means_of(traced(world, below_effects[shaded]), means[shaded]);
    world->view = wide;
    return means[1][1] / means[0][1];
}

/* So near each other that most of their shade is the others', and that mostly their sunlit tops are
 * seen; drawn one by one, and by cells. */
static void test_march_shadow__trees_below_a_pixel_are_as_dark_as_traced(void **state)
{
    (void)state;
    static const float eyes_m[3][3] = {{600, 800, 1600}, {-1200, 300, 1400}, {600, 1800, 100}};
    struct world world = world_of_forest(6);
    world.scene.terrain.samples_x = 0; /* of trees alone */
    struct ready *ready[2][2];
    for (int k = 0; k < 4; k++) {
        struct march_options options = usual;
        options.cells = k & 1;
        ready[k & 1][k / 2] = march_ready(&world, &options, below_effects[k / 2], 2);
    }
    for (int eye = 0; eye < 3; eye++) {
        world_look(&world, eyes_m[eye][0], eyes_m[eye][1], eyes_m[eye][2], 0, 2, 0);
        world_sun(&world, 0.7, 0.3, -0.5);
        double expected = light_traced(&world);
        for (int cells = 0; cells < 2; cells++) {
            double means[2][4];
            for (int shaded = 0; shaded < 2; shaded++)
                means_of(ready_picture(&world, ready[cells][shaded]), means[shaded]);
            double share = means[1][1] / means[0][1];
            if (!(fabs(share - expected) < 0.045 && expected < 0.5))
                fail_msg("%s from eye %d: %g of the light, reference %g", cells ? "cells" : "trees",
                         eye, share, expected);
        }
    }
    arena_destroy(world.arena);
}

static void test_march_shadow__a_sun_below_the_ground_gives_no_light(void **state)
{
    (void)state;
    struct world world = world_of_balls(3, 2000, 0.25);
    world.scene.terrain = level_ground(world.arena, 200, 0.4f);
    world_sun(&world, 0.6, -0.4, 0.3);
    struct ready *ready = march_ready(&world, &usual, lit | EFFECT_SUN_SHADOWS, 2);
    const struct frame *low = ready_picture(&world, ready);
    for (int i = 0; i < 3; i++)
        world.scene.sun.radiance[i] = 0;
    assert_memory_equal(low->rgba, ready_picture(&world, ready)->rgba, 4 * sizeof(float) * 96 * 80);
    arena_destroy(world.arena);
}

static void test_march_shadow__threads_and_instruction_sets_change_no_byte(void **state)
{
    (void)state;
    const unsigned effects = EFFECT_TWO_SIDED | EFFECT_SUN_SHADOWS;
    static const char *const names[] = {"plain", "avx2", "avx512"};
    struct world world = world_of_balls(3, 2000, 0.25);
    world.scene.terrain = level_ground(world.arena, 200, 0.4f);
    const struct frame *first = march_picture(&world, &usual, effects, 1);
    for (int i = 0; i < 3; i++) {
        struct march_options options = usual;
        options.isa = names[i];
        assert_memory_equal(march_picture(&world, &options, effects, 1 + i)->rgba, first->rgba,
                            4 * sizeof(float) * 96 * 80);
    }
    arena_destroy(world.arena);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_march_shadow__axes_are_at_right_angles_and_turn_little_at_the_zenith),
        cmocka_unit_test(test_march_shadow__a_slab_sees_one_minus_exp_of_its_depth_over_it),
        cmocka_unit_test(test_march_shadow__light_falls_by_exp_of_the_way_through_from_any_side),
        cmocka_unit_test(test_march_shadow__trees_behind_each_other_multiply_however_many),
        cmocka_unit_test(test_march_shadow__a_ridge_shades_as_far_as_the_sun_is_low),
        cmocka_unit_test(test_march_shadow__pictures_are_as_traced_from_low_sun_to_zenith),
        cmocka_unit_test(test_march_shadow__large_leaves_do_not_shade_themselves),
        cmocka_unit_test(test_march_shadow__a_forest_is_as_traced),
        cmocka_unit_test(test_march_shadow__trees_below_a_pixel_are_as_dark_as_traced),
        cmocka_unit_test(test_march_shadow__a_sun_below_the_ground_gives_no_light),
        cmocka_unit_test(test_march_shadow__threads_and_instruction_sets_change_no_byte),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
