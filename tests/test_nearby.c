/* Stacks of slices turn into their trees' triangles, at once or gradually, where the eye is near.
 */
#include "testing_stacks.h"

enum { SHOWN_SLICES, SHOWN_TRIANGLES, SHOWN_NEAR, SHOWN };

/* RMS difference of colours and coverage. */
static double apart(const struct frame *a, const struct frame *b)
{
    double sum = 0;
    for (int i = 0; i < 4 * TREE_PIXELS; i++)
        sum += pow((double)a->rgba[i] - (double)b->rgba[i], 2);
    return sqrt(sum / (4 * TREE_PIXELS));
}

/* The greatest difference of a picture to the mix of two, in any channel. */
static double apart_from_mix(const struct frame *frame, const struct frame *const shown[SHOWN],
                             double share)
{
    double most = 0;
    for (int i = 0; i < 4 * TREE_PIXELS; i++) {
        double mix = (1 - share) * (double)shown[SHOWN_SLICES]->rgba[i] +
                     share * (double)shown[SHOWN_TRIANGLES]->rgba[i];
        most = fmax(most, fabs((double)frame->rgba[i] - mix));
    }
    return most;
}

enum { VIEWS_MOST = 3 };
struct pictures {
    const struct frame *of[VIEWS_MOST][SHOWN];
};

/* All trees by slices, all by triangles, and those within a radius by either. */
static struct pictures draw(struct fixture *f, const char *method, const char *options,
                            const struct scene *scene, const struct view *views, int count)
{
    static const char *const nears[SHOWN] = {"near=0", "near=16", "near=1"};
    struct pictures pictures;
    for (int k = 0; k < SHOWN; k++) {
        struct studio studio;
        studio_open(&studio, f->arena, tree_method(method),
                    arena_printf(f->arena, "resolution=64,%s,%s", options, nears[k]), LOD_HIGH,
                    scene, lit);
        for (int v = 0; v < count; v++)
            pictures.of[v][k] = studio_draw(&studio, &views[v]);
        studio_close(&studio);
    }
    return pictures;
}

/* So many radii from a tree's axis; the same solid angle is in the picture from anywhere. */
static struct view view_from(const struct fixture *f, const struct scene *scene, float radii)
{
    float distance_m = radii * f->mesh->radius_m;
    return tree_view(scene, 0.3f, 0, distance_m, 1.6f * distance_m);
}

/* From where so much of a tree is shown by its triangles. */
static struct pictures draw_shares(struct fixture *f, const char *method, const char *options,
                                   struct scene *scene, const float shares[VIEWS_MOST],
                                   struct view views[VIEWS_MOST])
{
    for (int v = 0; v < VIEWS_MOST; v++)
        views[v] = view_from(f, scene, exp2f(0.5f * (1 - shares[v])));
    return draw(f, method, options, scene, views, VIEWS_MOST);
}

/* All of it within a radius, nothing of it half an octave farther, between them in between. */
static void claim_gradual(struct fixture *f, const char *method, const char *options)
{
    static const float shares[VIEWS_MOST] = {0.002f, 0.5f, 0.998f};
    static const double most[VIEWS_MOST][2] = {{0.05, 1.05}, {0.75, 0.75}, {1.05, 0.05}};
    struct scene *scene = tree_scene(f->arena, f->plant, 1, 1);
    struct view views[VIEWS_MOST];
    struct pictures pictures = draw_shares(f, method, options, scene, shares, views);
    for (int v = 0; v < VIEWS_MOST; v++) {
        const struct frame *const *shown = pictures.of[v];
        double whole = apart(shown[SHOWN_SLICES], shown[SHOWN_TRIANGLES]);
        double to[2] = {apart(shown[SHOWN_NEAR], shown[SHOWN_SLICES]) / whole,
                        apart(shown[SHOWN_NEAR], shown[SHOWN_TRIANGLES]) / whole};
        if (!(whole > 0.03 && to[0] < most[v][0] && to[1] < most[v][1]))
            fail_msg("%s, share %g: %.3f of the way from the slices, %.3f from the triangles, "
                     "which are %.3f apart",
                     method, (double)shares[v], to[0], to[1], whole);
    }
}

