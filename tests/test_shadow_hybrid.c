/* Shadow volumes near by and a shadow map beyond: method shadow-hybrid against rays, and against
 * the two methods that it is made of, pixel by pixel. */
#include "shadow_rig.h"

#include "testing.h"

#include "bake/backdrop.h"
#include "bake/shadow_volume.h"

enum { PIXELS = WIDTH * HEIGHT };

/* The sun's visibility in each pixel. */
static void draw(struct rig *rig, const char *method, const char *options, float mask[PIXELS])
{
    struct setting setting = {.method = method,
                              .options = options,
                              .backend = "osmesa",
                              .effects = EFFECT_SUN_SHADOWS | EFFECT_TWO_SIDED,
                              .format = TARGET_RGBA32F,
                              .masked = true};
    struct picture picture = picture_draw(rig->arena, rig->scene, &rig->view, &setting);
    for (size_t i = 0; i < PIXELS; i++) {
        mask[i] = picture.rgba[4 * i];
        assert_true(isfinite(mask[i]));
    }
}

/* Depths along the view; INFINITY in the sky. */
static void find_depths(struct rig *rig, float depths_m[PIXELS])
{
    for (int i = 0; i < PIXELS; i++) {
        struct embree_packet packet = {0};
        float direction[3], along = 0;
        view_ray(&rig->view, (float)(i % WIDTH) + 0.5f, (float)(i / WIDTH) + 0.5f, direction);
        for (int axis = 0; axis < 3; axis++) {
            packet.origin[axis][0] = rig->view.eye_m[axis];
            packet.direction[axis][0] = direction[axis];
            along += direction[axis] * rig->view.forward[axis];
        }
        packet.far[0] = INFINITY;
        embree_intersect(rig->embree, &packet, 1, false);
        depths_m[i] = packet.geometry[0] == EMBREE_NONE ? INFINITY : along * packet.far[0];
    }
}

/* Pixels from a depth to another whose sun is not what rays find. */
static int wrong_between(struct rig *rig, const float mask[PIXELS], const float depths_m[PIXELS],
                         float from_m, float to_m)
{
    int wrong = 0;
    for (int i = 0; i < PIXELS; i++) {
        float direction[3];
        view_ray(&rig->view, (float)(i % WIDTH) + 0.5f, (float)(i / WIDTH) + 0.5f, direction);
        int truth = sun_at(rig, direction);
        if (truth >= 0 && depths_m[i] >= from_m && depths_m[i] < to_m)
            wrong += (mask[i] > 0.5f) != truth;
    }
    return wrong;
}

/* A ring whose shadow comes toward the eye; hills shade each other. */
static struct rig *rig_of(struct arena *arena, bool bent)
{
    struct rig *rig = rig_open(ring(arena, 24, 12), arena, bent ? hills : flat);
    rig_look(rig, (float[3]){3, 7, 14}, (float[3]){0, 0, 0},
             bent ? (float[3]){-0.3f, 0.35f, -1} : (float[3]){-0.2f, 0.5f, -1});
    return rig;
}

#define COARSE "size=256,casters=exact"

static void test_shadow_hybrid__is_as_wrong_as_volumes_near_by_and_as_a_map_beyond(void **unused)
{
    for (int bent = 0; bent < 2; bent++) {
        struct arena *arena = arena_create(0);
        struct rig *rig = rig_of(arena, bent);
        const float near_m = 14;
        static float mixed[PIXELS], volumes[PIXELS], map[PIXELS], depths_m[PIXELS];
        find_depths(rig, depths_m);
        draw(rig, "shadow-hybrid", "samples=1,near_m=14,blend=0," COARSE, mixed);
        draw(rig, "shadow-volume", "samples=1", volumes);
        draw(rig, "shadow-map", "samples=1," COARSE, map);
        int near = wrong_between(rig, mixed, depths_m, 0, near_m);
        int far = wrong_between(rig, mixed, depths_m, near_m, INFINITY);
        int near_volumes = wrong_between(rig, volumes, depths_m, 0, near_m);
        int far_map = wrong_between(rig, map, depths_m, near_m, INFINITY);
        int near_map = wrong_between(rig, map, depths_m, 0, near_m);
        int far_volumes = wrong_between(rig, volumes, depths_m, near_m, INFINITY);
        printf("# wrong pixels nearer and farther: hybrid %d %d, volumes %d %d, map %d %d\n", near,
               far, near_volumes, far_volumes, near_map, far_map);
        /* a pixel at the very depth may go either way */
        assert_true(abs(near - near_volumes) <= 2 && abs(far - far_map) <= 2);
        assert_true((bent || near_map > near_volumes + 5) && far_map > far_volumes + 2);
        embree_destroy(rig->embree);
        arena_destroy(arena);
    }
    (void)unused;
}

