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
        const char *method, *options;
        double wrong, share;
    } rows[] = {
        {"polygons", "samples=4", 0.03, 0.08},
        {"billboards", "resolution=64,views=8", 0.045, 0.2},
        {"billboards", "resolution=64,views=8,alpha=blend", 0.04, 0.18},
        {"cross-quads", "resolution=64", 0.045, 0.3},
        {"texels", "resolution=32,slices=16", 0.035, 0.155},
        {"shaded-texels", "resolution=32,slices=16", 0.035, 0.13},
        {"jakulin", "resolution=32,slices=16", 0.035, 0.13},
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
        const char *options =
            arena_printf(arena, "%s,shadow=map,shadow_size=512,cascades=1", rows[i].options);
        drawn(arena, rows[i].method, options, scene, shadowed, &picture, &drawn_mask);
        if (mask_compare(drawn_mask, true_mask, &mask, &error) != STATUS_OK)
            fail_msg("%s: %s", rows[i].method, error.text);
        double share = boxes_apart(picture, truth) / boxes_apart(unshaded, truth);
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
    static const char *const casters[] = {"exact", "low", "billboard"};
    static const double wrong[] = {0.03, 0.03, 0.042};
    static const float stretches[TREES] = {1.6f, 0.6f, 1.3f};
    struct arena *arena = arena_create(0);
    struct error error = {0};
    for (int sun = 0; sun < 3; sun++) {
        struct scene *scene = world_of(arena, 1 + 2.5f * (float)(sun % 2));
        for (int i = 0; i < TREES && sun == 2; i++)
            scene->instances[i].stretch = stretches[i];
        scene->tree_reach_m = sun == 2 ? 14 : 9;
        struct frame *true_mask = traced(arena, scene, shadowed, true);
        for (int i = 0; i < 3; i++) {
            struct frame *picture, *mask;
            struct mask_error errs;
            const char *options = arena_printf(
                arena, "size=512,cascades=1,samples=4,bias=normal,casters=%s", casters[i]);
            drawn(arena, "shadow-map", options, scene, shadowed, &picture, &mask);
            if (mask_compare(mask, true_mask, &errs, &error) != STATUS_OK)
                fail_msg("%s: %s", casters[i], error.text);
            printf("# casters %s, sun %d: wrong %.4f of %.4f\n", casters[i], sun, errs.wrong,
                   errs.dark);
            if (!(errs.wrong < wrong[i]))
                fail_msg("%s, sun %d: wrong %g (leak %g, acne %g) of %g", casters[i], sun,
                         errs.wrong, errs.leak, errs.acne, errs.dark);
        }
    }
    arena_destroy(arena);
}

static void test_shadow_choice__none_draws_the_same_whether_shadows_are_wanted_or_not(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct scene *scene = world_of(arena, 1);
    static const char *const methods[][2] = {{"polygons", ""},
                                             {"billboards", "resolution=32,views=4"},
                                             {"shaded-texels", "resolution=16,slices=8"}};
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
        cmocka_unit_test(test_shadow_choice__none_draws_the_same_whether_shadows_are_wanted_or_not),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
