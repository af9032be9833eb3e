/* Cells of many trees in the march's picture: against the closed form of trees at random, and
 * against the same trees one by one. */
#include "testing.h"

#include "reference_world.h"

#include "bake/march.h"

#include <stdlib.h>

/* A closed octahedron of bark, 4 m high and wide: whatever hides, it hides all. */
static struct mesh *octahedron(struct arena *arena)
{
    struct mesh *mesh = mesh_new(arena, MATERIAL_BARK, 0.6f, 8);
    for (int k = 0; k < 8; k++) {
        double x = k & 1 ? 2 : -2, y = k & 2 ? 4 : 0, z = k & 4 ? 2 : -2;
        bool turned = (k & 1) ^ (k >> 1 & 1) ^ (k >> 2 & 1);
        const double a[3] = {x, 2, 0}, b[3] = {0, y, 0}, c[3] = {0, 2, z};
        mesh_triangle(mesh, a, turned ? b : c, turned ? c : b);
    }
    return mesh_finish(arena, mesh);
}

/* count trees at random on a square around the origin. */
static struct world world_of_forest(size_t count, float half_m, uint64_t seed)
{
    struct world world = world_create(96, 80, 0.2);
    struct scene *scene = &world.scene;
    struct random random = random_seed(seed, 1);
    scene->species_count = 1;
    scene->species[0] = (struct species){
        "solid", plant_from_mesh(world.arena, "solid", octahedron(world.arena)), 1, 1, 1};
    scene->instances_count = count;
    scene->instances = ARENA_ARRAY(world.arena, struct instance, count);
    for (size_t i = 0; i < count; i++)
        scene->instances[i] = (struct instance){
            {half_m * (2 * random_float(&random) - 1), 0, half_m * (2 * random_float(&random) - 1)},
            6.2831853f * random_float(&random),
            0.7f + 0.6f * random_float(&random),
            0,
            1};
    for (int i = 0; i < 3; i++)
        scene->ambient[i] = 0.3f;
    world_sun(&world, 0.5, 0.7, 0.3);
    return world;
}

struct drawn {
    float *rgba;
    uint64_t lookups;
};

static struct drawn draw_lit(struct world *world, bool cells, float far_px, const char *isa,
                             int threads, unsigned lit)
{
    const int width_px = world->view.width_px, height_px = world->view.height_px;
    struct error error = {0};
    struct workspace workspace = {.arena = world->arena,
                                  .error = &error,
                                  .effects = EFFECT_TWO_SIDED | EFFECT_AMBIENT | lit,
                                  .threads = threads};
    const struct march_options options = {.resolution = 32,
                                          .stop = 0.02f,
                                          .step = 1,
                                          .tile_px = 16,
                                          .far_px = far_px,
                                          .cells = cells,
                                          .shadow_resolution = 32,
                                          .isa = isa};
    struct march *march;
    struct frame *frame = frame_create(world->arena, width_px, height_px, false);
    struct target target = {.width_px = width_px,
                            .height_px = height_px,
                            .format = TARGET_RGBA32F,
                            .pixels = frame->rgba};
    setenv("TREELINE_CACHE", "off", 1);
    if (march_prepare(&workspace, &world->scene, &options, &march) ||
        march_draw(&workspace, march, &world->view, &target))
        fail_msg("%s", error.text);
    return (struct drawn){frame->rgba, workspace.tally.lookups};
}

static struct drawn draw_far(struct world *world, bool cells, float far_px, const char *isa,
                             int threads)
{
    return draw_lit(world, cells, far_px, isa, threads, 0);
}

static struct drawn draw(struct world *world, bool cells, const char *isa, int threads)
{
    return draw_far(world, cells, 0, isa, threads);
}

static void means_of(const float *rgba, double means[4])
{
    memset(means, 0, 4 * sizeof *means);
    for (size_t i = 0; i < 4 * 96 * 80; i++)
        means[i % 4] += rgba[i] / (96.0 * 80);
}

enum { FOREST = 180000 };
static const float half_m = 900;

/* Looked at from far above, the picture is within the forest. */
static struct world forest_from_afar(void)
{
    struct world world = world_of_forest(FOREST, half_m, 3);
    world_look(&world, 0, 1800, 3000, 0, 2, 0);
    return world;
}

/* The octahedron's silhouette along a direction that rises so, the mean over turns: of 8 faces of
 * area 2 sqrt(3), as of every convex body, half of what they show one by one. */
static double silhouette_m2(double rise)
{
    enum { TURNS = 100 };
    double flat = sqrt(1 - rise * rise), sum = 0;
    for (int k = 0; k < TURNS * 8; k++) {
        double turn = 2 * M_PI * (k / 8) / TURNS;
        double across = flat * cos(turn), along = flat * sin(turn);
        sum += fabs((k & 1 ? across : -across) + (k & 2 ? rise : -rise) + (k & 4 ? along : -along));
    }
    return sum / TURNS;
}

