/* Conifers: where the needles are, their polygons against closed forms, what is refused. */
#include "testing.h"

#include "plant/conifer.h"
#include "plant/normals.h"
#include "plant/plant.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

/* A trunk with `twigs` twigs, of the paper's counts by default. */
static struct conifer *conifer_new(struct arena *arena, uint32_t twigs, uint32_t cones,
                                   uint32_t needles)
{
    struct conifer *conifer = ARENA_NEW(arena, struct conifer);
    conifer->branches_count = 1;
    conifer->branches = ARENA_NEW(arena, struct conifer_branch);
    conifer->branches[0] = (struct conifer_branch){{0, 0, 0}, {0, 2, 0}, 0.1f, 0.02f, 0, twigs};
    conifer->twigs_count = twigs;
    conifer->twigs = ARENA_ARRAY(arena, struct conifer_twig, twigs);
    for (uint32_t i = 0; i < twigs; i++) {
        float angle = 2 * (float)pi * (float)i / (float)twigs;
        conifer->twigs[i] =
            (struct conifer_twig){.base_m = {0, 0.1f + 1.8f * (float)i / (float)twigs, 0},
                                  .axis = {0.8f * cosf(angle), 0.6f, 0.8f * sinf(angle)},
                                  .length_m = 0.5f,
                                  .axis_radius_m = 0.003f,
                                  .cones_count = cones,
                                  .spacing_m = 0.5f / (float)cones,
                                  .needles_count = needles,
                                  .needle_length_m = 0.04f,
                                  .needle_radius_m = 0.001f,
                                  .needle_angle_rad = 0.9f,
                                  .azimuth_rad = 0.3f,
                                  .azimuth_step_rad = 0.2f};
    }
    conifer->needle_albedo[1] = conifer->bark_albedo[0] = 0.3f;
    return conifer;
}

static struct arena *arena_of(void **state)
{
    return *state;
}

static int setup(void **state)
{
    *state = arena_create(0);
    return 0;
}

static int teardown(void **state)
{
    arena_destroy(*state);
    return 0;
}

static double dot(const float a[3], const float b[3])
{
    return (double)a[0] * b[0] + (double)a[1] * b[1] + (double)a[2] * b[2];
}

static void test_needle__has_its_length_its_angle_and_its_place_on_the_axis(void **state)
{
    struct conifer *conifer = conifer_new(arena_of(state), 5, 8, 16);
    for (size_t t = 0; t < 5; t++)
        for (uint32_t cone = 0; cone < 8; cone++)
            for (uint32_t n = 0; n < 16; n++) {
                const struct conifer_twig *twig = &conifer->twigs[t];
                float base[3], tip[3], across[3], along[3], line[3], from[3];
                conifer_needle(twig, cone, n, base, tip);
                conifer_frame(twig->axis, across, along);
                for (int k = 0; k < 3; k++) {
                    line[k] = tip[k] - base[k];
                    from[k] = base[k] - twig->base_m[k];
                }
                double h = (cone + 0.5) * 0.5 / 8, azimuth = 0.3 + 0.2 * cone + 2 * pi * n / 16;
                assert_float_equal(dot(from, twig->axis), h, 1e-6);
                assert_float_equal(sqrt(dot(from, from)), h, 1e-6);
                assert_float_equal(sqrt(dot(line, line)), 0.04, 1e-6);
                assert_float_equal(dot(line, twig->axis), 0.04 * cos(0.9), 1e-6);
                assert_float_equal(dot(line, across), 0.04 * sin(0.9) * cos(azimuth), 1e-6);
                assert_float_equal(dot(line, along), 0.04 * sin(0.9) * sin(azimuth), 1e-6);
            }
}

