/* Shadow volumes: boundaries that close, and the shadow masks of method shadow-volume and of
 * polygons with volumes against rays traced through pixel centres. */
#include "shadow_rig.h"

#include "bake/shadow_caster.h"
#include "base/random.h"

#include <stdio.h>

/* Loose triangles in a box of 5 m above the ground. */
static struct mesh *leaves(struct arena *arena, size_t count)
{
    struct mesh *mesh = mesh_new(arena, MATERIAL_LEAF, 0.5f, count);
    struct random random = random_seed(4, 9);
    while (mesh->triangles_count < count) {
        double corner[3][3];
        float at[3];
        for (int i = 0; i < 3; i++)
            at[i] = 5 * random_float(&random) - (i == 1 ? -1 : 2.5f);
        for (int k = 0; k < 3; k++)
            for (int i = 0; i < 3; i++)
                corner[k][i] = at[i] + 1.4f * random_float(&random) - 0.7f;
        mesh_triangle(mesh, corner[0], corner[1], corner[2]);
    }
    return mesh_finish(arena, mesh);
}

/* A level square, from two triangles, facing up. */
static void add_square(struct mesh *mesh, float half_m, float height_m)
{
    const double a[3] = {-half_m, height_m, -half_m}, b[3] = {-half_m, height_m, half_m};
    const double c[3] = {half_m, height_m, half_m}, d[3] = {half_m, height_m, -half_m};
    mesh_quad(mesh, a, b, c, d);
}

static struct mesh *squares(struct arena *arena, size_t count, float half_m)
{
    struct mesh *mesh = mesh_new(arena, MATERIAL_LEAF, 0.5f, 2 * count);
    for (size_t i = 0; i < count; i++)
        add_square(mesh, half_m, 2 + 0.004f * (float)i);
    return mesh_finish(arena, mesh);
}

/* Needles: closed pieces of leaf that face outward, flat ones over each other. */
static struct mesh *slabs(struct arena *arena, size_t count, float half_m)
{
    struct mesh *mesh = mesh_new(arena, MATERIAL_LEAF, 0.5f, 12 * count);
    mesh->materials->solid = true;
    for (size_t i = 0; i < count; i++) {
        const float low = 2 + 0.004f * (float)i, high = low + 0.002f;
        double corner[2][4][3];
        for (int k = 0; k < 4; k++)
            for (int up = 0; up < 2; up++) {
                corner[up][k][0] = k == 1 || k == 2 ? half_m : -half_m;
                corner[up][k][1] = up ? high : low;
                corner[up][k][2] = k < 2 ? half_m : -half_m;
            }
        mesh_quad(mesh, corner[1][0], corner[1][1], corner[1][2], corner[1][3]);
        mesh_quad(mesh, corner[0][0], corner[0][3], corner[0][2], corner[0][1]);
        for (int k = 0; k < 4; k++) {
            int next = (k + 1) % 4;
            mesh_quad(mesh, corner[0][k], corner[0][next], corner[1][next], corner[1][k]);
        }
    }
    return mesh_finish(arena, mesh);
}

/* Almost all pixels are right, and those that are not are beside the true edge: of the method whose
 * volumes stand at the very triangles that are drawn, and of one whose do a little behind. */
static void assert_exact(struct rig *rig, const char *options)
{
    const char *methods[2] = {"shadow-volume", "polygons"};
    const char *all[2] = {options, "samples=1,error_px=0.1,shadow=volume"};
    for (int m = 0; m < (strcmp(options, "samples=1") ? 1 : 2); m++) {
        int edge, wrong = wrong_pixels(rig, methods[m], all[m], &edge);
        if (wrong || edge > 25)
            fail_msg("%s %s: %d pixels wrong off the edge, %d in all", methods[m], all[m], wrong,
                     edge);
    }
}

static const float front[3] = {3, 6, 13}, middle[3] = {0, 2, 0};

static void test_shadow__a_closed_mesh_casts_what_rays_find(void **unused)
{
    static const float suns[][3] = {
        {0.5f, 0.8f, 0.4f}, {0, 1, 0}, {-0.9f, 0.03f, 0.2f}, {1, 0.6f, -1}};
    static const char *const options[] = {"samples=1", "samples=1,test=z-fail",
                                          "samples=1,test=z-pass", "samples=1,volumes=triangles"};
    struct arena *arena = arena_create(0);
    struct rig *rig = rig_open(ring(arena, 24, 12), arena, flat);
    rig->scene->instances[0] = (struct instance){
        .position_m = {0.3f, 0.2f, -1}, .rotation_rad = 0.7f, .scale = 1.1f, .stretch = 0.8f};
    for (int s = 0; s < 4; s++) {
        rig_look(rig, front, middle, suns[s]);
        assert_exact(rig, options[s]);
        assert_exact(rig, options[0]);
    }
    embree_destroy(rig->embree);
    arena_destroy(arena);
    (void)unused;
}

