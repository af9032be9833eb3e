/* Sifted pictures against those of every triangle, and what sifting may drop. */
#include "pictures.h"

#include "bake/sift.h"
#include "base/random.h"
#include "scene/scene.h"

enum { WIDTH = 96, HEIGHT = 72 };

static struct scene *forest(struct arena *arena, size_t trees)
{
    struct error error;
    struct scene *scene;
    struct scene_request request = {
        .trees = trees, .seed = 3, .width_px = WIDTH, .height_px = HEIGHT};
    if (scene_load(arena, "oak-hills", &request, &scene, &error) != STATUS_OK)
        fail_msg("%s", error.text);
    return scene;
}

static struct picture draw(struct arena *arena, const struct scene *scene, const struct view *view,
                           enum lod lod, const char *options)
{
    struct setting setting = {.method = "polygons",
                              .options = options,
                              .effects = EFFECT_AMBIENT | EFFECT_TWO_SIDED | EFFECT_FOG,
                              .lod = lod,
                              .format = TARGET_RGBA32F};
    return picture_draw(arena, scene, view, &setting);
}

/* Rounding may move a corner by 1/256 px, and depths that are equal in the buffer to either side.
 */
static void compare(const struct picture *a, const struct picture *b, size_t allowed)
{
    size_t other = 0, covered = 0;
    for (size_t i = 0; i < WIDTH * HEIGHT; i++) {
        double worst = 0;
        for (int k = 0; k < 4; k++)
            worst = fmax(worst, fabs((double)a->rgba[4 * i + k] - b->rgba[4 * i + k]));
        other += worst > 2e-3;
        covered += b->rgba[4 * i + 3] > 0;
    }
    assert_true(covered > 300);
    if (other > allowed)
        fail_msg("%zu of %zu covered pixels differ", other, covered);
}

static void test_sift__no_level_of_a_forest_looks_other_than_with_every_triangle(void **state)
{
    (void)state;
    static const char *const sifted_options[] = {"sift=on", "sift=on,samples=4",
                                                 "sift=on,samples=16"};
    static const char *const all_options[] = {"sift=off", "sift=off,samples=4",
                                              "sift=off,samples=16"};
    struct arena *arena = arena_create(0);
    struct scene *scene = forest(arena, 12);
    struct view view;
    for (int run = 0; run < 5; run++) {
        static const enum lod lods[] = {LOD_HIGH, LOD_AUTO, LOD_LOW, LOD_HIGH, LOD_AUTO};
        static const int samples[] = {0, 0, 0, 1, 2};
        int i = run % 3;
        view_at(scene, 0.5 * i, &view);
        struct picture sifted = draw(arena, scene, &view, lods[run], sifted_options[samples[run]]);
        struct picture all = draw(arena, scene, &view, lods[run], all_options[samples[run]]);
        compare(&sifted, &all, 8);
        assert_true(2 * sifted.triangles < all.triangles || lods[run] != LOD_HIGH);
    }
    arena_destroy(arena);
}

static void test_sift__a_tree_around_the_eye_is_drawn(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct scene *scene = forest(arena, 3);
    const float *foot = scene->instances[0].position_m;
    float eye[3] = {foot[0] + 1, foot[1] + 7, foot[2]};
    float target[3] = {foot[0] + 20, foot[1] + 5, foot[2] + 3};
    struct view view;
    view_look_at(scene, eye, target, &view);
    struct picture sifted = draw(arena, scene, &view, LOD_HIGH, "sift=on");
    struct picture all = draw(arena, scene, &view, LOD_HIGH, "sift=off");
    compare(&sifted, &all, 20);
    arena_destroy(arena);
}

/* Two leaves of a triangle each, of size `size` m, upright at z = 0, facing +z, about (0, 2). */
static struct sift_set *leaf(struct arena *arena, float size)
{
    struct sift_vertex *vertices = ARENA_ARRAY(arena, struct sift_vertex, 3);
    static const float corners[3][2] = {{-0.5f, -0.5f}, {0.5f, -0.5f}, {0, 0.5f}};
    for (int i = 0; i < 3; i++) {
        vertices[i].position_m[0] = size * corners[i][0];
        vertices[i].position_m[1] = 2 + size * corners[i][1];
        vertices[i].normal[2] = 32767;
        vertices[i].normal[3] = 1;
    }
    return sift_set_create(arena, vertices, 1, NULL, NULL);
}

static const struct sampling_places middle = {1, {{0.5f, 0.5f}}};

