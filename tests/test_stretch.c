/* Trees that are higher or lower than their plants: balls become ellipsoids, whose normals and
 * light are known in closed form. */
#include "level_ground.h"
#include "pictures.h"
#include "shadow_world.h"
#include "slices_meshes.h"

enum { SIDE_PX = 64 };
static const float albedo = 0.5f, radius_m = 3, turn_rad = 0.7f;
static const float middle_m[3] = {1, 4, -2};

/* What a tree's normals may be: M^-T n; wrongly, stretched as vertices are, M n, or left as the
 * plant's. */
enum normals { NORMALS_RIGHT, NORMALS_AS_VERTICES, NORMALS_OF_PLANT, NORMALS_COUNT };

/* A ball of bark, stretched, under a sun alone. */
static struct scene *ball_scene(struct arena *arena, float stretch)
{
    struct scene *scene = tree_scene(arena, shape_ball(arena), 1, 0.9f);
    struct instance *tree = &scene->instances[0];
    memcpy(tree->position_m, middle_m, sizeof middle_m);
    tree->rotation_rad = turn_rad;
    tree->scale = radius_m;
    tree->stretch = stretch;
    scene->tree_reach_m = 8;
    scene->effects = 0;
    for (int i = 0; i < 3; i++)
        scene->sun.radiance[i] = 1;
    return scene;
}

static struct view ball_view(const struct scene *scene, float elevation_rad)
{
    const float away_m = 40;
    struct scene zoomed = *scene;
    struct view view;
    float reach_m = radius_m * fmaxf(1, scene->instances[0].stretch);
    zoomed.width_px = zoomed.height_px = SIDE_PX;
    zoomed.camera.fov_y_rad = 2 * atanf(1.1f * reach_m / away_m);
    float eye_m[3] = {middle_m[0] + away_m * cosf(elevation_rad) * 0.6f,
                      middle_m[1] + away_m * sinf(elevation_rad),
                      middle_m[2] + away_m * cosf(elevation_rad) * 0.8f};
    view_look_at(&zoomed, eye_m, middle_m, &view);
    return view;
}

static double unit(double v[3])
{
    double length = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    for (int i = 0; i < 3; i++)
        v[i] /= length;
    return length;
}

/* Cosines between the sun and what each kind of normal is where a pixel's ray meets the ellipsoid;
 * false beside it and near its rim. A turned ball is the same ball: its axes are the world's. */
static bool ellipsoid_light(const struct view *view, int x, int y, float stretch,
                            double light[NORMALS_COUNT])
{
    const double factors[NORMALS_COUNT] = {1 / (double)stretch, (double)stretch, 1};
    float ray[3];
    double o[3], d[3], a = 0, b = 0, c = -1, facing = 0;
    view_ray(view, (float)x + 0.5f, (float)y + 0.5f, ray);
    for (int i = 0; i < 3; i++) {
        double size_m = i == 1 ? radius_m * stretch : radius_m;
        o[i] = (view->eye_m[i] - middle_m[i]) / size_m;
        d[i] = ray[i] / size_m;
        a += d[i] * d[i];
        b += o[i] * d[i];
        c += o[i] * o[i];
    }
    if (b * b - a * c <= 0)
        return false;
    double at = (-b - sqrt(b * b - a * c)) / a;
    for (int k = 0; k < NORMALS_COUNT; k++) {
        double n[3] = {o[0] + at * d[0], (o[1] + at * d[1]) * factors[k], o[2] + at * d[2]};
        unit(n);
        light[k] = 0;
        for (int i = 0; i < 3; i++) {
            light[k] += n[i] * view->sun_direction[i];
            facing -= k == NORMALS_RIGHT ? n[i] * ray[i] : 0;
        }
        light[k] = fmax(0, light[k]);
    }
    return facing > 0.4;
}

/* What a picture differs from the ellipsoid by, root mean square, and how far it lies on the way
 * from it to an ellipsoid with each kind of wrong normals, by least squares: 0 not at all, 1 there.
 */
static void claim_ellipsoid(const char *what, const struct view *view, float stretch,
                            const float *rgba, double most)
{
    double square = 0, count = 0, along[NORMALS_COUNT] = {0}, apart[NORMALS_COUNT] = {0};
    for (int y = 0; y < SIDE_PX; y++)
        for (int x = 0; x < SIDE_PX; x++) {
            double light[NORMALS_COUNT];
            if (!ellipsoid_light(view, x, y, stretch, light))
                continue;
            double off = rgba[4 * (y * SIDE_PX + x)] - albedo * light[NORMALS_RIGHT];
            count++;
            square += off * off;
            for (int k = 1; k < NORMALS_COUNT; k++) {
                double wrong = albedo * (light[k] - light[NORMALS_RIGHT]);
                along[k] += off * wrong;
                apart[k] += wrong * wrong;
            }
        }
    assert_true(count > 400);
    double error = sqrt(square / count);
    if (!(error <= most))
        fail_msg("%s, stretch %g: differs by %.4f; allowed: %g", what, (double)stretch, error,
                 most);
    for (int k = 1; k < NORMALS_COUNT; k++)
        if (!(fabs(along[k] / apart[k]) < 0.25))
            fail_msg("%s, stretch %g: %.2f of the way to wrong normals %d", what, (double)stretch,
                     along[k] / apart[k], k);
}

