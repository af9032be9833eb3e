/* The march's levels of detail turn into each other without a jump. */
#include "testing.h"

#include "reference_world.h"

#include "bake/march.h"
#include "truth/metrics.h"

#include <stdlib.h>

enum { FRAMES = 18, WIDTH = 96, HEIGHT = 80 };

/* Leaves of 0.2 m in a ball of radius 4 m. */
static struct mesh *ball(struct arena *arena)
{
    enum { LEAVES = 2500 };
    struct mesh *mesh = mesh_new(arena, MATERIAL_LEAF, 0.6f, LEAVES);
    struct random random = random_seed(31, 1);
    while (mesh->triangles_count < LEAVES) {
        double at[3], corners[2][3], square = 0;
        for (int i = 0; i < 3; i++) {
            at[i] = 8 * random_double(&random) - 4;
            square += at[i] * at[i];
        }
        if (square > 16)
            continue;
        at[1] += 5;
        for (int k = 0; k < 2; k++)
            for (int i = 0; i < 3; i++)
                corners[k][i] = at[i] + 0.4 * (random_double(&random) - 0.5);
        mesh_triangle(mesh, at, corners[0], corners[1]);
    }
    return mesh_finish(arena, mesh);
}

/* A ball 8 m wide is 96 px wide at first. Voxels of 1/8 m are a pixel from 16 m on: another level
 * at 32 m. */
static struct world path_world(void)
{
    struct world world = world_create(WIDTH, HEIGHT, 0.6);
    setenv("TREELINE_CACHE", "off", 1);
    world_add(&world, ball(world.arena), 0, 0, 0);
    world_sun(&world, 0.5, 0.7, 0.3);
    return world;
}

/* From beyond 32 m to before it, 4 % nearer at a time. */
static void path_look(struct world *world, int k)
{
    float distance_m = 45 * powf(0.96f, (float)k);
    world_look(world, 0.3f * distance_m, 5, 0.954f * distance_m, 0, 5, 0);
}

static struct march *march_ready(struct world *world, struct workspace *workspace,
                                 const struct march_options *options)
{
    struct march *march;
    *workspace = (struct workspace){.arena = world->arena,
                                    .error = ARENA_NEW(world->arena, struct error),
                                    .effects = EFFECT_TWO_SIDED,
                                    .threads = 2};
    assert_int_equal(march_prepare(workspace, &world->scene, options, &march), STATUS_OK);
    return march;
}

static struct frame *march_drawn(struct world *world, struct workspace *workspace,
                                 struct march *march)
{
    struct frame *frame = frame_create(world->arena, WIDTH, HEIGHT, false);
    struct target target = {
        .width_px = WIDTH, .height_px = HEIGHT, .format = TARGET_RGBA32F, .pixels = frame->rgba};
    assert_int_equal(march_draw(workspace, march, &world->view, &target), STATUS_OK);
    return frame;
}

static const struct march_options usual = {.resolution = 64, .step = 1, .tile_px = 16};

static void path_draw(struct world *world, float smooth, const struct frame *frames[FRAMES])
{
    struct workspace workspace;
    struct march_options options = usual;
    options.smooth = smooth;
    struct march *march = march_ready(world, &workspace, &options);
    for (int k = 0; k < FRAMES; k++) {
        path_look(world, k);
        frames[k] = march_drawn(world, &workspace, march);
    }
}

static void path_trace(struct world *world, const struct frame *frames[FRAMES])
{
    struct reference_options options = {.effects = EFFECT_TWO_SIDED,
                                        .samples_min = 64,
                                        .samples_max = 64,
                                        .threads = 2,
                                        .quiet = true};
    for (int k = 0; k < FRAMES; k++) {
        struct reference_stats stats;
        struct error error = {0};
        struct frame *frame;
        path_look(world, k);
        if (reference_render(world->arena, &world->scene, &world->view, &options, &frame, &stats,
                             &error))
            fail_msg("%s", error.text);
        frames[k] = frame;
    }
}

