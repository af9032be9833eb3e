/* Voxels of plants: areas, moments and opacities against closed forms, distances against brute
 * force. */
#include "testing.h"

#include "reference_world.h"

#include "bake/voxels_parts.h"

#include <stdlib.h>

static struct plant *plant_of(struct arena *arena, struct mesh *mesh)
{
    setenv("TREELINE_CACHE", "off", 1);
    return plant_from_mesh(arena, "test", mesh);
}

static const struct voxels *voxels_made(struct arena *arena, struct mesh *mesh, int resolution)
{
    const struct voxels *voxels;
    struct error error = {0};
    assert_int_equal(voxels_of_plant(arena, plant_of(arena, mesh), resolution, &voxels, &error),
                     STATUS_OK);
    return voxels;
}

static double uniform(struct random *random, double low, double high)
{
    return low + (high - low) * random_double(random);
}

/* Leaves (right triangles of legs leg_m) turned at random in a unit cube. */
static struct mesh *leaves_at_random(struct arena *arena, size_t count, double leg_m)
{
    struct mesh *mesh = mesh_new(arena, MATERIAL_LEAF, 0.5f, count);
    struct random random = random_seed(7, 1);
    for (size_t i = 0; i < count; i++) {
        double at[3], u[3], v[3], n[3], corners[2][3];
        double z = uniform(&random, -1, 1), turn = uniform(&random, 0, 2 * M_PI),
               r = sqrt(1 - z * z);
        double spin = uniform(&random, 0, 2 * M_PI);
        n[0] = r * cos(turn);
        n[1] = r * sin(turn);
        n[2] = z;
        double a[3] = {-sin(turn), cos(turn), 0};
        double b[3] = {n[1] * a[2] - n[2] * a[1], n[2] * a[0] - n[0] * a[2],
                       n[0] * a[1] - n[1] * a[0]};
        for (int k = 0; k < 3; k++) {
            at[k] = uniform(&random, 0, 1);
            u[k] = cos(spin) * a[k] + sin(spin) * b[k];
            v[k] = cos(spin) * b[k] - sin(spin) * a[k];
            corners[0][k] = at[k] + leg_m * u[k];
            corners[1][k] = at[k] + leg_m * v[k];
        }
        mesh_triangle(mesh, at, corners[0], corners[1]);
    }
    return mesh_finish(arena, mesh);
}

static struct voxel_grid grid_made(struct arena *arena, struct mesh *mesh, uint32_t side)
{
    struct voxel_grid grid = {.size = {side, side, side}};
    struct error error = {0};
    float origin[3] = {-0.25f, -0.25f, -0.25f};
    assert_int_equal(voxel_grid_fill(arena, mesh, origin, 1.5f / (float)side, &grid, &error),
                     STATUS_OK);
    return grid;
}

static void test_voxels__area_and_moments_are_the_triangles(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct mesh *mesh = leaves_at_random(arena, 4000, 0.1);
    struct voxel_grid grid = grid_made(arena, mesh, 24);
    double area = 0, moments[6] = {0}, exact = 4000 * 0.005, face = 1.5 / 24 * 1.5 / 24;
    for (size_t i = 0; i < grid.count; i++) {
        area += grid.masses[i].area * face;
        for (int k = 0; k < 6; k++)
            moments[k] += grid.masses[i].moments[k] * face;
    }
    assert_true(fabs(area / exact - 1) < 0.01);
    /* normals turned at random: a third along each axis, nothing between them */
    for (int k = 0; k < 6; k++)
        assert_true(fabs(moments[k] / exact - (k < 3 ? 1.0 / 3 : 0)) < 0.01);
    arena_destroy(arena);
}

static void test_voxels__a_pane_hides_its_axis_alone_and_its_neighbours_share_no_ray(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct mesh *mesh = mesh_new(arena, MATERIAL_LEAF, 0.5f, 2);
    double c[4][3] = {{0, 0, 0.5}, {1, 0, 0.5}, {1, 1, 0.5}, {0, 1, 0.5}};
    mesh_quad(mesh, c[0], c[1], c[2], c[3]);
    mesh_finish(arena, mesh);
    struct voxel_grid grid = {.size = {4, 4, 4}}, coarse;
    float origin[3] = {0, 0, 0};
    struct error error = {0};
    assert_int_equal(voxel_grid_fill(arena, mesh, origin, 0.25f, &grid, &error), STATUS_OK);
    assert_int_equal(grid.count, 16);
    for (size_t i = 0; i < grid.count; i++) {
        assert_true(fabsf(grid.masses[i].area - 1) < 1e-5f);
        assert_true(grid.masses[i].cover[2] == 1 && grid.masses[i].cover[0] == 0);
    }
    voxel_grid_halve(arena, &grid, &coarse);
    assert_int_equal(coarse.count, 4);
    for (size_t i = 0; i < coarse.count; i++)
        assert_true(coarse.masses[i].cover[2] == 1 && coarse.masses[i].rays[2] == UINT64_MAX);
    arena_destroy(arena);
}

