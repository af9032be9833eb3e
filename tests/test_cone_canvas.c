/* Relief and trees in one cone: where an edge of relief crosses a pixel, the pixel is the mean of
 * 4 x 4 of its parts, each of which has one depth. */
#include "conifer_world.h"

#include "bake/cone_canvas.h"
#include "base/random.h"

enum { WIDTH = 36, HEIGHT = 34, FINE = 4 };

/* A hedge of twigs behind a slanted ridge, which hides some of it; before a hill or a black sky.
 * With the hill it stands a second time before the ridge, a third as large at a third of the
 * distance. */
static struct world ridge(int fine, bool trees, bool hill)
{
    enum { COUNT = 80 };
    struct world world = world_create(WIDTH * fine, HEIGHT * fine, 0.5);
    struct terrain *terrain = &world.scene.terrain;
    struct conifer_twig twigs[COUNT];
    struct random random = random_seed(5, 1);
    for (int k = 0; k < COUNT; k++) {
        twigs[k] = twig_along(random_double(&random) - 0.5, 1, 0.3);
        twigs[k].base_m[0] = 0.03f * (float)k - 1.2f;
        twigs[k].base_m[1] =
            0.3f + 0.2125f * twigs[k].base_m[0]; /* the ridge is seen 0.15 m above */
        twigs[k].needle_radius_m = 0.002f;
    }
    if (trees)
        plant_add(&world, plant_of(world.arena, twigs, COUNT));
    if (trees && hill)
        world.scene.instances[world.scene.instances_count++] =
            (struct instance){{-0.05f, 0.6f, 3}, 0, 1.0f / 3, 0, 1};
    world.scene.terrain = level_ground(world.arena, 8, 0.4f);
    terrain->samples_z = 5;
    terrain->heights_m = ARENA_ARRAY(world.arena, float, 10);
    terrain->normals = arena_alloc(world.arena, 10, sizeof *terrain->normals);
    for (int i = 0; i < 10; i++) {
        terrain->heights_m[i] = i / 2 == 3 ? (i % 2 ? 1.5f : -0.2f) : i < 2 && hill ? 2.5f : -1.5f;
        terrain->normals[i][i < 6 ? 2 : 1] = 1; /* what is behind the ridge is darker */
    }
    world_look(&world, 0, 0.9f, 4.5f, 0, 0.5f, 0);
    world_sun(&world, 0.5, 0.7, 0.3);
    return world;
}

static struct frame *picture(struct world *world, bool edges)
{
    struct cones_options options = options_of(CONE_NEEDLE);
    options.edges = edges;
    options.shadows = false;
    return drawn(world, &options, 0, 2);
}

/* The mean over a pixel's parts. */
static double part_mean(const struct frame *fine, size_t pixel, int channel)
{
    double sum = 0;
    for (size_t k = 0; k < FINE * FINE; k++) {
        size_t x = FINE * (pixel % WIDTH) + k % FINE, y = FINE * (pixel / WIDTH) + k / FINE;
        sum += fine->rgba[4 * (y * FINE * WIDTH + x) + (size_t)channel];
    }
    return sum / (FINE * FINE);
}

static void check_parts(bool hill)
{
    struct world world = ridge(1, false, hill), parts = ridge(FINE, false, hill);
    struct frame *cut = picture(&world, true), *whole = picture(&world, false);
    struct frame *fine = picture(&parts, false);
    int edges = 0, coarse = 0, missed = 0;
    for (size_t i = 0; i < WIDTH * HEIGHT; i++) {
        double truth = part_mean(fine, i, 0);
        missed += fabs(cut->rgba[4 * i] - truth) > 0.02;
        if (cut->rgba[4 * i] == whole->rgba[4 * i])
            continue;
        edges++;
        coarse += fabs(whole->rgba[4 * i] - truth) > 0.01;
        if (!(fabs(cut->rgba[4 * i] - truth) < 1e-4))
            fail_msg("pixel %zu: %g, its parts %g", i, (double)cut->rgba[4 * i], truth);
    }
    if (edges <= 20 || coarse <= 15 || missed > 0)
        fail_msg("%d edges, %d wrong without layers, %d missed", edges, coarse, missed);
    arena_destroy(world.arena);
    arena_destroy(parts.arena);
}