/* Trees at random: exp(-n a) stays clear, n trees a square metre of the plane across the view that
 * hide a square metres each (Stoyan, Kendall and Mecke 1995). */
static void test_march_cells__a_far_forest_covers_what_trees_at_random_do(void **state)
{
    (void)state;
    struct world world = forest_from_afar();
    double squares = 0, expected = 0, means[4];
    for (size_t i = 0; i < FOREST; i++)
        squares += pow(world.scene.instances[i].scale, 2);
    for (int y = 0; y < 80; y++) {
        float ray[3];
        view_ray(&world.view, 48, (float)y + 0.5f, ray);
        double depth = squares * silhouette_m2(-ray[1]) / (4.0 * half_m * half_m * -ray[1]);
        expected += (1 - exp(-depth)) / 80;
    }
    means_of(draw(&world, true, NULL, 2).rgba, means);
    if (!(fabs(means[3] / expected - 1) < 0.03))
        fail_msg("covers %g, by the closed form %g", means[3], expected);
    arena_destroy(world.arena);
}

static void test_march_cells__a_far_forest_looks_as_its_trees_one_by_one(void **state)
{
    (void)state;
    struct world world = forest_from_afar();
    struct drawn together = draw(&world, true, NULL, 2), alone = draw(&world, false, NULL, 2);
    double of_cells[4], of_trees[4], worst = 0;
    means_of(together.rgba, of_cells);
    means_of(alone.rgba, of_trees);
    for (int c = 0; c < 4; c++)
        if (!(fabs(of_cells[c] / of_trees[c] - 1) < 0.02))
            fail_msg("channel %d: %g, by trees %g", c, of_cells[c], of_trees[c]);
    for (int y = 0; y < 80; y += 8) /* means of 8 x 8 pixels */
        for (int x = 0; x < 96; x += 8) {
            double difference = 0;
            for (int k = 0; k < 64; k++) {
                size_t at = 4 * (size_t)((y + k / 8) * 96 + x + k % 8) + 3;
                difference += ((double)together.rgba[at] - alone.rgba[at]) / 64;
            }
            worst = fmax(worst, fabs(difference));
        }
    if (!(worst > 0 && worst < 0.04)) /* 0: no cell was drawn */
        fail_msg("a box of 8 x 8 pixels differs by %g", worst);
    arena_destroy(world.arena);
}

/* As large as trees of cells become, each hides much of a pixel, and what several hide adds up to
 * more than their areas say: cells have to know. */
static void test_march_cells__trees_of_nearly_a_pixel_hide_as_much_together_as_alone(void **state)
{
    (void)state;
    struct world world = world_of_forest(31000, 300, 11);
    double covers[2];
    world_look(&world, 0, 1955, 1275, 0, 2, 0);
    for (int cells = 0; cells < 2; cells++) {
        struct drawn drawn = draw(&world, cells, NULL, 2);
        double means[4];
        means_of(drawn.rgba, means);
        covers[cells] = means[3];
    }
    if (!(covers[0] > 0.3 && covers[0] < 0.9 && fabs(covers[1] / covers[0] - 1) < 0.015 &&
          covers[1] != covers[0]))
        fail_msg("cells cover %g, their trees one by one %g", covers[1], covers[0]);
    arena_destroy(world.arena);
}

static void test_march_cells__threads_and_instruction_sets_change_no_byte(void **state)
{
    (void)state;
    struct world world = forest_from_afar();
    struct drawn one = draw(&world, true, "plain", 1), three = draw(&world, true, NULL, 3);
    assert_memory_equal(one.rgba, three.rgba, 4 * sizeof(float) * 96 * 80);
    assert_int_equal(one.lookups, three.lookups);
    arena_destroy(world.arena);
}

/* Two trees that fill the picture; then others behind it, beside it and behind the eye, too. */
static void test_march_cells__hidden_trees_and_trees_outside_cost_no_lookup(void **state)
{
    (void)state;
    struct world world = world_of_forest(3000, 40, 5);
    for (size_t i = 2; i < 3000; i++) {
        struct instance *tree = &world.scene.instances[i];
        tree->position_m[0] += i % 3 == 1 ? 400 : 0;
        tree->position_m[2] += i % 3 == 2 ? 300 : -100;
    }
    for (int i = 0; i < 2; i++)
        world.scene.instances[i] = (struct instance){{0, 0, -20.0f * (float)i}, 0, 20, 0, 1};
    world_look(&world, 0, 40, 120, 0, 40, 0);
    world.scene.instances_count = 2;
    struct drawn alone = draw(&world, true, NULL, 2);
    world.scene.instances_count = 3000;
    struct drawn among = draw(&world, true, NULL, 2);
    double means[4];
    means_of(alone.rgba, means);
    if (!(fabs(means[3] - 1) < 1e-6))
        fail_msg("the trees leave %g of the picture", 1 - means[3]);
    assert_true(alone.lookups > 0);
    assert_int_equal(among.lookups, alone.lookups);
    assert_memory_equal(among.rgba, alone.rgba, 4 * sizeof(float) * 96 * 80);
    arena_destroy(world.arena);
}

