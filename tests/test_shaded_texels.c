/* Shaded texels against the ray-traced reference and closed forms: coverage from all sides, light,
 * fog, numbers of slices, and the borders of their use. */
#include "testing_stacks.h"

static int open_fixture(void **state)
{
    return fixture_open(state, "shaded-texels");
}

/* A board of one kind, 6 m x 6 m, in the middle of what tree_view shows; its front (the side that
 * its triangles turn to and its normal) along an axis, sign 1 or -1. */
static struct plant *board_plant(struct arena *arena, int axis, float sign, enum material_kind kind)
{
    struct mesh *mesh = ARENA_NEW(arena, struct mesh);
    mesh->vertices_count = 4;
    mesh->triangles_count = 2;
    mesh->positions = arena_alloc(arena, 4, sizeof *mesh->positions);
    mesh->normals = arena_alloc(arena, 4, sizeof *mesh->normals);
    mesh->triangles = arena_alloc(arena, 2, sizeof *mesh->triangles);
    for (int k = 0; k < 4; k++) {
        float s = k == 1 || k == 2 ? 3 : -3, t = k >= 2 ? 3 : -3;
        mesh->positions[k][(axis + 1) % 3] = sign * s;
        mesh->positions[k][(axis + 2) % 3] = t;
        mesh->positions[k][1] += 3.5f;
        mesh->normals[k][axis] = sign;
    }
    memcpy(mesh->triangles, (uint32_t[2][3]){{0, 1, 2}, {0, 2, 3}}, 2 * sizeof *mesh->triangles);
    mesh->materials_count = mesh->parts_count = 1;
    mesh->materials = ARENA_NEW(arena, struct material);
    *mesh->materials =
        (struct material){arena_strdup(arena, "board"), kind, {0.6f, 0.3f, 0.1f}, NULL, false};
    mesh->parts = ARENA_NEW(arena, struct mesh_part);
    *mesh->parts = (struct mesh_part){.triangles_count = 2};
    if (kind == MATERIAL_LEAF) {
        mesh->parts->elements_count = 1;
        mesh->parts->element_first = ARENA_ARRAY(arena, uint32_t, 2);
        mesh->parts->element_first[1] = 2;
    }
    mesh_bounds(mesh);
    return plant_from_mesh(arena, "board", mesh);
}

static const float *middle_of(const struct frame *frame)
{
    return frame->rgba + 4 * ((size_t)(frame->height_px / 2) * (size_t)frame->width_px +
                              (size_t)frame->width_px / 2);
}

/* Along one of the axes, from its positive or negative end. */
static struct view axis_view(const struct scene *scene, int axis, float sign)
{
    float azimuth = axis == 0 ? 1.5707963f : 0, turn = sign < 0 ? 3.1415927f : 0;
    return axis == 1 ? tree_view(scene, 0, sign * 1.5707f, 300, 9)
                     : tree_view(scene, azimuth + turn, 0, 300, 9);
}

static void
test_shaded_texels__coverage_is_right_from_twelve_azimuths_and_three_elevations(void **state)
{
    struct fixture *f = *state;
    static const float elevations[3] = {0, 0.6f, 1.2f};
    struct scene *scene = tree_scene(f->arena, f->plant, 1, 1);
    struct studio studio;
    studio_open(&studio, f->arena, f->method, "", LOD_HIGH, scene, lit);
    for (int e = 0; e < 3; e++)
        for (int a = 0; a < 12; a++) {
            struct view view = tree_view(scene, (float)a * 0.5235988f, elevations[e], 300, 9);
            struct frame *truth = tree_reference(f->arena, scene, lit, &view);
            struct frame *drawn = studio_draw(&studio, &view);
            double covered = tree_mean(truth, 3), ratio = tree_mean(drawn, 3) / covered;
            double off = tree_difference(drawn, truth, false) / covered;
            if (fabs(ratio - 1) > 0.15 || off > 0.35)
                fail_msg("azimuth %d, elevation %d: %.3f of the coverage, off by %.3f", a, e, ratio,
                         off);
        }
    studio_close(&studio);
}

