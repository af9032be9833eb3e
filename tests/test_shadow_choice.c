/* The choice of sun shadows inside methods: masks and pictures of each against the ray-traced ones,
 * of each kind of caster, under more than one sun. */
#include "level_ground.h"
#include "shadow_world.h"
#include "testing_tree.h"

#include "truth/mask.h"

enum { LEAVES = 500, TREES = 3 };
static const unsigned plain = EFFECT_TWO_SIDED | EFFECT_AMBIENT;
static const unsigned shadowed = EFFECT_TWO_SIDED | EFFECT_AMBIENT | EFFECT_SUN_SHADOWS;

/* Three trees that shade each other, on level ground. */
static struct scene *world_of(struct arena *arena, float azimuth_rad)
{
    struct plant *plant = plant_from_mesh(arena, "tree", tree_mesh(arena, LEAVES));
    struct scene *scene = tree_scene(arena, plant, TREES, azimuth_rad);
    static const float places[TREES][3] = {{-3, 0, 0}, {1.5f, 0, -2}, {3, 0, 2}};
    for (int i = 0; i < TREES; i++) {
        memcpy(scene->instances[i].position_m, places[i], sizeof places[i]);
        scene->instances[i].rotation_rad = 2.1f * (float)i;
        scene->instances[i].scale = 1 - 0.1f * (float)i;
    }
    scene->effects = shadowed;
    scene->tree_reach_m = 9;
    scene->camera.near_m = 25; /* the map is about as large as the picture */
    scene->camera.far_m = 60;
    scene->terrain = level_ground(arena, 200, 0.4f);
    return scene;
}

static struct view view_of(const struct scene *scene)
{
    return tree_view(scene, 0.4f, 0.8f, 40, 15);
}

static struct frame *traced(struct arena *arena, const struct scene *scene, unsigned effects,
                            bool masked)
{
    struct error error = {0};
    struct reference_options options = {.effects = effects,
                                        .samples_min = 32,
                                        .samples_max = 32,
                                        .threads = 2,
                                        .seed = 1,
                                        .quiet = true,
                                        .masked = masked};
    struct reference_stats stats;
    struct view view = view_of(scene);
    struct frame *frame;
    if (reference_render(arena, scene, &view, &options, &frame, &stats, &error) != STATUS_OK)
        fail_msg("%s", error.text);
    return frame;
}

/* The picture and the mask of a method. */
static void drawn(struct arena *arena, const char *method, const char *options,
                  const struct scene *scene, unsigned effects, struct frame **picture,
                  struct frame **mask)
{
    struct studio studio;
    struct view view = view_of(scene);
    studio_open(&studio, arena, tree_method(method), options, LOD_AUTO, scene, effects);
    *picture = studio_draw(&studio, &view);
    studio.workspace.masked = true;
    *mask = studio_draw(&studio, &view);
    studio_close(&studio);
}

