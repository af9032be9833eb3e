/* The contract, run on every registered method: what method.h promises holds for each of them. */
#include "testing.h"

#include "method/method.h"
#include "truth/frame.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* One method prepared on one scene, alone in its context, as a cell has it. */
struct stage {
    struct arena *arena;
    struct error error;
    struct workspace workspace;
    struct scene *scene;
    struct target target;
    const struct method *method;
    void *state;
};

static void must(enum status status, const struct stage *stage, const char *what)
{
    if (status != STATUS_OK)
        fail_msg("%s: %s: %s: %s", stage->method->name, what, status_word(status),
                 stage->error.text);
}

static void stage_open(struct stage *stage, const struct method *method, size_t trees, int width_px,
                       int height_px, enum target_format format, unsigned effects_wanted)
{
    *stage = (struct stage){.arena = arena_create(0), .method = method};
    struct scene_request request = {
        .trees = trees, .seed = 1, .width_px = width_px, .height_px = height_px};
    must(scene_load(stage->arena, "tiny", &request, &stage->scene, &stage->error), stage, "scene");
    stage->scene->fog.density_per_m = 0.01f; /* the scene itself asks for none */
    struct gl *gl = NULL;
    if (!(method->traits & TRAIT_CPU))
        must(gl_context_create(NULL, 2, &gl, &stage->error), stage, "context");
    stage->workspace = (struct workspace){
        .arena = stage->arena,
        .gl = gl,
        .error = &stage->error,
        .effects = effects_wanted & method->traits,
        .lod = LOD_HIGH,
        .format = format,
        .threads = 2,
        .seed = 1,
    };
    if (gl)
        must(gl_target(gl, width_px, height_px, format, &stage->target, &stage->error), stage,
             "target");
    else
        stage->target = (struct target){
            .width_px = width_px,
            .height_px = height_px,
            .format = format,
            .pixels = ARENA_ARRAY(stage->arena, float, (size_t)width_px *height_px * 4)};
    void *options = arena_alloc(stage->arena, 1, method->options_size);
    options_default(method->options, options);
    const char *reason = "";
    if (method->supported)
        must(method->supported(stage->scene, &reason), stage, reason);
    must(method->prepare(&stage->workspace, stage->scene, options, &stage->state), stage,
         "prepare");
}

static void stage_close(struct stage *stage)
{
    gl_context_destroy(stage->workspace.gl);
    arena_destroy(stage->arena);
}

/* Draws over a target full of 77 and reads it: width x height x 4, malloced. */
static float *stage_draw(struct stage *stage, const struct view *view)
{
    struct gl *gl = stage->workspace.gl;
    size_t count = (size_t)stage->target.width_px * (size_t)stage->target.height_px * 4;
    float *rgba = malloc(count * sizeof *rgba);
    if (gl) {
        gl->BindFramebuffer(GL_FRAMEBUFFER, stage->target.framebuffer);
        gl->ClearColor(77, 77, 77, 77);
        gl->Clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    } else {
        for (size_t i = 0; i < count; i++)
            stage->target.pixels[i] = 77;
    }
    must(stage->method->draw(&stage->workspace, stage->state, view, &stage->target), stage, "draw");
    if (gl) {
        must(gl_check(gl, "after draw", &stage->error), stage, "gl");
        gl_target_read(gl, &stage->target, rgba);
    } else {
        memcpy(rgba, stage->target.pixels, count * sizeof *rgba);
    }
    return rgba;
}

static float *draw_once(const struct method *method, size_t trees, int width_px, int height_px,
                        enum target_format format, unsigned effects, const float *sun)
{
    struct stage stage;
    struct view view;
    stage_open(&stage, method, trees, width_px, height_px, format, effects);
    view_at(stage.scene, 0, &view);
    if (sun)
        memcpy(view.sun_direction, sun, sizeof view.sun_direction);
    float *rgba = stage_draw(&stage, &view);
    stage_close(&stage);
    return rgba;
}

static double coverage(const float *rgba, size_t pixels)
{
    double sum = 0;
    for (size_t i = 0; i < pixels; i++)
        sum += rgba[4 * i + 3];
    return sum / (double)pixels;
}

enum { WIDTH = 80, HEIGHT = 60, PIXELS = WIDTH * HEIGHT, BYTES = PIXELS * 4 * sizeof(float) };
static const float low_sun[3] = {0.6f, 0.48f, -0.64f};

static bool is_null(const struct method *method)
{
    return strcmp(method->name, "null") == 0;
}

#define EACH_METHOD(m) for (const struct method *const *m = methods_builtin; *m; m++)