/* From straight on nothing is between the slices: the outline is the plant's, and not a mirrored
 * one's. */
static void test_shaded_texels__along_the_axes_the_outline_is_the_plants(void **state)
{
    struct fixture *f = *state;
    struct scene *scene = tree_scene(f->arena, f->plant, 1, 1);
    struct studio studio;
    studio_open(&studio, f->arena, f->method, "slices=32,resolution=256,texel=0.5", LOD_HIGH, scene,
                lit);
    for (int k = 0; k < 6; k++) {
        struct view view = axis_view(scene, k % 3, k < 3 ? 1 : -1);
        struct frame *truth = tree_reference(f->arena, scene, lit, &view);
        struct frame *drawn = studio_draw(&studio, &view);
        double covered = tree_mean(truth, 3), off = tree_difference(drawn, truth, false);
        double mirrored = tree_difference(drawn, truth, true);
        if (off > 0.12 * covered || fabs(tree_mean(drawn, 3) / covered - 1) > 0.05 ||
            mirrored < 3 * off)
            fail_msg("axis %d: off by %.3f of the coverage, mirrored %.3f", k, off / covered,
                     mirrored / covered);
    }
    studio_close(&studio);
}

/* A board is lit by |N.L| (leaf, two sides), max(0, N.L) of the side seen (leaf, one side; bark),
 * whichever side faces the eye, with the sun along, beside and against each axis. */
static void test_shaded_texels__a_board_is_lit_by_the_closed_form(void **state)
{
    struct fixture *f = *state;
    for (int k = 0; k < 18; k++) {
        int axis = k % 3, way = k / 3 % 3;
        bool leaf = k < 9 || way == 0, two = way != 1;
        struct plant *plant =
            board_plant(f->arena, axis, k % 2 ? 1 : -1, leaf ? MATERIAL_LEAF : MATERIAL_BARK);
        struct scene *scene = tree_scene(f->arena, plant, 1, 0);
        struct studio studio;
        unsigned effects = EFFECT_AMBIENT | (two ? EFFECT_TWO_SIDED : 0u);
        studio_open(&studio, f->arena, f->method, "slices=8,resolution=32", LOD_HIGH, scene,
                    effects);
        for (int s = 0; s < 6; s++) {
            float eye = s % 2 ? 1 : -1;
            static const float suns[6][3] = {{1, 0, 0},  {0, 1, 0},  {0, 0, 1},
                                             {-1, 0, 0}, {0, -1, 0}, {0.48f, 0.6f, -0.64f}};
            struct view view = axis_view(scene, axis, eye);
            memcpy(view.sun_direction, suns[s], sizeof view.sun_direction);
            const float *pixel = middle_of(studio_draw(&studio, &view));
            float along = eye * suns[s][axis];
            float diffuse = leaf && two ? fabsf(along) : fmaxf(0, along);
            assert_true(fabsf(pixel[3] - 1) < 0.01f);
            for (int c = 0; c < 3; c++) {
                static const float albedo[3] = {0.6f, 0.3f, 0.1f};
                float wants = albedo[c] * (scene->sun.radiance[c] * diffuse + scene->ambient[c]);
                if (fabsf(pixel[c] - wants) > 0.02f)
                    fail_msg("board %d, sun %d, channel %d: %.4f instead of %.4f", k, s, c,
                             (double)pixel[c], (double)wants);
            }
        }
        studio_close(&studio);
    }
}

/* Coarse texels, whose normals point everywhere. Of length 1 again, little scatters (between texels
 * they are still averaged): spreading the light changes less; and a short normal's light is lost
 * without spreading, a long one's is not. */