/* Of the picture: as far from the traced one as so much of what a traced one without shadows is. */
static void test_shadow_choice__each_method_is_shaded_as_traced(void **state)
{
    (void)state;
    static const struct {
        const char *method, *options, *shadow;
        double wrong, share;
    } rows[] = {
        {"polygons", "samples=4", "map", 0.03, 0.08},
        {"polygons", "samples=16", "volume", 0.01, 0.04},
        {"polygons", "samples=4", "hybrid", 0.03, 0.08},
        {"billboards", "resolution=64,views=8", "map", 0.045, 0.2},
        {"billboards", "resolution=64,views=8", "volume", 0.055, 0.24},
        {"billboards", "resolution=64,views=8,alpha=coverage", "volume", 0.035, 0.2},
        {"billboards", "resolution=64,views=8,alpha=blend", "map", 0.04, 0.18},
        {"cross-quads", "resolution=64", "map", 0.045, 0.3},
        {"cross-quads", "resolution=64", "volume", 0.055, 0.3},
        {"texels", "resolution=32,slices=16", "map", 0.035, 0.155},
        {"shaded-texels", "resolution=32,slices=16", "map", 0.035, 0.13},
        {"jakulin", "resolution=32,slices=16", "map", 0.035, 0.13},
        {"ray-texels-gl", "resolution=64,shadows=64", NULL, 0.025, 0.16}, /* its own */
    };
    struct arena *arena = arena_create(0);
    struct error error = {0};
    struct scene *scene = world_of(arena, 1);
    struct frame *truth = traced(arena, scene, shadowed, false);
    struct frame *unshaded = traced(arena, scene, plain, false);
    struct frame *true_mask = traced(arena, scene, shadowed, true);
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        struct frame *picture, *drawn_mask;
        struct mask_error mask;
        const char *options = rows[i].shadow
                                  ? arena_printf(arena, "%s,shadow=%s,shadow_size=512,cascades=1",
                                                 rows[i].options, rows[i].shadow)
                                  : rows[i].options;
        drawn(arena, rows[i].method, options, scene, shadowed, &picture, &drawn_mask);
        if (mask_compare(drawn_mask, true_mask, &mask, &error) != STATUS_OK)
            fail_msg("%s: %s", rows[i].method, error.text);
        double share = boxes_apart(picture, truth) / boxes_apart(unshaded, truth);
        printf("# %s:%s: wrong %.4f (leak %.4f, acne %.4f), %.3f of the error without\n",
               rows[i].method, options, mask.wrong, mask.leak, mask.acne, share);
        if (!(mask.wrong < rows[i].wrong && share < rows[i].share))
            fail_msg("%s: wrong %g (leak %g, acne %g) of %g, error %g of that without shadows",
                     rows[i].method, mask.wrong, mask.leak, mask.acne, mask.dark, share);
    }
    arena_destroy(arena);
}

/* Under two suns, and of trees that are stretched; a picture of a tree from nearest to the sun errs
 * more than the tree. */
static void test_shadow_choice__every_kind_of_caster_shades_as_traced(void **state)
{
    (void)state;
    /* pictures cast where the map is not finer than they are */
    static const char *const casters[] = {"size=512,casters=exact", "size=512,casters=low",
                                          "size=256,casters=billboard",
                                          "size=1024,casters=billboard"};
    static const double wrong[] = {0.03, 0.03, 0.042, 0.024};
    static const float stretches[TREES] = {1.6f, 0.6f, 1.3f};
    struct arena *arena = arena_create(0);
    struct error error = {0};
    for (int sun = 0; sun < 3; sun++) {
        struct scene *scene = world_of(arena, 1 + 2.5f * (float)(sun % 2));
        for (int i = 0; i < TREES && sun == 2; i++)
            scene->instances[i].stretch = stretches[i];
        scene->tree_reach_m = sun == 2 ? 14 : 9;
        struct frame *true_mask = traced(arena, scene, shadowed, true);
        for (size_t i = 0; i < sizeof casters / sizeof *casters; i++) {
            struct frame *picture, *mask;
            struct mask_error errs;
            const char *options =
                arena_printf(arena, "cascades=1,samples=4,bias=normal,%s", casters[i]);
            drawn(arena, "shadow-map", options, scene, shadowed, &picture, &mask);
            if (mask_compare(mask, true_mask, &errs, &error) != STATUS_OK)
                fail_msg("%s: %s", casters[i], error.text);
            printf("# %s, sun %d: wrong %.4f of %.4f\n", casters[i], sun, errs.wrong, errs.dark);
            if (!(errs.wrong < wrong[i]))
                fail_msg("%s, sun %d: wrong %g (leak %g, acne %g) of %g", casters[i], sun,
                         errs.wrong, errs.leak, errs.acne, errs.dark);
        }
    }
    arena_destroy(arena);
}

/* Under a sun along the ground, at the zenith and in the picture: a volume a little behind what
 * casts it shades as one that stands at it, and so it does what is drawn at a lower level. */