static void test_methods__each_is_fully_described(void **unused)
{
    (void)unused;
    const char *last = "";
    EACH_METHOD(m)
    {
        const struct method *method = *m, *found;
        assert_int_equal(method->abi, METHOD_ABI);
        assert_true(strlen(method->summary) > 10 && strlen(method->source) > 5);
        assert_true(method->prepare && method->draw);
        assert_true(strcmp(last, method->name) < 0);
        last = method->name;
        assert_int_equal(method_find(method->name, &found, NULL), STATUS_OK);
        assert_ptr_equal(found, method);
        for (const struct option *option = method->options; option && option->name; option++) {
            assert_true(strlen(option->doc) > 3 && option->unit);
            assert_true(option->offset < method->options_size);
            if (option->type != OPTION_CHOICE)
                assert_true(option->minimum <= option->fallback &&
                            option->fallback <= option->maximum);
        }
    }
    struct error error;
    const struct method *found;
    assert_int_equal(method_find("bilboards", &found, &error), STATUS_NOT_FOUND);
    assert_non_null(strstr(error.text, "did you mean 'billboards'"));
}

static void test_methods__every_pixel_is_drawn_and_valid_in_every_format(void **unused)
{
    (void)unused;
    EACH_METHOD(m)
    for (enum target_format format = TARGET_RGBA8; format <= TARGET_RGBA32F; format++) {
        float *rgba = draw_once(*m, 3, WIDTH, HEIGHT, format, EFFECTS_ALL, NULL);
        for (size_t i = 0; i < PIXELS * 4; i++)
            if (!(rgba[i] >= -1e-4f && rgba[i] < 50) || (i % 4 == 3 && rgba[i] > 1.001f))
                fail_msg("%s: value %zu of pixel %zu is %g", (*m)->name, i % 4, i / 4, rgba[i]);
        double share = coverage(rgba, PIXELS);
        if (is_null(*m) ? share != 0 : share < 0.005)
            fail_msg("%s: coverage is %g", (*m)->name, share);
        free(rgba);
    }
}

static void test_methods__the_same_cell_gives_the_same_bytes(void **unused)
{
    (void)unused;
    EACH_METHOD(m)
    {
        float *a = draw_once(*m, 3, WIDTH, HEIGHT, TARGET_RGBA16F, EFFECTS_ALL, NULL);
        float *b = draw_once(*m, 3, WIDTH, HEIGHT, TARGET_RGBA16F, EFFECTS_ALL, NULL);
        assert_memory_equal(a, b, BYTES);
        free(a);
        free(b);
    }
}

static void test_methods__an_empty_scene_is_the_backdrop_alone(void **unused)
{
    (void)unused;
    const struct method *null;
    assert_int_equal(method_find("null", &null, NULL), STATUS_OK);
    float *floor = draw_once(null, 0, WIDTH, HEIGHT, TARGET_RGBA32F, EFFECT_AMBIENT, NULL);
    EACH_METHOD(m)
    {
        float *rgba = draw_once(*m, 0, WIDTH, HEIGHT, TARGET_RGBA32F, EFFECT_AMBIENT, NULL);
        for (size_t i = 0; i < PIXELS * 4; i++)
            if (fabsf(rgba[i] - floor[i]) > 1e-3f)
                fail_msg("%s: pixel %zu: %g, backdrop %g", (*m)->name, i / 4, rgba[i], floor[i]);
        free(rgba);
    }
    free(floor);
}

static void test_methods__one_pixel_and_odd_sizes_are_drawn(void **unused)
{
    (void)unused;
    static const int sizes[][2] = {{1, 1}, {17, 1}, {1, 23}, {33, 47}};
    EACH_METHOD(m)
    for (size_t k = 0; k < 4; k++) {
        float *rgba = draw_once(*m, 1, sizes[k][0], sizes[k][1], TARGET_RGBA16F, EFFECTS_ALL, NULL);
        for (int i = 0; i < sizes[k][0] * sizes[k][1] * 4; i++)
            assert_true(isfinite(rgba[i]) && rgba[i] < 50);
        free(rgba);
    }
}

static void test_methods__drawing_leaves_nothing_behind(void **unused)
{
    (void)unused;
    EACH_METHOD(m)
    {
        struct stage stage;
        struct view view, other;
        stage_open(&stage, *m, 3, WIDTH, HEIGHT, TARGET_RGBA16F, EFFECTS_ALL);
        view_at(stage.scene, 0, &view);
        view_at(stage.scene, 0, &other);
        memcpy(other.sun_direction, low_sun, sizeof low_sun);
        float *first = stage_draw(&stage, &view);
        float *between = stage_draw(&stage, &other);
        float *again = stage_draw(&stage, &view);
        assert_memory_equal(first, again, BYTES);
        free(first);
        free(between);
        free(again);
        stage_close(&stage);
    }
}

