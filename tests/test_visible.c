/* Voxels known by the mean of their normals: area and light against quadrature over the spheroid,
 * means against every direction of the triangles' normals. */
#include "testing.h"

#include "march_block.h"
#include "reference_world.h"

#include "bake/voxels_parts.h"
#include "bake/voxels_visible.h"

#include <gsl/gsl_integration.h>
#include <gsl/gsl_roots.h>

#include <stdlib.h>

/* What a spheroid whose normals have the mean m along z shows along z and from the side. */
struct spheroid {
    double along, side;
};

static double cauchy_excess(double side, void *along)
{
    double m = *(double *)along, d = sqrt(fmax(m * m - side * side, 1e-24));
    return m + side * side / d * asinh(d / side) - 1;
}

static struct spheroid spheroid_of(double m)
{
    struct spheroid spheroid = {m, 0.5};
    gsl_function excess = {cauchy_excess, &m};
    gsl_root_fsolver *solver = gsl_root_fsolver_alloc(gsl_root_fsolver_brent);
    gsl_root_fsolver_set(solver, &excess, 1e-9, m);
    for (int i = 0; i < 100; i++)
        gsl_root_fsolver_iterate(solver);
    spheroid.side = gsl_root_fsolver_root(solver);
    gsl_root_fsolver_free(solver);
    return spheroid;
}

/* Means over the normals of a spheroid, by the points of the sphere that it is stretched from. */
struct means {
    double length, z, z_squared, seen, even, odd;
};

static struct means quadrature(const struct spheroid *spheroid, const double eye[3],
                               const double sun[3])
{
    enum { RINGS = 64, STEPS = 256 };
    struct means means = {0};
    double area = 0;
    gsl_integration_glfixed_table *table = gsl_integration_glfixed_table_alloc(RINGS);
    for (size_t ring = 0; ring < RINGS; ring++) {
        double y, weight;
        gsl_integration_glfixed_point(0, 1, ring, &y, &weight, table);
        double r = spheroid->side * sqrt(1 - y * y), z = spheroid->along * y;
        double length = sqrt(r * r + z * z);
        for (int step = 0; step < STEPS; step++) {
            double turn = 2 * M_PI * (step + 0.5) / STEPS, share = weight * length / STEPS;
            double n[3] = {r * cos(turn) / length, r * sin(turn) / length, z / length};
            double a = n[0] * eye[0] + n[1] * eye[1] + n[2] * eye[2];
            double b = n[0] * sun[0] + n[1] * sun[1] + n[2] * sun[2];
            area += share;
            means.z += share * n[2];
            means.z_squared += share * n[2] * n[2];
            means.seen += share * fabs(a);
            means.even += share * fabs(a * b);
            means.odd += share * fabs(a) * fmax(0, a > 0 ? b : -b);
        }
    }
    means.length = area;
    means.z /= area;
    means.z_squared /= area;
    means.seen /= area;
    means.even /= area;
    means.odd /= area;
    gsl_integration_glfixed_table_free(table);
    return means;
}

static double terms(const float values[VISIBLE_TERMS], double x)
{
    double value = 0;
    for (int k = VISIBLE_TERMS; k-- > 0;)
        value = x * ((double)values[k] + value);
    return value;
}

static void test_visible__side_and_second_moment_are_those_of_quadrature(void **state)
{
    (void)state;
    const double up[3] = {0, 0, 1};
    for (double m = 0.501; m < 1; m += 0.013) {
        struct spheroid spheroid = spheroid_of(m);
        struct means means = quadrature(&spheroid, up, up);
        assert_true(fabs(means.z - m) < 1e-4); /* it is the spheroid of that mean */
        assert_true(fabs(means.length - 0.5) < 1e-4);
        assert_true(fabs(terms(visible_side, 1 - m) - spheroid.side * spheroid.side) < 0.0007);
        assert_true(fabs(terms(visible_across, 1 - m) - (1 - means.z_squared) / 2) < 0.0004);
    }
}

static void unit_at_random(struct random *random, double v[3])
{
    double z = 2 * random_double(random) - 1, turn = 2 * M_PI * random_double(random);
    v[0] = sqrt(1 - z * z) * cos(turn);
    v[1] = sqrt(1 - z * z) * sin(turn);
    v[2] = z;
}

/* One voxel that a ray of a voxel's length passes. */
struct lone {
    struct voxel voxel;
    uint32_t cell;
    struct march_job job;
    struct block rays;
};

/* A voxel of area 1 per side with the normals, seen and lit from the directions; one_sided: 0, 1.
 */
