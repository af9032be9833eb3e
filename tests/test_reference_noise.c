/* Is the reference honest about its noise, unbiased when adaptive, and the same whatever the
 * threads? */
#include "reference_world.h"

#include "truth/reference_parts.h"
#include "wall/embree.h"

#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

/* Bright and dark leaves before a dark ground, with shadows: edges, small leaves, and empty parts.
 */
static struct world grove(int width_px, int height_px)
{
    struct world world = world_create(width_px, height_px, 0.8);
    struct random random = random_seed(4, 4);
    world.scene.terrain = level_ground(world.arena, 60, 0.3f);
    struct mesh *mesh = mesh_new(world.arena, MATERIAL_LEAF, 0.8f, 600);
    for (int i = 0; i < 600; i++) {
        double p[3][3], center[3];
        for (int k = 0; k < 3; k++)
            center[k] = random_double(&random) * (k == 1 ? 3 : 2) - (k == 1 ? 0 : 1);
        for (int corner = 0; corner < 3; corner++)
            for (int k = 0; k < 3; k++)
                p[corner][k] = center[k] + 0.25 * (random_double(&random) - 0.5);
        mesh_triangle(mesh, p[0], p[1], p[2]);
    }
    world_add(&world, mesh_finish(world.arena, mesh), 0, 0, 0);
    world.scene.sky = (struct sky){{0.2f, 0.3f, 0.6f}, {0.5f, 0.6f, 0.7f}, {0, 0, 0}};
    for (int i = 0; i < 3; i++)
        world.scene.ambient[i] = 0.3f;
    world_look(&world, 2, 3, 6, 0.3f, 1.4f, 0);
    world_sun(&world, 1, 2, 1);
    return world;
}

static const unsigned grove_effects =
    EFFECT_AMBIENT | EFFECT_SUN_SHADOWS | EFFECT_SKY_OCCLUSION | EFFECT_TWO_SIDED;

static struct reference_options grove_options(int samples, uint64_t seed)
{
    return (struct reference_options){
        .effects = grove_effects, .samples_min = samples, .samples_max = samples, .seed = seed};
}

struct honesty {
    double squares, stated, counted, beyond;
};

static void honesty_add(const struct frame *frame, const struct frame *truth,
                        struct honesty *honesty)
{
    size_t values = 4 * (size_t)frame->width_px * (size_t)frame->height_px;
    for (size_t i = 0; i < values; i++) {
        double error = (double)frame->rgba[i] - truth->rgba[i];
        double variance = (double)frame->variance[i] + truth->variance[i];
        honesty->squares += error * error;
        honesty->stated += variance;
        if (frame->variance[i] > 1e-6f && i % 4 == 1) {
            honesty->counted++;
            honesty->beyond += error * error > 3.182 * 3.182 * variance;
        }
    }
}

/* Pooled over pixels and eight seeds, squared errors must equal stated variances; a single pixel's
 * z has Student's distribution with three degrees of freedom, of which 5 % lie beyond 3.182. */
static void check_honest(struct world *world, struct reference_options options)
{
    struct honesty honesty = {0};
    struct frame *truth = world_render(world, grove_options(1024, 1000), NULL);
    for (options.seed = 1; options.seed <= 8; options.seed++)
        honesty_add(world_render(world, options, NULL), truth, &honesty);
    double ratio = honesty.squares / honesty.stated, share = honesty.beyond / honesty.counted;
    if (!(ratio > 0.9 && ratio < 1.1))
        fail_msg("squared error %g, stated variance %g", honesty.squares, honesty.stated);
    if (!(honesty.counted > 4000 && share > 0.02 && share < 0.1))
        fail_msg("%g of %g pixels are beyond their 95 %% interval", honesty.beyond,
                 honesty.counted);
}

static void test_reference__stated_variance_is_the_squared_error(void **state)
{
    (void)state;
    struct world world = grove(48, 40);
    check_honest(&world, grove_options(8, 1));
    check_honest(&world, grove_options(32, 2));
    arena_destroy(world.arena);
}

static void test_reference__stated_variance_holds_when_adaptive(void **state)
{
    (void)state;
    struct world world = grove(48, 40);
    struct reference_options options = grove_options(16, 3);
    options.standard_error = 0.01f;
    options.samples_max = 512;
    check_honest(&world, options);
    arena_destroy(world.arena);
}

