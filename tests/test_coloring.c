/* Voxel colouring: volumes, opacity, agreement, areas and colours of shapes that are known. */
#include "testing.h"

#include "bake/coloring_views.h"
#include "base/file.h"
#include "base/random.h"
#include "wall/image.h"

#include <dirent.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const double pi = 3.14159265358979323846;

static struct plant *plant_of(struct arena *arena, const char *generator, const char *options)
{
    struct error error = {0};
    struct plant *plant = NULL;
    if (plant_generated(arena, generator, options, &plant, &error) != STATUS_OK)
        fail_msg("%s", error.text);
    return plant;
}

static struct coloring_request usual(int grid)
{
    return (struct coloring_request){.grid = grid, .agreement = INFINITY, .see_through = 1};
}

static struct coloring colored(struct arena *arena, struct plant *plant, size_t views,
                               struct coloring_request request)
{
    struct error error = {0};
    struct coloring coloring;
    struct coloring_shots shots = {views, 2 * request.grid, 0.005f};
    if (coloring_of_plant(arena, plant, &shots, &request, 2, &coloring, &error) != STATUS_OK)
        fail_msg("%s", error.text);
    size_t cells = (size_t)request.grid * (size_t)request.grid * (size_t)request.grid;
    assert_int_equal(coloring.voxels_count + coloring.unseen_count + coloring.clear_count +
                         coloring.carved_count,
                     cells);
    return coloring;
}

/* What no ray saw through counts as solid. */
static double volume_m3(const struct coloring *coloring)
{
    double sum = (double)coloring->unseen_count;
    for (size_t i = 0; i < coloring->voxels_count; i++)
        sum += (double)coloring->voxels[i].opacity;
    const float *v = coloring->voxel_m;
    return sum * (double)v[0] * (double)v[1] * (double)v[2];
}

/* A ball of radius 1: no noise, and 1 = sqrt(1.25^2 - t (1.25^2 - .75^2)) for t = .5625. */
static struct plant *ball(struct arena *arena)
{
    return plant_of(arena, "hypertexture", "radius=1,amplitude=0,threshold=0.5625,resolution=60");
}

static double ball_error(size_t views, int grid)
{
    struct arena *arena = arena_create(0);
    struct coloring coloring = colored(arena, ball(arena), views, usual(grid));
    double error = fabs(volume_m3(&coloring) / (4 * pi / 3) - 1);
    arena_destroy(arena);
    return error;
}

static void test_ball__is_rebuilt_the_better_the_more_views_see_it(void **state)
{
    (void)state;
    /* One view leaves all behind the ball unseen: half a cylinder for half a ball, but for what the
     * box's back cuts off. */
    double one = ball_error(1, 32), six = ball_error(6, 32), many = ball_error(32, 32);
    assert_true(one > 0.2);
    assert_true(six < one / 3);
    assert_true(many < six);
    assert_true(many < 0.02);
}

static void test_ball__is_rebuilt_the_better_the_finer_the_grid(void **state)
{
    (void)state;
    assert_true(ball_error(32, 64) < ball_error(32, 16));
}

static void test_ball__has_squares_of_its_own_area_on_its_surface(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct coloring coloring = colored(arena, ball(arena), 32, usual(32));
    struct mesh *mesh = coloring_mesh(arena, &coloring);
    struct error error = {0};
    if (mesh_check(mesh, &error) != STATUS_OK)
        fail_msg("%s", error.text);
    double area = 0, off = 0, turned = 0;
    for (size_t i = 0; i < coloring.voxels_count; i++) {
        const struct colored_voxel *voxel = &coloring.voxels[i];
        const float *p = voxel->position_m, *n = mesh->normals[4 * i];
        area += (double)voxel->area_m2;
        double radius = sqrt((double)(p[0] * p[0] + (p[1] - 1) * (p[1] - 1) + p[2] * p[2]));
        off = fmax(off, fabs(radius - 1));
        turned += (double)(p[0] * n[0] + (p[1] - 1) * n[1] + p[2] * n[2]) / radius;
    }
    assert_float_equal(area / (4 * pi), 1, 0.15);
    assert_true(off < 0.5 * (double)coloring.voxel_m[0]);
    assert_true(turned / (double)coloring.voxels_count > 0.98); /* cosine of 11 degrees */
    arena_destroy(arena);
}