static void test_shadow_choice__volumes_of_polygons_are_those_of_shadow_volume(void **state)
{
    (void)state;
    static const float elevations[] = {0, 0.6f, 1.5707963f};
    struct arena *arena = arena_create(0);
    for (size_t sun = 0; sun < sizeof elevations / sizeof *elevations; sun++) {
        struct scene *scene = world_of(arena, 3.5f);
        struct frame *pictures[4], *masks[4];
        scene->sun.elevation_rad = elevations[sun];
        scene->tree_reach_m = 9;
        drawn(arena, "shadow-volume", "samples=4", scene, shadowed, &pictures[0], &masks[0]);
        drawn(arena, "polygons", "samples=4,shadow=volume,error_px=0.1", scene, shadowed,
              &pictures[1], &masks[1]);
        drawn(arena, "polygons", "samples=4,shadow=volume,error_px=4", scene, shadowed,
              &pictures[2], &masks[2]);
        drawn(arena, "polygons", "samples=4,shadow=map,error_px=4", scene, shadowed, &pictures[3],
              &masks[3]);
        int apart = 0;
        for (size_t i = 0; i < 4 * TREE_PIXELS; i++)
            apart += i % 4 < 3 && fabsf(masks[0]->rgba[i] - masks[1]->rgba[i]) > 0.01f;
        double picture = boxes_apart(pictures[0], pictures[1]);
        double lit = tree_mean(masks[2], 0), more = lit - tree_mean(masks[3], 0);
        printf("# sun %zu: %d values of the mask differ, the picture by %.5f; of coarse leaves "
               "%.4f are lit, %.4f more than by a map\n",
               sun, apart, picture, lit, more);
        assert_true(apart < 15 && picture < 1e-3 && fabs(more) < 0.01);
    }
    arena_destroy(arena);
}

/* One line that says what, its value, and what is allowed. */
static void assert_refused(struct arena *arena, const struct scene *scene, const char *method,
                           const char *options, const char *line)
{
    struct error error = {0};
    struct studio studio = {.method = tree_method(method),
                            .workspace = {.arena = arena,
                                          .effects = shadowed,
                                          .format = TARGET_RGBA32F,
                                          .error = &error,
                                          .threads = 2}};
    void *values = arena_alloc(arena, 1, studio.method->options_size);
    options_default(studio.method->options, values);
    assert_int_equal(gl_context_create(NULL, 2, &studio.workspace.gl, &error), STATUS_OK);
    enum status status = options_parse(studio.method->options, options, values, &error);
    if (status == STATUS_OK)
        status = studio.method->prepare(&studio.workspace, scene, values, &studio.state);
    assert_int_not_equal(status, STATUS_OK);
    assert_string_equal(error.text, line);
    gl_context_destroy(studio.workspace.gl);
}

static void test_shadow_choice__what_volumes_cannot_shade_is_refused_in_a_line(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct scene *scene = world_of(arena, 1);
    assert_refused(arena, scene, "texels", "shadow=volume",
                   "shadow: 'volume' is not one of none|map");
    assert_refused(arena, scene, "billboards", "alpha=blend,shadow=volume",
                   "shadow=volume: with alpha=blend a pixel has many depths, volumes tell of one; "
                   "allowed: alpha=test or coverage, or shadow=none or map");
    scene->terrain.detail_px = 2;
    assert_refused(arena, scene, "polygons", "shadow=hybrid",
                   "terrain.detail_px: 2; allowed by shadow volumes: 0, every triangle is drawn "
                   "and casts");
    scene->terrain.detail_px = 0;
    scene->instances_count = 21; /* of 508 triangles */
    scene->instances = ARENA_ARRAY(arena, struct instance, scene->instances_count);
    for (size_t i = 0; i < scene->instances_count; i++)
        scene->instances[i].scale = scene->instances[i].stretch = 1;
    assert_refused(arena, scene, "cross-quads", "shadow=volume,triangles=10000",
                   "trees: 10668 triangles together; allowed: 10000, by option triangles");
    arena_destroy(arena);
}