static const float stretches[] = {2, 0.5f};
static const float elevations_rad[] = {0.1f, 0.7f};

static void test_reference__a_stretched_ball_is_lit_as_its_ellipsoid(void **state)
{
    (void)state;
    for (int k = 0; k < 2; k++) {
        struct arena *arena = arena_create(0);
        struct scene *scene = ball_scene(arena, stretches[k]);
        struct view view = ball_view(scene, elevations_rad[k]);
        struct frame *frame = tree_reference(arena, scene, 0, &view);
        claim_ellipsoid("reference", &view, stretches[k], frame->rgba, 0.01);
        arena_destroy(arena);
    }
}

/* How a method draws it, and what its own kind of picture differs from the closed form by. */
static const struct {
    const char *method, *options;
    double most;
} drawn[] = {
    {"polygons", "sift=1", 0.01},
    {"polygons", "sift=0", 0.01},
    {"shaded-texels", "slices=64,samples=2,criterion=0", 0.05},
    {"texels", "slices=64,samples=2,criterion=none,turns=9", 0.05},
    {"ray-texels", "resolution=64", 0.06},
    {"ray-texels-gl", "resolution=64,step=0.5", 0.06},
    {"billboards", "layout=hemisphere,views=256,alpha=blend,resolution=128,near=0", 0.08},
};

static void test_methods__a_stretched_ball_is_lit_as_its_ellipsoid(void **state)
{
    (void)state;
    for (size_t m = 0; m < sizeof drawn / sizeof drawn[0]; m++)
        for (int k = 0; k < 2; k++) {
            struct arena *arena = arena_create(0);
            struct scene *scene = ball_scene(arena, stretches[k]);
            struct view view = ball_view(scene, elevations_rad[k]);
            struct setting setting = {.method = drawn[m].method,
                                      .options = drawn[m].options,
                                      .lod = LOD_HIGH,
                                      .format = TARGET_RGBA32F};
            struct picture picture = picture_draw(arena, scene, &view, &setting);
            claim_ellipsoid(drawn[m].method, &view, stretches[k], picture.rgba, drawn[m].most);
            arena_destroy(arena);
        }
}

/* Pictures are of plants in steps of a quarter of an octave; trees are between them. */
static void test_billboards__a_stretched_tree_covers_the_references_pixels(void **state)
{
    (void)state;
    static const float between[] = {1.09f, 2.18f, 0.46f};
    static const char options[] = "layout=hemisphere,views=400,alpha=blend,resolution=128,near=0";
    for (int k = 0; k < 3; k++) {
        struct arena *arena = arena_create(0);
        struct plant *plant = plant_from_mesh(arena, "lopsided", tree_mesh(arena, 400));
        struct scene *scene = tree_scene(arena, plant, 1, 1);
        scene->instances[0].stretch = between[k];
        scene->instances[0].position_m[1] = 3.5f * (1 - between[k]); /* its middle stays */
        struct view view = tree_view(scene, 0.4f, 0.3f, 300, 9 * fmaxf(1, between[k]));
        struct frame *truth = tree_reference(arena, scene, EFFECT_TWO_SIDED, &view);
        struct frame *shown = tree_draw(arena, tree_method("billboards"), options, scene,
                                        EFFECT_TWO_SIDED, &view, NULL);
        double covered = tree_mean(truth, 3), ratio = tree_mean(shown, 3) / covered;
        double off = tree_difference(shown, truth, false) / covered;
        if (!(fabs(ratio - 1) < 0.03 && off < 0.33))
            fail_msg("stretch %g: %.3f of the coverage, off by %.3f", (double)between[k], ratio,
                     off);
        arena_destroy(arena);
    }
}

/* The picture is the one that is nearest to where the eye is for the plant. Of 4 x 4 pictures of
 * the hemisphere, seen along +z, the next is nearer from tan(elevation) = 1/2 on, for a tree that
 * is r times as high as what it has pictures of from r/2 on; a turn within one picture changes
 * little. */