static void test_conifer__counts_as_many_needles_as_its_mesh_has(void **state)
{
    /* The paper's table: 2048, 2560, and 3072 where it prints 3840, which is 24 x 8 x 20. */
    static const unsigned rows[][4] = {
        {16, 8, 16, 2048}, {16, 8, 20, 2560}, {24, 8, 16, 3072}, {24, 8, 20, 3840}};
    for (size_t k = 0; k < 4; k++) {
        struct conifer *conifer = conifer_new(arena_of(state), rows[k][0], rows[k][1], rows[k][2]);
        assert_int_equal(conifer_finish(conifer, NULL), STATUS_OK);
        assert_int_equal(conifer->needles_count, rows[k][3]);
        const struct mesh *mesh = conifer_mesh(arena_of(state), conifer);
        struct error error = {STATUS_OK, ""};
        assert_int_equal(mesh_check(mesh, &error), STATUS_OK);
        assert_int_equal(mesh->parts_count, 2);
        assert_int_equal(mesh->parts[1].elements_count, rows[k][3]);
    }
}

static double part_volume(const struct mesh *mesh, size_t part, double *area)
{
    double volume = 0;
    *area = 0;
    uint32_t first = mesh->parts[part].first_triangle;
    for (uint32_t t = first; t < first + mesh->parts[part].triangles_count; t++) {
        const float *a = mesh->positions[mesh->triangles[t][0]];
        double cross[3];
        triangle_cross(a, mesh->positions[mesh->triangles[t][1]],
                       mesh->positions[mesh->triangles[t][2]], cross);
        volume += (a[0] * cross[0] + a[1] * cross[1] + a[2] * cross[2]) / 6;
        *area += sqrt(cross[0] * cross[0] + cross[1] * cross[1] + cross[2] * cross[2]) / 2;
    }
    return volume;
}

/* Closed, oriented outward: the divergence theorem gives the prisms' volume. The lateral area is
 * the cylinder's, so that by Cauchy's formula the mean silhouette is, but for the caps. */
static void test_mesh__is_closed_and_keeps_the_needles_area_at_any_number_of_sides(void **state)
{
    static const uint32_t sides[] = {3, 4, 7, 48};
    for (size_t k = 0; k < 4; k++) {
        struct conifer *conifer = conifer_new(arena_of(state), 16, 8, 16);
        conifer->needle_sides = sides[k], conifer->branch_sides = 64;
        assert_int_equal(conifer_finish(conifer, NULL), STATUS_OK);
        const struct mesh *mesh = conifer_mesh(arena_of(state), conifer);
        double n = sides[k], r = 0.001, l = 0.04, area;
        double circumradius = pi * r / (n * sin(pi / n));
        double section = n / 2 * circumradius * circumradius * sin(2 * pi / n);
        double volume = part_volume(mesh, 1, &area);
        assert_float_equal(volume / (2048 * section * l), 1, 1e-3);
        assert_float_equal(area / (2048 * (2 * pi * r * l + 2 * section)), 1, 1e-4);
        /* The trunk, a frustum, and 16 twigs; 64 sides are a circle within 0.1 %. */
        volume = pi / 3 * 2 * (0.01 + 0.002 + 0.0004) + 16 * pi * 0.003 * 0.003 * 0.5;
        assert_float_equal(part_volume(mesh, 0, &area) / volume, 1, 2e-3);
    }
}

static void test_mesh__lies_within_the_bounds(void **state)
{
    struct conifer *conifer = conifer_new(arena_of(state), 24, 8, 16);
    conifer->needle_sides = conifer->branch_sides = 64;
    assert_int_equal(conifer_finish(conifer, NULL), STATUS_OK);
    const struct mesh *mesh = conifer_mesh(arena_of(state), conifer);
    for (int k = 0; k < 3; k++) {
        assert_true(conifer->minimum_m[k] <= mesh->minimum_m[k] + 1e-4f);
        assert_true(conifer->maximum_m[k] >= mesh->maximum_m[k] - 1e-4f);
        assert_true(conifer->minimum_m[k] > mesh->minimum_m[k] - 0.11f); /* the trunk's radius */
    }
}

