/* Crossed quads against the ray-traced reference, and their order against the depth buffer. */
#include "testing_stacks.h"

static int open_fixture(void **state)
{
    return fixture_open(state, "cross-quads");
}

/* Against a plane's front and back the other plane is seen edge on, so the picture is the plane's
 * own. */
static void test_cross_quads__front_and_back_have_the_plants_outline(void **state)
{
    struct fixture *f = *state;
    for (int side = 0; side < 4; side++) {
        struct scene *scene = tree_scene(f->arena, f->plant, 1, 1);
        struct view view = tree_view(scene, (float)side * 1.5707963f, 0, 300, 9);
        struct frame *truth = tree_reference(f->arena, scene, lit, &view);
        struct frame *drawn = fixture_draw(f, "alpha=blend", scene, lit, &view, NULL);
        double covered = tree_mean(truth, 3), off = tree_difference(drawn, truth, false);
        double mirrored = tree_difference(drawn, truth, true);
        if (off > 0.25 * covered || mirrored < 2.5 * off)
            fail_msg("side %d: coverage is off by %g of %g, mirrored by %g", side, off, covered,
                     mirrored);
    }
}

static void test_cross_quads__light_follows_the_sun_as_the_reference_does(void **state)
{
    struct fixture *f = *state;
    for (int k = 0; k < 8; k++) {
        struct scene *scene = tree_scene(f->arena, f->plant, 1, (float)k * 0.7853982f);
        struct view view = tree_view(scene, k < 4 ? 0 : 3.1415927f, 0, 300, 9);
        unsigned effects = k % 2 ? lit : EFFECT_AMBIENT | EFFECT_FOG;
        struct frame *truth = tree_reference(f->arena, scene, effects, &view);
        struct frame *drawn = fixture_draw(f, "alpha=blend", scene, effects, &view, NULL);
        double cover = tree_mean(drawn, 3) / tree_mean(truth, 3);
        for (int channel = 0; channel < 3; channel++) {
            double ratio = tree_mean(drawn, channel) / tree_mean(truth, channel) / cover;
            if (fabs(ratio - 1) > 0.12) /* the plane seen edge on adds to it */
                fail_msg("sun %d, channel %d: %.4f of the light", k, channel, ratio);
        }
    }
}

/* A plant that is one opaque cylinder of many colours: there blending must give what the depth
 * buffer gives, from wherever the eye looks, or the order of the half planes is wrong. */
static struct plant *opaque_plant(struct arena *arena)
{
    enum { SIDES = 12 };
    struct mesh *mesh = tree_mesh(arena, 2 * SIDES);
    mesh->triangles_count = mesh->vertices_count = 0;
    struct random random = random_seed(3, 3);
    const float step = 6.2831853f / SIDES;
    for (int k = 0; k < SIDES; k++) {
        float a = (float)k * step, b = a + step, r = 2;
        const float color[3] = {random_float(&random), random_float(&random),
                                random_float(&random)};
        float p[4][3] = {{r * sinf(a), 0, r * cosf(a)},
                         {r * sinf(b), 0, r * cosf(b)},
                         {r * sinf(b), 6, r * cosf(b)},
                         {r * sinf(a), 6, r * cosf(a)}};
        float low[3][3], high[3][3];
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++) {
                low[i][j] = p[i][j];
                high[i][j] = p[i ? i + 1 : 0][j];
            }
        tree_triangle(mesh, (const float(*)[3])low, color);
        tree_triangle(mesh, (const float(*)[3])high, color);
    }
    mesh->parts_count = 1;
    mesh->parts[0].triangles_count = 2 * SIDES;
    mesh->materials[0].albedo[0] = mesh->materials[0].albedo[1] = 0.8f;
    mesh->materials[0].albedo[2] = 0.8f;
    mesh_bounds(mesh);
    return plant_from_mesh(arena, "cylinder", mesh);
}

static void test_cross_quads__half_planes_are_blended_from_back_to_front(void **state)
{
    struct fixture *f = *state;
    struct plant *plant = opaque_plant(f->arena);
    static const char *const options[][2] = {
        {"planes=2,alpha=blend,filter=bilinear", "planes=2,alpha=test,filter=bilinear"},
        {"planes=3,alpha=blend,filter=bilinear", "planes=3,alpha=test,filter=bilinear"},
        {"planes=8,alpha=blend,filter=bilinear", "planes=8,alpha=test,filter=bilinear"}};
    for (int k = 0; k < 24; k++) {
        struct scene *scene = tree_scene(f->arena, plant, 1, 1);
        scene->instances[0].rotation_rad = 0.7f * (float)k;
        struct view view = tree_view(scene, 0.2617994f * (float)k + 0.05f, 0.1f, 300, 9);
        struct frame *blended = fixture_draw(f, options[k % 3][0], scene, lit, &view, NULL);
        struct frame *tested = fixture_draw(f, options[k % 3][1], scene, lit, &view, NULL);
        /* apart from the edges, where one blends and the other does not */
        size_t wrong = 0, covered = 0;
        for (int i = 0; i < TREE_PIXELS; i++) {
            covered += tested->rgba[4 * i + 3] == 1;
            for (int channel = 0; channel < 3; channel++)
                if (fabsf(blended->rgba[4 * i + channel] - tested->rgba[4 * i + channel]) > 0.03f) {
                    wrong++;
                    break;
                }
        }
        if (covered < 1000 || wrong > covered / 5)
            fail_msg("%s, view %d: %zu of %zu pixels differ", options[k % 3][0], k, wrong, covered);
    }
}