static void test_canvas__an_edge_of_relief_is_the_mean_of_its_parts(void **state)
{
    (void)state;
    check_parts(false);
    check_parts(true);
}

/* Trees behind the edge: seen in the part of the pixel that the relief leaves; before it: in all of
 * it. */
static void check_trees(bool hill)
{
    struct world world = ridge(1, true, hill), parts = ridge(FINE, true, hill);
    struct world bare = ridge(1, false, hill);
    struct frame *cut = picture(&world, true), *whole = picture(&world, false);
    struct frame *fine = picture(&parts, false);
    struct frame *edge[2] = {picture(&bare, true), picture(&bare, false)};
    double sum = 0, error[2] = {0, 0};
    for (size_t i = 0; i < WIDTH * HEIGHT; i++) {
        if (edge[0]->rgba[4 * i] == edge[1]->rgba[4 * i])
            continue;
        double truth = part_mean(fine, i, 3);
        sum += truth;
        error[0] += fabs(cut->rgba[4 * i + 3] - truth);
        error[1] += fabs(whole->rgba[4 * i + 3] - truth);
    }
    /* a hedge before the ridge is right without layers, too */
    if (!(sum > 2 && error[0] < (hill ? 0.06 : 0.12) * sum && (hill || error[0] < 0.4 * error[1])))
        fail_msg("covered %.2f, off by %.2f, without layers by %.2f", sum, error[0], error[1]);
    arena_destroy(world.arena);
    arena_destroy(parts.arena);
    arena_destroy(bare.arena);
}

static void test_canvas__an_edge_of_relief_hides_its_part_of_a_tree(void **state)
{
    (void)state;
    check_trees(false);
    check_trees(true);
}

/* The farthest relief at the centres of a pixel's tile. */
static float tile_far_m(const struct cone_canvas *canvas, int x, int y)
{
    float far_m = 0;
    for (int row = y / CONE_TILE * CONE_TILE; row < HEIGHT; row++)
        for (int column = x / CONE_TILE * CONE_TILE; column < WIDTH; column++)
            if (row / CONE_TILE == y / CONE_TILE && column / CONE_TILE == x / CONE_TILE)
                far_m = fmaxf(far_m, canvas->front_m[row * WIDTH + column]);
    return far_m;
}

/* A level ridge whose edge goes down through the first row of a tile, so that at last parts of
 * pixels alone see the sky. */
static void test_canvas__what_parts_of_a_pixel_see_is_not_passed_over(void **state)
{
    (void)state;
    int beyond = 0;
    for (int step = 0; step < 16; step++) {
        struct world world = ridge(1, false, false);
        struct error error = {0};
        struct workspace workspace = {.arena = world.arena, .error = &error, .threads = 2};
        enum status status;
        world.scene.terrain.heights_m[6] = world.scene.terrain.heights_m[7] = 0.12f - 0.005f * step;
        struct cone_canvas *canvas =
            cone_canvas_create(&workspace, &world.scene, NULL, true, &status);
        assert_int_equal(status, STATUS_OK);
        cone_canvas_begin(&workspace, canvas, &world.view);
        for (int i = 0; i < WIDTH * HEIGHT; i++)
            for (int k = 0; k < CONE_LAYERS && canvas->edges[i] >= 0; k++) {
                const struct cone_layer *layer =
                    &canvas->layers[CONE_LAYERS * canvas->edges[i] + k];
                const float place_px[2] = {(float)(i % WIDTH), (float)(i / WIDTH)};
                const float near_m = fminf(0.999f * layer->depth_m, 1e6f);
                assert_true(layer->share == 0 || cone_canvas_sees(canvas, place_px, 0, near_m));
                beyond += layer->share > 0 && near_m > tile_far_m(canvas, i % WIDTH, i / WIDTH);
            }
        arena_destroy(world.arena);
    }
    assert_true(beyond > 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_canvas__an_edge_of_relief_is_the_mean_of_its_parts),
        cmocka_unit_test(test_canvas__an_edge_of_relief_hides_its_part_of_a_tree),
        cmocka_unit_test(test_canvas__what_parts_of_a_pixel_see_is_not_passed_over),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