/* A cube of 2 m on the ground, each face of its own colour. */
struct cube {
    struct mesh mesh;
    float positions[24][3], normals[24][3], colors[24][3];
    uint32_t triangles[12][3];
    struct mesh_part part;
    struct material material;
};

static void cube_make(struct cube *cube)
{
    *cube = (struct cube){.material = {.name = (char[]){'a', 0}, .albedo = {1, 1, 1}}};
    for (int face = 0; face < 6; face++)
        for (int corner = 0; corner < 4; corner++) {
            int axis = face / 2, at = 4 * face + corner;
            float sign = face % 2 ? -1 : 1;
            float u = corner == 0 || corner == 3 ? -1 : 1, v = corner < 2 ? -1 : 1;
            cube->positions[at][axis] = sign;
            cube->positions[at][(axis + 1) % 3] = u * sign;
            cube->positions[at][(axis + 2) % 3] = v;
            cube->positions[at][1] += 1;
            cube->normals[at][axis] = sign;
            for (int i = 0; i < 3; i++)
                cube->colors[at][i] = face + 1 == 2 * i + 1 || face == i + 3 ? 0.9f : 0.1f;
        }
    for (uint32_t face = 0; face < 6; face++)
        for (uint32_t i = 0; i < 3; i++) {
            cube->triangles[2 * face][i] = 4 * face + i;
            cube->triangles[2 * face + 1][i] = 4 * face + (i ? i + 1 : 0);
        }
    cube->part.triangles_count = 12;
    cube->mesh = (struct mesh){.vertices_count = 24,
                               .positions = cube->positions,
                               .normals = cube->normals,
                               .colors = cube->colors,
                               .triangles_count = 12,
                               .triangles = cube->triangles,
                               .parts_count = 1,
                               .parts = &cube->part,
                               .materials_count = 1,
                               .materials = &cube->material};
    mesh_bounds(&cube->mesh);
}

static void test_cube__has_its_volume_from_six_views(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct cube cube;
    cube_make(&cube);
    struct error error = {0};
    if (mesh_check(&cube.mesh, &error) != STATUS_OK)
        fail_msg("%s", error.text);
    struct coloring coloring =
        colored(arena, plant_from_mesh(arena, "cube", &cube.mesh), 6, usual(40));
    assert_float_equal(volume_m3(&coloring) / 8, 1, 0.06);
    /* Nothing but its faces: 40^3 - 38^3, and what lies within is not seen. */
    assert_int_equal(coloring.voxels_count, 40 * 40 * 40 - 38 * 38 * 38);
    assert_int_equal(coloring.unseen_count, 38 * 38 * 38);
    arena_destroy(arena);
}

/* The middles of the faces have the faces' colours; edges mix two. */
static void test_cube__has_the_colors_of_its_faces(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct cube cube;
    cube_make(&cube);
    struct coloring coloring =
        colored(arena, plant_from_mesh(arena, "cube", &cube.mesh), 12, usual(16));
    for (size_t i = 0; i < coloring.voxels_count; i++) {
        const struct colored_voxel *voxel = &coloring.voxels[i];
        float p[3] = {voxel->position_m[0], voxel->position_m[1] - 1, voxel->position_m[2]};
        int faces = 0, face = 0;
        for (int k = 0; k < 3; k++)
            if (fabsf(p[k]) > 0.86f)
                faces++, face = 2 * k + (p[k] < 0);
        if (faces != 1)
            continue;
        for (int k = 0; k < 3; k++)
            assert_float_equal(voxel->color[k], cube.colors[4 * face][k], 1e-5);
    }
    arena_destroy(arena);
}

