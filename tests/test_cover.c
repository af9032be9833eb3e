/* What far trees cover at an automatic level of detail, against the ray-traced reference. */
#include "pictures.h"

#include "base/random.h"
#include "truth/reference.h"

#include <math.h>

enum { SIDE_PX = 256, TREES = 4000 };
static const float DISTANCE_M = 20000;

/* Trees at random places in a cube that is SIDE_PX wide where a plant is 3 px high, so that they
 * stand apart from wherever they are seen. */
static struct scene *scatter(struct arena *arena, const struct mesh *mesh)
{
    struct scene *scene = scene_by_hand(arena, SIDE_PX, SIDE_PX);
    struct random random = random_seed(5, 5);
    float side_m = SIDE_PX / 3.0f * mesh->maximum_m[1];
    scene_plant(arena, scene, mesh, TREES);
    for (int i = 0; i < TREES; i++) {
        for (int axis = 0; axis < 3; axis++)
            scene->instances[i].position_m[axis] = side_m * (random_float(&random) - 0.5f);
        scene->instances[i].rotation_rad = 6.2831853f * random_float(&random);
    }
    scene->camera.near_m = 10;
    scene->camera.far_m = 1e5f;
    return scene;
}

static double mean_alpha(const float *rgba)
{
    double sum = 0;
    for (size_t i = 0; i < SIDE_PX * SIDE_PX; i++)
        sum += rgba[4 * i + 3];
    return sum / (SIDE_PX * SIDE_PX);
}

static double reference_cover(struct arena *arena, const struct scene *scene,
                              const struct view *view)
{
    struct reference_options options = {.samples_min = 32, .samples_max = 32, .quiet = true};
    struct reference_stats stats;
    struct frame *frame;
    struct error error = {0};
    if (reference_render(arena, scene, view, &options, &frame, &stats, &error) != STATUS_OK)
        fail_msg("%s", error.text);
    return mean_alpha(frame->rgba);
}

/* Prepared once, as that takes longest, and drawn from every side. */
struct drawer {
    struct workspace workspace;
    struct error error;
    const struct method *method;
    struct target target;
    void *state;
};

static void prepare_drawer(struct drawer *drawer, struct arena *arena, const struct scene *scene)
{
    struct gl *gl;
    assert_int_equal(method_find("polygons", &drawer->method, &drawer->error), STATUS_OK);
    if (gl_context_create(NULL, 2, &gl, &drawer->error) != STATUS_OK)
        fail_msg("%s", drawer->error.text);
    drawer->workspace = (struct workspace){.arena = arena,
                                           .gl = gl,
                                           .error = &drawer->error,
                                           .lod = LOD_AUTO,
                                           .format = TARGET_RGBA32F,
                                           .threads = 2,
                                           .seed = 1};
    void *options = arena_alloc(arena, 1, drawer->method->options_size);
    options_default(drawer->method->options, options);
    if (options_parse(drawer->method->options, "samples=16", options, &drawer->error) !=
            STATUS_OK ||
        gl_target(gl, SIDE_PX, SIDE_PX, TARGET_RGBA32F, &drawer->target, &drawer->error) !=
            STATUS_OK ||
        drawer->method->prepare(&drawer->workspace, scene, options, &drawer->state) != STATUS_OK)
        fail_msg("%s", drawer->error.text);
}

static double drawn_cover(struct drawer *drawer, struct arena *arena, const struct view *view)
{
    float *rgba = ARENA_ARRAY(arena, float, 4 * SIDE_PX * SIDE_PX);
    if (drawer->method->draw(&drawer->workspace, drawer->state, view, &drawer->target) != STATUS_OK)
        fail_msg("%s", drawer->error.text);
    gl_target_read(drawer->workspace.gl, &drawer->target, rgba);
    return mean_alpha(rgba);
}

/* Level, obliquely and from above; 3 and 12 px high. The chance of a few elements a tree leaves a
 * standard error of about 0.01. */
static void compare_cover(const char *generator)
{
    static const float elevations_rad[] = {0, 0.35f, 0.8f, 1.57f}, heights_px[] = {3, 12};
    struct arena *arena = arena_create(0);
    struct error error;
    struct plant *plant;
    const struct mesh *mesh;
    struct drawer drawer;
    if (plant_generated(arena, generator, NULL, &plant, &error) != STATUS_OK ||
        plant_mesh(plant, &mesh, &error) != STATUS_OK)
        fail_msg("%s", error.text);
    struct scene *scene = scatter(arena, mesh);
    prepare_drawer(&drawer, arena, scene);
    for (int k = 0; k < 8; k++) {
        float elevation = elevations_rad[k / 2], height_px = heights_px[k % 2];
        float eye[3] = {0, DISTANCE_M * sinf(elevation), DISTANCE_M * cosf(elevation)};
        struct view view;
        scene->camera.fov_y_rad =
            2 * atanf(0.5f * SIDE_PX * mesh->maximum_m[1] / (height_px * DISTANCE_M));
        view_look_at(scene, eye, (float[3]){0, 0, 0}, &view);
        double exact = reference_cover(arena, scene, &view);
        double drawn = drawn_cover(&drawer, arena, &view);
        if (!(exact > 1e-3 && fabs(drawn / exact - 1) < 0.035))
            fail_msg("%s of %g px from %g rad above: %g, not %g", generator, (double)height_px,
                     (double)elevation, drawn, exact);
    }
    gl_context_destroy(drawer.workspace.gl);
    arena_destroy(arena);
}

static void test_cover__far_poplars_cover_what_the_reference_says_from_every_side(void **state)
{
    (void)state;
    compare_cover("poplar");
}

static void test_cover__far_oaks_cover_what_the_reference_says_from_every_side(void **state)
{
    (void)state;
    compare_cover("oak");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_cover__far_poplars_cover_what_the_reference_says_from_every_side),
        cmocka_unit_test(test_cover__far_oaks_cover_what_the_reference_says_from_every_side),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