static void lone_fill(struct lone *lone, const double mean[3], const double eye[3],
                      const double sun[3], float one_sided)
{
    double m2 = mean[0] * mean[0] + mean[1] * mean[1] + mean[2] * mean[2];
    struct spheroid spheroid = spheroid_of(sqrt(m2));
    struct voxel_optics optics = {.extinction = (float)sqrt(m2 + 2 * spheroid.side * spheroid.side),
                                  .evenness = 1,
                                  .albedo = {1, 1, 1}};
    memset(lone, 0, sizeof *lone);
    lone->voxel = voxel_pack(&optics, (const float[3]){1, 1, 1});
    lone->voxel.normals =
        voxel_pack_mean((const float[3]){(float)mean[0], (float)mean[1], (float)mean[2]});
    lone->cell = MARCH_FULL;
    struct march_job *job = &lone->job;
    *job = (struct march_job){.cells = &lone->cell,
                              .voxels = (const uint32_t *)(const void *)&lone->voxel,
                              .size = {1, 1, 1},
                              .eye = {-1, 0.5f, 0.5f},
                              .first = {1, 0, 0},
                              .speed = 1,
                              .step = 1,
                              .far_m = INFINITY,
                              .by_mean = true,
                              .sun_square = 1,
                              .one_sided = one_sided,
                              .clear = 1};
    for (int i = 0; i < 3; i++) {
        job->toward_eye[i] = (float)eye[i];
        job->toward_sun[i] = (float)sun[i];
        job->cosine += (float)(eye[i] * sun[i]);
        job->sun[i] = 1.0f / 255;
    }
    block_open(&lone->rays);
}

/* Normals about z, seen and lit from anywhere: what hides and what it sends, by every kernel. */
static void test_visible__area_and_light_are_those_of_quadrature_in_any_direction(void **state)
{
    (void)state;
    struct march_isa isas[4];
    size_t count = march_isas(isas);
    struct random random = random_seed(17, 3);
    double sum = 0, area_sum = 0;
    for (int n = 0; n < 240; n++) {
        double m = 0.5 + 0.5 * random_double(&random), eye[3], sun[3], mean[3] = {0, 0, m};
        unit_at_random(&random, eye);
        unit_at_random(&random, sun);
        struct spheroid spheroid = spheroid_of(m);
        struct means means = quadrature(&spheroid, eye, sun);
        for (size_t isa = 0; isa < count; isa++) {
            struct lone lone;
            lone_fill(&lone, mean, eye, sun, (float)(n % 2));
            block_march(&isas[isa], &lone.job, &lone.rays);
            double depth = -log((double)lone.rays.left[0]);
            double light = (double)lone.rays.rgb[1][0] / (1 - (double)lone.rays.left[0]);
            double sent = n % 2 ? means.odd : means.even; /* per area of leaf */
            if (fabs(depth - means.seen) > 0.01 || fabs(light * depth - sent) > 0.015)
                fail_msg("m %g: hides %g, not %g; sends %g, not %g", m, depth, means.seen,
                         light * depth, sent);
            sum += fabs(light * depth - sent) / (double)count;
            area_sum += fabs(depth - means.seen) / (double)count;
        }
    }
    if (sum / 240 > 0.003 || area_sum / 240 > 0.001)
        fail_msg("sends %g off in the mean, hides %g", sum / 240, area_sum / 240);
}

static void test_visible__leaves_that_lie_alike_hide_nothing_edge_on(void **state)
{
    (void)state;
    struct march_isa isas[4];
    march_isas(isas);
    for (int axis = 0; axis < 3; axis++) {
        double mean[3] = {0, 0, 0}, along[3] = {0, 0, 0}, across[3] = {0, 0, 0};
        mean[axis] = along[axis] = across[(axis + 1) % 3] = 1;
        struct lone lone;
        lone_fill(&lone, mean, along, along, 0);
        block_march(&isas[0], &lone.job, &lone.rays);
        assert_true(fabs(-log((double)lone.rays.left[0]) - 1) < 0.01);
        assert_true(fabs((double)lone.rays.rgb[0][0] / (1 - (double)lone.rays.left[0]) - 1) < 0.01);
        lone_fill(&lone, mean, across, along, 0);
        block_march(&isas[0], &lone.job, &lone.rays);
        assert_true(lone.rays.left[0] > 0.98f);
    }
}

/* Leaves whose normals are within an angle of an axis, or beside it, placed in a ball. */
static struct mesh *leaves_about(struct arena *arena, const double axis[3], double spread)
{
    enum { COUNT = 3000 };
    struct mesh *mesh = mesh_new(arena, MATERIAL_LEAF, 0.5f, COUNT);
    struct random random = random_seed(29, 1);
    while (mesh->triangles_count < COUNT) {
        double n[3], u[3], v[3], at[3], corners[2][3], length = 0;
        unit_at_random(&random, n);
        for (int i = 0; i < 3; i++) {
            n[i] = axis[i] + spread * n[i];
            length += n[i] * n[i];
        }
        unit_at_random(&random, at);
        for (int i = 0; i < 3; i++)
            u[i] = n[(i + 1) % 3] * at[(i + 2) % 3] - n[(i + 2) % 3] * at[(i + 1) % 3];
        double uu = sqrt(u[0] * u[0] + u[1] * u[1] + u[2] * u[2]);
        for (int i = 0; i < 3; i++)
            v[i] =
                (n[(i + 1) % 3] * u[(i + 2) % 3] - n[(i + 2) % 3] * u[(i + 1) % 3]) / sqrt(length);
        for (int i = 0; i < 3; i++) {
            corners[0][i] = 0.5 * at[i] + 0.02 * u[i] / uu;
            corners[1][i] = 0.5 * at[i] + 0.02 * v[i] / uu;
        }
        for (int i = 0; i < 3; i++)
            at[i] *= 0.5;
        mesh_triangle(mesh, at, corners[0], corners[1]);
    }
    return mesh_finish(arena, mesh);
}

