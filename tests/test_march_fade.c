/* Voxels, far pictures and cells of the march turn into each other without a jump. */
#include "testing.h"

#include "march_world.h"

#include "base/random.h"

/* Trees in a row across the view: all are at one depth, and change at once. */
static struct world world_of_row(size_t trees, float apart_m)
{
    struct world world = world_of_balls(1, 2500, 0.4);
    struct scene *scene = &world.scene;
    struct random random = random_seed(5, 2);
    scene->instances_count = trees;
    scene->instances = ARENA_ARRAY(world.arena, struct instance, trees);
    for (size_t i = 0; i < trees; i++) {
        float across_m = apart_m * ((float)i - 0.5f * (float)(trees - 1));
        scene->instances[i] = (struct instance){
            {across_m, 0, 0}, (float)(2 * M_PI * random_double(&random)), 1, 0, 1};
    }
    return world;
}

/* A way toward the row. */
struct way {
    float from_m, to_m;
};
enum { STEPS = 40 };

static double mean_of(const struct frame *frame)
{
    double means[4];
    means_of(frame, means);
    return (means[0] + means[1] + means[2]) / 3;
}

/* What the row shows in each of the steps, times the squared distance: its size does not count. */
static void way_go(struct world *world, const struct march_options *options, const struct way *way,
                   double shown[STEPS])
{
    struct ready *ready = march_ready(world, options, EFFECT_TWO_SIDED | EFFECT_AMBIENT, 2);
    for (int k = 0; k < STEPS; k++) {
        float away_m = way->from_m * powf(way->to_m / way->from_m, (float)k / (STEPS - 1));
        world_look(world, 0, 5 + 0.2f * away_m, 0.98f * away_m, 0, 5, 0);
        shown[k] = mean_of(ready_picture(world, ready)) * away_m * away_m;
    }
}

/* The greatest step between two pictures of the way, of what is shown: at once, and gradually. */
static void expect_gradual(struct world *world, const struct march_options *from,
                           const struct way *way, double at_once, double part)
{
    struct march_options options = *from;
    double shown[STEPS], greatest[2] = {0, 0};
    for (int k = 0; k < 2; k++) {
        options.smooth = (float)k;
        way_go(world, &options, way, shown);
        for (int i = 1; i < STEPS; i++)
            greatest[k] = fmax(greatest[k], fabs(shown[i] / shown[i - 1] - 1));
    }
    if (!(greatest[0] > at_once && greatest[1] < part * greatest[0]))
        fail_msg("greatest step: at once %g, smooth %g", greatest[0], greatest[1]);
}

static double change(const struct frame *a, const struct frame *b)
{
    double sum = 0;
    for (int i = 0; i < 4 * a->width_px * a->height_px; i++)
        sum += pow((double)a->rgba[i] - b->rgba[i], 2);
    return sqrt(sum);
}

/* A still view of a tree that is larger, then smaller than what is drawn as a far picture. */
static void test_march__voxels_turn_into_far_pictures_without_a_jump(void **state)
{
    (void)state;
    enum { LIMITS = 20 };
    struct world world = world_of_balls(1, 2500, 0.4);
    struct march_options options = usual;
    world_look(&world, 9, 8, 100, 0, 5, 0);
    double greatest[2] = {0, 0}, whole = 0;
    for (int smooth = 0; smooth < 2; smooth++) {
        struct frame *first = NULL, *last = NULL;
        options.smooth = (float)smooth;
        for (int k = 0; k < LIMITS; k++) {
            options.far_px = 4 * powf(4, (float)k / (LIMITS - 1));
            struct frame *frame = march_picture(&world, &options, EFFECT_TWO_SIDED, 2);
            if (k > 0)
                greatest[smooth] = fmax(greatest[smooth], change(last, frame));
            last = frame;
            first = first ? first : frame;
        }
        whole = change(first, last);
    }
    if (!(greatest[0] > 0.999 * whole && greatest[1] < 0.25 * whole && whole > 0.05))
        fail_msg("greatest change: at once %g, smooth %g of %g", greatest[0], greatest[1], whole);
    arena_destroy(world.arena);
}

static void test_march__voxels_turn_into_points_without_a_jump(void **state)
{
    (void)state;
    struct world world = world_of_row(64, 8);
    struct march_options options = usual;
    static const struct way way = {1500, 300};
    options.cells = false;
    expect_gradual(&world, &options, &way, 0.2, 0.5);
    arena_destroy(world.arena);
}

static void test_march__cells_turn_into_trees_without_a_jump(void **state)
{
    (void)state;
    struct world world = world_of_row(256, 2.4f);
    static const struct way way = {1500, 700};
    expect_gradual(&world, &usual, &way, 0.1, 0.5);
    arena_destroy(world.arena);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_march__voxels_turn_into_far_pictures_without_a_jump),
        cmocka_unit_test(test_march__voxels_turn_into_points_without_a_jump),
        cmocka_unit_test(test_march__cells_turn_into_trees_without_a_jump),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
