/* Noise, surfaces of sampled fields and the hypertexture: bounds, closedness, topology, volume. */
#include "testing.h"

#include "plant/isosurface.h"
#include "plant/noise.h"
#include "plant/normals.h"
#include "plant/plant.h"

#include <stdlib.h>

static const double pi = 3.14159265358979323846;

static void test_noise__is_bounded_centred_and_zero_on_its_lattice(void **state)
{
    (void)state;
    struct random random = random_seed(7, 0);
    double largest = 0, sum = 0, square = 0;
    enum { COUNT = 400000 };
    for (int i = 0; i < COUNT; i++) {
        struct vec p = {random_between(&random, -500, 500), random_between(&random, -500, 500),
                        random_between(&random, -500, 500)};
        double value = noise_gradient(3, p);
        largest = fmax(largest, fabs(value));
        sum += value, square += value * value;
    }
    assert_true(largest < 1 && largest > 0.75);
    assert_true(fabs(sum / COUNT) < 3 * sqrt(square / COUNT / COUNT)); /* standard errors */
    for (int i = -3; i <= 3; i++)
        assert_true(noise_gradient(3, (struct vec){i, 2 * i, 5 - i}) == 0);
    assert_true(noise_gradient(3, (struct vec){0.3, 0.4, 0.2}) !=
                noise_gradient(4, (struct vec){0.3, 0.4, 0.2}));
}

/* The mean of the product of two gradients' components is 2/3 for the same axis, else 0, and
 * gradients of different points are independent: so the variance is the integral of the squared
 * weights times 2/3 of the squared offsets. */
static void test_noise__has_the_variance_of_independent_gradients(void **state)
{
    (void)state;
    enum { STEPS = 200, COUNT = 400000 };
    double weight2 = 0, ramp2 = 0;
    for (int i = 0; i < STEPS; i++) {
        double t = (i + 0.5) / STEPS, s = t * t * t * (t * (t * 6 - 15) + 10);
        weight2 += ((1 - s) * (1 - s) + s * s) / STEPS;
        ramp2 += ((1 - s) * (1 - s) * t * t + s * s * (1 - t) * (1 - t)) / STEPS;
    }
    double variance = 2.0 / 3 * 3 * ramp2 * weight2 * weight2 / (1.04 * 1.04), square = 0;
    struct random random = random_seed(8, 0);
    for (int i = 0; i < COUNT; i++) {
        struct vec p = {random_between(&random, -500, 500), random_between(&random, -500, 500),
                        random_between(&random, -500, 500)};
        double value = noise_gradient(11, p);
        square += value * value / COUNT;
    }
    assert_float_equal(square / variance, 1, 0.01);
}

static void test_noise__is_continuous_with_its_slope_across_cells(void **state)
{
    (void)state;
    struct random random = random_seed(9, 0);
    for (int i = 0; i < 2000; i++) {
        struct vec p = {(double)random_below(&random, 40), random_double(&random) * 40,
                        random_double(&random) * 40};
        struct vec step = {1e-4, 0, 0};
        double here = noise_gradient(5, p), left = noise_gradient(5, vec_sub(p, step)),
               right = noise_gradient(5, vec_add(p, step));
        assert_float_equal(left, here, 4e-4);
        assert_float_equal((here - left) / 1e-4, (right - here) / 1e-4, 4e-3);
    }
}

static int compare_u64(const void *a, const void *b)
{
    uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return (x > y) - (x < y);
}

struct topology {
    long euler; /* vertices - edges + faces */
    double volume_m3;
};

/* Fails unless every edge is passed once in each direction and no triangle is empty. */
static struct topology check_closed(const float (*positions)[3], size_t vertices_count,
                                    uint32_t (*triangles)[3], size_t triangles_count)
{
    uint64_t *edges = malloc(3 * triangles_count * sizeof *edges);
    struct topology topology = {0};
    for (size_t i = 0; i < triangles_count; i++) {
        const uint32_t *t = triangles[i];
        for (int k = 0; k < 3; k++)
            edges[3 * i + (size_t)k] = (uint64_t)t[k] << 32 | t[(k + 1) % 3];
        double cross[3];
        triangle_cross(positions[t[0]], positions[t[1]], positions[t[2]], cross);
        assert_true(cross[0] != 0 || cross[1] != 0 || cross[2] != 0);
        for (int k = 0; k < 3; k++)
            topology.volume_m3 += cross[k] / 6 * (double)positions[t[0]][k];
        for (int k = 0; k < 3; k++)
            topology.volume_m3 += cross[k] / 18 *
                                  ((double)positions[t[1]][k] + (double)positions[t[2]][k] -
                                   2 * (double)positions[t[0]][k]);
    }
    qsort(edges, 3 * triangles_count, sizeof *edges, compare_u64);
    for (size_t i = 0; i < 3 * triangles_count; i++) {
        uint64_t back = edges[i] << 32 | edges[i] >> 32;
        assert_true(i == 0 || edges[i] != edges[i - 1]);
        assert_non_null(bsearch(&back, edges, 3 * triangles_count, sizeof *edges, compare_u64));
    }
    free(edges);
    topology.euler = (long)vertices_count - 3 * (long)triangles_count / 2 + (long)triangles_count;
    return topology;
}