static void test_reference__seeds_agree_within_their_errors(void **state)
{
    (void)state;
    struct world world = grove(48, 40);
    for (int channel = 0; channel < 4; channel++) {
        double first_error, second_error;
        double first =
            frame_mean(world_render(&world, grove_options(16, 1), NULL), channel, &first_error);
        double second =
            frame_mean(world_render(&world, grove_options(16, 2), NULL), channel, &second_error);
        assert_true(first != second);
        assert_true(fabs(first - second) < 3.5 * hypot(first_error, second_error));
    }
    arena_destroy(world.arena);
}

/* Rare bright leaves on black: the case where stopping early on a quiet pixel would darken the
 * mean. The pilot has four samples; over many seeds the mean must be the leaves' known area. */
static void test_reference__adaptive_means_are_unbiased(void **state)
{
    (void)state;
    enum { SEEDS = 600, LEAVES = 9 };
    struct world world = world_create(12, 12, 0.5);
    struct mesh *mesh = mesh_new(world.arena, MATERIAL_LEAF, 1, 1);
    mesh_triangle(mesh, (double[]){0, 0, 0}, (double[]){1, 0, 0}, (double[]){0, 1, 0});
    mesh_finish(world.arena, mesh);
    for (int i = 0; i < LEAVES; i++)
        world_add(&world, mesh, -0.9f + 0.6f * (float)(i % 3), -0.8f + 0.55f * (float)(i / 3), -4)
            ->scale = 0.06f + 0.004f * (float)i;
    world_look(&world, 0, 0, 0, 0, 0, -1);
    world_sun(&world, 0, 0, 1);
    double truth = 0, scale = 12 / (2 * tan(0.25) * 4) / 12, sum = 0, squares = 0, samples = 0;
    for (int i = 0; i < LEAVES; i++)
        truth += 0.5 * pow((double)(0.06f + 0.004f * (float)i) * scale, 2);
    for (uint64_t seed = 0; seed < SEEDS; seed++) {
        struct reference_options options = {
            .standard_error = 0.04f, .samples_min = 4, .samples_max = 256, .seed = seed};
        struct reference_stats stats;
        double error, mean = frame_mean(world_render(&world, options, &stats), 0, &error);
        sum += mean;
        squares += mean * mean;
        samples += stats.samples / SEEDS;
    }
    double mean = sum / SEEDS, error = sqrt((squares / SEEDS - mean * mean) / SEEDS);
    assert_true(samples > 1.5 * 4 * 144); /* it did adapt */
    if (!(fabs(mean - truth) < 3.5 * error && error < 0.03 * truth))
        fail_msg("mean %g +- %g, not %g", mean, error, truth);
    arena_destroy(world.arena);
}

static void test_reference__the_asked_standard_error_is_reached_and_not_much_more(void **state)
{
    (void)state;
    struct world world = grove(96, 64);
    for (int i = 0; i < 3; i++) {
        struct reference_options options = grove_options(8, 5);
        struct reference_stats stats, plain;
        options.standard_error = 0.02f / (float)(1 << i);
        options.samples_max = 8192;
        struct frame *frame = world_render(&world, options, &stats);
        double sum = 0;
        for (size_t pixel = 0; pixel < 96 * 64; pixel++)
            for (size_t k = 0; k < 3; k++)
                sum += frame->variance[4 * pixel + k] / (3.0 * 96 * 64);
        assert_true(fabs(sqrt(sum) - stats.standard_error) < 1e-5);
        assert_true(stats.standard_error <= options.standard_error);
        assert_true(stats.standard_error > 0.75f * options.standard_error);
        /* Fewer samples than the same number everywhere would need. */
        int uniform = 8;
        do {
            uniform *= 2;
            world_render(&world, grove_options(uniform, 6), &plain);
        } while (plain.standard_error > stats.standard_error);
        assert_true(stats.samples < plain.samples);
    }
    arena_destroy(world.arena);
}

static void test_reference__samples_max_ends_what_cannot_be_reached(void **state)
{
    (void)state;
    struct world world = grove(24, 16);
    struct reference_options options = grove_options(16, 1);
    struct reference_stats stats;
    options.standard_error = 1e-9f;
    options.samples_max = 64;
    world_render(&world, options, &stats);
    assert_true(stats.samples <= 64 * 24 * 16 && stats.samples > 40 * 24 * 16);
    assert_true(stats.standard_error > options.standard_error);
    arena_destroy(world.arena);
}

