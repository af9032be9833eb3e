/* ray-texels-gl: transmittance and light against closed forms, whole pictures against the march on
 * the CPU; tiles against brute force. */
#include "testing_tree.h"

#include "reference_world.h"

#include "bake/tiles.h"

static const unsigned lit = EFFECT_TWO_SIDED | EFFECT_AMBIENT;

/* Up to three layers that face +z, 16 m wide and high, each in a voxel of 1 m of its own: stripes
 * along x, stripes along y, stripes along x of half their width. Each covers half of every voxel's
 * face, and of what each two leave open: light passes each layer by half. */
static struct plant *layers(struct arena *arena, int count)
{
    enum { STRIPES = 32 };
    struct mesh *mesh = mesh_new(arena, MATERIAL_LEAF, 0.5f, (size_t)(2 * STRIPES * count));
    for (int layer = 0; layer < count; layer++)
        for (int stripe = 0; stripe < (layer == 2 ? STRIPES : STRIPES / 2); stripe++) {
            double z = count > 1 ? layer * (1 + 0.5 / (count - 1)) : 0;
            double low = layer == 2 ? 0.5 * stripe - 0.25 : stripe, x = 8, y = low;
            double wide = layer == 2 ? 0.25 : 0.5;
            double along_x[4][3] = {{-x, y, z}, {x, y, z}, {x, y + wide, z}, {-x, y + wide, z}};
            x = low - 7.75;
            double along_y[4][3] = {{x, 0, z}, {x + wide, 0, z}, {x + wide, 15.5, z}, {x, 15.5, z}};
            double(*corners)[3] = layer == 1 ? along_y : along_x;
            mesh_quad(mesh, corners[0], corners[1], corners[2], corners[3]);
        }
    mesh_finish(arena, mesh);
    setenv("TREELINE_CACHE", "off", 1);
    return plant_from_mesh(arena, "layers", mesh);
}

/* 12 m of the layers' middle, along -z. */
static struct view layers_view(const struct scene *scene, float eye_z_m)
{
    struct view view;
    struct scene zoomed = *scene;
    zoomed.camera.fov_y_rad = 2 * atanf(6.0f / 100);
    zoomed.camera.near_m = 1e-3f;
    view_look_at(&zoomed, (float[3]){0, 7.75f, eye_z_m}, (float[3]){0, 7.75f, eye_z_m - 1}, &view);
    return view;
}

static void expect_coverage(const struct frame *frame, double coverage)
{
    for (int i = 0; i < TREE_PIXELS; i++)
        if (fabs(frame->rgba[4 * i + 3] - coverage) >
            0.012) /* borders differ, and the plant is matched as a whole */
            fail_msg("pixel %d: coverage %g, not %g", i, (double)frame->rgba[4 * i + 3], coverage);
}

static void test_ray_texels_gl__each_layer_lets_half_of_the_light_through(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    static const char *const options[] = {"resolution=16,stop=0,step=1",
                                          "resolution=16,stop=0,step=0.25",
                                          "resolution=16,stop=0,step=1,bias=-4"};
    for (int count = 1; count <= 3; count++)
        for (int k = 0; k < 3; k++) {
            struct scene *scene = tree_scene(arena, layers(arena, count), 1, 0);
            struct view view = layers_view(scene, 100);
            struct frame *frame =
                tree_draw(arena, tree_method("ray-texels-gl"), options[k], scene, lit, &view, NULL);
            expect_coverage(frame, 1 - pow(0.5, count));
        }
    arena_destroy(arena);
}

static void test_ray_texels_gl__an_eye_within_sees_what_is_before_it(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct scene *scene = tree_scene(arena, layers(arena, 3), 1, 0);
    struct view view = layers_view(scene, 1.25f); /* a layer and a half of one */
    struct frame *frame = tree_draw(arena, tree_method("ray-texels-gl"),
                                    "resolution=16,stop=0,step=1", scene, lit, &view, NULL);
    expect_coverage(frame, 1 - pow(0.5, 1.5));
    arena_destroy(arena);
}