static void test_shaded_texels__normals_of_length_1_do_not_scatter(void **state)
{
    struct fixture *f = *state;
    struct scene *scene = tree_scene(f->arena, f->plant, 1, 0.6f);
    struct view view = tree_view(scene, 0.2f, 0.1f, 30, 9);
    struct frame *frames[2][2];
    for (int unit = 0; unit < 2; unit++)
        for (int rough = 0; rough < 2; rough++)
            frames[unit][rough] = tree_draw(
                f->arena, f->method,
                arena_printf(f->arena, "slices=4,resolution=16,facing=off,rough=%s,unit=%s",
                             rough ? "on" : "off", unit ? "on" : "off"),
                scene, lit, &view, NULL);
    double short_spread = tree_rmse(frames[0][0], frames[0][1]);
    double long_spread = tree_rmse(frames[1][0], frames[1][1]);
    double lost = tree_mean(frames[1][0], 1) / tree_mean(frames[0][0], 1);
    if (long_spread > 0.6 * short_spread || lost < 1.05 ||
        tree_difference(frames[0][0], frames[1][0], false) > 1e-6)
        fail_msg("spread %.4f, of length 1 %.4f; light without spread %.3f times", short_spread,
                 long_spread, lost);
}

static void test_shaded_texels__light_follows_the_sun_as_the_reference_does(void **state)
{
    struct fixture *f = *state;
    static const unsigned effects[2] = {EFFECT_TWO_SIDED | EFFECT_AMBIENT, EFFECT_TWO_SIDED};
    for (int e = 0; e < 2; e++) {
        struct scene *scene = tree_scene(f->arena, f->plant, 1, 0);
        struct studio studio;
        studio_open(&studio, f->arena, f->method, "", LOD_HIGH, scene, effects[e]);
        for (int k = 0; k < 8; k++) {
            scene->sun.azimuth_rad = scene->sun.end_azimuth_rad = (float)k * 0.7853982f;
            scene->hash = 100 + (uint64_t)k;
            struct view view = tree_view(scene, 0.3f, 0.2f, 300, 9);
            struct frame *truth = tree_reference(f->arena, scene, effects[e], &view);
            struct frame *drawn = studio_draw(&studio, &view);
            double wants = tree_mean(truth, 1) / tree_mean(truth, 3);
            double has = tree_mean(drawn, 1) / tree_mean(drawn, 3);
            if (fabs(has - wants) > 0.07 * wants)
                fail_msg("effects %u, sun %d: %.4f, the reference %.4f", effects[e], k, has, wants);
        }
        studio_close(&studio);
    }
}

static void test_shaded_texels__fog_takes_what_the_law_of_beer_lambert_says(void **state)
{
    struct fixture *f = *state;
    struct plant *plant = board_plant(f->arena, 2, 1, MATERIAL_LEAF);
    static const float distances[3] = {20, 60, 150};
    for (int k = 0; k < 3; k++) {
        struct scene *scene = tree_scene(f->arena, plant, 1, 0);
        struct view view = tree_view(scene, 0, 0, distances[k], 9);
        struct frame *clear = tree_draw(f->arena, f->method, "slices=8", scene, lit, &view, NULL);
        struct frame *fog =
            tree_draw(f->arena, f->method, "slices=8", scene, lit | EFFECT_FOG, &view, NULL);
        float share = expf(-scene->fog.density_per_m * distances[k]);
        for (int c = 0; c < 3; c++) {
            float wants = share * middle_of(clear)[c] + (1 - share) * scene->fog.color[c];
            assert_true(fabsf(middle_of(fog)[c] - wants) < 0.003f);
        }
    }
}

/* Of what a pixel shows in part, as much fog as is covered, though many slices cover it: from 300 m
 * a tree is everywhere as far away, within 1 %. */