static void test_methods__a_moved_sun_relights_as_if_it_had_always_stood_there(void **unused)
{
    (void)unused;
    EACH_METHOD(m)
    {
        struct stage stage;
        struct view view;
        stage_open(&stage, *m, 3, WIDTH, HEIGHT, TARGET_RGBA32F, EFFECTS_ALL);
        view_at(stage.scene, 0, &view);
        float *before = stage_draw(&stage, &view);
        memcpy(view.sun_direction, low_sun, sizeof low_sun);
        float *moved = stage_draw(&stage, &view);
        float *fresh = draw_once(*m, 3, WIDTH, HEIGHT, TARGET_RGBA32F, EFFECTS_ALL, low_sun);
        double worst = 0, change = 0;
        for (size_t i = 0; i < PIXELS * 4; i++) {
            worst = fmax(worst, fabs((double)moved[i] - fresh[i]));
            if (before[i / 4 * 4 + 3] > 0.5f)
                change = fmax(change, fabs((double)moved[i] - before[i]));
        }
        if (worst > 1e-4)
            fail_msg("%s: differs from a fresh start by %g", (*m)->name, worst);
        if (!is_null(*m) && change < 0.01)
            fail_msg("%s: trees do not follow the sun", (*m)->name);
        free(before);
        free(moved);
        free(fresh);
        stage_close(&stage);
    }
}

static void test_methods__a_claimed_effect_acts(void **unused)
{
    (void)unused;
    static const struct {
        unsigned effect;
        const char *word;
    } effects[] = {
#define EFFECT_ROW(name, bit, word, meaning) {name, word},
        EFFECT_LIST(EFFECT_ROW)
#undef EFFECT_ROW
    };
    EACH_METHOD(m)
    for (size_t e = 0; e < sizeof effects / sizeof effects[0]; e++) {
        if (!((*m)->traits & effects[e].effect) || is_null(*m))
            continue;
        unsigned rest = EFFECTS_ALL & ~effects[e].effect;
        float *with = draw_once(*m, 3, WIDTH, HEIGHT, TARGET_RGBA32F, EFFECTS_ALL, low_sun);
        float *without = draw_once(*m, 3, WIDTH, HEIGHT, TARGET_RGBA32F, rest, low_sun);
        double change = 0;
        for (size_t i = 0; i < PIXELS * 4; i++)
            if (with[i / 4 * 4 + 3] > 0.5f)
                change = fmax(change, fabs((double)with[i] - without[i]));
        if (change < 1e-3)
            fail_msg("%s: claims %s, which changes nothing", (*m)->name, effects[e].word);
        free(with);
        free(without);
    }
}

static void test_methods__device_memory_is_declared(void **unused)
{
    (void)unused;
    EACH_METHOD(m)
    {
        struct stage stage;
        struct view view;
        stage_open(&stage, *m, 3, WIDTH, HEIGHT, TARGET_RGBA16F, EFFECTS_ALL);
        view_at(stage.scene, 0, &view);
        free(stage_draw(&stage, &view));
        if (stage.workspace.gl) {
            size_t target_bytes = PIXELS * (8 + 4);
            assert_true(gl_device_bytes(stage.workspace.gl) >=
                        target_bytes + (is_null(*m) ? 0 : 1000));
            size_t before = gl_device_bytes(stage.workspace.gl);
            free(stage_draw(&stage, &view));
            assert_int_equal(gl_device_bytes(stage.workspace.gl),
                             before); /* a still frame leaks nothing */
        }
        stage_close(&stage);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_methods__each_is_fully_described),
        cmocka_unit_test(test_methods__every_pixel_is_drawn_and_valid_in_every_format),
        cmocka_unit_test(test_methods__the_same_cell_gives_the_same_bytes),
        cmocka_unit_test(test_methods__an_empty_scene_is_the_backdrop_alone),
        cmocka_unit_test(test_methods__one_pixel_and_odd_sizes_are_drawn),
        cmocka_unit_test(test_methods__drawing_leaves_nothing_behind),
        cmocka_unit_test(test_methods__a_moved_sun_relights_as_if_it_had_always_stood_there),
        cmocka_unit_test(test_methods__a_claimed_effect_acts),
        cmocka_unit_test(test_methods__device_memory_is_declared),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