static void test_shadow__open_leaves_shade_each_other_and_not_themselves(void **unused)
{
    static const float suns[][3] = {{0.5f, 0.8f, 0.4f}, {-0.3f, 0.5f, -0.8f}};
    struct arena *arena = arena_create(0);
    struct rig *rig = rig_open(leaves(arena, 60), arena, flat);
    for (int s = 0; s < 2; s++) {
        rig_look(rig, front, middle, suns[s]);
        assert_exact(rig, "samples=1");
        assert_exact(rig, s ? "samples=1,volumes=triangles" : "samples=1,test=z-fail");
    }
    embree_destroy(rig->embree);
    arena_destroy(arena);
    (void)unused;
}

/* There the places of a drawn leaf and of its cap, computed in two ways, are farther apart than
 * depths are. */
static void
test_shadow__leaves_near_the_eye_and_far_from_the_origin_do_not_shade_themselves(void **unused)
{
    static const float suns[][3] = {{0.5f, 0.8f, 0.4f}, {-0.3f, 0.5f, -0.8f}};
    struct arena *arena = arena_create(0);
    struct mesh *mesh = mesh_new(arena, MATERIAL_LEAF, 0.5f, 8);
    const float foot[3] = {4.1f, 0.2f, 3.1f}, turn = 2.1f, scale = 7.3f;
    for (int i = 0; i < 8; i++) {
        const double x = foot[0] + 0.03 * (i % 3), z = foot[2] + 0.04 * (i / 3);
        const double y = 0.01 + 0.013 * i, a = 0.7 * i;
        mesh_triangle(mesh, (double[3]){x, y, z},
                      (double[3]){x + 0.05 * cos(a), y + 0.02, z + 0.05 * sin(a)},
                      (double[3]){x - 0.05 * sin(a), y + 0.03, z + 0.05 * cos(a)});
    }
    struct rig *rig = rig_open(mesh_finish(arena, mesh), arena, flat);
    rig->scene->instances[0] =
        (struct instance){.rotation_rad = turn, .scale = scale, .stretch = 1};
    rig->scene->camera.near_m = 0.5f;
    const float middle_m[3] = {scale * (foot[0] * cosf(turn) + foot[2] * sinf(turn)), 0.5f,
                               scale * (foot[2] * cosf(turn) - foot[0] * sinf(turn))};
    for (int s = 0; s < 2; s++) {
        rig_look(rig, (float[3]){middle_m[0] + 0.3f, 1, middle_m[2] + 1.3f}, middle_m, suns[s]);
        assert_exact(rig, "samples=1");
    }
    embree_destroy(rig->embree);
    arena_destroy(arena);
    (void)unused;
}

static void test_shadow__hills_shade_each_other(void **unused)
{
    struct arena *arena = arena_create(0);
    struct rig *rig = rig_open(ring(arena, 12, 8), arena, hills);
    rig_look(rig, (float[3]){5, 14, 30}, (float[3]){0, -4, 0}, (float[3]){1, 0.25f, 0.3f});
    assert_exact(rig, "samples=1");
    embree_destroy(rig->embree);
    arena_destroy(arena);
    (void)unused;
}

/* More azimuths and a finer map, fewer wrong pixels; the ring still casts its volume. */
static void test_horizon_map__more_azimuths_have_fewer_errors(void **unused)
{
    struct arena *arena = arena_create(0);
    struct rig *rig = rig_open(ring(arena, 12, 8), arena, hills);
    int wrong[4];
    rig->scene->instances[0].position_m[1] = 2;
    rig_look(rig, (float[3]){5, 14, 30}, (float[3]){0, -4, 0}, (float[3]){1, 0.25f, 0.3f});
    wrong_pixels(rig, "horizon-map", "samples=1,azimuths=4", &wrong[0]);
    wrong_pixels(rig, "horizon-map", "samples=1,azimuths=4,lookup=nearest", &wrong[1]);
    wrong_pixels(rig, "horizon-map", "samples=1,azimuths=64,detail=1", &wrong[2]);
    wrong_pixels(rig, "horizon-map", "samples=1,azimuths=64", &wrong[3]);
    printf("# wrong of %d pixels: 4 azimuths %d, nearest %d, 64 azimuths %d, finer %d\n",
           WIDTH * HEIGHT, wrong[0], wrong[1], wrong[2], wrong[3]);
    assert_true(wrong[2] < WIDTH * HEIGHT / 25);
    assert_true(wrong[2] < wrong[0] / 2 && wrong[2] < wrong[1] / 2 && wrong[3] < wrong[2] / 2);
    embree_destroy(rig->embree);
    arena_destroy(arena);
    (void)unused;
}