static void test_ray_texels_gl__a_tree_in_another_hides_what_is_left(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct scene *scene = tree_scene(arena, layers(arena, 1), 3, 0);
    scene->instances[1].position_m[2] = 0.3f;
    scene->instances[2].rotation_rad = 3.1415927f;
    struct view view = layers_view(scene, 100);
    struct frame *frame = tree_draw(arena, tree_method("ray-texels-gl"),
                                    "resolution=16,stop=0,step=1", scene, lit, &view, NULL);
    expect_coverage(frame, 1 - pow(0.5, 3));
    arena_destroy(arena);
}

/* All normals are +z and seen from +z: |N.L| or max(0, N.L) of the sun, and the sky. */
static void test_ray_texels_gl__leaves_that_lie_alike_are_lit_as_one(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    for (int k = 0; k < 8; k++) {
        struct scene *scene = tree_scene(arena, layers(arena, 3), 1, 0.7853982f * (float)k);
        unsigned effects = k % 2 ? EFFECT_AMBIENT : lit;
        struct view view = layers_view(scene, 100);
        view.sun_direction[0] = cosf(0.61f) * sinf(0.3f + 0.7853982f * (float)k);
        view.sun_direction[2] = cosf(0.61f) * cosf(0.3f + 0.7853982f * (float)k);
        double facing = view.sun_direction[2];
        facing = effects & EFFECT_TWO_SIDED ? fabs(facing) : fmax(facing, 0);
        struct frame *frame = tree_draw(arena, tree_method("ray-texels-gl"), "resolution=16", scene,
                                        effects, &view, NULL);
        for (int c = 0; c < 3; c++) {
            double wants = 0.5 * (scene->sun.radiance[c] * facing + scene->ambient[c]);
            double has = tree_mean(frame, c) / tree_mean(frame, 3);
            if (fabs(has - wants) > 0.005)
                fail_msg("sun %d, channel %d: %g, not %g", k, c, has, wants);
        }
    }
    arena_destroy(arena);
}

/* The march on the CPU, made ready. */
struct on_cpu {
    struct error error;
    struct workspace workspace;
    void *own;
};

static struct on_cpu *cpu_ready(struct arena *arena, const char *options, enum lod lod,
                                const struct scene *scene, unsigned effects)
{
    const struct method *method = tree_method("ray-texels");
    struct on_cpu *cpu = ARENA_NEW(arena, struct on_cpu);
    void *values = arena_alloc(arena, 1, method->options_size);
    cpu->workspace = (struct workspace){.arena = arena,
                                        .error = &cpu->error,
                                        .effects = effects,
                                        .lod = lod,
                                        .format = TARGET_RGBA32F,
                                        .threads = 2};
    options_default(method->options, values);
    if (options_parse(method->options, options, values, &cpu->error) != STATUS_OK ||
        options_parse(method->options, "tile=8,far=0", values, &cpu->error) != STATUS_OK ||
        method->prepare(&cpu->workspace, scene, values, &cpu->own) != STATUS_OK)
        fail_msg("%s", cpu->error.text);
    return cpu;
}

static struct frame *cpu_draw(struct on_cpu *cpu, const struct view *view)
{
    struct frame *frame =
        frame_create(cpu->workspace.arena, view->width_px, view->height_px, false);
    struct target target = {.width_px = view->width_px,
                            .height_px = view->height_px,
                            .format = TARGET_RGBA32F,
                            .pixels = frame->rgba};
    if (tree_method("ray-texels")->draw(&cpu->workspace, cpu->own, view, &target) != STATUS_OK)
        fail_msg("%s", cpu->error.text);
    return frame;
}

/* The CPU turns light for each tile, the smallest here, this method for each pixel, and trees about
 * as small as a pixel have looks of their own in each, so they differ a little; where a pixel is a
 * small part of a voxel also because steps begin elsewhere behind a leap, the less the shorter. */
