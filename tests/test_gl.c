/* The OpenGL wall: every back end of this build, against closed forms and against each other. */
#include "testing.h"

#include "base/hash.h"
#include "wall/gl.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { SIDE = 64 };

/* A triangle over the whole target; SHADE is the fragment shader's main(). */
#define FULL_SCREEN(SHADE)                                                                         \
    "#pragma stage vertex\n"                                                                       \
    "void main()\n"                                                                                \
    "{\n"                                                                                          \
    "    gl_Position = vec4(gl_VertexID == 1 ? 3 : -1, gl_VertexID == 2 ? 3 : -1, 0.5, 1);\n"      \
    "}\n"                                                                                          \
    "#pragma stage fragment\n"                                                                     \
    "layout(location = 0) out vec4 color;\n"                                                       \
    "void main()\n"                                                                                \
    "{\n" SHADE "}\n"

struct rig {
    struct gl *gl;
    struct target target;
    GLuint program;
    struct error error;
    float rgba[SIDE * SIDE * 4];
};

/* Opens a back end; false when this machine has none of the kind. */
static bool rig_open(struct rig *rig, const char *backend, enum target_format format)
{
    *rig = (struct rig){0};
    if (gl_context_create(backend, 2, &rig->gl, &rig->error) != STATUS_OK) {
        assert_int_equal(rig->error.status, STATUS_UNAVAILABLE);
        assert_non_null(strstr(rig->error.text, backend));
        print_message("[          ] %s\n", rig->error.text);
        return false;
    }
    assert_int_equal(gl_target(rig->gl, SIDE, SIDE, format, &rig->target, &rig->error), STATUS_OK);
    return true;
}

/* Compiles, binds and prepares for drawing the full-screen triangle. */
static void rig_program(struct rig *rig, const char *source)
{
    struct gl *gl = rig->gl;
    enum status status = gl_program(gl, "test", source, NULL, &rig->program, &rig->error);
    if (status != STATUS_OK)
        fail_msg("%s", rig->error.text);
    gl->UseProgram(rig->program);
    gl->BindVertexArray(gl_vertex_array(gl));
    gl->BindFramebuffer(GL_FRAMEBUFFER, rig->target.framebuffer);
    gl->Viewport(0, 0, rig->target.width_px, rig->target.height_px);
    gl->ClearColor(0, 0, 0, 0);
    gl->Clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
}

static void rig_draw(struct rig *rig)
{
    gl_draw_arrays(rig->gl, GL_TRIANGLES, 0, 3, 1);
    gl_target_read(rig->gl, &rig->target, rig->rgba);
    assert_int_equal(gl_check(rig->gl, "test", &rig->error), STATUS_OK);
}

static void uniform3(struct rig *rig, const char *name, float x, float y, float z)
{
    rig->gl->Uniform3f(gl_uniform(rig->gl, rig->program, name), x, y, z);
}

#define EACH_BACKEND(rig, format)                                                                  \
    for (size_t backend_ = 0; gl_backends[backend_]; backend_++)                                   \
        if (rig_open(rig, gl_backends[backend_], format))                                          \
            for (bool open_ = true; open_; open_ = false, gl_context_destroy((rig)->gl))

static void test_gl__a_back_end_opens_a_core_4_5_context(void **state)
{
    (void)state;
    struct rig *rig = calloc(1, sizeof *rig);
    size_t opened = 0;
    EACH_BACKEND(rig, TARGET_RGBA8)
    {
        GLint major = 0, minor = 0, profile = 0;
        struct gl *gl = rig->gl;
        gl->GetIntegerv(GL_MAJOR_VERSION, &major);
        gl->GetIntegerv(GL_MINOR_VERSION, &minor);
        gl->GetIntegerv(GL_CONTEXT_PROFILE_MASK, &profile);
        assert_true(major * 10 + minor >= 45);
        assert_true(profile & GL_CONTEXT_CORE_PROFILE_BIT);
        assert_true(*gl->renderer && *gl->vendor && *gl->version);
        assert_true(gl->samples_max >= 4);
        assert_string_equal(gl->backend, gl_backends[backend_]);
        opened++;
    }
    assert_true(opened > 0);
    free(rig);
}