/* A picture that is opaque up to its layer's border must end there, in every level: seen from the
 * front the cylinder covers its 4 x 6 m. */
static void test_cross_quads__a_picture_that_fills_its_layer_ends_at_the_border(void **state)
{
    struct fixture *f = *state;
    struct plant *plant = opaque_plant(f->arena);
    static const char *const options[] = {"alpha=blend,filter=bilinear,resolution=64",
                                          "alpha=blend,filter=nearest,resolution=64"};
    for (int k = 0; k < 2; k++) {
        double drawn = 0, wanted = 0;
        for (int i = 0; i < 8; i++) {
            struct scene *scene = tree_scene(f->arena, plant, 1, 1);
            float span_m = 40 + 3.1f * (float)i;
            struct view view = tree_view(scene, 0, 0, 3000, span_m);
            drawn += tree_mean(fixture_draw(f, options[k], scene, EFFECT_AMBIENT, &view, NULL), 3);
            wanted += 24 / (span_m * span_m);
        }
        if (fabs(drawn / wanted - 1) > 0.05)
            fail_msg("%s: %.3f of the cylinder's area", options[k], drawn / wanted);
    }
}

static void test_cross_quads__every_way_keeps_the_same_coverage(void **state)
{
    struct fixture *f = *state;
    static const float spans[] = {9, 30};
    for (int k = 0; k < 2; k++) {
        struct scene *scene = tree_scene(f->arena, f->plant, 1, 1);
        struct view view = tree_view(scene, 0.7853982f, 0.1f, 300, spans[k]);
        double blend = tree_mean(fixture_draw(f, "alpha=blend", scene, lit, &view, NULL), 3);
        double coverage = tree_mean(fixture_draw(f, "alpha=coverage", scene, lit, &view, NULL), 3);
        double test = tree_mean(fixture_draw(f, "alpha=test", scene, lit, &view, NULL), 3);
        if (fabs(coverage / blend - 1) > 0.03 || fabs(test / blend - 1) > 0.1)
            fail_msg("span %g: blended %g, coverage %g, tested %g", spans[k], blend, coverage,
                     test);
    }
}

static void test_cross_quads__ten_thousand_trees_take_a_few_draw_calls(void **state)
{
    struct fixture *f = *state;
    struct scene *scene = tree_scene(f->arena, f->plant, 10000, 1);
    for (size_t i = 0; i < 10000; i++) {
        scene->instances[i].position_m[0] = ((float)(i % 100) - 50) * 2;
        scene->instances[i].position_m[2] = ((float)(i / 100) - 50) * 2;
    }
    struct view view = tree_view(scene, 0.3f, 0.4f, 150, 60);
    struct gl_counters counters;
    fixture_draw(f, "resolution=64", scene, lit, &view, &counters);
    assert_true(counters.draw_calls <= 4);
    assert_true(counters.triangles > 4000);
}

static void test_cross_quads__an_eye_in_the_crown_is_drawn(void **state)
{
    struct fixture *f = *state;
    static const char *const options[] = {"", "alpha=blend,planes=8,depth=on", "alpha=coverage"};
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) {
            struct scene *scene = tree_scene(f->arena, f->plant, 1, 1);
            float distance = k == 0 ? 0.5f : k == 1 ? 1e-3f : 1e-7f;
            struct view view = tree_view(scene, 0, k == 2 ? 1.5707963f : 0, distance, distance);
            fixture_draw(f, options[i], scene, lit, &view, NULL);
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_cross_quads__front_and_back_have_the_plants_outline),
        cmocka_unit_test(test_cross_quads__light_follows_the_sun_as_the_reference_does),
        cmocka_unit_test(test_cross_quads__half_planes_are_blended_from_back_to_front),
        cmocka_unit_test(test_cross_quads__a_picture_that_fills_its_layer_ends_at_the_border),
        cmocka_unit_test(test_cross_quads__every_way_keeps_the_same_coverage),
        cmocka_unit_test(test_cross_quads__ten_thousand_trees_take_a_few_draw_calls),
        cmocka_unit_test(test_cross_quads__an_eye_in_the_crown_is_drawn),
    };
    return cmocka_run_group_tests_name("cross-quads", tests, open_fixture, close_fixture);
}