static void test_voxels__what_hides_a_ray_twice_counts_once_when_coarser(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct mesh *mesh = leaves_at_random(arena, 4000, 0.1);
    struct voxel_grid fine = grid_made(arena, mesh, 24), coarse;
    struct voxel_grid direct = grid_made(arena, mesh, 12);
    voxel_grid_halve(arena, &fine, &coarse);
    double halved[3] = {0}, made[3] = {0};
    for (size_t i = 0; i < coarse.count; i++)
        for (int k = 0; k < 3; k++)
            halved[k] += coarse.masses[i].cover[k];
    for (size_t i = 0; i < direct.count; i++)
        for (int k = 0; k < 3; k++)
            made[k] += direct.masses[i].cover[k];
    for (int k = 0; k < 3; k++)
        assert_true(fabs(halved[k] / made[k] - 1) < 0.01);
    arena_destroy(arena);
}

static void test_voxels__distances_are_those_of_brute_force(void **state)
{
    (void)state;
    const uint32_t size[3] = {17, 9, 23};
    uint32_t cells[17 * 9 * 23] = {0};
    struct random random = random_seed(3, 1);
    long full[12][3];
    for (int i = 0; i < 12; i++) {
        for (int k = 0; k < 3; k++)
            full[i][k] = (long)random_below(&random, size[k]);
        cells[(full[i][2] * 9 + full[i][1]) * 17 + full[i][0]] = VOXELS_FIRST + 5;
    }
    voxel_distances(size, cells);
    for (long at = 0; at < 17 * 9 * 23; at++) {
        long place[3] = {at % 17, at / 17 % 9, at / (17 * 9)}, least = 1000;
        for (int i = 0; i < 12; i++) {
            long distance = 0;
            for (int k = 0; k < 3; k++)
                distance =
                    labs(full[i][k] - place[k]) > distance ? labs(full[i][k] - place[k]) : distance;
            least = distance < least ? distance : least;
        }
        assert_int_equal(cells[at], least ? least : VOXELS_FIRST + 5);
    }
}

static void test_voxels__packing_keeps_what_a_picture_shows(void **state)
{
    (void)state;
    const float albedo[3] = {0.1f, 0.4f, 0.05f};
    struct voxel_optics in = {.extinction = 1.25f,
                              .shape = {0.2f, 0.5f, 0.3f, 0.1f, -0.2f, 0},
                              .normals = {1, 0, 0, 0, 0, 0},
                              .albedo = {0.05f, 0.4f, 0},
                              .evenness = 0.9f,
                              .bark = 0.6f};
    struct voxel voxel = voxel_pack(&in, albedo);
    struct voxels voxels = {.albedo = {0.1f, 0.4f, 0.05f}, .voxels = &voxel};
    struct voxel_optics out = voxel_unpack(&voxels, 0);
    for (int i = 0; i < 6; i++) {
        assert_true(fabsf(out.shape[i] - in.shape[i]) <= 0.0161f);
        assert_true(fabsf(out.normals[i] - in.normals[i]) <= 0.0161f);
    }
    for (int c = 0; c < 3; c++)
        assert_true(fabsf(out.albedo[c] - in.albedo[c]) <= albedo[c] / 500);
    assert_true(out.extinction == in.extinction && fabsf(out.evenness - 0.9f) < 0.0084f &&
                fabsf(out.bark - 0.6f) < 0.034f);
}

static void test_voxels__a_pyramid_ends_in_one_voxel_and_an_empty_mesh_in_none(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    const struct voxels *voxels = voxels_made(arena, leaves_at_random(arena, 300, 0.1), 37);
    const struct voxels_level *last = &voxels->levels[voxels->levels_count - 1];
    assert_int_equal(last->size[0] * last->size[1] * last->size[2], 1);
    assert_true(last->cells[0] >= VOXELS_FIRST &&
                last->cells[0] - VOXELS_FIRST == voxels->voxels_count - 1);
    struct mesh *none = mesh_new(arena, MATERIAL_LEAF, 0.5f, 1);
    voxels = voxels_made(arena, none, 64);
    assert_int_equal(voxels->voxels_count, 0);
    assert_int_equal(voxels->levels_count, 1);
    assert_true(voxels->levels[0].cells[0] < VOXELS_FIRST);
    arena_destroy(arena);
}