static void test_gl__a_probe_finds_a_back_end_and_the_environment_chooses_one(void **state)
{
    (void)state;
    struct gl *gl;
    struct error error;
    unsetenv("TREELINE_GL");
    assert_int_equal(gl_context_create(NULL, 2, &gl, &error), STATUS_OK);
    gl_context_destroy(gl);
    setenv("TREELINE_GL", "vulkan", 1);
    assert_int_equal(gl_context_create(NULL, 2, &gl, &error), STATUS_INVALID);
    assert_null(gl);
    assert_non_null(strstr(error.text, "TREELINE_GL: 'vulkan' is not one of"));
    assert_non_null(strstr(error.text, gl_backends[0]));
    unsetenv("TREELINE_GL");
    assert_int_equal(gl_context_create("", 2, &gl, &error), STATUS_INVALID);
    gl_context_destroy(NULL);
}

/* C = a (sun max(0, N.L) + ambient) with N of a unit sphere seen along -z. */
static void test_gl__a_lambert_sphere_has_the_closed_form_in_every_pixel(void **state)
{
    (void)state;
    static const double sun[3] = {0.48, 0.6, 0.64}, radiance[3] = {1.5, 1.0, 0.5};
    static const double albedo[3] = {0.2, 0.5, 0.8}, ambient = 0.25;
    struct rig *rig = calloc(1, sizeof *rig);
    EACH_BACKEND(rig, TARGET_RGBA32F)
    {
        rig_program(
            rig, FULL_SCREEN("    vec2 p = gl_FragCoord.xy / 32.0 - 1.0;\n"
                             "    if (dot(p, p) > 0.999) discard;\n"
                             "    vec3 n = 3.0 * vec3(p, sqrt(1.0 - dot(p, p)));\n"
                             "    color = vec4(shade_bark(vec3(0.2, 0.5, 0.8), n, true), 1);\n"));
        uniform3(rig, "sun_direction", (float)sun[0], (float)sun[1], (float)sun[2]);
        uniform3(rig, "sun_radiance", (float)radiance[0], (float)radiance[1], (float)radiance[2]);
        uniform3(rig, "ambient", (float)ambient, (float)ambient, (float)ambient);
        rig_draw(rig);
        for (int row = 0; row < SIDE; row++)
            for (int column = 0; column < SIDE; column++) {
                double x = (column + 0.5) / 32 - 1, y = 1 - (row + 0.5) / 32, r2 = x * x + y * y;
                const float *pixel = rig->rgba + 4 * (row * SIDE + column);
                double d = x * sun[0] + y * sun[1] + sqrt(fmax(0, 1 - r2)) * sun[2];
                if (fabs(r2 - 0.999) < 1e-3)
                    continue;
                assert_true(pixel[3] == (r2 < 0.999 ? 1.0f : 0.0f));
                for (int i = 0; i < 3 && r2 < 0.999; i++)
                    assert_true(fabs(pixel[i] - albedo[i] * (radiance[i] * fmax(0, d) + ambient)) <
                                2e-6);
            }
    }
    free(rig);
}

static void test_gl__shading_follows_the_effects_and_the_side_of_the_eye(void **state)
{
    (void)state;
    struct rig *rig = calloc(1, sizeof *rig);
    EACH_BACKEND(rig, TARGET_RGBA32F)
    {
        /* N.L = -0.6: facing bark and one-sided leaves are dark, the other side and two-sided
         * leaves are not */
        rig_program(
            rig,
            FULL_SCREEN("    int c = int(gl_FragCoord.x) % 4;\n"
                        "    vec3 n = vec3(0, -0.6, 0.8), a = vec3(0.5);\n"
                        "    vec3 v = c == 0 ? shade_bark(a, n, true)\n"
                        "           : c == 1 ? shade_bark(a, n, false)\n"
                        "           : c == 2 ? shade_leaf(a, n, true) : shade_leaf(a, n, false);\n"
                        "    color = vec4(v, 1);\n"));
        uniform3(rig, "sun_direction", 0, 1, 0);
        uniform3(rig, "sun_radiance", 2, 2, 2);
        rig_draw(rig);
        static const double one_sided[4] = {0, 0.6, 0, 0.6}, two_sided[4] = {0, 0.6, 0.6, 0.6};
        for (int i = 0; i < 4; i++)
            assert_true(fabs(rig->rgba[4 * i] - one_sided[i]) < 1e-6);
        rig->gl->Uniform1i(gl_uniform(rig->gl, rig->program, "two_sided"), 1);
        rig_draw(rig);
        for (int i = 0; i < 4; i++)
            assert_true(fabs(rig->rgba[4 * i] - two_sided[i]) < 1e-6);
    }
    free(rig);
}