/* Seitz and Dyer's test: where one of the views lies about the colour, what it sees is carved. */
static void test_agreement__carves_what_a_view_sees_in_another_color(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct cube cube;
    cube_make(&cube);
    struct error error = {0};
    struct images capture;
    struct plant *plant = plant_from_mesh(arena, "cube", &cube.mesh);
    assert_int_equal(
        coloring_trace(arena, plant, &(struct coloring_shots){12, 64, 0.005f}, 2, &capture, &error),
        STATUS_OK);
    float(*lie)[3] = arena_alloc(arena, 64 * 64, sizeof *lie);
    for (int i = 0; i < 64 * 64; i++)
        lie[i][0] = 1, lie[i][1] = lie[i][2] = 0.5f;
    struct coloring_request request = usual(16);
    memcpy(request.minimum_m, capture.minimum_m, sizeof capture.minimum_m);
    memcpy(request.maximum_m, capture.maximum_m, sizeof capture.maximum_m);
    struct coloring honest, lied, kept;
    /* Rays of one colour a face: only edges hold two, 0.8 apart; half a share each is .57. */
    request.agreement = 0.6f;
    coloring_build(arena, capture.views, 12, &request, &honest);
    assert_int_equal(honest.carved_count, 0);
    request.agreement = 0.15f;
    capture.views[3].color = (const float(*)[3])lie;
    coloring_build(arena, capture.views, 12, &request, &lied);
    const float *toward = capture.views[3].forward;
    for (size_t i = 0; i < lied.voxels_count; i++) {
        /* What is kept, the liar does not see: its face looks away, or it is out of two views. */
        const struct colored_voxel *voxel = &lied.voxels[i];
        float p[3] = {voxel->position_m[0], voxel->position_m[1] - 1, voxel->position_m[2]};
        for (int k = 0; k < 3; k++)
            if (fabsf(p[k]) > 0.95f && fabsf(p[(k + 1) % 3]) < 0.7f && fabsf(p[(k + 2) % 3]) < 0.7f)
                assert_true(p[k] * toward[k] > -1e-3f);
    }
    assert_true(lied.carved_count > 16 * 16 * 2);
    request.agreement = INFINITY;
    coloring_build(arena, capture.views, 12, &request, &kept);
    assert_int_equal(kept.carved_count, 0);
    arena_destroy(arena);
}

/* Small squares at random in a sheet of unit thickness, all across z: rays along z that arrive in a
 * voxel end there with its share of cover. */
static void test_opacity__is_the_share_of_rays_that_end(void **state)
{
    (void)state;
    enum { SIDE = 64 };
    struct arena *arena = arena_create(0);
    float(*color)[3] = arena_alloc(arena, SIDE * SIDE, sizeof *color);
    float *front = ARENA_ARRAY(arena, float, SIDE *SIDE),
          *back = ARENA_ARRAY(arena, float, SIDE *SIDE);
    struct random random = random_seed(3, 0);
    size_t ends = 0, beyond = 0, far_ends = 0;
    for (int i = 0; i < SIDE * SIDE; i++) {
        float t = random_float(&random);
        front[i] = t < 0.3f ? 1.2f : t < 0.6f ? 1.7f : INFINITY;
        ends += t < 0.3f, beyond += t >= 0.3f, far_ends += t >= 0.3f && t < 0.6f;
        back[i] = INFINITY;
    }
    struct depth_view views[2] = {{.position_m = {0, 0, 1},
                                   .right = {1, 0, 0},
                                   .up = {0, 1, 0},
                                   .forward = {0, 0, -1},
                                   .half = {0.5f, 0.5f},
                                   .width_px = SIDE,
                                   .height_px = SIDE,
                                   .color = (const float(*)[3])color,
                                   .depth_m = front}};
    views[1] = views[0];
    views[1].depth_m = back;
    struct coloring_request request = usual(2);
    for (int i = 0; i < 3; i++)
        request.minimum_m[i] = i < 2 ? -0.5f : -1, request.maximum_m[i] = i < 2 ? 0.5f : 0;
    struct coloring coloring;
    coloring_build(arena, views, 1, &request, &coloring);
    assert_int_equal(coloring.voxels_count, 8);
    double near_share = 0, far_share = 0;
    for (size_t i = 0; i < 8; i++)
        *(coloring.voxels[i].position_m[2] > -0.5f ? &near_share : &far_share) +=
            (double)coloring.voxels[i].opacity / 4;
    assert_float_equal(near_share, (double)ends / (SIDE * SIDE), 0.005);
    assert_float_equal(far_share, (double)far_ends / (double)beyond, 0.005);
    request.binary = true;
    coloring_build(arena, views, 1, &request, &coloring);
    assert_true(coloring.voxels[0].opacity == 1);
    /* A second view sees nothing at all: it sees through. */
    request.see_through = 0.99f;
    coloring_build(arena, views, 2, &request, &coloring);
    assert_int_equal(coloring.carved_count, 8);
    coloring_build(arena, views, 1, &request, &coloring);
    assert_int_equal(coloring.carved_count, 0);
    arena_destroy(arena);
}