static void test_nearby__with_smooth_slices_turn_into_triangles_gradually(void **state)
{
    struct fixture *f = *state;
    claim_gradual(f, "texels", "slices=32,turns=1,smooth=on");
    claim_gradual(f, "shaded-texels", "slices=32,smooth=on");
    claim_gradual(f, "jakulin", "smooth=on");
}

/* Two pictures of one tree, each opaque where it is, do not hide less while they change places:
 * every pixel is the mean of both, and so is the coverage, held against what is traced. */
static void claim_covers(struct fixture *f, const char *method, const char *options)
{
    static const float shares[VIEWS_MOST] = {0.25f, 0.5f, 0.75f};
    struct scene *scene = tree_scene(f->arena, f->plant, 1, 1);
    struct view views[VIEWS_MOST];
    struct pictures pictures = draw_shares(f, method, options, scene, shares, views);
    for (int v = 0; v < VIEWS_MOST; v++) {
        double traced = tree_mean(tree_reference(f->arena, scene, lit, &views[v]), 3);
        double bias[SHOWN], most;
        for (int k = 0; k < SHOWN; k++)
            bias[k] = tree_mean(pictures.of[v][k], 3) - traced;
        most = fmax(fabs(bias[SHOWN_SLICES]), fabs(bias[SHOWN_TRIANGLES])) + 0.0005;
        double off = apart_from_mix(pictures.of[v][SHOWN_NEAR], pictures.of[v], (double)shares[v]);
        if (!(fabs(bias[SHOWN_NEAR]) < most && off < 1e-3))
            fail_msg("%s, share %g: covers %+.4f of what is traced; slices %+.4f, triangles "
                     "%+.4f; a pixel is %g from the mean of both",
                     method, (double)shares[v], bias[SHOWN_NEAR], bias[SHOWN_SLICES],
                     bias[SHOWN_TRIANGLES], off);
    }
}

static void test_nearby__between_them_a_tree_hides_as_much_as_the_mean_of_both(void **state)
{
    struct fixture *f = *state;
    claim_covers(f, "texels", "slices=32,turns=1,smooth=on");
    claim_covers(f, "shaded-texels", "slices=32,smooth=on");
    claim_covers(f, "jakulin", "smooth=on");
}

static void test_nearby__without_smooth_they_do_so_at_once(void **state)
{
    struct fixture *f = *state;
    struct scene *scene = tree_scene(f->arena, f->plant, 1, 1);
    const struct view views[2] = {view_from(f, scene, 1.001f), view_from(f, scene, 0.999f)};
    struct pictures pictures = draw(f, "shaded-texels", "slices=32", scene, views, 2);
    assert_true(apart(pictures.of[0][SHOWN_NEAR], pictures.of[0][SHOWN_SLICES]) == 0);
    assert_true(apart(pictures.of[1][SHOWN_NEAR], pictures.of[1][SHOWN_TRIANGLES]) == 0);
}

static void test_nearby__above_a_tree_it_is_as_beside_it(void **state)
{
    struct fixture *f = *state;
    struct scene *scene = tree_scene(f->arena, f->plant, 1, 1);
    struct view views[2];
    for (int near = 0; near < 2; near++) {
        float above_m = (near ? 0.001f : 0.413f) * f->mesh->radius_m;
        float eye_m[3] = {0.01f, f->mesh->maximum_m[1] + above_m, 0};
        view_look_at(scene, eye_m, (const float[3]){0, 0, 0}, &views[near]);
    }
    struct pictures pictures = draw(f, "shaded-texels", "slices=32,smooth=on", scene, views, 2);
    for (int near = 0; near < 2; near++) {
        const struct frame *const *shown = pictures.of[near];
        double whole = apart(shown[SHOWN_SLICES], shown[SHOWN_TRIANGLES]);
        double to = apart(shown[SHOWN_NEAR], shown[near ? SHOWN_TRIANGLES : SHOWN_SLICES]);
        if (!(whole > 0.03 && to < 0.05 * whole))
            fail_msg("near %d: off by %.3f of %.3f", near, to / whole, whole);
    }
}