static void test_gl__fog_is_beer_lambert(void **state)
{
    (void)state;
    struct rig *rig = calloc(1, sizeof *rig);
    EACH_BACKEND(rig, TARGET_RGBA32F)
    {
        rig_program(rig, FULL_SCREEN("    vec3 p = vec3(10, 0, 0) + vec3(0, 0, gl_FragCoord.x);\n"
                                     "    color = vec4(shade_fog(vec3(0.1, 0.4, 0.9), p), 1);\n"));
        uniform3(rig, "eye_m", 10, 0, 0);
        uniform3(rig, "fog_color", 0.7f, 0.8f, 0.9f);
        rig->gl->Uniform1f(gl_uniform(rig->gl, rig->program, "fog_density"), 0.02f);
        rig_draw(rig);
        for (int i = 0; i < SIDE; i++) {
            double f = exp(-0.02 * (i + 0.5));
            assert_true(fabs(rig->rgba[4 * i] - (f * 0.1 + (1 - f) * 0.7)) < 2e-6);
            assert_true(fabs(rig->rgba[4 * i + 2] - 0.9) < 2e-6);
        }
        rig->gl->Uniform1f(gl_uniform(rig->gl, rig->program, "fog_density"), 0);
        rig_draw(rig);
        assert_true(rig->rgba[4 * 63] == 0.1f);
    }
    free(rig);
}

/* A triangle of half the target, its edge across pixels; alpha is what it covers. */
static void test_gl__multisampled_alpha_is_the_covered_area(void **state)
{
    (void)state;
    static const char source[] =
        "#pragma stage vertex\n"
        "const vec2 at[3] = vec2[](vec2(-0.9, -0.9), vec2(0.83, -0.7), vec2(-0.4, 0.9));\n"
        "void main() { gl_Position = vec4(at[gl_VertexID], 0, 1); }\n"
        "#pragma stage fragment\n"
        "layout(location = 0) out vec4 color;\n"
        "void main() { color = vec4(1); }\n";
    double area = 0.5 * fabs((0.83 + 0.9) * (0.9 + 0.9) - (-0.4 + 0.9) * (-0.7 + 0.9)) / 4;
    struct rig *rig = calloc(1, sizeof *rig);
    EACH_BACKEND(rig, TARGET_RGBA16F)
    {
        struct target twin;
        struct gl *gl = rig->gl;
        rig_program(rig, source);
        assert_int_equal(gl_target_multisample(gl, &rig->target, 4, &twin, &rig->error), STATUS_OK);
        gl->BindFramebuffer(GL_FRAMEBUFFER, twin.framebuffer);
        gl->Clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
        gl_draw_arrays(gl, GL_TRIANGLES, 0, 3, 1);
        gl_target_resolve(gl, &twin, &rig->target);
        gl_target_read(gl, &rig->target, rig->rgba);
        double sum = 0;
        size_t quarters = 0;
        for (size_t i = 3; i < SIDE * SIDE * 4; i += 4) {
            sum += rig->rgba[i];
            assert_true(fabs(4 * rig->rgba[i] - round(4 * rig->rgba[i])) < 1e-6);
            quarters += rig->rgba[i] > 0 && rig->rgba[i] < 1;
        }
        assert_true(fabs(sum / (SIDE * SIDE) - area) < 0.003);
        assert_true(quarters > SIDE);
        assert_int_equal(gl_check(gl, "resolve", &rig->error), STATUS_OK);
    }
    free(rig);
}