static void test_shaded_texels__fog_covers_no_more_than_the_slices(void **state)
{
    struct fixture *f = *state;
    struct scene *scene = tree_scene(f->arena, f->plant, 1, 0);
    scene->fog.density_per_m = 0.002f;
    struct view view = tree_view(scene, 0.4f, 0.2f, 300, 9);
    struct frame *clear = tree_draw(f->arena, f->method, "slices=32", scene, lit, &view, NULL);
    struct frame *fog =
        tree_draw(f->arena, f->method, "slices=32", scene, lit | EFFECT_FOG, &view, NULL);
    const double share = exp(-0.002 * 300);
    size_t parts = 0;
    for (int i = 0; i < TREE_PIXELS; i++) {
        double covered = clear->rgba[4 * i + 3];
        parts += covered > 0.05 && covered < 0.8;
        for (int c = 0; c < 3; c++) {
            double wants = share * clear->rgba[4 * i + c] +
                           (1 - share) * covered * (double)scene->fog.color[c] +
                           (1 - covered) * (double)fog->rgba[c]; /* a corner's: the sky's */
            if (fabs(fog->rgba[4 * i + c] - wants) > 0.01)
                fail_msg("pixel %d, channel %d, %.3f covered: %.4f, by the law %.4f", i, c, covered,
                         (double)fog->rgba[4 * i + c], wants);
        }
    }
    assert_true(parts > 100);
}

static void test_shaded_texels__naive_and_fast_draw_the_same_picture(void **state)
{
    struct fixture *f = *state;
    struct scene *scene = tree_scene(f->arena, f->plant, 2, 1);
    scene->instances[1].position_m[0] = 1.5f;
    scene->instances[1].rotation_rad = 2;
    struct view view = tree_view(scene, 0.4f, 0.5f, 300, 12);
    struct frame *truth = tree_reference(f->arena, scene, lit, &view);
    static const char *const options[] = {"slices=32,resolution=64,path=naive",
                                          "slices=32,resolution=64,path=naive,add=batches",
                                          "slices=32,resolution=64,path=naive,add=rectangles",
                                          "slices=32,resolution=64,path=naive,add=even",
                                          "slices=32,resolution=64,path=naive,add=bilinear",
                                          "slices=32,resolution=64,path=fast",
                                          "slices=32,resolution=64,path=fast,filter=trilinear"};
    struct frame *naive = NULL;
    for (size_t i = 0; i < sizeof options / sizeof *options; i++) {
        struct frame *drawn = tree_draw(f->arena, f->method, options[i], scene, lit, &view, NULL);
        naive = naive ? naive : drawn;
        if (i == 1)
            assert_memory_equal(drawn->rgba, naive->rgba, TREE_PIXELS * 16);
        if (i == 2 && tree_rmse(drawn, naive) > 1e-3)
            fail_msg("rectangles change the picture by %g", tree_rmse(drawn, naive));
        if (tree_rmse(drawn, truth) > 1.05 * tree_rmse(naive, truth) ||
            fabs(tree_mean(drawn, 3) / tree_mean(naive, 3) - 1) > 0.08)
            fail_msg("%s: RMSE %g, naive %g; coverage %g", options[i], tree_rmse(drawn, truth),
                     tree_rmse(naive, truth), tree_mean(drawn, 3) / tree_mean(naive, 3));
    }
}

static void test_shaded_texels__one_slice_and_five_hundred_and_twelve_are_drawn(void **state)
{
    struct fixture *f = *state;
    struct scene *scene = tree_scene(f->arena, f->plant, 1, 1);
    struct view view = tree_view(scene, 0.2f, 0.1f, 300, 9);
    struct frame *truth = tree_reference(f->arena, scene, lit, &view);
    static const char *const options[] = {"slices=1",
                                          "slices=3",
                                          "slices=512,resolution=64",
                                          "slices=512,resolution=64,interpolate=on",
                                          "slices=1,interpolate=on",
                                          "slices=2,cut=clip",
                                          "slices=2"};
    struct frame *drawn[sizeof options / sizeof *options];
    for (size_t i = 0; i < sizeof options / sizeof *options; i++) {
        drawn[i] = tree_draw(f->arena, f->method, options[i], scene, lit, &view, NULL);
        double ratio = tree_mean(drawn[i], 3) / tree_mean(truth, 3);
        if (fabs(ratio - 1) > 0.2)
            fail_msg("%s: %.3f of the coverage", options[i], ratio);
    }
    assert_true(tree_difference(drawn[5], drawn[6], false) > 1e-4); /* leaves are cut in two */
}