static void test_reference__one_and_two_threads_give_the_same_bytes(void **state)
{
    (void)state;
    struct world world = grove(70, 50); /* tiles that the border cuts */
    struct reference_options options = grove_options(16, 9);
    struct reference_stats stats[2];
    struct frame *frames[2];
    options.standard_error = 0.005f;
    options.samples_max = 512;
    for (int i = 0; i < 2; i++) {
        options.threads = i + 1;
        frames[i] = world_render(&world, options, &stats[i]);
    }
    size_t bytes = 70 * 50 * 4 * sizeof(float);
    assert_memory_equal(frames[0]->rgba, frames[1]->rgba, bytes);
    assert_memory_equal(frames[0]->variance, frames[1]->variance, bytes);
    assert_true(stats[0].samples == stats[1].samples);
    assert_true(stats[0].shadow_rays == stats[1].shadow_rays);
    arena_destroy(world.arena);
}

/* The share of a pixel must not change with what was measured in the pixel itself. */
static void test_reference__a_pixels_share_does_not_depend_on_its_own_variance(void **state)
{
    (void)state;
    enum { WIDTH = 9, HEIGHT = 7, PIXELS = WIDTH * HEIGHT };
    float variance[PIXELS][4];
    int16_t before[PIXELS], after[PIXELS];
    struct random random = random_seed(8, 8);
    for (int i = 0; i < PIXELS; i++)
        for (int k = 0; k < 4; k++)
            variance[i][k] = random_float(&random);
    plan_levels((const float(*)[4])variance, WIDTH, HEIGHT, before);
    for (int i = 0; i < PIXELS; i++) {
        float kept = variance[i][1];
        variance[i][1] = 1000;
        plan_levels((const float(*)[4])variance, WIDTH, HEIGHT, after);
        assert_int_equal(after[i], before[i]);
        assert_memory_not_equal(after, before, sizeof after); /* but its neighbours' does */
        variance[i][1] = kept;
    }
}

static void test_reference__the_cache_returns_the_same_frame(void **state)
{
    (void)state;
    char folder[] = "/tmp/treeline-test-XXXXXX";
    assert_non_null(mkdtemp(folder));
    setenv("TREELINE_CACHE", folder, 1);
    struct world world = grove(20, 16);
    world.scene.hash = 12345;
    struct reference_options options = grove_options(16, 9);
    struct reference_stats stats[2];
    struct frame *frames[2];
    struct error error;
    options.quiet = true;
    for (int i = 0; i < 2; i++) {
        options.threads = i + 1;
        assert_int_equal(reference_cached(world.arena, &world.scene, &world.view, &options,
                                          &frames[i], &stats[i], &error),
                         STATUS_OK);
    }
    assert_false(stats[0].from_cache);
    assert_true(stats[1].from_cache);
    assert_true(stats[1].samples == stats[0].samples);
    assert_memory_equal(frames[0]->rgba, frames[1]->rgba, 20 * 16 * 4 * sizeof(float));
    assert_memory_equal(frames[0]->variance, frames[1]->variance, 20 * 16 * 4 * sizeof(float));
    char command[128];
    snprintf(command, sizeof command, "rm -rf %s", folder);
    assert_int_equal(system(command), 0);
    unsetenv("TREELINE_CACHE");
    arena_destroy(world.arena);
}

static void test_reference__the_key_changes_with_all_that_changes_the_picture(void **state)
{
    (void)state;
    struct world world = grove(20, 16);
    struct reference_options options = grove_options(16, 9);
    uint64_t keys[12];
    int count = 0;
    keys[count++] = reference_key(&world.scene, &world.view, &options);
    options.threads = 7;
    options.quiet = true;
    assert_true(reference_key(&world.scene, &world.view, &options) == keys[0]);
    options.seed++;
    keys[count++] = reference_key(&world.scene, &world.view, &options);
    options.effects ^= EFFECT_FOG;
    keys[count++] = reference_key(&world.scene, &world.view, &options);
    options.samples_max = 64;
    keys[count++] = reference_key(&world.scene, &world.view, &options);
    options.samples_min = 4;
    keys[count++] = reference_key(&world.scene, &world.view, &options);
    options.standard_error = 0.1f;
    keys[count++] = reference_key(&world.scene, &world.view, &options);
    world.scene.hash++;
    keys[count++] = reference_key(&world.scene, &world.view, &options);
    world.view.width_px++;
    keys[count++] = reference_key(&world.scene, &world.view, &options);
    world.view.eye_m[1] += 0.1f;
    keys[count++] = reference_key(&world.scene, &world.view, &options);
    world.view.sun_direction[0] += 0.1f;
    keys[count++] = reference_key(&world.scene, &world.view, &options);
    world.view.near_m *= 2;
    keys[count++] = reference_key(&world.scene, &world.view, &options);
    for (int i = 0; i < count; i++)
        for (int j = 0; j < i; j++)
            assert_true(keys[i] != keys[j]);
    arena_destroy(world.arena);
}