/* Triangles left of a set for trees, with room for the least. */
static size_t left_of(struct arena *arena, const struct scene *scene, const struct view *view,
                      const struct sampling_places *places, const struct sift_set *set, int threads)
{
    struct sift_run run = {.set = set, .kept = (float)set->count, .growth = 1};
    struct sift_tree *trees = ARENA_ARRAY(arena, struct sift_tree, scene->instances_count);
    for (size_t i = 0; i < scene->instances_count; i++)
        trees[i] = (struct sift_tree){&scene->instances[i], 0, 1, 0, 4, 3, false, 0};
    struct sift *sift = sift_create(arena, threads, 4096);
    struct sift_vertex *vertices =
        ARENA_ARRAY(arena, struct sift_vertex, sift_vertices_count(sift));
    size_t left = 0;
    sift_begin(sift, view, places, trees, scene->instances_count, &run);
    while (sift_fill(sift, vertices))
        for (int stream = 0; stream < SIFT_STREAMS; stream++)
            for (int thread = 0; thread < sift_threads(sift); thread++)
                left += sift_left(sift, stream, thread).count / 3;
    return left;
}

/* Triangles `size_px` wide and high at a depth of 101 m. */
static void expect_share(const struct scene *scene, const struct view *view,
                         const struct sampling_places *places, double size_px, int threads,
                         double slack)
{
    struct arena *arena = arena_create(0);
    float pixel_m = 100 * 2 * tanf(0.4f) / HEIGHT;
    double want = places->count * 0.5 * size_px * size_px;
    size_t left =
        left_of(arena, scene, view, places, leaf(arena, (float)size_px * pixel_m), threads);
    double share = (double)left / (double)scene->instances_count;
    arena_destroy(arena);
    if (!(share > 0.95 * want && share < slack * want))
        fail_msg("%d samples, %d threads: a share of %g is left, not %g", places->count, threads,
                 share, want);
}

static void test_sift__small_triangles_are_left_as_often_as_they_meet_a_sample(void **state)
{
    (void)state;
    enum { TREES = 20000 };
    struct arena *arena = arena_create(0);
    struct scene *scene = scene_by_hand(arena, WIDTH, HEIGHT);
    struct random random = random_seed(1, 2);
    scene->instances_count = TREES;
    scene->instances = ARENA_ARRAY(arena, struct instance, TREES);
    float depth_m = 100, pixel_m = depth_m * 2 * tanf(0.4f) / HEIGHT;
    float right_m = 0.8f * WIDTH / 2 * pixel_m, up_m = 0.8f * HEIGHT / 2 * pixel_m;
    for (size_t i = 0; i < TREES; i++) /* each nearer than the last: nothing is hidden */
        scene->instances[i] =
            (struct instance){{right_m * (2 * random_float(&random) - 1),
                               up_m * (2 * random_float(&random) - 1) - 2, (float)i * 1e-4f},
                              0,
                              1,
                              0,
                              1};
    float eye[3] = {0, 0, depth_m + 1}, target[3] = {0, 0, 0};
    struct view view;
    view_look_at(scene, eye, target, &view);
    /* the chance that a sample lies in a triangle is its area; a rounding margin adds to that */
    for (int threads = 1; threads <= 3; threads++)
        expect_share(scene, &view, &middle, 0.6, threads, 1.15);
    /* none of these four is within 0.24 px of another, upright or across: one at most is met */
    static const struct sampling_places four = {
        4, {{0.375f, 0.125f}, {0.875f, 0.375f}, {0.125f, 0.625f}, {0.625f, 0.875f}}};
    expect_share(scene, &view, &four, 0.24, 2, 1.4);
    arena_destroy(arena);
}

static void test_sift__what_a_nearer_triangle_covers_is_dropped(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct scene *scene = scene_by_hand(arena, WIDTH, HEIGHT);
    scene->instances_count = 3;
    scene->instances = ARENA_ARRAY(arena, struct instance, 3);
    float pixel_m = 20 * 2 * tanf(0.4f) / HEIGHT;
    float eye[3] = {pixel_m / 2, 2 + pixel_m / 2, 20},
          target[3] = {pixel_m / 2, 2 + pixel_m / 2, 0};
    struct view view;
    view_look_at(scene, eye, target, &view);
    for (int i = 0; i < 3; i++)
        scene->instances[i] = (struct instance){{0, 0, i == 1 ? -1 : 0}, 0, 1, 0, 1};
    scene->instances_count = 1;
    size_t one = left_of(arena, scene, &view, &middle, leaf(arena, 4 * pixel_m), 2);
    scene->instances_count =
        2; /* the second stands a metre behind: smaller, in the first's middle */
    size_t two = left_of(arena, scene, &view, &middle, leaf(arena, 4 * pixel_m), 2);
    assert_true(one >= 1);
    struct instance nearer = scene->instances[0];
    scene->instances[0] = scene->instances[1];
    scene->instances[1] = nearer; /* from far to near nothing is known yet */
    size_t both = left_of(arena, scene, &view, &middle, leaf(arena, 4 * pixel_m), 2);
    assert_true(both > two);
    arena_destroy(arena);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_sift__no_level_of_a_forest_looks_other_than_with_every_triangle),
        cmocka_unit_test(test_sift__a_tree_around_the_eye_is_drawn),
        cmocka_unit_test(test_sift__small_triangles_are_left_as_often_as_they_meet_a_sample),
        cmocka_unit_test(test_sift__what_a_nearer_triangle_covers_is_dropped),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