/* One that is near altogether, one almost so before it and one behind it. */
static void test_nearby__trees_that_become_near_hide_each_other_in_order(void **state)
{
    struct fixture *f = *state;
    struct scene *scene = tree_scene(f->arena, f->plant, 3, 1);
    static const float places_radii[3][2] = {{0, 0}, {0.75f, 0.3f}, {-0.1f, -0.02f}};
    for (int i = 0; i < 3; i++) {
        scene->instances[i].position_m[0] = places_radii[i][0] * f->mesh->radius_m;
        scene->instances[i].position_m[2] = places_radii[i][1] * f->mesh->radius_m;
        scene->instances[i].rotation_rad = (float)i;
    }
    float distance_m = 0.995f * f->mesh->radius_m;
    struct view view = tree_view(scene, 0, 0, distance_m, 1.6f * distance_m);
    struct pictures pictures = draw(f, "shaded-texels", "slices=32,smooth=on", scene, &view, 1);
    const struct frame *const *shown = pictures.of[0];
    double whole = apart(shown[SHOWN_SLICES], shown[SHOWN_TRIANGLES]);
    double to = apart(shown[SHOWN_NEAR], shown[SHOWN_TRIANGLES]);
    if (!(whole > 0.03 && to < 0.15 * whole))
        fail_msg("off by %.3f of %.3f", to / whole, whole);
}

/* A small one before a large one that begins to be near, or is: it is seen, itself by its slices.
 */
static void test_nearby__a_small_tree_stays_before_a_large_one_that_is_near(void **state)
{
    struct fixture *f = *state;
    static const float radii[2] = {1.413f, 0.999f};
    for (int near = 0; near < 2; near++) {
        struct scene *scene = tree_scene(f->arena, f->plant, 2, 1);
        struct view view = view_from(f, scene, radii[near]);
        scene->instances[1].scale = 0.25f;
        for (int i = 0; i < 3; i++)
            scene->instances[1].position_m[i] = 0.4f * (view.eye_m[i] - 3.5f * (float)(i == 1));
        scene->instances[1].position_m[1] = 2.6f;
        struct pictures with = draw(f, "shaded-texels", "slices=32,smooth=on", scene, &view, 1);
        scene->instances_count = 1;
        struct pictures without = draw(f, "shaded-texels", "slices=32,smooth=on", scene, &view, 1);
        const struct frame *const *shown = with.of[0];
        int like = near ? SHOWN_TRIANGLES : SHOWN_SLICES;
        double seen = apart(shown[SHOWN_NEAR], without.of[0][SHOWN_NEAR]);
        double whole = apart(shown[like], without.of[0][like]),
               off = apart(shown[SHOWN_NEAR], shown[like]);
        if (!(whole > 0.01 && seen > 0.7 * whole && off < 0.6 * whole))
            fail_msg("near %d: %.3f is seen of %.3f, off by %.3f", near, seen, whole, off);
    }
}

static int open_fixture(void **state)
{
    return fixture_open(state, "shaded-texels");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_nearby__with_smooth_slices_turn_into_triangles_gradually),
        cmocka_unit_test(test_nearby__between_them_a_tree_hides_as_much_as_the_mean_of_both),
        cmocka_unit_test(test_nearby__without_smooth_they_do_so_at_once),
        cmocka_unit_test(test_nearby__above_a_tree_it_is_as_beside_it),
        cmocka_unit_test(test_nearby__trees_that_become_near_hide_each_other_in_order),
        cmocka_unit_test(test_nearby__a_small_tree_stays_before_a_large_one_that_is_near),
    };
    return cmocka_run_group_tests_name("nearby", tests, open_fixture, close_fixture);
}