/* From straight on all slices lie behind each other, so more of them show the same: opacity
 * correction keeps the transmittance of what is as thick as a few slices. */
static void test_shaded_texels__interpolated_slices_keep_the_opacity(void **state)
{
    struct fixture *f = *state;
    struct scene *scene = tree_scene(f->arena, f->plant, 1, 1);
    struct studio studio;
    struct frame *frames[2];
    struct view view = tree_view(scene, 0.5f, 0.1f, 300, 9);
    for (int i = 0; i < 2; i++) {
        studio_open(&studio, f->arena, f->method,
                    i ? "slices=16,interpolate=on,criterion=0.1" : "slices=16,criterion=0.1",
                    LOD_AUTO, scene, lit);
        frames[i] = studio_draw(&studio, &view);
        studio_close(&studio);
    }
    assert_true(tree_rmse(frames[0], frames[1]) > 1e-4);
    assert_true(fabs(tree_mean(frames[1], 3) / tree_mean(frames[0], 3) - 1) < 0.15);
}

/* The camera backs away: with smooth=on no step between two pictures is above twice the mean one,
 * where without it the number of slices jumps. */
static void test_shaded_texels__smooth_changes_do_not_jump(void **state)
{
    struct fixture *f = *state;
    struct scene *scene = tree_scene(f->arena, f->plant, 1, 1);
    enum { STEPS = 60 };
    double worst[2] = {0, 0}, mean[2] = {0, 0};
    for (int smooth = 0; smooth < 2; smooth++) {
        struct studio studio;
        struct frame *last = NULL;
        studio_open(&studio, f->arena, f->method, smooth ? "criterion=4,smooth=on" : "criterion=4",
                    LOD_AUTO, scene, lit);
        for (int step = 0; step < STEPS; step++) {
            /* round the corner between two stacks, nearly as far away all the time */
            struct view view =
                tree_view(scene, 0.55f + 0.008f * (float)step, 0.2f, 300 + (float)step, 14);
            struct frame *drawn = studio_draw(&studio, &view);
            if (last) {
                double change = tree_rmse(last, drawn);
                worst[smooth] = fmax(worst[smooth], change);
                mean[smooth] += change / (STEPS - 1);
            }
            last = drawn;
        }
        studio_close(&studio);
    }
    if (worst[0] < 4 * mean[0] || worst[1] > 2 * mean[1])
        fail_msg("worst and mean change: %g %g, smooth %g %g", worst[0], mean[0], worst[1],
                 mean[1]);
}

/* Two boards, one behind the other: the nearer one is seen, whichever is listed first. */
static void test_shaded_texels__a_nearer_tree_hides_a_farther_one(void **state)
{
    struct fixture *f = *state;
    static const char *const options[] = {"slices=8,resolution=32",
                                          "slices=8,resolution=32,path=naive",
                                          "slices=8,resolution=32,front=2"};
    for (int k = 0; k < 6; k++) {
        struct scene *scene =
            tree_scene(f->arena, board_plant(f->arena, 2, 1, MATERIAL_LEAF), 2, 0);
        struct species *species = ARENA_ARRAY(f->arena, struct species, 2);
        struct plant *other = board_plant(f->arena, 2, 1, MATERIAL_LEAF);
        const struct mesh *mesh;
        assert_int_equal(plant_mesh(other, &mesh, NULL), STATUS_OK);
        mesh->materials->albedo[0] = 0;
        species[0] = species[1] = scene->species[0];
        species[1].plant = other;
        scene->species = species;
        scene->species_count = 2;
        bool first_is_near = k & 1;
        scene->instances[0].position_m[2] = first_is_near ? 4 : -4;
        scene->instances[1].species = 1;
        struct view view = tree_view(scene, 0, 0, 300, 9);
        const float *pixel =
            middle_of(tree_draw(f->arena, f->method, options[k / 2], scene, lit, &view, NULL));
        if ((pixel[0] > 0.05f) != first_is_near || pixel[1] < 0.05f)
            fail_msg("%s: the nearer one is number %d; red %.3f", options[k / 2], !first_is_near,
                     (double)pixel[0]);
    }
}