static void expect_refusal(struct world *world, struct reference_options options, const char *text)
{
    struct error error = {0};
    struct frame *frame = NULL;
    enum status status =
        reference_render(world->arena, &world->scene, &world->view, &options, &frame, NULL, &error);
    assert_int_equal(status, STATUS_INVALID);
    assert_non_null(strstr(error.text, text));
}

/* Eight rays down onto a triangle, of sixteen lanes of which the rest are no numbers. */
static void test_embree__unused_lanes_of_a_packet_may_hold_anything(void **state)
{
    (void)state;
    enum { USED = 8 };
    struct arena *arena = arena_create(0);
    struct error error = {0};
    struct embree *embree;
    static const float positions[] = {-1, 0, -1, 1, 0, -1, 0, 0, 2};
    static const uint32_t triangle[] = {0, 1, 2};
    static const float identity[12] = {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0};
    const struct embree_part part = {.first_triangle = 0, .triangles_count = 1};
    const struct embree_mesh mesh = {.positions = positions,
                                     .vertices_count = 3,
                                     .triangles = triangle,
                                     .triangles_count = 1,
                                     .parts = &part,
                                     .parts_count = 1};
    assert_int_equal(embree_create(arena, 1, &embree, &error), STATUS_OK);
    assert_int_equal(embree_add_mesh(embree, &mesh, &error), STATUS_OK);
    embree_add_instance(embree, 0, identity);
    assert_int_equal(embree_commit(embree, &error), STATUS_OK);
    for (int coherent = 0; coherent < 2; coherent++) {
        struct embree_packet packet;
        memset(&packet, 0xff, sizeof packet);
        for (int lane = 0; lane < USED; lane++) {
            packet.origin[0][lane] = lane % 2 ? 3 : 0;
            packet.origin[1][lane] = 1;
            packet.origin[2][lane] = packet.direction[0][lane] = packet.direction[2][lane] = 0;
            packet.direction[1][lane] = -1;
            packet.near[lane] = 0;
            packet.far[lane] = INFINITY;
        }
        struct embree_packet shadow = packet;
        embree_intersect(embree, &packet, USED, coherent);
        for (int lane = 0; lane < USED; lane++)
            assert_int_equal(packet.geometry[lane], lane % 2 ? EMBREE_NONE : 0);
        assert_int_equal(embree_occluded(embree, &shadow, USED), 0x55);
    }
    embree_destroy(embree);
    arena_destroy(arena);
}

static void test_reference__bad_requests_are_refused_by_name(void **state)
{
    (void)state;
    struct world world = grove(20, 16);
    expect_refusal(&world, (struct reference_options){.samples_min = -1},
                   "samples_min: -1 is outside 1..65536");
    expect_refusal(&world, (struct reference_options){.samples_min = 32, .samples_max = 16},
                   "samples_max: 16 is outside 32..65536");
    expect_refusal(&world, (struct reference_options){.standard_error = NAN},
                   "standard_error: nan");
    expect_refusal(&world, (struct reference_options){.standard_error = -1}, "standard_error: -1");
    expect_refusal(&world, (struct reference_options){.effects = 1u << 9},
                   "effects: 0x200 is outside 0..0x3f");
    expect_refusal(&world, (struct reference_options){.threads = -2}, "threads: -2 is outside");
    world.scene.instances[0].species = 9;
    expect_refusal(&world, grove_options(4, 1), "instance 0: species 9 is outside 0..0");
    world.view.width_px = 0;
    expect_refusal(&world, grove_options(4, 1), "size 0 x 16 px is outside 1..16384");
    arena_destroy(world.arena);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_reference__stated_variance_is_the_squared_error),
        cmocka_unit_test(test_reference__stated_variance_holds_when_adaptive),
        cmocka_unit_test(test_reference__seeds_agree_within_their_errors),
        cmocka_unit_test(test_reference__adaptive_means_are_unbiased),
        cmocka_unit_test(test_reference__the_asked_standard_error_is_reached_and_not_much_more),
        cmocka_unit_test(test_reference__samples_max_ends_what_cannot_be_reached),
        cmocka_unit_test(test_reference__one_and_two_threads_give_the_same_bytes),
        cmocka_unit_test(test_reference__a_pixels_share_does_not_depend_on_its_own_variance),
        cmocka_unit_test(test_reference__the_cache_returns_the_same_frame),
        cmocka_unit_test(test_reference__the_key_changes_with_all_that_changes_the_picture),
        cmocka_unit_test(test_embree__unused_lanes_of_a_packet_may_hold_anything),
        cmocka_unit_test(test_reference__bad_requests_are_refused_by_name),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