static void test_ray_texels_gl__draws_what_the_march_on_the_cpu_draws(void **state)
{
    (void)state;
    static const struct {
        const char *scene, *options;
        size_t trees;
        enum lod lod;
        unsigned effects;
    } cases[] = {
        {"oak-hills", "resolution=48,step=1", 300, LOD_HIGH, EFFECT_TWO_SIDED | EFFECT_FOG},
        {"oak-hills", "resolution=48,step=1,model=isotropic", 30, LOD_LOW, EFFECT_AMBIENT},
        {"poplar-forest", "resolution=64,step=1", 200, LOD_AUTO, EFFECT_TWO_SIDED | EFFECT_AMBIENT},
        {"poplar-forest", "resolution=32,step=1", 20000, LOD_HIGH,
         EFFECT_TWO_SIDED | EFFECT_AMBIENT},
        {"walk-in", "resolution=32,step=0.5,bias=-1", 40, LOD_HIGH, EFFECT_TWO_SIDED},
    };
    setenv("TREELINE_CACHE", "off", 1);
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        struct arena *arena = arena_create(0);
        struct error error = {0};
        struct scene *scene;
        struct view view;
        struct scene_request request = {cases[k].trees, 1, 160, 120};
        if (scene_load(arena, cases[k].scene, &request, &scene, &error) != STATUS_OK)
            fail_msg("%s", error.text);
        view_at(scene, 0.3, &view);
        struct frame *cpu = cpu_draw(
            cpu_ready(arena, cases[k].options, cases[k].lod, scene, cases[k].effects), &view);
        struct frame *gl =
            tree_draw_as(arena, tree_method("ray-texels-gl"), cases[k].options, cases[k].lod,
                         TARGET_RGBA32F, scene, cases[k].effects, &view, NULL);
        double rmse = tree_rmse(cpu, gl), off = tree_difference(cpu, gl, false);
        double mirrored = tree_difference(cpu, gl, true), covered = tree_mean(cpu, 3);
        if (rmse > 0.005 || off > 0.05 * covered || mirrored < 10 * off)
            fail_msg("%s, %s: rmse %g, coverage %g off by %g, mirrored by %g", cases[k].scene,
                     cases[k].options, rmse, covered, off, mirrored);
        arena_destroy(arena);
    }
}

enum { SUNS = 4 };
static const float suns[SUNS][3] = {
    {0.77f, 0.57f, 0.28f}, {0, 1, 0}, {-0.28f, 0, 0.96f}, {0.958f, -0.05f, 0.282f}};

/* Pictures of a forest under some of the suns, on the CPU and by OpenGL. */
static void forest_draw(struct arena *arena, const struct scene *scene, const char *options,
                        unsigned effects, int count, struct frame *pictures[SUNS][2])
{
    struct on_cpu *cpu = cpu_ready(arena, options, LOD_HIGH, scene, effects);
    struct studio studio = {
        .method = tree_method("ray-texels-gl"),
        .workspace = {
            .arena = arena, .effects = effects, .lod = LOD_HIGH, .format = TARGET_RGBA32F}};
    struct view view;
    view_at(scene, 0.3, &view);
    studio_prepare(&studio, options, scene, view.width_px, view.height_px);
    for (int sun = 0; sun < count; sun++) {
        memcpy(view.sun_direction, suns[sun], sizeof suns[sun]);
        pictures[sun][0] = cpu_draw(cpu, &view);
        pictures[sun][1] = studio_draw(&studio, &view);
    }
    studio_close(&studio);
}

/* Apart no more than without shadows. */
static void forest_check(struct frame *plain[2], struct frame *shaded[2], int sun)
{
    double rmse = tree_rmse(shaded[0], shaded[1]), plainly = tree_rmse(plain[0], plain[1]);
    double shadows = tree_rmse(shaded[0], plain[0]), left[2];
    for (int gl = 0; gl < 2; gl++)
        left[gl] = tree_mean(shaded[gl], 1) / tree_mean(plain[gl], 1);
    printf("# sun %d: rmse %.4f (%.4f without) of %.4f, light %.4f, on the CPU %.4f\n", sun, rmse,
           plainly, shadows, left[1], left[0]);
    if (!(rmse < 1.5 * plainly && rmse < 0.2 * shadows && fabs(left[1] - left[0]) < 0.006))
        fail_msg("sun %d: rmse %g, %g without, shadows %g, light left %g, on the CPU %g", sun, rmse,
                 plainly, shadows, left[1], left[0]);
}