/* Between the two depths a pixel is their mean by its depth: no seam at either. */
static void test_shadow_hybrid__goes_over_from_volumes_to_the_map_by_depth(void **unused)
{
    struct arena *arena = arena_create(0);
    struct rig *rig = rig_of(arena, true);
    static float mixed[PIXELS], volumes[PIXELS], map[PIXELS], depths_m[PIXELS];
    const float from_m = 8, to_m = 16;
    int between = 0, differ = 0;
    find_depths(rig, depths_m);
    draw(rig, "shadow-hybrid", "samples=1,near_m=16,blend=0.5," COARSE, mixed);
    draw(rig, "shadow-volume", "samples=1", volumes);
    draw(rig, "shadow-hybrid", "samples=1,near_m=0.01," COARSE, map);
    for (int i = 0; i < PIXELS; i++) {
        float share = fminf(1, fmaxf(0, (depths_m[i] - from_m) / (to_m - from_m)));
        float wanted = volumes[i] + share * (map[i] - volumes[i]);
        between += share > 0 && share < 1;
        differ += share > 0 && share < 1 && fabsf(map[i] - volumes[i]) > 0.1f;
        if (isfinite(depths_m[i]) && fabsf(mixed[i] - wanted) > 2e-3f)
            fail_msg("pixel %d at %g m: %g, not %g of %g and %g", i, (double)depths_m[i],
                     (double)mixed[i], (double)wanted, (double)volumes[i], (double)map[i]);
    }
    assert_true(between > PIXELS / 10 && differ > 10);
    embree_destroy(rig->embree);
    arena_destroy(arena);
    (void)unused;
}

/* near_m=0, texels as large as any pixel may be: all is the map's; as none may be: all is the
 * volumes'. */
static void test_shadow_hybrid__begins_where_a_texel_is_as_small_as_is_asked_for(void **unused)
{
    struct arena *arena = arena_create(0);
    struct rig *rig = rig_of(arena, false);
    static float by_itself[PIXELS], volumes[PIXELS], map[PIXELS];
    draw(rig, "shadow-volume", "samples=1", volumes);
    draw(rig, "shadow-hybrid", "samples=1,near_m=0.01," COARSE, map);
    draw(rig, "shadow-hybrid", "samples=1,texel_px=1000," COARSE, by_itself);
    assert_memory_equal(by_itself, map, sizeof map);
    draw(rig, "shadow-hybrid", "samples=1,texel_px=0.01," COARSE, by_itself);
    assert_memory_equal(by_itself, volumes, sizeof volumes);
    embree_destroy(rig->embree);
    arena_destroy(arena);
    (void)unused;
}

/* A moving eye and a sun that stands: volumes of casters that were too far are made when they come
 * near. */
static void test_shadow_hybrid__casters_that_come_near_get_volumes(void **unused)
{
    struct arena *arena = arena_create(0);
    struct rig *rig = rig_of(arena, false);
    struct view away;
    struct setting setting = {.method = "shadow-hybrid",
                              .options = "samples=1,near_m=14,blend=0," COARSE,
                              .backend = "osmesa",
                              .effects = EFFECT_SUN_SHADOWS | EFFECT_TWO_SIDED,
                              .format = TARGET_RGBA32F,
                              .masked = true};
    struct picture at_once = picture_draw(arena, rig->scene, &rig->view, &setting);
    view_look_at(rig->scene, (float[3]){36, 3, 36}, (float[3]){36, 0, 80}, &away);
    memcpy(away.sun_direction, rig->view.sun_direction, sizeof away.sun_direction);
    setting.before = &away;
    struct picture later = picture_draw(arena, rig->scene, &rig->view, &setting);
    assert_memory_equal(at_once.rgba, later.rgba, 4 * PIXELS * sizeof(float));
    embree_destroy(rig->embree);
    arena_destroy(arena);
    (void)unused;
}