enum shape { SHAPE_SPHERE, SHAPE_TORUS, SHAPE_TWO_SPHERES, SHAPE_WHITE_NOISE };

static double shape_at(enum shape shape, double x, double y, double z, struct random *random)
{
    if (shape == SHAPE_SPHERE)
        return sqrt(x * x + y * y + z * z) - 0.7;
    if (shape == SHAPE_TORUS) {
        double ring = sqrt(x * x + z * z) - 0.6;
        return sqrt(ring * ring + y * y) - 0.2;
    }
    if (shape == SHAPE_TWO_SPHERES)
        return fmin(sqrt((x - 0.4) * (x - 0.4) + y * y + z * z),
                    sqrt((x + 0.4) * (x + 0.4) + y * y + z * z)) -
               0.3;
    bool rim = fmax(fabs(x), fmax(fabs(y), fabs(z))) > 0.95;
    return rim ? 1 : random_double(random) - 0.4;
}

static struct topology shape_topology(enum shape shape, size_t cells)
{
    struct arena *arena = arena_create(0);
    size_t n = cells + 1;
    float *values = ARENA_ARRAY(arena, float, n *n *n);
    struct field field = {{n, n, n}, {-1, -1, -1}, 2.0 / (double)cells, values};
    struct random random = random_seed(1, 0);
    for (size_t i = 0; i < n * n * n; i++) {
        double x = (double)(i % n) * field.cell_m - 1, y = (double)(i / n % n) * field.cell_m - 1;
        values[i] = (float)shape_at(shape, x, y, (double)(i / n / n) * field.cell_m - 1, &random);
    }
    struct isosurface surface = isosurface_extract(arena, &field);
    struct topology topology =
        check_closed((const float(*)[3])surface.positions_m, surface.vertices_count,
                     surface.triangles, surface.triangles_count);
    arena_destroy(arena);
    return topology;
}

static void test_isosurface__has_the_topology_and_volume_of_what_was_sampled(void **state)
{
    (void)state;
    struct topology sphere = shape_topology(SHAPE_SPHERE, 41);
    assert_int_equal(sphere.euler, 2);
    assert_float_equal(sphere.volume_m3, 4 * pi / 3 * 0.343, 0.004 * 1.44);
    struct topology torus = shape_topology(SHAPE_TORUS, 41);
    assert_int_equal(torus.euler, 0);
    assert_float_equal(torus.volume_m3, 2 * pi * pi * 0.6 * 0.04, 0.02 * 0.474);
    struct topology two = shape_topology(SHAPE_TWO_SPHERES, 41);
    assert_int_equal(two.euler, 4);
    assert_float_equal(two.volume_m3, 8 * pi / 3 * 0.027, 0.02 * 0.226);
}

static void test_isosurface__converges_with_the_square_of_the_cell(void **state)
{
    (void)state;
    double exact = 4 * pi / 3 * 0.343;
    double coarse = fabs(shape_topology(SHAPE_SPHERE, 16).volume_m3 - exact);
    double fine = fabs(shape_topology(SHAPE_SPHERE, 64).volume_m3 - exact);
    assert_true(fine < coarse / 10);
}

static void test_isosurface__is_closed_even_where_every_other_point_is_inside(void **state)
{
    (void)state;
    assert_int_equal(shape_topology(SHAPE_WHITE_NOISE, 20).euler % 2, 0);
}

static const struct mesh *hypertexture(struct arena *arena, const char *options)
{
    struct error error = {0};
    struct plant *plant;
    const struct mesh *mesh = NULL;
    if (plant_generated(arena, "hypertexture", options, &plant, &error) != STATUS_OK ||
        plant_mesh(plant, &mesh, &error) != STATUS_OK || mesh_check(mesh, &error) != STATUS_OK)
        fail_msg("%s", error.text);
    return mesh;
}

static struct topology hypertexture_topology(const char *options)
{
    struct arena *arena = arena_create(0);
    const struct mesh *mesh = hypertexture(arena, options);
    assert_float_equal(mesh->minimum_m[1], 0, 1e-6);
    struct topology topology =
        check_closed((const float(*)[3])mesh->positions, mesh->vertices_count, mesh->triangles,
                     mesh->triangles_count);
    arena_destroy(arena);
    return topology;
}