/* The greatest area that the triangles show in a direction, per area of them, and which. */
static double most_shown(const struct mesh *mesh, double direction[3])
{
    enum { DIRECTIONS = 1000 };
    double most = 0;
    for (int k = 0; k < DIRECTIONS; k++) {
        double z = (k + 0.5) / DIRECTIONS, turn = k * 2.399963229728653, shown = 0;
        double w[3] = {sqrt(1 - z * z) * cos(turn), z, sqrt(1 - z * z) * sin(turn)};
        for (size_t t = 0; t < mesh->triangles_count; t++) {
            const float *n = mesh->normals[mesh->triangles[t][0]]; /* leaves are of one size */
            shown += fabs((double)n[0] * w[0] + (double)n[1] * w[1] + (double)n[2] * w[2]) /
                     (double)mesh->triangles_count;
        }
        if (shown > most) {
            most = shown;
            memcpy(direction, w, sizeof w);
        }
    }
    return most;
}

static const struct voxels *voxels_made(struct arena *arena, struct mesh *mesh, int resolution)
{
    const struct voxels *voxels;
    struct error error = {0};
    setenv("TREELINE_CACHE", "off", 1);
    assert_int_equal(
        voxels_of_plant(arena, plant_from_mesh(arena, "leaves", mesh), resolution, &voxels, &error),
        STATUS_OK);
    return voxels;
}

static const double axes[3][3] = {{0, 1, 0}, {0.6, 0.64, 0.48}, {-0.36, 0.48, 0.8}};
static const double spreads[4] = {0.1, 0.7, 1.2, 1000};

/* From second moments, packed as they are: leaves about an axis, widely, turned everywhere. Their
 * normals end at an angle, a spheroid's do not. */
static void test_visible__the_mean_is_the_area_shown_where_most_is(void **state)
{
    (void)state;
    for (int k = 0; k < 12; k++) {
        struct arena *arena = arena_create(0);
        struct mesh *mesh = leaves_about(arena, axes[k % 3], spreads[k / 3]);
        const struct voxels *voxels = voxels_made(arena, mesh, 64);
        struct voxel_optics optics = voxel_unpack(voxels, voxels->voxels_count - 1); /* of all */
        double direction[3] = {0, 0, 0}, most = most_shown(mesh, direction), along = 0, length = 0;
        float mean[3];
        voxel_mean_normal(&optics, mean);
        for (int i = 0; i < 3; i++) {
            along += (double)mean[i] * direction[i];
            length += (double)mean[i] * (double)mean[i];
        }
        length = sqrt(length);
        if (fabs(length - most) > 0.03 || (k < 6 && fabs(along) < 0.995 * length))
            fail_msg("leaves %d: mean of length %g, %g of it along where %g is shown", k, length,
                     fabs(along) / length, most);
        arena_destroy(arena);
    }
}

static void test_visible__voxels_hide_along_the_axes_together_what_they_hid(void **state)
{
    (void)state;
    for (int k = 0; k < 12; k++) {
        struct arena *arena = arena_create(0);
        const struct voxels *voxels =
            voxels_made(arena, leaves_about(arena, axes[k % 3], spreads[k / 3]), 5);
        const struct voxels *visible = voxels_visible(arena, voxels);
        double hid = 0, hides = 0;
        assert_int_equal(visible->voxels_count, voxels->voxels_count);
        for (uint32_t i = 0; i < voxels->voxels_count; i++) {
            struct voxel_optics before = voxel_unpack(voxels, i), after = voxel_unpack(visible, i);
            for (int axis = 0; axis < 3; axis++) {
                hid += (double)before.extinction * sqrt(fmax(0, (double)before.shape[axis]));
                hides += (double)after.extinction * sqrt(fmax(0, (double)after.shape[axis]));
            }
        }
        if (fabs(hides / hid - 1) > 0.04) /* of what 6 bits keep */
            fail_msg("leaves %d: hides %g, not %g", k, hides, hid);
        arena_destroy(arena);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_visible__side_and_second_moment_are_those_of_quadrature),
        cmocka_unit_test(test_visible__area_and_light_are_those_of_quadrature_in_any_direction),
        cmocka_unit_test(test_visible__leaves_that_lie_alike_hide_nothing_edge_on),
        cmocka_unit_test(test_visible__the_mean_is_the_area_shown_where_most_is),
        cmocka_unit_test(test_visible__voxels_hide_along_the_axes_together_what_they_hid),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