/* Level ground and relief; the sun from its highest to below the ground; trees that are near, and
 * trees below a pixel, which shade each other. */
static void test_ray_texels_gl__the_sun_shades_as_in_the_march_on_the_cpu(void **state)
{
    (void)state;
    static const struct {
        const char *scene, *options;
        size_t trees;
        int suns;
    } cases[] = {
        {"forest-shadows", "resolution=32,step=1,shadows=16", 12, SUNS},
        {"poplar-forest", "resolution=32,step=1,shadows=16,model=isotropic", 200, 1},
        {"poplar-forest", "resolution=16,step=1,shadows=16", 20000, 1},
    };
    setenv("TREELINE_CACHE", "off", 1);
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        struct arena *arena = arena_create(0);
        const struct scene_request request = {cases[k].trees, 1, 64, 48};
        struct error error = {0};
        struct scene *scene;
        struct frame *plain[SUNS][2], *shaded[SUNS][2];
        if (scene_load(arena, cases[k].scene, &request, &scene, &error) != STATUS_OK)
            fail_msg("%s", error.text);
        forest_draw(arena, scene, cases[k].options, lit, cases[k].suns, plain);
        forest_draw(arena, scene, cases[k].options, lit | EFFECT_SUN_SHADOWS, cases[k].suns,
                    shaded);
        for (int sun = 0; sun < cases[k].suns; sun++)
            forest_check(plain[sun], shaded[sun], sun);
        arena_destroy(arena);
    }
}

static void test_ray_texels_gl__a_sun_that_has_moved_shades_as_one_that_stood_there(void **state)
{
    (void)state;
    static const char options[] = "resolution=32,shadows=16";
    struct arena *arena = arena_create(0);
    struct plant *plant = plant_from_mesh(arena, "tree", tree_mesh(arena, 300));
    struct scene *scene = tree_scene(arena, plant, 1, 0);
    const unsigned effects = lit | EFFECT_SUN_SHADOWS;
    struct view view = tree_view(scene, 0.5f, 0.4f, 40, 12);
    struct studio studio;
    struct frame *moved = NULL;
    setenv("TREELINE_CACHE", "off", 1);
    studio_open(&studio, arena, tree_method("ray-texels-gl"), options, LOD_HIGH, scene, effects);
    for (int i = 0; i < 3; i++) { /* there, elsewhere, and back */
        memcpy(view.sun_direction, suns[i % 2], sizeof suns[0]);
        moved = studio_draw(&studio, &view);
    }
    studio_close(&studio);
    struct frame *stood =
        tree_draw(arena, tree_method("ray-texels-gl"), options, scene, effects, &view, NULL);
    assert_memory_equal(moved->rgba, stood->rgba, 4 * sizeof(float) * TREE_PIXELS);
    arena_destroy(arena);
}

/* The level that a pixel asks for grows by one in equal parts, of a still tree: at once all of it
 * changes in one step. */
static void test_ray_texels_gl__a_level_turns_into_the_next_without_a_jump(void **state)
{
    (void)state;
    enum { STEPS = 12 };
    struct arena *arena = arena_create(0);
    struct plant *plant = plant_from_mesh(arena, "lopsided", tree_mesh(arena, 400));
    struct scene *scene = tree_scene(arena, plant, 1, 0);
    struct view view = tree_view(scene, 0.55f, 0.2f, 300, 14);
    double greatest[3] = {0, 0, 0}, whole = 0;
    for (int k = 0; k < 3; k++) {
        struct frame *first = NULL, *last = NULL;
        for (int step = 0; step < STEPS; step++) {
            char options[64];
            snprintf(options, sizeof options, "resolution=64,bias=%g,smooth=%g",
                     0.55 + 1.1 * step / (STEPS - 1), 0.5 * k);
            struct frame *frame =
                tree_draw(arena, tree_method("ray-texels-gl"), options, scene, lit, &view, NULL);
            greatest[k] = last ? fmax(greatest[k], tree_rmse(last, frame)) : 0;
            last = frame;
            first = first ? first : frame;
        }
        whole = k == 0 ? tree_rmse(first, last) : whole;
    }
    if (!(greatest[0] > 0.8 * whole && greatest[1] < 0.4 * whole && greatest[2] < 0.25 * whole))
        fail_msg("greatest change: %g, %g and %g of %g", greatest[0], greatest[1], greatest[2],
                 whole);
    arena_destroy(arena);
}