/* One tree inside another, and two that overlap: what is seen is the union. */
static void test_shaded_texels__trees_in_each_other_cover_as_in_the_reference(void **state)
{
    struct fixture *f = *state;
    static const float apart[3] = {0, 0.7f, 2};
    for (int k = 0; k < 3; k++) {
        struct scene *scene = tree_scene(f->arena, f->plant, 2, 1);
        scene->instances[1].position_m[2] = apart[k];
        scene->instances[1].rotation_rad = 1.5f;
        scene->instances[1].scale = k == 0 ? 0.8f : 1;
        struct view view = tree_view(scene, 0.3f, 0.2f, 300, 11);
        struct frame *truth = tree_reference(f->arena, scene, lit, &view);
        struct frame *drawn =
            tree_draw(f->arena, f->method, "resolution=64", scene, lit, &view, NULL);
        double ratio = tree_mean(drawn, 3) / tree_mean(truth, 3);
        double light = tree_mean(drawn, 1) / tree_mean(truth, 1);
        if (fabs(ratio - 1) > 0.12 || fabs(light - 1) > 0.15)
            fail_msg("%g m apart: %.3f of the coverage, %.3f of the light", (double)apart[k], ratio,
                     light);
    }
}

static void test_shaded_texels__an_eye_in_the_crown_sees_the_crown(void **state)
{
    struct fixture *f = *state;
    static const char *const options[] = {"resolution=64,near=0", "resolution=64,path=naive",
                                          "resolution=64,near=0,interpolate=on,smooth=on"};
    struct scene *scene = tree_scene(f->arena, f->plant, 1, 1);
    for (int i = 0; i < 3; i++) {
        struct studio studio;
        studio_open(&studio, f->arena, f->method, options[i], LOD_HIGH, scene, lit);
        for (int k = 0; k < 4; k++) {
            static const float distances[4] = {2, 0.5f, 1e-3f, 1e-7f};
            struct view view = tree_view(scene, 0.7f, 0.3f, distances[k], distances[k]);
            struct frame *drawn = studio_draw(&studio, &view);
            if (k < 2)
                assert_true(tree_mean(drawn, 3) >
                            0.6 * tree_mean(tree_reference(f->arena, scene, lit, &view), 3));
        }
        studio_close(&studio);
    }
}

static void test_shaded_texels__terrain_in_front_hides_and_behind_does_not(void **state)
{
    struct fixture *f = *state;
    struct scene *scene = tree_scene(f->arena, f->plant, 1, 1);
    float heights[4] = {-0.01f, -0.01f, -0.01f, -0.01f}, normals[4][3];
    for (int i = 0; i < 4; i++)
        normals[i][0] = normals[i][2] = 0, normals[i][1] = 1;
    scene->terrain =
        (struct terrain){2, 2, 100, 100, heights, normals, {0.2f, 0.2f, 0.2f}, NULL, 0};
    struct view view = tree_view(scene, 0.6f, 0.5f, 300, 9);
    struct frame *truth = tree_reference(f->arena, scene, lit, &view);
    struct frame *drawn = tree_draw(f->arena, f->method, "resolution=64", scene, lit, &view, NULL);
    assert_true(fabs(tree_mean(drawn, 3) / tree_mean(truth, 3) - 1) < 0.1);
    for (int i = 0; i < 4; i++)
        heights[i] = 12; /* a plateau between the eye below it and the tree */
    view = tree_view(scene, 0.6f, 1.2f, 300, 9);
    drawn = tree_draw(f->arena, f->method, "resolution=64", scene, lit, &view, NULL);
    assert_true(tree_mean(drawn, 3) == 0);
}