/* Nine trees, each of a radius of some 3 pixels, elsewhere in its pixels; the sun from the side. */
static struct world world_of_nine(int width_px, int height_px)
{
    struct world world = world_of_forest(9, 1, 7);
    world.scene.width_px = width_px;
    world.scene.height_px = height_px;
    for (int i = 0; i < 9; i++) {
        struct instance *tree = &world.scene.instances[i];
        tree->position_m[0] = 11.3f * (float)(i % 3 - 1);
        tree->position_m[2] = 17.7f * (float)(i / 3 - 1);
        tree->rotation_rad = 0.7853982f * (float)i; /* as far pictures are turned */
    }
    world_look(&world, 0, 150, 250, 0, 2, 0);
    world_sun(&world, 0.9, 0.3, 0.1);
    return world;
}

/* What a pixel of a far picture shows is what the pixels in it show of the tree marched, larger. */
static void
test_march_cells__trees_of_a_few_pixels_show_the_mean_of_what_is_in_a_pixel(void **state)
{
    (void)state;
    enum { TIMES = 8 };
    struct world small = world_of_nine(96, 80), large = world_of_nine(96 * TIMES, 80 * TIMES);
    struct drawn sprites = draw_far(&small, true, 8, NULL, 2);
    struct drawn marched = draw_far(&small, true, 0, NULL, 2);
    const float *fine = draw_far(&large, true, 0, NULL, 2).rgba;
    double of_sprites = 0, of_marched = 0, covers = 0, means = 0;
    assert_true(sprites.lookups > 0 && marched.lookups > 0);
    for (int i = 0; i < 96 * 80; i++)
        for (int c = 0; c < 4; c++) {
            double mean = 0;
            for (int k = 0; k < TIMES * TIMES; k++)
                mean += fine[4 * ((i / 96 * TIMES + k / TIMES) * 96 * TIMES + i % 96 * TIMES +
                                  k % TIMES) +
                             c];
            mean /= TIMES * TIMES;
            of_sprites += pow(sprites.rgba[4 * i + c] - mean, 2);
            of_marched += pow(marched.rgba[4 * i + c] - mean, 2);
            covers += c == 3 ? sprites.rgba[4 * i + c] : 0;
            means += c == 3 ? mean : 0;
        }
    if (!(fabs(covers / means - 1) < 0.04 && of_sprites < 0.6 * of_marched))
        fail_msg("cover %g of %g, squared error %g, marched %g", covers, means, of_sprites,
                 of_marched);
    arena_destroy(small.arena);
    arena_destroy(large.arena);
}

/* The share of the light from trees that is left by the shadows that they cast; the ground is
 * black. A far picture takes one mean over a tree, so within a quarter of what other trees take
 * (.40). */
static void test_march_cells__trees_of_a_few_pixels_are_as_dark_in_shadow_as_marched(void **state)
{
    (void)state;
    double left[2];
    struct world world = world_of_nine(96, 80);
    for (int c = 0; c < 3; c++)
        world.scene.terrain.albedo[c] = world.scene.ambient[c] = 0;
    world_sun(&world, 0.9, 0.15, 0.1);
    for (int far = 0; far < 2; far++) {
        double light[2] = {0};
        for (int shadows = 0; shadows < 2; shadows++) {
            const struct drawn drawn =
                draw_lit(&world, true, far ? 8 : 0, NULL, 2, shadows ? EFFECT_SUN_SHADOWS : 0);
            for (int i = 0; i < 96 * 80; i++)
                light[shadows] += drawn.rgba[4 * i + 3] > 0 ? drawn.rgba[4 * i] : 0;
        }
        left[far] = light[1] / light[0];
    }
    if (!(left[0] < 0.9 && fabs(left[1] - left[0]) < 0.1))
        fail_msg("%g of the light left in far pictures, %g marched", left[1], left[0]);
    arena_destroy(world.arena);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_march_cells__a_far_forest_covers_what_trees_at_random_do),
        cmocka_unit_test(test_march_cells__a_far_forest_looks_as_its_trees_one_by_one),
        cmocka_unit_test(test_march_cells__trees_of_nearly_a_pixel_hide_as_much_together_as_alone),
        cmocka_unit_test(test_march_cells__threads_and_instruction_sets_change_no_byte),
        cmocka_unit_test(
            test_march_cells__trees_of_a_few_pixels_show_the_mean_of_what_is_in_a_pixel),
        cmocka_unit_test(test_march_cells__hidden_trees_and_trees_outside_cost_no_lookup),
        cmocka_unit_test(test_march_cells__trees_of_a_few_pixels_are_as_dark_in_shadow_as_marched),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