static void test_gl__row_0_of_what_is_read_is_the_top(void **state)
{
    (void)state;
    struct rig *rig = calloc(1, sizeof *rig);
    for (int format = TARGET_RGBA8; format <= TARGET_RGBA32F; format++)
        EACH_BACKEND(rig, (enum target_format)format)
        {
            rig_program(
                rig,
                FULL_SCREEN("    color = vec4(gl_FragCoord.x, gl_FragCoord.y, 0, 64) / 64.0;\n"));
            rig_draw(rig);
            double tolerance = format == TARGET_RGBA8 ? 0.5 / 255 + 1e-6 : 1e-3;
            for (int row = 0; row < SIDE; row += 7)
                for (int column = 0; column < SIDE; column += 7) {
                    const float *pixel = rig->rgba + 4 * (row * SIDE + column);
                    assert_true(fabs(pixel[0] - (column + 0.5) / 64) <= tolerance);
                    assert_true(fabs(pixel[1] - (63.5 - row) / 64) <= tolerance);
                    assert_true(pixel[3] == 1);
                }
        }
    free(rig);
}

/* Random triangles with depth, a filtered texture and shading: all that can differ between drivers.
 */
static void draw_confetti(struct rig *rig)
{
    static const char source[] =
        "#pragma stage vertex\n"
        "flat out vec3 tint;\n"
        "out vec2 uv;\n"
        "uint mixed(uint x) { x ^= x >> 16; x *= 0x7feb352du; x ^= x >> 15; x *= 0x846ca68bu; "
        "return x ^ x >> 16; }\n"
        "float number(uint x) { return float(mixed(x) & 0xffffu) / 65536.0; }\n"
        "void main()\n"
        "{\n"
        "    uint piece = uint(gl_VertexID) / 3u, corner = uint(gl_VertexID);\n"
        "    vec2 center = 2.0 * vec2(number(piece * 7u), number(piece * 7u + 1u)) - 1.0;\n"
        "    uv = vec2(number(corner * 5u + 90000u), number(corner * 5u + 80000u));\n"
        "    tint = vec3(number(piece * 3u + 11u), number(piece * 3u + 12u), 0.5);\n"
        "    gl_Position = vec4(center + 0.5 * (uv - 0.5), number(piece + 70000u), 1);\n"
        "}\n"
        "#pragma stage fragment\n"
        "flat in vec3 tint;\n"
        "in vec2 uv;\n"
        "layout(binding = 0) uniform sampler2D picture;\n"
        "layout(location = 0) out vec4 color;\n"
        "void main() { color = vec4(shade_leaf(tint * texture(picture, 3.0 * uv).rgb, vec3(uv, "
        "0.3), true), 1); }\n";
    struct gl *gl = rig->gl;
    uint8_t texels[16 * 16 * 4];
    for (size_t i = 0; i < sizeof texels; i++)
        texels[i] = (uint8_t)(i * 131 % 251);
    rig_program(rig, source);
    GLuint texture = gl_texture(gl, GL_TEXTURE_2D, 0, GL_RGBA8, 16, 16, 1);
    gl->TextureSubImage2D(texture, 0, 0, 0, 16, 16, GL_RGBA, GL_UNSIGNED_BYTE, texels);
    gl->GenerateTextureMipmap(texture);
    gl->BindTextureUnit(0, texture);
    uniform3(rig, "sun_direction", 0.6f, 0.8f, 0);
    uniform3(rig, "sun_radiance", 1, 0.9f, 0.8f);
    gl->Enable(GL_DEPTH_TEST);
    gl_draw_arrays(gl, GL_TRIANGLES, 0, 3 * 500, 1);
    gl_target_read(gl, &rig->target, rig->rgba);
    assert_int_equal(gl_check(gl, "confetti", &rig->error), STATUS_OK);
}