static void test_shadow__an_eye_within_a_shadow_wants_z_fail(void **unused)
{
    int edge;
    struct arena *arena = arena_create(0);
    struct rig *rig = rig_open(squares(arena, 1, 6), arena, flat);
    rig_look(rig, (float[3]){1, 1.2f, 3}, (float[3]){-6, 0, -30}, (float[3]){0.2f, 1, 0.1f});
    assert_exact(rig, "samples=1,test=z-fail");
    assert_exact(rig, "samples=1");
    wrong_pixels(rig, "shadow-volume", "samples=1,test=z-pass", &edge);
    assert_true(edge > WIDTH * HEIGHT / 4);
    embree_destroy(rig->embree);
    arena_destroy(arena);
    (void)unused;
}

static void
test_shadow__an_eye_toward_the_sun_and_planes_a_million_apart_are_no_matter(void **unused)
{
    struct arena *arena = arena_create(0);
    struct rig *rig = rig_open(ring(arena, 24, 12), arena, flat);
    rig_look(rig, front, middle, (float[3]){-0.3f, 0.15f, -1}); /* in the picture */
    assert_exact(rig, "samples=1");
    rig->scene->camera.near_m = 1e-3f;
    rig->scene->camera.far_m = 1e3f;
    rig_look(rig, front, middle, (float[3]){-0.6f, 0.5f, 1});
    assert_exact(rig, "samples=1,test=z-fail");
    embree_destroy(rig->embree);
    arena_destroy(arena);
    (void)unused;
}

/* Whether the ground below a plant under a sun at the zenith is lit. */
static bool is_lit_below(struct arena *arena, struct mesh *plant)
{
    struct rig *rig = rig_open(plant, arena, flat);
    struct setting setting = {.method = "shadow-volume",
                              .options = "samples=1,test=z-fail",
                              .backend = "osmesa",
                              .effects = EFFECT_SUN_SHADOWS,
                              .format = TARGET_RGBA32F};
    view_look_at(rig->scene, (float[3]){0, 1.5f, 0}, (float[3]){0, 0, 0.1f}, &rig->view);
    struct picture picture = picture_draw(arena, rig->scene, &rig->view, &setting);
    embree_destroy(rig->embree);
    return picture.rgba[4 * (HEIGHT / 2 * WIDTH + WIDTH / 2)] > 0;
}

/* Eight bits wrap, seven bits too; what casts is counted in two halves. A needle has two sides and
 * is one volume. */
static void test_shadow__no_number_of_volumes_is_taken_for_light(void **unused)
{
    static const size_t stacks[] = {1, 127, 128, 129, 255, 256, 257, 384, 512},
                        needles[] = {1, 64, 128, 256};
    struct arena *arena = arena_create(0);
    for (size_t s = 0; s < sizeof stacks / sizeof *stacks; s++)
        if (is_lit_below(arena, squares(arena, stacks[s], 6)))
            fail_msg("%zu volumes: lit", stacks[s]);
    for (size_t s = 0; s < sizeof needles / sizeof *needles; s++)
        if (is_lit_below(arena, slabs(arena, needles[s], 6)))
            fail_msg("%zu needles: lit", needles[s]);
    arena_destroy(arena);
    (void)unused;
}

/* Each edge is run through as often one way as the other; all ends, from points on, are one point
 * at infinity. */
static void assert_closed(const struct shadow_boundary *boundary, size_t points)
{
    size_t side = points + 1;
    int *balance = calloc(side * side, sizeof *balance);
    const uint32_t *lists[3] = {boundary->walls, boundary->caps, boundary->leaf_caps};
    size_t counts[3] = {boundary->walls_count, boundary->caps_count, boundary->leaf_caps_count};
    assert_non_null(balance);
    for (int l = 0; l < 3; l++)
        for (size_t i = 0; i < counts[l]; i++) {
            uint32_t from = lists[l][i], to = lists[l][i % 3 == 2 ? i - 2 : i + 1];
            from = from < points ? from : (uint32_t)points;
            to = to < points ? to : (uint32_t)points;
            balance[from * side + to]++;
            balance[to * side + from]--;
        }
    for (size_t i = 0; i < side * side; i++)
        assert_int_equal(balance[i], 0);
    free(balance);
}

/* Adds a half. */
static void extrude(const struct shadow_caster *caster, const float sun[3], bool silhouette,
                    int half, struct shadow_boundary *boundary)
{
    struct shadow_extrusion extrusion = {
        .silhouette = silhouette, .half = half, .ends = (uint32_t)caster->points_count};
    memcpy(extrusion.toward, sun, sizeof extrusion.toward);
    shadow_caster_extrude(caster, &extrusion, boundary);
}

