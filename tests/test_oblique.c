/* Stacks of slices seen at a slant: a ball of leaves, whose coverage is known in closed form and
 * the same from everywhere. */
#include "testing_tree.h"

static const double radius_m = 3;

static void triangle_turn(struct mesh *mesh, uint32_t k)
{
    const uint32_t *corner = mesh->triangles[k];
    const float *p[3] = {mesh->positions[corner[0]], mesh->positions[corner[1]],
                         mesh->positions[corner[2]]};
    double n[3], length = 0;
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, l = (i + 2) % 3;
        n[i] = ((double)p[1][j] - p[0][j]) * ((double)p[2][l] - p[0][l]) -
               ((double)p[1][l] - p[0][l]) * ((double)p[2][j] - p[0][j]);
        length += n[i] * n[i];
    }
    for (int c = 0; c < 3; c++)
        for (int i = 0; i < 3; i++)
            mesh->normals[corner[c]][i] = (float)(n[i] / sqrt(length));
}

/* Leaves about points that are spread evenly in a ball about (0, 3.5, 0); no trunk. *density: mean
 * area that they turn to any side, a volume. */
static struct plant *ball_of_leaves(struct arena *arena, uint32_t leaves, double leaf_m,
                                    double *density)
{
    struct mesh *mesh = tree_mesh(arena, leaves);
    struct random random = random_seed(5, 1);
    double area_m2 = 0;
    mesh->parts++;
    mesh->parts_count = 1;
    for (uint32_t k = mesh->parts->first_triangle; k < mesh->triangles_count; k++) {
        double middle[3] = {2, 2, 2};
        while (middle[0] * middle[0] + middle[1] * middle[1] + middle[2] * middle[2] > 1)
            for (int i = 0; i < 3; i++)
                middle[i] = 2 * (double)random_float(&random) - 1;
        for (int n = 0; n < 9; n++) {
            double at = radius_m * middle[n % 3] + leaf_m * ((double)random_float(&random) - 0.5);
            mesh->positions[mesh->triangles[k][n / 3]][n % 3] =
                (float)(at + (n % 3 == 1 ? 3.5 : 0));
        }
        triangle_turn(mesh, k);
        area_m2 += mesh_triangle_area(mesh, k);
    }
    mesh_bounds(mesh);
    *density = 0.5 * area_m2 / (4 * M_PI / 3 * pow(radius_m, 3));
    return plant_from_mesh(arena, "ball", mesh);
}

/* The mean of 1 - exp(-k chord) over a ball's disc. */
static double ball_covers(double density)
{
    double depth = 2 * density * radius_m;
    return 1 - 2 / (depth * depth) * (1 - (1 + depth) * exp(-depth));
}

static const float views_rad[][2] = {
    {0, 0}, {0.7854f, 0}, {0.7854f, 0.6155f}, {0.7854f, 0.7854f}, {0.3927f, 0.3f}, {0.46f, 0.29f}};
enum { VIEWS = 6 };

/* Coverage over what it should be, from all views. */
static void ratios_of(const char *method, const char *options, uint32_t leaves, double leaf_m,
                      double ratios[VIEWS])
{
    struct arena *arena = arena_create(0);
    double density;
    struct scene *scene = tree_scene(arena, ball_of_leaves(arena, leaves, leaf_m, &density), 1, 1);
    struct studio studio;
    const double span_m = 7, disc = M_PI * radius_m * radius_m / (span_m * span_m);
    studio_open(&studio, arena, tree_method(method), options, LOD_HIGH, scene, 0);
    for (int v = 0; v < VIEWS; v++) {
        struct view view = tree_view(scene, views_rad[v][0], views_rad[v][1], 300, (float)span_m);
        ratios[v] = tree_mean(studio_draw(&studio, &view), 3) / (disc * ball_covers(density));
    }
    studio_close(&studio);
    arena_destroy(arena);
}

static void test_oblique__a_ball_of_leaves_covers_the_same_from_everywhere(void **state)
{
    (void)state;
    static const struct {
        const char *method, *options;
        double allowed;
    } cases[] = {
        {"texels", "slices=32,resolution=32,turns=1,near=0", 0.05},
        {"texels", "slices=32,resolution=32,turns=1,near=0,interpolate=on,smooth=on", 0.05},
        {"shaded-texels", "slices=32,resolution=32,near=0", 0.1},
        {"jakulin", "slices=16,resolution=32,near=0", 0.1},
        {"jakulin", "slices=16,resolution=32,near=0,order=exact", 0.1},
    };
    for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
        double ratios[VIEWS];
        ratios_of(cases[c].method, cases[c].options, 12000, 0.16, ratios);
        for (int v = 0; v < VIEWS; v++)
            if (fabs(ratios[v] - 1) > cases[c].allowed)
                fail_msg("%s:%s, view %d: %.3f of the coverage", cases[c].method, cases[c].options,
                         v, ratios[v]);
    }
}

/* Leaves that are alone in their texels, of ten texels each and more: those that turn to the eye
 * are wider than the slice shows them, and cannot show more than all of a texel. The nearer a
 * direction of slices is, the less is lost. */
static void test_oblique__a_thin_ball_of_large_leaves_loses_little(void **state)
{
    (void)state;
    static const struct {
        const char *options;
        uint32_t leaves;
        double leaf_m, small[VIEWS];
    } cases[] = {
        {"near=0", 500, 0.5, {0.97, 0.9, 0.83, 0.87, 0.97, 0.97}},
        {"near=0,directions=7,slices=32,samples=2", 500, 0.5, {0.97, 0.92, 0.96, 0.96, 0.97, 0.97}},
        {"near=0,directions=13,slices=32,resolution=64,samples=2",
         100,
         1,
         {0.93, 0.93, 0.93, 0.93, 0.93, 0.93}}};
    for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
        double ratios[VIEWS];
        ratios_of("shaded-texels", cases[c].options, cases[c].leaves, cases[c].leaf_m, ratios);
        for (int v = 0; v < VIEWS; v++) {
            if (!(ratios[v] > cases[c].small[v] && ratios[v] < 1.08))
                fail_msg("%s, leaves of %g m, view %d: %.3f of the coverage", cases[c].options,
                         cases[c].leaf_m, v, ratios[v]);
        }
    }
}

/* Without it the way through the slices is shorter by the cosine: of a thin crown as much is
 * lost. */
static void test_oblique__as_published_slices_at_a_slant_are_too_thin(void **state)
{
    (void)state;
    double ratios[VIEWS];
    ratios_of("texels", "slices=32,resolution=32,turns=1,near=0,oblique=off", 12000, 0.16, ratios);
    assert_true(fabs(ratios[0] - 1) < 0.05);
    assert_true(ratios[2] < 0.85 && ratios[3] < 0.9);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_oblique__a_ball_of_leaves_covers_the_same_from_everywhere),
        cmocka_unit_test(test_oblique__a_thin_ball_of_large_leaves_loses_little),
        cmocka_unit_test(test_oblique__as_published_slices_at_a_slant_are_too_thin),
    };
    return cmocka_run_group_tests_name("oblique", tests, NULL, NULL);
}