static void test_gl__the_software_back_ends_give_the_same_bytes_every_time(void **state)
{
    (void)state;
    struct rig *rig = calloc(1, sizeof *rig);
    uint64_t first = 0;
    for (int round = 0; round < 2; round++)
        EACH_BACKEND(rig, TARGET_RGBA16F)
        {
            if (!rig->gl->software)
                continue;
            draw_confetti(rig);
            uint64_t hash = hash_bytes(0, rig->rgba, sizeof rig->rgba);
            double covered = 0;
            for (size_t i = 3; i < SIDE * SIDE * 4; i += 4)
                covered += rig->rgba[i] / (SIDE * SIDE);
            assert_true(covered > 0.5 && covered < 1);
            assert_true(first == 0 || hash == first);
            first = hash;
        }
    free(rig);
}

static void test_gl__device_bytes_are_the_sum_of_what_is_alive(void **state)
{
    (void)state;
    struct rig *rig = calloc(1, sizeof *rig);
    EACH_BACKEND(rig, TARGET_RGBA16F)
    {
        struct gl *gl = rig->gl;
        size_t floor = SIDE * SIDE * (8 + 4); /* the target: colour 16F, depth 32F */
        assert_int_equal(gl_device_bytes(gl), floor);
        GLuint buffer = gl_buffer(gl, 1000, NULL, 0);
        assert_int_equal(gl_device_bytes(gl), floor + 1000);
        GLuint pyramid = gl_texture(gl, GL_TEXTURE_2D, 0, GL_RGBA8, 16, 4, 1);
        size_t pyramid_bytes = 4 * (16 * 4 + 8 * 2 + 4 + 2 + 1);
        assert_int_equal(gl_device_bytes(gl), floor + 1000 + pyramid_bytes);
        gl_delete_buffer(gl, buffer);
        gl_delete_buffer(gl, buffer); /* twice is once */
        assert_int_equal(gl_device_bytes(gl), floor + pyramid_bytes);
        gl_delete_texture(gl, pyramid);
        gl_texture(gl, GL_TEXTURE_2D_ARRAY, 1, GL_R8, 10, 10, 7);
        gl_texture(gl, GL_TEXTURE_3D, 2, GL_RG16F, 8, 8, 8);
        gl_texture(gl, GL_TEXTURE_CUBE_MAP, 1, GL_RGBA8, 8, 8, 1);
        gl_texture_multisample(gl, 4, GL_RGBA8, 10, 10);
        assert_int_equal(gl_device_bytes(gl),
                         floor + 700 + 4 * (512 + 64) + 6 * 64 * 4 + 4 * 100 * 4);
        for (int i = 0; i < 200; i++)
            gl_buffer(gl, 3, "abc", 0);
        assert_int_equal(gl_device_bytes(gl),
                         floor + 700 + 4 * (512 + 64) + 6 * 64 * 4 + 4 * 100 * 4 + 600);
        gl_buffer(gl, 0, NULL, 0);
        assert_int_equal(gl_check(gl, "objects", &rig->error), STATUS_OK);
    }
    free(rig);
}

static void test_gl__a_shader_error_names_program_stage_and_line(void **state)
{
    (void)state;
    static const char wrong[] = "// one\n"
                                "#pragma stage vertex\n"
                                "void main() { gl_Position = vec4(0); }\n"
                                "#pragma stage fragment\n"
                                "layout(location = 0) out vec4 color;\n"
                                "void main()\n"
                                "{\n"
                                "    color = vec4(nonsense);\n"
                                "}\n";
    struct rig *rig = calloc(1, sizeof *rig);
    EACH_BACKEND(rig, TARGET_RGBA8)
    {
        struct gl *gl = rig->gl;
        struct error *error = &rig->error;
        GLuint program = 7;
        assert_int_equal(gl_program(gl, "leafy", wrong, NULL, &program, error), STATUS_GL);
        assert_int_equal(program, 0);
        assert_non_null(strstr(error->text, "leafy: fragment shader, line 8: "));
        assert_non_null(strstr(error->text, "nonsense"));
        assert_null(strchr(error->text, '\n'));
        assert_int_equal(gl_program(gl, "leafy", "void main() {}", NULL, &program, error),
                         STATUS_GL);
        assert_non_null(strstr(error->text, "leafy: no line '#pragma stage"));
        assert_int_equal(gl_program(gl, "leafy", "\n#pragma stage pixel\n", NULL, &program, error),
                         STATUS_GL);
        assert_non_null(strstr(error->text, "line 2: unknown stage 'pixel'"));
        assert_int_equal(gl_check(gl, "after", error), STATUS_OK);
    }
    free(rig);
}

