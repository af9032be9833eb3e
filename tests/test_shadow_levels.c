/* A shadow map on ground that is drawn by levels of detail, against rays at the full surface. */
#include "shadow_rig.h"

#include "testing.h"

#include <stdio.h>

/* Bent enough for shadows of its own under a low sun, and little enough for coarse levels. */
static float soft(float x, float z)
{
    return 1.5f * cosf(9 * x) * cosf(7 * z) - 4;
}

static struct rig *rig_of(struct arena *arena, float detail_px)
{
    struct rig *rig = rig_open(ring(arena, 12, 8), arena, soft);
    rig->scene->terrain.detail_px = detail_px;
    rig_look(rig, (float[3]){5, 30, 100}, (float[3]){0, -4, 0}, (float[3]){1, 0.2f, 0.3f});
    return rig;
}

/* Level, and 10 m higher along one side. */
static float walled(float x, float z)
{
    return z > 0.81f ? 8 : 0 * x - 2;
}

/* Off the edges nothing is wrong that every triangle would have right: what casts is what is drawn,
 * and does not shade itself. */
static void test_shadow_levels__shadows_are_as_right_as_on_every_triangle(void **unused)
{
    static const char *const options[] = {"samples=1,size=1024", "samples=16,size=1024"};
    for (int o = 0; o < 2; o++) {
        int off[2], edge[2];
        for (int d = 0; d < 2; d++) {
            struct arena *arena = arena_create(0);
            struct rig *rig = rig_of(arena, (float)d);
            off[d] = wrong_pixels(rig, "shadow-map", options[o], &edge[d]);
            embree_destroy(rig->embree);
            arena_destroy(arena);
        }
        printf("# %s, wrong of %d pixels off the edges and in all: every triangle %d %d, moved by "
               "a pixel %d %d\n",
               options[o], WIDTH * HEIGHT, off[0], edge[0], off[1], edge[1]);
        assert_true(off[1] <= off[0] + 40);
    }
    (void)unused;
}

/* The wall is behind the eye, the sun behind the wall. */
static void test_shadow_levels__what_is_out_of_the_picture_casts_too(void **unused)
{
    int off[2], edge[2];
    for (int d = 0; d < 2; d++) {
        struct arena *arena = arena_create(0);
        struct rig *rig = rig_open(ring(arena, 12, 8), arena, walled);
        rig->scene->terrain.detail_px = (float)d;
        rig_look(rig, (float[3]){0, 5, -8}, (float[3]){0, -2, -20}, (float[3]){0.1f, 0.2f, 1});
        off[d] = wrong_pixels(rig, "shadow-map", "samples=1,size=1024", &edge[d]);
        embree_destroy(rig->embree);
        arena_destroy(arena);
    }
    printf("# behind a wall, wrong off the edges and in all: every triangle %d %d, moved %d %d\n",
           off[0], edge[0], off[1], edge[1]);
    assert_true(off[1] <= off[0] + 10);
    (void)unused;
}

static void test_shadow_levels__fewer_triangles_are_drawn(void **unused)
{
    struct arena *arena = arena_create(0);
    uint64_t triangles[2];
    for (int d = 0; d < 2; d++) {
        struct rig *rig = rig_of(arena, (float)d);
        struct setting setting = {.method = "shadow-map",
                                  .options = "samples=1,size=256",
                                  .backend = "osmesa",
                                  .effects = EFFECT_SUN_SHADOWS,
                                  .format = TARGET_RGBA32F};
        triangles[d] = picture_draw(arena, rig->scene, &rig->view, &setting).triangles;
        embree_destroy(rig->embree);
    }
    printf("# triangles: all %d, moved by a pixel %d\n", (int)triangles[0], (int)triangles[1]);
    assert_true(2 * triangles[1] < triangles[0]);
    arena_destroy(arena);
    (void)unused;
}

/* The same picture whether or not the eye was elsewhere before: a map goes with the levels. */
static void test_shadow_levels__a_map_follows_the_levels_of_the_view(void **unused)
{
    struct arena *arena = arena_create(0);
    struct rig *rig = rig_of(arena, 1);
    struct view before = rig->view; /* the same map, from elsewhere: other levels */
    struct setting setting = {.method = "shadow-map",
                              .options = "samples=1,size=1024",
                              .backend = "osmesa",
                              .effects = EFFECT_SUN_SHADOWS,
                              .format = TARGET_RGBA32F,
                              .masked = true};
    struct picture at_once = picture_draw(arena, rig->scene, &rig->view, &setting);
    view_look_at(rig->scene, (float[3]){-35, 60, -60}, (float[3]){0, -5, 0}, &before);
    memcpy(before.sun_direction, rig->view.sun_direction, sizeof before.sun_direction);
    setting.before = &before;
    struct picture later = picture_draw(arena, rig->scene, &rig->view, &setting);
    assert_memory_equal(at_once.rgba, later.rgba, 4 * WIDTH * HEIGHT * sizeof(float));
    embree_destroy(rig->embree);
    arena_destroy(arena);
    (void)unused;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_shadow_levels__shadows_are_as_right_as_on_every_triangle),
        cmocka_unit_test(test_shadow_levels__what_is_out_of_the_picture_casts_too),
        cmocka_unit_test(test_shadow_levels__fewer_triangles_are_drawn),
        cmocka_unit_test(test_shadow_levels__a_map_follows_the_levels_of_the_view),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