/* The ground in the sun where volumes that are counted to a depth let it, into a target that was
 * black. */
static void draw_lit_ground(struct rig *rig, float deep_m, float *rgba)
{
    struct error error;
    struct workspace workspace = {.arena = rig->arena, .error = &error, .threads = 2};
    const struct shadow_volume_request request = {.test = SHADOW_AUTO};
    struct target target, twin;
    struct backdrop *backdrop = NULL;
    struct shadow_volume *volume = NULL;
    struct view lit = rig->view, dark;
    shadow_volume_view(&lit);
    dark = lit;
    memset(dark.sun_direction, 0, sizeof dark.sun_direction);
    if (gl_context_create("osmesa", 2, &workspace.gl, &error) != STATUS_OK ||
        gl_target(workspace.gl, WIDTH, HEIGHT, TARGET_RGBA32F, &target, &error) != STATUS_OK ||
        gl_target_stencil(workspace.gl, &target, 1, &twin, &error) != STATUS_OK ||
        backdrop_prepare(&workspace, rig->scene, &backdrop) != STATUS_OK ||
        shadow_volume_prepare(&workspace, rig->scene, &request, &volume) != STATUS_OK)
        fail_msg("%s", error.text);
    workspace.gl->BindFramebuffer(GL_FRAMEBUFFER, twin.framebuffer);
    backdrop_draw(&workspace, backdrop, &dark);
    shadow_volume_extrude(&workspace, volume, &lit, deep_m);
    shadow_volume_count(&workspace, volume, &lit, deep_m);
    backdrop_draw(&workspace, backdrop, &lit);
    shadow_volume_end(&workspace);
    gl_target_read(workspace.gl, &twin, rgba);
    gl_context_destroy(workspace.gl);
}

/* What is beyond is the map's and need not be drawn again: there the count is not 0. */
static void test_shadow_hybrid__nothing_beyond_the_volumes_depth_is_lit_by_them(void **unused)
{
    struct arena *arena = arena_create(0);
    struct rig *rig = rig_of(arena, false);
    static float all[4 * PIXELS], near[4 * PIXELS];
    const float deep_m = 14;
    int lit = 0, beyond = 0;
    draw_lit_ground(rig, INFINITY, all);
    draw_lit_ground(rig, deep_m, near);
    for (int i = 0; i < PIXELS; i++) {
        float direction[3], along = 0;
        view_ray(&rig->view, (float)(i % WIDTH) + 0.5f, (float)(i / WIDTH) + 0.5f, direction);
        for (int axis = 0; axis < 3; axis++)
            along += direction[axis] * rig->view.forward[axis];
        float depth_m = -rig->view.eye_m[1] / direction[1] * along; /* of the ground, y = 0 */
        if (direction[1] > -0.01f || fabsf(depth_m - deep_m) < 0.01f)
            continue;
        lit += depth_m < deep_m && all[4 * i] > 0;
        beyond += depth_m > deep_m && all[4 * i] > 0;
        if (near[4 * i] != (depth_m < deep_m ? all[4 * i] : 0))
            fail_msg("pixel %d at %g m: %g, all volumes: %g", i, (double)depth_m,
                     (double)near[4 * i], (double)all[4 * i]);
    }
    assert_true(lit > PIXELS / 10 && beyond > PIXELS / 10);
    embree_destroy(rig->embree);
    arena_destroy(arena);
    (void)unused;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_shadow_hybrid__is_as_wrong_as_volumes_near_by_and_as_a_map_beyond),
        cmocka_unit_test(test_shadow_hybrid__goes_over_from_volumes_to_the_map_by_depth),
        cmocka_unit_test(test_shadow_hybrid__begins_where_a_texel_is_as_small_as_is_asked_for),
        cmocka_unit_test(test_shadow_hybrid__casters_that_come_near_get_volumes),
        cmocka_unit_test(test_shadow_hybrid__nothing_beyond_the_volumes_depth_is_lit_by_them),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