static void test_caster__boundaries_are_closed_whatever_the_mesh_and_the_sun(void **unused)
{
    struct arena *arena = arena_create(0);
    struct random random = random_seed(1, 1);
    struct mesh *meshes[4] = {ring(arena, 12, 8), leaves(arena, 60), squares(arena, 1, 1),
                              slabs(arena, 2, 1)};
    for (int m = 0; m < 4; m++)
        for (int s = 0; s < 20; s++) {
            struct shadow_caster caster;
            float sun[3] = {random_float(&random) - 0.5f, random_float(&random) - 0.5f,
                            s ? random_float(&random) - 0.5f : 0};
            shadow_caster_build(arena, meshes[m], false, &caster);
            size_t room = shadow_caster_room(&caster);
            struct shadow_boundary boundary = {.walls = ARENA_ARRAY(arena, uint32_t, room),
                                               .caps = ARENA_ARRAY(arena, uint32_t, room / 6),
                                               .leaf_caps = ARENA_ARRAY(arena, uint32_t, room / 6)};
            assert_int_equal(caster.kinds[0], m % 3 ? SHADOW_LEAF : SHADOW_SOLID);
            uint32_t points = (uint32_t)caster.points_count;
            for (int half = 0; half < 2; half++) { /* each of its own */
                extrude(&caster, sun, s % 4 != 3, half, &boundary);
                assert_closed(&boundary, points);
            }
            assert_true(boundary.walls_count > 0);
        }
    arena_destroy(arena);
    (void)unused;
}

/* A cube seen from a corner is a hexagon, from a side a square. */
static void test_caster__the_silhouette_of_a_cube_has_six_or_four_edges(void **unused)
{
    struct arena *arena = arena_create(0);
    struct mesh *cube = mesh_new(arena, MATERIAL_BARK, 0.5f, 12);
    for (int side = 0; side < 6; side++) {
        double corner[4][3];
        int a = side / 2, b = (a + 1) % 3, c = (a + 2) % 3;
        for (int k = 0; k < 4; k++) {
            bool first = k == 1 || k == 2, second = k >= 2;
            corner[k][a] = side & 1;
            corner[k][b] = side & 1 ? first : second;
            corner[k][c] = side & 1 ? second : first;
        }
        mesh_quad(cube, corner[0], corner[1], corner[2], corner[3]);
    }
    mesh_finish(arena, cube);
    struct shadow_caster caster;
    shadow_caster_build(arena, cube, false, &caster);
    assert_int_equal(caster.points_count, 8);
    assert_int_equal(caster.edges_count, 18);
    assert_int_equal(caster.kinds[0], SHADOW_SOLID);
    uint32_t walls[216], caps[36], leaf_caps[1];
    struct shadow_boundary boundary = {walls, caps, leaf_caps, 0, 0, 0};
    for (int half = 0; half < 2; half++)
        extrude(&caster, (float[3]){1, 0.9f, 0.8f}, true, half, &boundary);
    assert_int_equal(boundary.walls_count, 6 * 6);
    assert_int_equal(boundary.caps_count, 3 * 6);
    boundary = (struct shadow_boundary){walls, caps, leaf_caps, 0, 0, 0};
    for (int half = 0; half < 2; half++)
        extrude(&caster, (float[3]){0, 1, 0}, true, half, &boundary);
    assert_int_equal(boundary.walls_count, 6 * 4);
    boundary = (struct shadow_boundary){walls, caps, leaf_caps, 0, 0, 0};
    for (int half = 0; half < 2; half++)
        extrude(&caster, (float[3]){0, 1, 0}, false, half, &boundary);
    assert_int_equal(boundary.walls_count, 6 * 36);
    arena_destroy(arena);
    (void)unused;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_shadow__a_closed_mesh_casts_what_rays_find),
        cmocka_unit_test(test_shadow__open_leaves_shade_each_other_and_not_themselves),
        cmocka_unit_test(
            test_shadow__leaves_near_the_eye_and_far_from_the_origin_do_not_shade_themselves),
        cmocka_unit_test(test_shadow__hills_shade_each_other),
        cmocka_unit_test(test_horizon_map__more_azimuths_have_fewer_errors),
        cmocka_unit_test(test_shadow__an_eye_within_a_shadow_wants_z_fail),
        cmocka_unit_test(
            test_shadow__an_eye_toward_the_sun_and_planes_a_million_apart_are_no_matter),
        cmocka_unit_test(test_shadow__no_number_of_volumes_is_taken_for_light),
        cmocka_unit_test(test_caster__boundaries_are_closed_whatever_the_mesh_and_the_sun),
        cmocka_unit_test(test_caster__the_silhouette_of_a_cube_has_six_or_four_edges),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