static void test_tiles__hold_what_touches_them_in_order(void **state)
{
    (void)state;
    enum { COUNT = 300, WIDTH = 203, HEIGHT = 97 };
    struct arena *arena = arena_create(0);
    struct random random = random_seed(5, 1);
    struct tiles *tiles = tiles_create(arena, COUNT);
    struct tiles_rect *rects = ARENA_ARRAY(arena, struct tiles_rect, COUNT);
    for (int i = 0; i < COUNT; i++)
        for (int axis = 0; axis < 2; axis++) {
            int size = axis ? HEIGHT : WIDTH, first = (int)random_below(&random, (uint32_t)size);
            int last = first + (int)random_below(&random, 40) - 4; /* some hold nothing */
            rects[i].low[axis] = (int16_t)first;
            rects[i].high[axis] = (int16_t)(last < size ? last : size - 1);
        }
    tiles_bin(tiles, WIDTH, HEIGHT, rects, COUNT);
    assert_int_equal(tiles->side_px, TILES_SIDE_LEAST_PX);
    uint32_t at = 0;
    for (int tile = 0; tile < tiles->columns * tiles->rows; tile++) {
        int x = tile % tiles->columns * tiles->side_px, y = tile / tiles->columns * tiles->side_px;
        assert_int_equal(tiles->first[tile], at);
        for (uint32_t i = 0; i < COUNT; i++) {
            const struct tiles_rect *r = &rects[i];
            if (r->low[0] > r->high[0] || r->low[1] > r->high[1] || r->high[0] < x ||
                r->high[1] < y || r->low[0] >= x + tiles->side_px ||
                r->low[1] >= y + tiles->side_px)
                continue;
            assert_int_equal(tiles->entries[at++], i);
        }
    }
    assert_int_equal(tiles->first[tiles->columns * tiles->rows], at);
    arena_destroy(arena);
}

static void test_tiles__grow_until_all_fits(void **state)
{
    (void)state;
    enum { COUNT = 2000, SIDE = 8192 };
    struct arena *arena = arena_create(0);
    struct tiles *tiles = tiles_create(arena, COUNT);
    struct tiles_rect *rects = ARENA_ARRAY(arena, struct tiles_rect, COUNT);
    for (int i = 0; i < COUNT; i++)
        rects[i] = (struct tiles_rect){{0, 0}, {SIDE - 1, SIDE - 1}};
    tiles_bin(tiles, SIDE, SIDE, rects, COUNT);
    size_t count = (size_t)(tiles->columns * tiles->rows);
    assert_true(tiles->side_px > 64 && count <= TILES_MAX);
    assert_int_equal(tiles->first[count], COUNT * count);
    assert_true(COUNT * count <= tiles->capacity);
    arena_destroy(arena);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_ray_texels_gl__each_layer_lets_half_of_the_light_through),
        cmocka_unit_test(test_ray_texels_gl__an_eye_within_sees_what_is_before_it),
        cmocka_unit_test(test_ray_texels_gl__a_tree_in_another_hides_what_is_left),
        cmocka_unit_test(test_ray_texels_gl__leaves_that_lie_alike_are_lit_as_one),
        cmocka_unit_test(test_ray_texels_gl__draws_what_the_march_on_the_cpu_draws),
        cmocka_unit_test(test_ray_texels_gl__the_sun_shades_as_in_the_march_on_the_cpu),
        cmocka_unit_test(test_ray_texels_gl__a_sun_that_has_moved_shades_as_one_that_stood_there),
        cmocka_unit_test(test_ray_texels_gl__a_level_turns_into_the_next_without_a_jump),
        cmocka_unit_test(test_tiles__hold_what_touches_them_in_order),
        cmocka_unit_test(test_tiles__grow_until_all_fits),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