static void test_coloring__is_the_same_from_any_number_of_threads(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct coloring made[2];
    for (int k = 0; k < 2; k++) {
        struct coloring_request request = usual(32);
        assert_int_equal(coloring_of_plant(arena, plant_of(arena, "poplar", NULL),
                                           &(struct coloring_shots){6, 64, 0.005f}, &request,
                                           1 + 2 * k, &made[k], NULL),
                         STATUS_OK);
    }
    assert_int_equal(made[0].voxels_count, made[1].voxels_count);
    assert_memory_equal(made[0].voxels, made[1].voxels,
                        made[0].voxels_count * sizeof *made[0].voxels);
    assert_memory_equal(made[0].cells, made[1].cells, 32 * 32 * 32 * sizeof(uint32_t));
    arena_destroy(arena);
}

/* Removes a folder of files. */
static void folder_remove(const char *folder)
{
    struct dirent *entry;
    DIR *files = opendir(folder);
    assert_non_null(files);
    while ((entry = readdir(files)))
        if (entry->d_name[0] != '.')
            assert_int_equal(unlinkat(dirfd(files), entry->d_name, 0), 0);
    closedir(files);
    assert_int_equal(rmdir(folder), 0);
}

/* Files say the same as memory: axis-aligned cameras come back to the bit, turned ones to rounding.
 */
static void test_images__of_a_plant_give_the_voxels_of_the_plant(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct error error = {0};
    char folder[] = "/tmp/treeline-images-XXXXXX";
    assert_non_null(mkdtemp(folder));
    for (size_t count = 6; count <= 12; count += 6) {
        struct images capture;
        struct plant *plant = plant_of(arena, "poplar", NULL);
        if (coloring_trace(arena, plant, &(struct coloring_shots){count, 96, 0.005f}, 2, &capture,
                           &error) != STATUS_OK ||
            images_write(folder, &capture, &error) != STATUS_OK)
            fail_msg("%s", error.text);
        struct images images;
        if (images_describe(arena, folder, &images, &error) != STATUS_OK ||
            images_load(arena, &images, &error) != STATUS_OK)
            fail_msg("%s", error.text);
        struct coloring direct, loaded;
        struct coloring_request request = usual(48);
        memcpy(request.minimum_m, capture.minimum_m, sizeof capture.minimum_m);
        memcpy(request.maximum_m, capture.maximum_m, sizeof capture.maximum_m);
        coloring_build(arena, capture.views, count, &request, &direct);
        memcpy(request.minimum_m, images.minimum_m, sizeof images.minimum_m);
        memcpy(request.maximum_m, images.maximum_m, sizeof images.maximum_m);
        coloring_build(arena, images.views, count, &request, &loaded);
        size_t same = 0, cells = 48 * 48 * 48;
        for (size_t i = 0; i < cells; i++)
            same += (direct.cells[i] < COLORING_FIRST ? direct.cells[i] : COLORING_FIRST) ==
                    (loaded.cells[i] < COLORING_FIRST ? loaded.cells[i] : COLORING_FIRST);
        assert_true(count == 6 ? same == cells : same >= cells - cells / 2000);
        if (count == 6)
            for (size_t i = 0; i < direct.voxels_count; i++) {
                direct.voxels[i].leaf = 1; /* the files do not say */
                assert_memory_equal(&direct.voxels[i], &loaded.voxels[i], sizeof *loaded.voxels);
            }
        /* The plant of the folder has a rectangle a voxel. */
        struct plant *from = plant_images(arena, folder, &request);
        const struct mesh *mesh = NULL;
        if (plant_mesh(from, &mesh, &error) != STATUS_OK)
            fail_msg("%s", error.text);
        assert_int_equal(mesh->triangles_count, 2 * loaded.voxels_count);
    }
    folder_remove(folder);
    arena_destroy(arena);
}

/* A pinhole camera whose picture is a plane across it, stored as distances along the rays: the
 * points lie on that plane, and the normals face the camera. */
