/* Checks of what a method takes and leaves behind: GL state, memory. */
#include "conform/trial.h"

#include <dlfcn.h>
#include <malloc.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

/* What draw must leave as it found it: all that changes the next clear, draw or read of somebody
 * who knows nothing of it. Bindings that everybody sets for himself (program, vertex array,
 * framebuffer, buffers, textures), blend function and depth test are free. */
/* clang-format off */
static const struct { GLenum name; const char *word; } states[] = {
#define STATE(name) {name, #name}
    STATE(GL_BLEND), STATE(GL_CULL_FACE), STATE(GL_SCISSOR_TEST), STATE(GL_STENCIL_TEST),
    STATE(GL_POLYGON_OFFSET_FILL), STATE(GL_SAMPLE_ALPHA_TO_COVERAGE), STATE(GL_SAMPLE_ALPHA_TO_ONE),
    STATE(GL_SAMPLE_COVERAGE), STATE(GL_SAMPLE_SHADING), STATE(GL_SAMPLE_MASK),
    STATE(GL_RASTERIZER_DISCARD), STATE(GL_PRIMITIVE_RESTART), STATE(GL_PRIMITIVE_RESTART_FIXED_INDEX),
    STATE(GL_COLOR_LOGIC_OP), STATE(GL_FRAMEBUFFER_SRGB), STATE(GL_DEPTH_CLAMP), STATE(GL_DITHER),
    STATE(GL_MULTISAMPLE), STATE(GL_POLYGON_SMOOTH), STATE(GL_LINE_SMOOTH), STATE(GL_PROGRAM_POINT_SIZE),
    STATE(GL_CLIP_DISTANCE0), STATE(GL_CLIP_DISTANCE1), STATE(GL_CLIP_DISTANCE2), STATE(GL_CLIP_DISTANCE3),
    STATE(GL_DEPTH_FUNC), STATE(GL_DEPTH_WRITEMASK), STATE(GL_DEPTH_RANGE), STATE(GL_COLOR_WRITEMASK),
    STATE(GL_STENCIL_WRITEMASK), STATE(GL_POLYGON_MODE), STATE(GL_FRONT_FACE), STATE(GL_CULL_FACE_MODE),
    STATE(GL_CLIP_ORIGIN), STATE(GL_CLIP_DEPTH_MODE), STATE(GL_TRANSFORM_FEEDBACK_ACTIVE),
    STATE(GL_PIXEL_PACK_BUFFER_BINDING), STATE(GL_PIXEL_UNPACK_BUFFER_BINDING), STATE(GL_PACK_ALIGNMENT),
    STATE(GL_PACK_ROW_LENGTH), STATE(GL_PACK_SKIP_ROWS), STATE(GL_PACK_SKIP_PIXELS), STATE(GL_PACK_SWAP_BYTES),
    STATE(GL_UNPACK_ALIGNMENT), STATE(GL_UNPACK_ROW_LENGTH), STATE(GL_UNPACK_SKIP_ROWS),
    STATE(GL_UNPACK_SKIP_PIXELS), STATE(GL_UNPACK_SWAP_BYTES),
#undef STATE
};
static const struct { GLenum target; const char *word; } queries[] = {
    {GL_SAMPLES_PASSED, "GL_SAMPLES_PASSED"}, {GL_ANY_SAMPLES_PASSED, "GL_ANY_SAMPLES_PASSED"},
    {GL_PRIMITIVES_GENERATED, "GL_PRIMITIVES_GENERATED"}, {GL_TIME_ELAPSED, "GL_TIME_ELAPSED"},
};
/* clang-format on */
enum { STATES = sizeof states / sizeof *states, QUERIES = sizeof queries / sizeof *queries };
enum { UNITS = 16, ALL = STATES + QUERIES + UNITS };

struct snapshot {
    GLint values[ALL][4];
};

static void snapshot_take(struct gl *gl, struct snapshot *snapshot)
{
    *snapshot = (struct snapshot){0};
    for (int i = 0; i < STATES; i++)
        gl->GetIntegerv(states[i].name, snapshot->values[i]);
    for (int i = 0; i < QUERIES; i++)
        gl->GetQueryiv(queries[i].target, GL_CURRENT_QUERY, snapshot->values[STATES + i]);
    for (GLuint unit = 0; unit < UNITS; unit++)
        gl->GetIntegeri_v(GL_SAMPLER_BINDING, unit, snapshot->values[STATES + QUERIES + unit]);
}

/* Of a context in which nothing was done yet. */
static enum status snapshot_fresh(struct subject *subject, struct snapshot *snapshot)
{
    struct gl *gl;
    enum status status = gl_context_create(subject->backend, 0, &gl, subject->error);
    if (status)
        return status;
    snapshot_take(gl, snapshot);
    gl_context_destroy(gl);
    return STATUS_OK;
}

static enum status snapshot_compare(struct subject *subject, const struct snapshot *before,
                                    const struct snapshot *after)
{
    for (int i = 0; i < ALL; i++) {
        const GLint *a = before->values[i], *b = after->values[i];
        const char *word = i < STATES             ? states[i].word
                           : i < STATES + QUERIES ? queries[i - STATES].word
                                                  : "a sampler's binding";
        if (memcmp(a, b, sizeof before->values[i]) != 0)
            return subject_fail(subject, "draw leaves %s at %d, found it at %d", word, b[0], a[0]);
    }
    return STATUS_OK;
}