/* A level square below the middle of a tree that is three times as high as its plant: a picture
 * whose depths were not stretched with it would have it nearer to the sun than it is, in its own
 * shadow. */
static void test_shadow_choice__a_stretched_picture_casts_from_as_far_as_its_tree(void **state)
{
    (void)state;
    static const float corners[2][3][3] = {{{-2, 1, -2}, {-2, 1, 2}, {2, 1, 2}},
                                           {{-2, 1, -2}, {2, 1, 2}, {2, 1, -2}}};
    static const char *const casters[] = {"exact", "billboard"};
    struct arena *arena = arena_create(0);
    struct error error = {0};
    struct mask_error errs[2];
    struct mesh *mesh = tree_mesh(arena, 2);
    for (int leaf = 0; leaf < 2; leaf++)
        for (int k = 0; k < 3; k++) {
            size_t at = 3 * (size_t)(8 + leaf) + (size_t)k;
            memcpy(mesh->positions[at], corners[leaf][k], sizeof corners[leaf][k]);
            memcpy(mesh->normals[at], (float[3]){0, 1, 0}, sizeof mesh->normals[at]);
        }
    mesh_bounds(mesh);
    struct scene *scene = world_of(arena, 1);
    scene->species->plant = plant_from_mesh(arena, "table", mesh);
    scene->instances_count = 1;
    scene->instances[0] = (struct instance){.scale = 0.6f, .stretch = 3};
    scene->sun.elevation_rad = 1;
    scene->camera.near_m = 5;
    scene->tree_reach_m = 40; /* a coarse map: its texels are larger than the picture's */
    struct frame *picture, *mask, *true_mask = traced(arena, scene, shadowed, true);
    for (int i = 0; i < 2; i++) {
        drawn(arena, "shadow-map",
              arena_printf(arena, "size=256,samples=4,bias=normal,casters=%s", casters[i]), scene,
              shadowed, &picture, &mask);
        if (mask_compare(mask, true_mask, &errs[i], &error) != STATUS_OK)
            fail_msg("%s: %s", casters[i], error.text);
        printf("# %s: wrong %.4f (leak %.4f, acne %.4f) of %.4f\n", casters[i], errs[i].wrong,
               errs[i].leak, errs[i].acne, errs[i].dark);
    }
    assert_true(errs[1].acne < errs[0].acne + 0.005 && errs[1].wrong < errs[0].wrong + 0.01);
    arena_destroy(arena);
}

static void test_shadow_choice__none_draws_the_same_whether_shadows_are_wanted_or_not(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct scene *scene = world_of(arena, 1);
    static const char *const methods[][2] = {{"polygons", ""},
                                             {"billboards", "resolution=32,views=4"},
                                             {"shaded-texels", "resolution=16,slices=8"},
                                             {"ray-texels-gl", "resolution=16"}};
    for (size_t i = 0; i < sizeof methods / sizeof *methods; i++) {
        struct frame *pictures[2], *mask;
        for (int wanted = 0; wanted < 2; wanted++)
            drawn(arena, methods[i][0], methods[i][1], scene, wanted ? shadowed : plain,
                  &pictures[wanted], &mask);
        assert_memory_equal(pictures[0]->rgba, pictures[1]->rgba, 4 * sizeof(float) * TREE_PIXELS);
    }
    arena_destroy(arena);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_shadow_choice__each_method_is_shaded_as_traced),
        cmocka_unit_test(test_shadow_choice__every_kind_of_caster_shades_as_traced),
        cmocka_unit_test(test_shadow_choice__volumes_of_polygons_are_those_of_shadow_volume),
        cmocka_unit_test(test_shadow_choice__what_volumes_cannot_shade_is_refused_in_a_line),
        cmocka_unit_test(test_shadow_choice__a_stretched_picture_casts_from_as_far_as_its_tree),
        cmocka_unit_test(test_shadow_choice__none_draws_the_same_whether_shadows_are_wanted_or_not),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
