/* A trial: opening, drawing, closing; differences of pictures. */
#include "conform/trial.h"

#include "base/clock.h"
#include "truth/reference.h"

#include <math.h>
#include <string.h>

static enum status target_open(struct trial *trial, enum target_format format)
{
    int width_px = trial->scene->width_px, height_px = trial->scene->height_px;
    if (trial->workspace.gl)
        return gl_target(trial->workspace.gl, width_px, height_px, format, &trial->target,
                         trial->subject->error);
    size_t values = 4 * (size_t)width_px * (size_t)height_px;
    trial->target = (struct target){.width_px = width_px,
                                    .height_px = height_px,
                                    .format = format,
                                    .pixels = ARENA_ARRAY(trial->arena, float, values)};
    return STATUS_OK;
}

static enum status prepare(struct trial *trial, const char *text)
{
    const struct method *method = trial->method;
    struct error *error = trial->subject->error;
    const char *reason = "it gives no reason";
    void *options = NULL;
    enum status status = STATUS_OK;
    if (method->supported && (status = method->supported(trial->scene, &reason)))
        return error_set(error, status, "refused: %s", reason);
    if (method->options) {
        options = arena_alloc(trial->arena, 1, method->options_size);
        options_default(method->options, options);
        if (options_parse(method->options, text, options, error))
            return error->status;
    }
    trial->workspace.effects = method_effects(method, options, trial->workspace.effects);
    subject_say(trial->subject, "prepare");
    status = method->prepare(&trial->workspace, trial->scene, options, &trial->state);
    if (status && !error->status)
        return error_set(error, status, "prepare failed and gave no reason");
    if (status || !trial->workspace.gl)
        return status;
    trial->workspace.gl->Finish();
    return gl_check(trial->workspace.gl, "prepare", error);
}

/* A world of conifers for a method that refuses the mesh, if it takes that one. */
static enum status scene_make(struct trial *trial)
{
    const struct method *method = trial->method;
    struct error *error = trial->subject->error;
    struct world conifers = trial->world;
    const char *reason;
    enum status status = world_make(trial->arena, &trial->world, &trial->scene, error);
    if (status || trial->world.file || !method->supported ||
        !method->supported(trial->scene, &reason))
        return status;
    struct scene *scene;
    conifers.conifers = true;
    status = world_make(trial->arena, &conifers, &scene, error);
    if (status || method->supported(scene, &reason))
        return status; /* prepare says what is refused */
    trial->world = conifers;
    trial->scene = scene;
    return STATUS_OK;
}

enum status trial_open(struct subject *subject, const struct trial_request *request,
                       struct trial *trial)
{
    const struct method *method = request->method ? request->method : subject->method;
    *trial = (struct trial){.subject = subject, .world = request->world, .method = method};
    trial->arena = arena_create(0);
    trial->workspace = (struct workspace){.arena = arena_create(0),
                                          .error = subject->error,
                                          .lod = request->lod,
                                          .format = request->format,
                                          .threads = clock_cpu_count(),
                                          .seed = 1};
    subject_say(subject, "making the scene");
    enum status status = scene_make(trial);
    if (!status) {
        /* NOLINTNEXTLINE(clang-analyzer-core.NullDereference): world_make gave a scene */
        trial->scene->effects &= ~request->scene_effects_off;
        if (request->scene_effects_off & EFFECT_FOG)
            trial->scene->fog.density_per_m = 0;
        trial->workspace.effects = trial->scene->effects & ~request->effects_off;
        subject_say(subject, "making the GL context");
    }
    if (!status && !(method->traits & TRAIT_CPU))
        status = gl_context_create(subject->backend, trial->workspace.threads, &trial->workspace.gl,
                                   subject->error);
    if (!status)
        status = target_open(trial, request->format);
    if (!status)
        status = prepare(trial, request->options);
    if (status)
        trial_close(trial);
    return status;
}

void trial_close(struct trial *trial)
{
    gl_context_destroy(trial->workspace.gl);
    arena_destroy(trial->workspace.arena);
    arena_destroy(trial->arena);
}

enum status trial_draw_only(struct trial *trial, const struct view *view)
{
    struct error *error = trial->subject->error;
    struct gl *gl = trial->workspace.gl;
    subject_say(trial->subject, "draw");
    enum status status = trial->method->draw(&trial->workspace, trial->state, view, &trial->target);
    if (status && !error->status)
        return error_set(error, status, "draw failed and gave no reason");
    if (status || !gl)
        return status;
    gl->Finish();
    return gl_check(gl, "draw", error);
}

/* NaN where the format holds it: a pixel that is not drawn is found out. */
static void target_spoil(const struct trial *trial)
{
    const struct target *target = &trial->target;
    struct gl *gl = trial->workspace.gl;
    const float nothing[4] = {NAN, NAN, NAN, NAN};
    if (gl && target->format != TARGET_RGBA8)
        gl->ClearNamedFramebufferfv(target->framebuffer, GL_COLOR, 0, nothing);
    size_t values = 4 * (size_t)target->width_px * (size_t)target->height_px;
    for (size_t i = 0; !gl && i < values; i++)
        target->pixels[i] = NAN;
}

enum status trial_draw(struct trial *trial, const struct view *view, struct frame **result)
{
    const struct target *target = &trial->target;
    target_spoil(trial);
    enum status status = trial_draw_only(trial, view);
    if (status)
        return status;
    struct frame *frame =
        frame_create(trial->subject->arena, target->width_px, target->height_px, false);
    if (trial->workspace.gl)
        gl_target_read(trial->workspace.gl, target, frame->rgba);
    else
        memcpy(frame->rgba, target->pixels,
               4 * sizeof(float) * (size_t)target->width_px * (size_t)target->height_px);
    if (result)
        *result = frame;
    return frame_check(frame, trial->subject->error);
}

enum status trial_reference(struct trial *trial, const struct view *view, unsigned effects,
                            struct frame **frame)
{
    struct reference_options options = {.effects = effects,
                                        .samples_min = 64,
                                        .samples_max = 64,
                                        .threads = trial->workspace.threads,
                                        .seed = 1,
                                        .quiet = true};
    struct reference_stats stats;
    subject_say(trial->subject, "the reference");
    return reference_render(trial->subject->arena, trial->scene, view, &options, frame, &stats,
                            trial->subject->error);
}

enum status trial_picture(struct subject *subject, const struct trial_request *request,
                          const struct view *given, struct frame **frame)
{
    struct trial trial;
    struct view view;
    enum status status = trial_open(subject, request, &trial);
    if (status)
        return status;
    if (given)
        view = *given;
    else
        world_view_near(trial.scene, &trial.world, &view);
    status = trial_draw(&trial, &view, frame);
    trial_close(&trial);
    return status;
}

double frame_coverage(const struct frame *frame)
{
    double sum = 0;
    size_t pixels = (size_t)frame->width_px * (size_t)frame->height_px;
    for (size_t i = 0; i < pixels; i++)
        sum += frame->rgba[4 * i + 3];
    return sum / (double)pixels;
}

struct difference frame_difference(const struct frame *a, const struct frame *b)
{
    struct difference difference = {0, 0};
    size_t values = 4 * (size_t)a->width_px * (size_t)a->height_px;
    for (size_t i = 0; i < values; i++) {
        double one = fabs((double)a->rgba[i] - b->rgba[i]);
        difference.mean += one / (double)values;
        difference.worst = fmax(difference.worst, one);
    }
    return difference;
}