/* The same picture in 8 and 16 bits, but for their steps. */
static void test_shaded_texels__eight_bits_do_not_darken(void **state)
{
    struct fixture *f = *state;
    struct scene *scene = tree_scene(f->arena, f->plant, 1, 1);
    struct view view = tree_view(scene, 0.6f, 0.3f, 300, 9);
    struct frame *exact = tree_draw(f->arena, f->method, "resolution=64", scene, lit, &view, NULL);
    static const double limits[2] = {0.02, 0.002};
    for (int i = 0; i < 2; i++) {
        struct frame *drawn =
            tree_draw_as(f->arena, f->method, "resolution=64", LOD_HIGH,
                         i ? TARGET_RGBA16F : TARGET_RGBA8, scene, lit, &view, NULL);
        double light = tree_mean(drawn, 1) / tree_mean(exact, 1);
        if (fabs(light - 1) > limits[i])
            fail_msg("%s: %.4f of the light", i ? "rgba16f" : "rgba8", light);
    }
}

static void test_shaded_texels__a_thousand_trees_take_a_few_draw_calls(void **state)
{
    struct fixture *f = *state;
    struct scene *scene = tree_scene(f->arena, f->plant, 1000, 1);
    for (size_t i = 0; i < 1000; i++) {
        scene->instances[i].position_m[0] = ((float)(i % 40) - 20);
        scene->instances[i].position_m[2] = ((float)(i / 40) - 12);
    }
    struct view view = tree_view(scene, 0.3f, 0.4f, 150, 60);
    struct gl_counters counters[2];
    tree_draw_as(f->arena, f->method, "resolution=64,distant=0", LOD_AUTO, TARGET_RGBA16F, scene,
                 lit, &view, &counters[0]);
    tree_draw_as(f->arena, f->method, "resolution=64,path=naive", LOD_AUTO, TARGET_RGBA16F, scene,
                 lit, &view, &counters[1]);
    assert_true(counters[0].draw_calls <= 8);
    assert_true(counters[1].draw_calls > 1000);
    assert_true(counters[1].triangles > 100000 && counters[0].triangles < 30000);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(
            test_shaded_texels__coverage_is_right_from_twelve_azimuths_and_three_elevations),
        cmocka_unit_test(test_shaded_texels__along_the_axes_the_outline_is_the_plants),
        cmocka_unit_test(test_shaded_texels__a_board_is_lit_by_the_closed_form),
        cmocka_unit_test(test_shaded_texels__normals_of_length_1_do_not_scatter),
        cmocka_unit_test(test_shaded_texels__light_follows_the_sun_as_the_reference_does),
        cmocka_unit_test(test_shaded_texels__fog_takes_what_the_law_of_beer_lambert_says),
        cmocka_unit_test(test_shaded_texels__fog_covers_no_more_than_the_slices),
        cmocka_unit_test(test_shaded_texels__naive_and_fast_draw_the_same_picture),
        cmocka_unit_test(test_shaded_texels__one_slice_and_five_hundred_and_twelve_are_drawn),
        cmocka_unit_test(test_shaded_texels__interpolated_slices_keep_the_opacity),
        cmocka_unit_test(test_shaded_texels__smooth_changes_do_not_jump),
        cmocka_unit_test(test_shaded_texels__a_nearer_tree_hides_a_farther_one),
        cmocka_unit_test(test_shaded_texels__trees_in_each_other_cover_as_in_the_reference),
        cmocka_unit_test(test_shaded_texels__an_eye_in_the_crown_sees_the_crown),
        cmocka_unit_test(test_shaded_texels__terrain_in_front_hides_and_behind_does_not),
        cmocka_unit_test(test_shaded_texels__eight_bits_do_not_darken),
        cmocka_unit_test(test_shaded_texels__a_thousand_trees_take_a_few_draw_calls),
    };
    return cmocka_run_group_tests_name("shaded-texels", tests, open_fixture, close_fixture);
}