static void test_gl__defines_and_the_common_part_reach_every_stage(void **state)
{
    (void)state;
    static const char source[] = "const float half_value = 0.5 * VALUE;\n"
                                 "#pragma stage vertex\n"
                                 "void main() { gl_Position = vec4(gl_VertexID == 1 ? 3 : -1, "
                                 "gl_VertexID == 2 ? 3 : -1, 0, 2 * half_value / VALUE); }\n"
                                 "#pragma stage fragment\n"
                                 "layout(location = 0) out vec4 color;\n"
                                 "#ifdef FLAG\n"
                                 "void main() { color = vec4(half_value); }\n"
                                 "#endif\n";
    struct rig *rig = calloc(1, sizeof *rig);
    EACH_BACKEND(rig, TARGET_RGBA32F)
    {
        rig_program(rig, FULL_SCREEN("    color = vec4(0);\n"));
        assert_int_equal(
            gl_program(rig->gl, "defines", source, "VALUE 0.5\nFLAG", &rig->program, &rig->error),
            STATUS_OK);
        rig->gl->UseProgram(rig->program);
        rig_draw(rig);
        assert_true(rig->rgba[0] == 0.25f);
        assert_int_equal(gl_uniform(rig->gl, rig->program, "absent"), -1);
    }
    free(rig);
}

static void test_gl__pending_errors_are_named_and_cleared(void **state)
{
    (void)state;
    struct rig *rig = calloc(1, sizeof *rig);
    EACH_BACKEND(rig, TARGET_RGBA8)
    {
        rig->gl->Enable(0xbad);
        assert_int_equal(gl_check(rig->gl, "here", &rig->error), STATUS_GL);
        assert_string_equal(rig->error.text, "here: OpenGL reported GL_INVALID_ENUM");
        assert_int_equal(gl_check(rig->gl, "here", &rig->error), STATUS_OK);
    }
    free(rig);
}

static void test_gl__draws_are_counted_and_statistics_agree(void **state)
{
    (void)state;
    struct rig *rig = calloc(1, sizeof *rig);
    EACH_BACKEND(rig, TARGET_RGBA8)
    {
        struct gl *gl = rig->gl;
        rig_program(rig, FULL_SCREEN("    color = vec4(1);\n"));
        for (int round = 0; round < 2; round++) {
            gl_statistics_begin(gl);
            gl_timer_begin(gl);
            gl_draw_arrays(gl, GL_TRIANGLES, 0, 3, 5);
            double seconds = gl_timer_end(gl);
            struct gl_statistics statistics = gl_statistics_end(gl);
            assert_true(gl->has_timer ? seconds > 0 && seconds < 10 : seconds < 0);
            if (gl->has_pipeline_statistics) {
                assert_true(statistics.vertices >= 3 && statistics.vertices <= 15);
                assert_true(statistics.primitives >= 5);
                /* llvmpipe counts whole blocks at the rim */
                assert_in_range(statistics.fragments, 5 * SIDE * SIDE, 6 * SIDE * SIDE);
            }
        }
        assert_int_equal(gl->counters.draw_calls, 2);
        assert_int_equal(gl->counters.triangles, 10);
        gl_counters_reset(gl);
        gl_draw_arrays(gl, GL_TRIANGLE_STRIP, 0, 4, 3);
        gl_draw_arrays(gl, GL_POINTS, 0, 4, 1);
        assert_int_equal(gl->counters.draw_calls, 2);
        assert_int_equal(gl->counters.triangles, 6);
        static const uint16_t indices[6] = {0, 1, 2, 0, 1, 2};
        static const uint32_t command[5] = {3, 4, 0, 0, 0};
        GLuint array = gl_vertex_array(gl);
        gl->VertexArrayElementBuffer(array, gl_buffer(gl, sizeof indices, indices, 0));
        gl->BindVertexArray(array);
        gl->BindBuffer(GL_DRAW_INDIRECT_BUFFER, gl_buffer(gl, sizeof command, command, 0));
        gl_draw_elements(gl, GL_TRIANGLES, 6, GL_UNSIGNED_SHORT, 0, 2, 0, 0);
        gl_multi_draw_elements_indirect(gl, GL_TRIANGLES, GL_UNSIGNED_SHORT, 0, 1, 4);
        assert_int_equal(gl->counters.draw_calls, 4);
        assert_int_equal(gl->counters.triangles, 14);
        assert_int_equal(gl_check(gl, "draws", &rig->error), STATUS_OK);
    }
    free(rig);
}