static void test_hypertexture__without_noise_is_a_ball(void **state)
{
    (void)state;
    /* D = 1/4 between 1.5 and 2.5: r^2 = 2.5^2 - (2.5^2 - 1.5^2) / 4. */
    struct topology ball =
        hypertexture_topology("radius=2,softness=0.5,threshold=0.25,amplitude=0,resolution=48");
    double r2 = 6.25 - (6.25 - 2.25) / 4;
    assert_int_equal(ball.euler, 2);
    assert_float_equal(ball.volume_m3 / (4 * pi / 3 * r2 * sqrt(r2)), 1, 0.004);
}

/* The volume inside, by counting the points of a finer grid where the bent distance is below the
 * radius; the noise's shift and seed are the generator's. */
static void test_hypertexture__holds_the_volume_of_its_density(void **state)
{
    (void)state;
    struct topology shape = hypertexture_topology("radius=1,resolution=80,amplitude=0.4,seed=5");
    enum { POINTS = 120 };
    double half = 1.02 / 0.6, cell = 2 * half / POINTS, volume = 0;
    double r2 = 1.25 * 1.25 - (1.25 * 1.25 - 0.75 * 0.75) / 2;
    for (int i = 0; i < POINTS * POINTS * POINTS; i++) {
        struct vec p = {(i % POINTS + 0.5) * cell - half, (i / POINTS % POINTS + 0.5) * cell - half,
                        ((double)(i / POINTS / POINTS) + 0.5) * cell - half};
        struct vec at = vec_add(vec_scale(p, 1.5), (struct vec){0.37, 0.61, 0.43});
        double bent = 1 + (double)0.4f * noise_octaves(random_mix(5), at, 4, 0.5);
        volume += vec_length(p) * bent < sqrt(r2) ? cell * cell * cell : 0;
    }
    assert_int_equal(shape.euler % 2, 0);
    assert_float_equal(shape.volume_m3 / volume, 1, 0.005);
}

static void test_hypertexture__of_the_scene_has_about_the_papers_triangles(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    size_t count = hypertexture(arena, "radius=3.2,resolution=64,seed=2")->triangles_count;
    assert_true(count > 40248 && count < 40448); /* Senegas 2001: 40,348 */
    arena_destroy(arena);
}

static void test_hypertexture__has_normals_on_the_outer_side(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    const struct mesh *mesh = hypertexture(arena, "resolution=64");
    size_t wrong = 0;
    for (size_t i = 0; i < mesh->triangles_count; i++) {
        const uint32_t *t = mesh->triangles[i];
        double c[3], along = 0;
        triangle_cross(mesh->positions[t[0]], mesh->positions[t[1]], mesh->positions[t[2]], c);
        for (int k = 0; k < 3; k++)
            along += c[k] * (double)mesh->normals[t[0]][k];
        wrong += along <= 0;
    }
    assert_true(wrong * 200 < mesh->triangles_count); /* where a bump is finer than the grid */
    arena_destroy(arena);
}

static void test_hypertexture__options_at_their_ends_give_closed_surfaces(void **state)
{
    (void)state;
    static const char *const cases[] = {
        "resolution=8,octaves=1",
        "amplitude=0.75,frequency=32,octaves=8,gain=1,resolution=40",
        "softness=1,threshold=0.99,radius=100,resolution=40",
        "softness=0.01,threshold=0.01,radius=0.05,frequency=0,resolution=40,seed=1000000",
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        assert_true(hypertexture_topology(cases[i]).volume_m3 > 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_noise__is_bounded_centred_and_zero_on_its_lattice),
        cmocka_unit_test(test_noise__has_the_variance_of_independent_gradients),
        cmocka_unit_test(test_noise__is_continuous_with_its_slope_across_cells),
        cmocka_unit_test(test_isosurface__has_the_topology_and_volume_of_what_was_sampled),
        cmocka_unit_test(test_isosurface__converges_with_the_square_of_the_cell),
        cmocka_unit_test(test_isosurface__is_closed_even_where_every_other_point_is_inside),
        cmocka_unit_test(test_hypertexture__without_noise_is_a_ball),
        cmocka_unit_test(test_hypertexture__holds_the_volume_of_its_density),
        cmocka_unit_test(test_hypertexture__of_the_scene_has_about_the_papers_triangles),
        cmocka_unit_test(test_hypertexture__has_normals_on_the_outer_side),
        cmocka_unit_test(test_hypertexture__options_at_their_ends_give_closed_surfaces),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