static enum status check_state(struct subject *subject)
{
    struct trial_request request = {.world.trees = 3, .format = TARGET_RGBA16F};
    struct snapshot before, after;
    struct trial trial;
    struct view view;
    if (subject->method->traits & TRAIT_CPU)
        return subject_skip(subject, "draws without OpenGL");
    enum status status = snapshot_fresh(subject, &before);
    if (!status)
        status = trial_open(subject, &request, &trial);
    if (status)
        return status;
    struct gl *gl = trial.workspace.gl;
    world_view_near(trial.scene, &trial.world, &view);
    for (int i = 0; i < 2 && !status; i++) {
        status = trial_draw(&trial, &view, NULL);
        snapshot_take(gl, &after);
        if (!status)
            status = snapshot_compare(subject, &before, &after);
    }
    trial_close(&trial);
    return status;
}

/* Bytes of this process in memory. */
static double resident_bytes(void)
{
    double pages = 0;
    FILE *file = fopen("/proc/self/statm", "re");
    malloc_trim(0);
    if (file) {
        if (fscanf(file, "%*s %lf", &pages) != 1)
            pages = 0;
        fclose(file);
    }
    return pages * (double)sysconf(_SC_PAGESIZE);
}

/* Freed memory stays resident under a sanitizer, and much is its own. */
static bool is_instrumented(void)
{
    return dlsym(RTLD_DEFAULT, "__asan_init") || dlsym(RTLD_DEFAULT, "__tsan_init");
}

/* What the driver keeps: compiled shaders, worker threads, bins, copies of buffers. */
static const double DRIVER_BYTES = 64e6;

/* The driver loaded and a first picture drawn, so that a method does not pay for it. */
static enum status driver_load(struct subject *subject)
{
    struct frame *frame;
    struct trial_request request = {.format = TARGET_RGBA16F};
    if (subject->method->traits & TRAIT_CPU)
        return STATUS_OK;
    enum status status = method_find("null", &request.method, subject->error);
    return status ? status : trial_picture(subject, &request, NULL, &frame);
}

static enum status check_memory(struct subject *subject)
{
    struct trial_request request = {.world.trees = 100, .format = TARGET_RGBA16F};
    struct trial trial;
    struct view view;
    enum status status = driver_load(subject);
    double before = resident_bytes();
    if (!status)
        status = trial_open(subject, &request, &trial);
    if (status)
        return status;
    struct gl *gl = trial.workspace.gl;
    world_view_near(trial.scene, &trial.world, &view);
    for (int i = 0; i < 2 && !status; i++)
        status = trial_draw(&trial, &view, NULL);
    double host = (double)arena_used_bytes(trial.workspace.arena);
    double device = gl ? (double)gl_device_bytes(gl) : 0;
    double alive = gl ? (double)gl_alive_bytes(gl) : 0;
    double grown = resident_bytes() - before;
    if (!status && alive > device)
        status = subject_fail(subject,
                              "OpenGL holds %.3g MB, declared are %.3g: made without gl_buffer, "
                              "gl_texture",
                              alive / 1e6, device / 1e6);
    if (!status && !is_instrumented() && grown > host + 2 * device + DRIVER_BYTES)
        status = subject_fail(subject,
                              "the process grew by %.3g MB, declared are %.3g of host and %.3g of "
                              "device memory",
                              grown / 1e6, host / 1e6, device / 1e6);
    subject_note(subject, "host %.3g MB, device %.3g MB, process %.3g MB", host / 1e6, device / 1e6,
                 grown / 1e6);
    trial_close(&trial);
    return status;
}

/* What grew with the draws, but for the pictures that are read here. */
struct use {
    double host, device, alive, resident;
};

static struct use use_of(const struct trial *trial)
{
    struct gl *gl = trial->workspace.gl;
    return (struct use){.host = (double)arena_used_bytes(trial->workspace.arena),
                        .device = gl ? (double)gl_device_bytes(gl) : 0,
                        .alive = gl ? (double)gl_alive_bytes(gl) : 0,
                        .resident = resident_bytes()};
}

static enum status check_growth(struct subject *subject)
{
    enum { DRAWS = 100, WARM = 20 };
    /* Mesa's rasterizer keeps as many scenes as were ever under way at once: more, the busier the
     * machine; shadow-volume, which fills the most, was seen to grow by 16 MB. */
    static const double RESIDENT_BYTES = 32e6;
    struct trial_request request = {.world.trees = 20, .format = TARGET_RGBA16F};
    struct trial trial;
    struct view view;
    struct use before = {0};
    enum status status = trial_open(subject, &request, &trial);
    if (status)
        return status;
    for (int i = 0; i < WARM + DRAWS && !status; i++) {
        double angle = 0.0628 * (i % WARM);
        if (i == WARM)
            before = use_of(&trial);
        world_view(trial.scene, &trial.world, (double[3]){40 * sin(angle), 14, 40 * cos(angle)},
                   (double[3]){0, 10, 0}, &view);
        status = trial_draw_only(&trial, &view);
    }
    struct use after = use_of(&trial);
    if (!status &&
        (after.host > before.host || after.device > before.device || after.alive > before.alive))
        status = subject_fail(
            subject, "%d draws took %.3g kB of host and %.3g kB of device memory more", DRAWS,
            (after.host - before.host) / 1e3, (after.alive - before.alive) / 1e3);
    if (!status && !is_instrumented() && after.resident - before.resident > RESIDENT_BYTES)
        status = subject_fail(subject, "the process grew by %.3g MB in %d draws",
                              (after.resident - before.resident) / 1e6, DRAWS);
    trial_close(&trial);
    return status;
}

const struct check checks_resources[] = {
    {"state", "draw leaves OpenGL's state as it found it, but for bindings and the depth test",
     check_state, false},
    {"memory", "memory in use is memory declared, of host and device", check_memory, false},
    {"growth", "100 draws take no more memory", check_growth, false},
    {NULL, NULL, NULL, false},
};