static void test_billboards__a_stretched_tree_shows_its_picture_from_where_the_eye_is(void **state)
{
    (void)state;
    static const float between[] = {1.08f, 0.925f}; /* of the step that has pictures of the plant */
    static const char options[] = "layout=hemisphere,views=16,alpha=blend,resolution=64,near=0";
    for (int k = 0; k < 2; k++) {
        struct arena *arena = arena_create(0);
        struct plant *plant = plant_from_mesh(arena, "lopsided", tree_mesh(arena, 400));
        struct scene *scene = tree_scene(arena, plant, 1, 1);
        struct studio studio;
        double changes[2];
        scene->instances[0].stretch = between[k];
        scene->instances[0].position_m[1] = 3.5f * (1 - between[k]);
        studio_open(&studio, arena, tree_method("billboards"), options, LOD_HIGH, scene, 0);
        for (int own = 0; own < 2; own++) {
            struct frame *frames[2];
            for (int i = 0; i < 2; i++) {
                float rise = 0.5f * (own ? between[k] : 1) * (i ? 1.02f : 0.98f);
                struct view view = tree_view(scene, 0, atanf(rise), 300, 9);
                frames[i] = studio_draw(&studio, &view);
            }
            changes[own] = tree_difference(frames[0], frames[1], false);
        }
        studio_close(&studio);
        if (!(changes[1] > 0.01 && changes[1] > 10 * changes[0]))
            fail_msg(
                "stretch %g: coverage changes by %g at the plant's border, by %g at the world's",
                (double)between[k], changes[1], changes[0]);
        arena_destroy(arena);
    }
}

/* ---- Their shadows. ---- */

enum { BOX_PX = 4, BOXES = TREE_WIDTH / BOX_PX };

/* How much light a shadow takes from boxes of pixels that show ground alone. */
static void shadow_of(const float *lit, const float *shaded, const float *truth,
                      double boxes[BOXES * BOXES])
{
    memset(boxes, 0, BOXES * BOXES * sizeof *boxes);
    for (int y = 0; y < TREE_HEIGHT; y++)
        for (int x = 0; x < TREE_WIDTH; x++) {
            int at = 4 * (y * TREE_WIDTH + x);
            if (truth[at + 3] < 0.01f)
                boxes[y / BOX_PX * BOXES + x / BOX_PX] +=
                    (double)lit[at + 1] - (double)shaded[at + 1];
        }
}

static void test_ray_texels__the_shadow_of_a_stretched_tree_is_as_traced(void **state)
{
    (void)state;
    for (int k = 0; k < 2; k++) {
        struct arena *arena = arena_create(0);
        struct plant *plant = plant_from_mesh(arena, "lopsided", tree_mesh(arena, 400));
        struct scene *scene = tree_scene(arena, plant, 1, 0.4f);
        double boxes[2][BOXES * BOXES], wanted = 0, has = 0, off = 0;
        const float *frames[2][2];
        scene->instances[0].rotation_rad = 1;
        scene->instances[0].stretch = stretches[k];
        scene->tree_reach_m = 16;
        scene->terrain = level_ground(arena, 200, 0.4f);
        struct view view = tree_view(scene, 1.5f, 0.7f, 100, 34);
        for (int shaded = 0; shaded < 2; shaded++) {
            unsigned effects = EFFECT_TWO_SIDED | (shaded ? EFFECT_SUN_SHADOWS : 0);
            struct setting setting = {.method = "ray-texels",
                                      .options = "resolution=64",
                                      .lod = LOD_HIGH,
                                      .effects = effects,
                                      .format = TARGET_RGBA32F};
            frames[0][shaded] = tree_reference(arena, scene, effects, &view)->rgba;
            frames[1][shaded] = picture_draw(arena, scene, &view, &setting).rgba;
        }
        for (int m = 0; m < 2; m++)
            shadow_of(frames[m][0], frames[m][1], frames[0][0], boxes[m]);
        for (int b = 0; b < BOXES * BOXES; b++) {
            wanted += boxes[0][b];
            has += boxes[1][b];
            off += fabs(boxes[1][b] - boxes[0][b]);
        }
        if (!(fabs(has / wanted - 1) < 0.1) || !(off / wanted < 0.3))
            fail_msg("stretch %g: %.3f of the shadow, %.3f of it elsewhere", (double)stretches[k],
                     has / wanted, off / wanted);
        arena_destroy(arena);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_ray_texels__the_shadow_of_a_stretched_tree_is_as_traced),
        cmocka_unit_test(test_reference__a_stretched_ball_is_lit_as_its_ellipsoid),
        cmocka_unit_test(test_billboards__a_stretched_tree_covers_the_references_pixels),
        cmocka_unit_test(test_billboards__a_stretched_tree_shows_its_picture_from_where_the_eye_is),
        cmocka_unit_test(test_methods__a_stretched_ball_is_lit_as_its_ellipsoid),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