/* RMS over RGB of the greatest change from one picture to the next. */
static double greatest_change(const struct frame *const *frames, int count)
{
    double greatest = 0;
    for (int k = 0; k + 1 < count; k++) {
        double sum = 0;
        for (int i = 0; i < 4 * WIDTH * HEIGHT; i++)
            if (i % 4 < 3)
                sum += pow((double)frames[k + 1]->rgba[i] - frames[k]->rgba[i], 2);
        greatest = fmax(greatest, sqrt(sum / (3 * WIDTH * HEIGHT)));
    }
    return greatest;
}

static double flicker_peak(struct world *world, const struct frame *const frames[FRAMES],
                           const struct frame *const references[FRAMES], double *floor)
{
    struct flicker flicker;
    struct error error = {0};
    if (metrics_flicker(world->arena, frames, references, FRAMES, &flicker, &error))
        fail_msg("%s", error.text);
    *floor = flicker.floor;
    return flicker.peak;
}

static void test_march__smooth_levels_on_an_approach_jump_no_more_than_what_is_traced(void **state)
{
    (void)state;
    struct world world = path_world();
    const struct frame *traced[FRAMES], *drawn[2][FRAMES];
    double floor, peaks[2], own, changes[2];
    path_trace(&world, traced);
    own = greatest_change(traced, FRAMES);
    for (int k = 0; k < 2; k++) {
        path_draw(&world, (float)k, drawn[k]);
        peaks[k] = flicker_peak(&world, drawn[k], traced, &floor);
        changes[k] = greatest_change(drawn[k], FRAMES);
    }
    if (!(peaks[1] < own + floor && peaks[1] < 0.85 * peaks[0] && changes[1] < own + floor &&
          changes[0] > own + floor))
        fail_msg(
            "flicker: smooth %g, at once %g; change: smooth %g, at once %g, traced %g, noise %g",
            peaks[1], peaks[0], changes[1], changes[0], own, floor);
    arena_destroy(world.arena);
}

/* A still view while the level that a pixel asks for grows from 1.05 to 2.15, an equal part at a
 * time: the whole change is that from level 1 to level 2. */
static void test_march__a_level_turns_into_the_next_without_a_jump(void **state)
{
    (void)state;
    enum { STEPS = 12 };
    static const float smooths[3] = {0, 0.5f, 1};
    static const double most[3] = {1.001, 0.35, 0.2};
    struct world world = path_world();
    struct march_options options = usual;
    options.resolution = 16;
    const struct frame *frames[3][STEPS];
    const size_t size = sizeof(float) * 4 * WIDTH * HEIGHT;
    world_look(&world, 0, 5, 40, 0, 5, 0);
    for (int k = 0; k < 3; k++) {
        options.smooth = smooths[k];
        for (int step = 0; step < STEPS; step++) {
            struct workspace workspace;
            options.bias = 1.8f + 1.1f * (float)step / (STEPS - 1);
            struct march *march = march_ready(&world, &workspace, &options);
            frames[k][step] = march_drawn(&world, &workspace, march);
        }
        double jump = greatest_change(frames[k], STEPS), whole = greatest_change(frames[0], STEPS);
        if (!(jump > 0.01 * whole && jump < most[k] * whole))
            fail_msg("smooth %g: jumps by %g, of %g", (double)smooths[k], jump, whole);
    }
    /* what is far from another level is drawn at one */
    assert_memory_equal(frames[1][0]->rgba, frames[0][0]->rgba, size);
    assert_memory_equal(frames[1][STEPS - 1]->rgba, frames[0][STEPS - 1]->rgba, size);
    arena_destroy(world.arena);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_march__smooth_levels_on_an_approach_jump_no_more_than_what_is_traced),
        cmocka_unit_test(test_march__a_level_turns_into_the_next_without_a_jump),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