static void test_gl__a_target_of_no_size_or_too_many_samples_is_refused(void **state)
{
    (void)state;
    struct rig *rig = calloc(1, sizeof *rig);
    EACH_BACKEND(rig, TARGET_RGBA8)
    {
        struct target target, twin;
        struct gl *gl = rig->gl;
        struct error *error = &rig->error;
        assert_int_equal(gl_target(gl, 0, 4, TARGET_RGBA8, &target, error), STATUS_INVALID);
        assert_non_null(strstr(error->text, "target: 0 x 4 px is outside 1.."));
        assert_int_equal(gl_target(gl, 4, 1 << 20, TARGET_RGBA8, &target, error), STATUS_INVALID);
        assert_int_equal(gl_target_multisample(gl, &rig->target, 1, &twin, error), STATUS_INVALID);
        assert_int_equal(gl_target_multisample(gl, &rig->target, gl->samples_max + 1, &twin, error),
                         STATUS_INVALID);
        assert_non_null(strstr(error->text, "samples: "));
        assert_int_equal(gl_target(gl, 1, 1, TARGET_RGBA8, &target, error), STATUS_OK);
        /* 8192 x 4096 x 4 samples x 16 bytes; llvmpipe allows 1 GiB. */
        target = (struct target){.width_px = 8192, .height_px = 4096, .format = TARGET_RGBA32F};
        if (gl->software) {
            assert_int_equal(gl_target_multisample(gl, &target, 4, &twin, error), STATUS_GL);
            assert_non_null(strstr(error->text, "8192 x 4096 px of rgba32f with 4 samples (2048 "));
            assert_non_null(strstr(error->text, "; allowed: fewer pixels, fewer samples, or "));
        }
    }
    free(rig);
}

static void test_gl__format_words_go_there_and_back(void **state)
{
    (void)state;
    enum target_format format;
    for (int i = TARGET_RGBA8; i <= TARGET_RGBA32F; i++) {
        assert_true(target_format_from_word(target_format_word((enum target_format)i), &format));
        assert_int_equal(format, i);
    }
    assert_false(target_format_from_word("rgb8", &format));
    assert_int_equal(target_format_gl(TARGET_RGBA16F), GL_RGBA16F);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_gl__a_back_end_opens_a_core_4_5_context),
        cmocka_unit_test(test_gl__a_probe_finds_a_back_end_and_the_environment_chooses_one),
        cmocka_unit_test(test_gl__a_lambert_sphere_has_the_closed_form_in_every_pixel),
        cmocka_unit_test(test_gl__shading_follows_the_effects_and_the_side_of_the_eye),
        cmocka_unit_test(test_gl__fog_is_beer_lambert),
        cmocka_unit_test(test_gl__multisampled_alpha_is_the_covered_area),
        cmocka_unit_test(test_gl__row_0_of_what_is_read_is_the_top),
        cmocka_unit_test(test_gl__the_software_back_ends_give_the_same_bytes_every_time),
        cmocka_unit_test(test_gl__device_bytes_are_the_sum_of_what_is_alive),
        cmocka_unit_test(test_gl__a_shader_error_names_program_stage_and_line),
        cmocka_unit_test(test_gl__defines_and_the_common_part_reach_every_stage),
        cmocka_unit_test(test_gl__pending_errors_are_named_and_cleared),
        cmocka_unit_test(test_gl__draws_are_counted_and_statistics_agree),
        cmocka_unit_test(test_gl__a_target_of_no_size_or_too_many_samples_is_refused),
        cmocka_unit_test(test_gl__format_words_go_there_and_back),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