static void test_voxels__nomas_opacity_is_the_mean_over_pairs(void **state)
{
    (void)state;
    const float steps[8] = {.1f, .2f, .3f, .4f, .5f, .6f, .7f, .8f};
    const float full[8] = {1, 1, 1, 1, 1, 1, 1, 1}, none[8] = {0}, half[8] = {1, 0, 1, 0, 1, 0, 1};
    assert_true(fabsf(voxel_noma(steps) - 0.65f) < 1e-6f);
    assert_true(voxel_noma(full) == 1 && voxel_noma(none) == 0 && voxel_noma(half) == 1);
    double printed = 0; /* the form in print: sums less products */
    for (int k = 0; k < 8; k += 2)
        printed += ((double)steps[k] + steps[k + 1] - (double)steps[k] * steps[k + 1]) / 4;
    assert_true(fabs(printed - 0.65) < 1e-6);
}

/* Two levels of 2 x 2 x 2 and one voxels, each of its own depths along the axes. */
static void test_voxels__nomas_pyramid_lets_through_the_mean_of_its_columns(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct random random = random_seed(3, 1);
    const float white[3] = {1, 1, 1};
    for (int n = 0; n < 50; n++) {
        uint32_t cells[9];
        struct voxel packed[9];
        struct voxels voxels = {.albedo = {1, 1, 1}, .levels_count = 2, .voxels = packed};
        voxels.levels[0] = (struct voxels_level){{2, 2, 2}, 1, cells};
        voxels.levels[1] = (struct voxels_level){{1, 1, 1}, 2, cells + 8};
        for (uint32_t k = 0; k < 8; k++) {
            struct voxel_optics optics = {.extinction = 2 * random_float(&random), .evenness = 1};
            optics.shape[0] = 0.2f + 0.2f * random_float(&random);
            optics.shape[1] = 0.2f + 0.2f * random_float(&random);
            optics.shape[3] = 0.1f;
            cells[k] = k && random_below(&random, 4) == 0 ? 1 : VOXELS_FIRST + voxels.voxels_count;
            if (cells[k] >= VOXELS_FIRST)
                packed[voxels.voxels_count++] = voxel_pack(&optics, white);
        }
        cells[8] = VOXELS_FIRST + voxels.voxels_count;
        packed[voxels.voxels_count++] = packed[0];
        const struct voxels *noma = voxels_noma(arena, &voxels);
        struct voxel_optics coarse = voxel_unpack(noma, cells[8] - VOXELS_FIRST);
        assert_true(coarse.shape[3] == 0 && coarse.shape[4] == 0 && coarse.shape[5] == 0);
        for (int axis = 0; axis < 3; axis++) {
            double depths[8] = {0}, clear = 0;
            for (int k = 0; k < 8; k++) { /* by the place of the column that the cell is in */
                if (cells[k] < VOXELS_FIRST)
                    continue;
                struct voxel_optics fine = voxel_unpack(&voxels, cells[k] - VOXELS_FIRST);
                depths[k & ~(1 << axis)] += fine.extinction * sqrt(fine.shape[axis]);
            }
            for (int k = 0; k < 8; k++)
                clear += k & 1 << axis ? 0 : exp(-depths[k]) / 4;
            double drawn = exp(-coarse.extinction * sqrt(fmax(coarse.shape[axis], 0)));
            assert_true(fabs(drawn - clear) < 0.01);
        }
    }
    arena_destroy(arena);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_voxels__area_and_moments_are_the_triangles),
        cmocka_unit_test(test_voxels__a_pane_hides_its_axis_alone_and_its_neighbours_share_no_ray),
        cmocka_unit_test(test_voxels__what_hides_a_ray_twice_counts_once_when_coarser),
        cmocka_unit_test(test_voxels__distances_are_those_of_brute_force),
        cmocka_unit_test(test_voxels__packing_keeps_what_a_picture_shows),
        cmocka_unit_test(test_voxels__nomas_opacity_is_the_mean_over_pairs),
        cmocka_unit_test(test_voxels__nomas_pyramid_lets_through_the_mean_of_its_columns),
        cmocka_unit_test(test_voxels__a_pyramid_ends_in_one_voxel_and_an_empty_mesh_in_none),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
