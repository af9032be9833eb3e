/* What methods with OpenGL tell of their own work: texels against the driver's count of fragments,
 * a march's lookups against the march on the CPU; and nothing outside of counted draws. */
#include "testing_tree.h"

/* What a plain draw says, and the fragments that the driver shaded; and a counted one. */
struct count {
    struct method_tally plain, tally;
    uint64_t fragments;
};

/* Sixteen lopsided trees on a grid, each turned and of a size of its own. */
static struct scene *grove(struct arena *arena, struct view *view)
{
    struct plant *plant = plant_from_mesh(arena, "lopsided", tree_mesh(arena, 300));
    struct scene *scene = tree_scene(arena, plant, 16, 1);
    for (size_t i = 0; i < 16; i++) {
        struct instance *instance = &scene->instances[i];
        instance->position_m[0] = 7 * (float)(i % 4) - 10;
        instance->position_m[2] = 7 * (float)(i / 4) - 10;
        instance->rotation_rad = (float)i;
        instance->scale = 0.8f + 0.03f * (float)i;
    }
    setenv("TREELINE_CACHE", "off", 1);
    view_look_at(scene, (float[3]){6, 12, 40}, (float[3]){0, 4, 0}, view);
    return scene;
}

static struct count count_draws(const char *name, const char *options, const struct scene *scene,
                                const struct view *view)
{
    struct arena *arena = arena_create(0);
    const struct method *method;
    struct error error = {0};
    struct count count = {0};
    struct gl *gl = NULL;
    struct target target = {
        .width_px = TREE_WIDTH, .height_px = TREE_HEIGHT, .format = TARGET_RGBA16F};
    void *state = NULL;
    if (method_find(name, &method, &error))
        fail_msg("%s", error.text);
    if (method->traits & TRAIT_CPU)
        target.pixels = ARENA_ARRAY(arena, float, (size_t)4 * TREE_WIDTH * TREE_HEIGHT);
    else if (gl_context_create(NULL, 2, &gl, &error) ||
             gl_target(gl, TREE_WIDTH, TREE_HEIGHT, TARGET_RGBA16F, &target, &error))
        fail_msg("%s", error.text);
    struct workspace workspace = {.arena = arena,
                                  .gl = gl,
                                  .error = &error,
                                  .lod = LOD_HIGH,
                                  .effects = method->traits & EFFECT_TWO_SIDED,
                                  .format = TARGET_RGBA16F,
                                  .threads = 2,
                                  .seed = 1};
    void *values = arena_alloc(arena, 1, method->options_size + 1);
    if (method->options)
        options_default(method->options, values);
    if ((method->options && options_parse(method->options, options, values, &error)) ||
        method->prepare(&workspace, scene, values, &state))
        fail_msg("%s: %s", name, error.text);
    for (int counted = 0; counted < 2; counted++) {
        const struct method_tally before = workspace.tally;
        workspace.counted = counted;
        if (gl && !counted)
            gl_statistics_begin(gl);
        if (method->draw(&workspace, state, view, &target))
            fail_msg("%s: %s", name, error.text);
        if (gl && !counted)
            count.fragments = gl_statistics_end(gl).fragments;
        struct method_tally *tally = counted ? &count.tally : &count.plain;
        tally->samples = workspace.tally.samples - before.samples;
        tally->lookups = workspace.tally.lookups - before.lookups;
    }
    if (gl && gl_check(gl, name, &error))
        fail_msg("%s", error.text);
    if (gl)
        gl_context_destroy(gl);
    arena_destroy(arena);
    return count;
}

static void test_tally__texels_are_those_of_every_fragment_of_a_tree(void **unused)
{
    (void)unused;
    static const struct {
        const char *method, *options;
        uint64_t samples, lookups; /* a fragment */
    } cases[] = {
        {"texels", "resolution=16", 1, 0},
        {"shaded-texels", "resolution=16", 2, 0},
        {"billboards", "near=0,resolution=16", 2, 0},
        {"billboards", "near=0,resolution=16,pick=blended", 4, 0},
        {"cross-quads", "near=0,resolution=16,filter=nearest", 0, 2},
    };
    struct arena *arena = arena_create(0);
    struct view view;
    struct scene *scene = grove(arena, &view);
    uint64_t ground = count_draws("null", "", scene, &view).fragments;
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        struct count count = count_draws(cases[k].method, cases[k].options, scene, &view);
        uint64_t fragments = count.fragments - ground;
        assert_true(fragments > 100);
        if (count.tally.samples != cases[k].samples * fragments ||
            count.tally.lookups != cases[k].lookups * fragments)
            fail_msg("%s:%s: %llu samples, %llu lookups of %llu fragments", cases[k].method,
                     cases[k].options, (unsigned long long)count.tally.samples,
                     (unsigned long long)count.tally.lookups, (unsigned long long)fragments);
        if (count.plain.samples || count.plain.lookups)
            fail_msg("%s counts where nobody asked", cases[k].method);
    }
    arena_destroy(arena);
}

/* Both walk the same voxels by the same steps, and leap over empty ones by what lies ahead; trees
 * about as small as a pixel have looks of their own in each, and a ray on the CPU goes on for some
 * steps until it is known that it is closed. */
static void test_tally__a_march_by_opengl_looks_up_what_the_cpu_s_does(void **unused)
{
    (void)unused;
    static const char *const options[] = {"resolution=32,step=1", "resolution=64,step=0.5"};
    for (size_t k = 0; k < sizeof options / sizeof *options; k++) {
        struct arena *arena = arena_create(0);
        struct view view;
        struct scene *scene = grove(arena, &view);
        struct count cpu = count_draws("ray-texels", options[k], scene, &view);
        struct count gl = count_draws("ray-texels-gl", options[k], scene, &view);
        double ratio = (double)gl.tally.lookups / (double)cpu.tally.lookups;
        if (!(ratio > 0.9 && ratio < 1.01))
            fail_msg("%s: %llu lookups by OpenGL, %llu by the CPU", options[k],
                     (unsigned long long)gl.tally.lookups, (unsigned long long)cpu.tally.lookups);
        assert_true(gl.plain.lookups == 0 && cpu.plain.lookups == cpu.tally.lookups);
        arena_destroy(arena);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_tally__texels_are_those_of_every_fragment_of_a_tree),
        cmocka_unit_test(test_tally__a_march_by_opengl_looks_up_what_the_cpu_s_does),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