static void test_plant__gives_the_hierarchy_of_a_conifer_and_none_of_a_poplar(void **state)
{
    struct conifer *conifer = conifer_new(arena_of(state), 16, 8, 16);
    assert_int_equal(conifer_finish(conifer, NULL), STATUS_OK);
    struct plant *plant = plant_from_conifer(arena_of(state), "pine", conifer), *poplar = NULL;
    const struct conifer *got = NULL;
    const struct mesh *mesh = NULL;
    uint64_t hash = 0, other = 0;
    assert_int_equal(plant_conifer(plant, &got, NULL), STATUS_OK);
    assert_ptr_equal(got, conifer);
    assert_int_equal(plant_mesh(plant, &mesh, NULL), STATUS_OK);
    assert_int_equal(mesh->parts[1].elements_count, 2048);
    assert_int_equal(plant_generated(arena_of(state), "poplar", NULL, &poplar, NULL), STATUS_OK);
    assert_int_equal(plant_conifer(poplar, &got, NULL), STATUS_OK);
    assert_null(got);
    assert_int_equal(plant_hash(plant, &hash, NULL), STATUS_OK);
    struct conifer *changed = conifer_new(arena_of(state), 16, 8, 16);
    changed->twigs[3].needle_angle_rad = 1;
    plant = plant_from_conifer(arena_of(state), "pine", changed);
    assert_int_equal(plant_hash(plant, &other, NULL), STATUS_OK);
    assert_true(hash != other);
}

static void refused(struct conifer *conifer, const char *words)
{
    struct error error = {STATUS_OK, ""};
    assert_int_equal(conifer_finish(conifer, &error), STATUS_INVALID);
    if (!strstr(error.text, words))
        fail_msg("'%s' does not say '%s'", error.text, words);
}

static void test_conifer__refuses_what_is_no_plant_and_names_it(void **state)
{
    struct conifer *conifer = conifer_new(arena_of(state), 4, 8, 16);
    conifer->twigs[2].needles_count = 3000000;
    refused(conifer, "more than 16777216 needles, at twig 2 of 4");
    conifer = conifer_new(arena_of(state), 4, 8, 16);
    conifer->twigs[1].axis[0] = 2;
    refused(conifer, "twig 1: base is not finite or axis");
    conifer = conifer_new(arena_of(state), 4, 8, 16);
    conifer->twigs[3].needle_radius_m = NAN;
    refused(conifer, "twig 3: cones");
    conifer = conifer_new(arena_of(state), 4, 8, 16);
    conifer->twigs[0].needle_angle_rad = 4;
    refused(conifer, "angle is 4 rad; allowed: 0..pi");
    conifer = conifer_new(arena_of(state), 4, 8, 16);
    conifer->branches[0].twigs_count = 3;
    refused(conifer, "the branches have 3 of 4 twigs");
    conifer->branches[0].radius_to_m = 0;
    refused(conifer, "branch 0: radii are 0.1 and 0 m");
    conifer->branches[0].to_m[1] = 0;
    refused(conifer, "branch 0: its ends are the same");
    conifer->branches_count = 0;
    refused(conifer, "0 branches; allowed: 1..");
}

/* clang-format off */
int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_needle__has_its_length_its_angle_and_its_place_on_the_axis, setup, teardown),
        cmocka_unit_test_setup_teardown(test_conifer__counts_as_many_needles_as_its_mesh_has, setup, teardown),
        cmocka_unit_test_setup_teardown(test_mesh__is_closed_and_keeps_the_needles_area_at_any_number_of_sides, setup, teardown),
        cmocka_unit_test_setup_teardown(test_mesh__lies_within_the_bounds, setup, teardown),
        cmocka_unit_test_setup_teardown(test_plant__gives_the_hierarchy_of_a_conifer_and_none_of_a_poplar, setup, teardown),
        cmocka_unit_test_setup_teardown(test_conifer__refuses_what_is_no_plant_and_names_it, setup, teardown),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