static void test_images__distances_along_rays_become_depths(void **state)
{
    (void)state;
    enum { SIDE = 8 };
    struct arena *arena = arena_create(0);
    struct error error = {0};
    char folder[] = "/tmp/treeline-images-XXXXXX";
    assert_non_null(mkdtemp(folder));
    static const char *const names[] = {"R", "G", "B", "Z"};
    struct image image = {SIDE, SIDE, 4, ARENA_ARRAY(arena, float, 4 * SIDE * SIDE), names};
    double half = tan(30 * pi / 180);
    for (int i = 0; i < SIDE * SIDE; i++) {
        double x = (2 * (i % SIDE + 0.5) / SIDE - 1) * half;
        double y = (1 - 2 * (i / SIDE + 0.5) / SIDE) * half;
        for (int c = 0; c < 3; c++)
            image.values[4 * i + c] = 0.5f;
        image.values[4 * i + 3] = (float)(4 * sqrt(1 + x * x + y * y) / 2); /* half metres */
    }
    image.values[3] = 1e10f; /* Blender's nothing */
    assert_int_equal(
        image_write(arena_printf(arena, "%s/a.exr", folder), &image, 32, false, &error), STATUS_OK);
    const char *text =
        "{\"minimum_m\":[-9,-9,-9],\"maximum_m\":[9,9,9],\"depth\":{\"kind\":\"ray\","
        "\"unit_m\":2},\"views\":[{\"kind\":\"pinhole\",\"color\":\"a.exr\","
        "\"position_m\":[1,2,3],\"direction\":[0,0,-2],\"fov_y_deg\":60}]}";
    assert_int_equal(
        file_write(arena_printf(arena, "%s/cameras.json", folder), text, strlen(text), &error),
        STATUS_OK);
    struct images images;
    if (images_describe(arena, folder, &images, &error) != STATUS_OK ||
        images_load(arena, &images, &error) != STATUS_OK)
        fail_msg("%s", error.text);
    assert_true(isinf(images.views[0].depth_m[0]));
    for (int i = 1; i < SIDE * SIDE; i++) {
        float point[3], normal[3];
        depth_view_point(&images.views[0], i % SIDE, i / SIDE, images.views[0].depth_m[i], point);
        depth_view_normal(&images.views[0], i % SIDE, i / SIDE, normal);
        assert_float_equal(point[2], -1, 1e-5);
        assert_float_equal(point[0], 1 + 4 * (2 * (i % SIDE + 0.5) / SIDE - 1) * half, 1e-5);
        assert_float_equal(normal[2], 1, 1e-5);
    }
    folder_remove(folder);
    arena_destroy(arena);
}

static void test_directions__are_unit_apart_and_balanced(void **state)
{
    (void)state;
    for (size_t count = 1; count <= COLORING_VIEWS_MAX; count++) {
        double sum[3] = {0}, nearest = -1;
        for (size_t i = 0; i < count; i++) {
            float a[3], b[3];
            coloring_direction(count, i, a);
            double length = 0;
            for (int k = 0; k < 3; k++)
                sum[k] += (double)a[k], length += (double)(a[k] * a[k]);
            assert_float_equal(length, 1, 1e-5);
            for (size_t j = 0; j < i; j++) {
                coloring_direction(count, j, b);
                nearest = fmax(nearest, (double)(a[0] * b[0] + a[1] * b[1] + a[2] * b[2]));
            }
        }
        double off = sqrt(sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]) / (double)count;
        assert_true(count < 4 || off < 0.2);
        /* Each has half of the share of the sphere that a hexagonal packing would give it. */
        double share = 2.0 / (double)count;
        assert_true(count < 4 || nearest < 1 - share / 2);
        assert_true(count != 12 || fabs(nearest - 1 / sqrt(5)) < 1e-5); /* icosahedron */
    }
}

int main(void)
{
    setenv("TREELINE_CACHE", "off", 1);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_ball__is_rebuilt_the_better_the_more_views_see_it),
        cmocka_unit_test(test_ball__is_rebuilt_the_better_the_finer_the_grid),
        cmocka_unit_test(test_ball__has_squares_of_its_own_area_on_its_surface),
        cmocka_unit_test(test_cube__has_its_volume_from_six_views),
        cmocka_unit_test(test_cube__has_the_colors_of_its_faces),
        cmocka_unit_test(test_agreement__carves_what_a_view_sees_in_another_color),
        cmocka_unit_test(test_opacity__is_the_share_of_rays_that_end),
        cmocka_unit_test(test_coloring__is_the_same_from_any_number_of_threads),
        cmocka_unit_test(test_images__of_a_plant_give_the_voxels_of_the_plant),
        cmocka_unit_test(test_images__distances_along_rays_become_depths),
        cmocka_unit_test(test_directions__are_unit_apart_and_balanced),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
