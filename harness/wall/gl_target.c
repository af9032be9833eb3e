/* Targets: the framebuffers that methods draw into, their multisampled twins, and reading them
 * back. */
#include "wall/gl.h"

#include "base/plural.h"

#include <string.h>

static const struct {
    const char *word;
    GLenum internal_format;
    double bytes; /* a pixel */
} formats[] = {{"rgba8", GL_RGBA8, 4}, {"rgba16f", GL_RGBA16F, 8}, {"rgba32f", GL_RGBA32F, 16}};

const char *target_format_word(enum target_format format)
{
    return formats[format].word;
}

bool target_format_from_word(const char *word, enum target_format *format)
{
    for (size_t i = 0; i < sizeof formats / sizeof *formats; i++)
        if (!strcmp(formats[i].word, word)) {
            *format = (enum target_format)i;
            return true;
        }
    return false;
}

GLenum target_format_gl(enum target_format format)
{
    return formats[format].internal_format;
}

/* Frames a colour and a depth texture; STATUS_GL when the driver refuses the pair: llvmpipe does
 * where a texture takes more than 1 GiB. */
static enum status frame_textures(struct gl *gl, struct target *target, int samples,
                                  struct error *error)
{
    target->framebuffer = gl_framebuffer(gl);
    gl->NamedFramebufferTexture(target->framebuffer, GL_COLOR_ATTACHMENT0, target->color, 0);
    gl->NamedFramebufferTexture(target->framebuffer,
                                target->stencil ? GL_DEPTH_STENCIL_ATTACHMENT : GL_DEPTH_ATTACHMENT,
                                target->depth, 0);
    GLenum state = gl->CheckNamedFramebufferStatus(target->framebuffer, GL_FRAMEBUFFER);
    if (state != GL_FRAMEBUFFER_COMPLETE)
        return error_set(error, STATUS_GL,
                         "target: %d x %d px of %s with %d sample%s (%.0f MiB) is too large for "
                         "%s; allowed: fewer pixels%s%s",
                         target->width_px, target->height_px, target_format_word(target->format),
                         samples, plural((size_t)samples),
                         formats[target->format].bytes * target->width_px * target->height_px *
                             samples / 0x1p20,
                         gl->renderer, samples > 1 ? ", fewer samples" : "",
                         target->format == TARGET_RGBA8 ? "" : ", or fewer bits a pixel");
    return gl_check(gl, "target", error);
}

static enum status check_size(struct gl *gl, int width_px, int height_px, struct error *error)
{
    GLint side_max = 0;
    gl->GetIntegerv(GL_MAX_TEXTURE_SIZE, &side_max);
    if (width_px < 1 || height_px < 1 || width_px > side_max || height_px > side_max)
        return error_set(error, STATUS_INVALID, "target: %d x %d px is outside 1..%d", width_px,
                         height_px, side_max);
    return STATUS_OK;
}

enum status gl_target(struct gl *gl, int width_px, int height_px, enum target_format format,
                      struct target *target, struct error *error)
{
    *target = (struct target){.width_px = width_px, .height_px = height_px, .format = format};
    enum status status = check_size(gl, width_px, height_px, error);
    if (status != STATUS_OK)
        return status;
    target->color =
        gl_texture(gl, GL_TEXTURE_2D, 1, target_format_gl(format), width_px, height_px, 1);
    target->depth = gl_texture(gl, GL_TEXTURE_2D, 1, GL_DEPTH_COMPONENT32F, width_px, height_px, 1);
    return frame_textures(gl, target, 1, error);
}

enum status gl_target_multisample(struct gl *gl, const struct target *target, int samples,
                                  struct target *multisampled, struct error *error)
{
    *multisampled = (struct target){
        .width_px = target->width_px, .height_px = target->height_px, .format = target->format};
    enum status status = check_size(gl, target->width_px, target->height_px, error);
    if (status != STATUS_OK)
        return status;
    if (samples < 2 || samples > gl->samples_max)
        return error_set(error, STATUS_INVALID, "samples: %d is outside 2..%d of %s", samples,
                         gl->samples_max, gl->renderer);
    multisampled->color = gl_texture_multisample(gl, samples, target_format_gl(target->format),
                                                 target->width_px, target->height_px);
    multisampled->depth = gl_texture_multisample(gl, samples, GL_DEPTH_COMPONENT32F,
                                                 target->width_px, target->height_px);
    return frame_textures(gl, multisampled, samples, error);
}

enum status gl_target_stencil(struct gl *gl, const struct target *target, int samples,
                              struct target *twin, struct error *error)
{
    *twin = (struct target){.width_px = target->width_px,
                            .height_px = target->height_px,
                            .format = target->format,
                            .stencil = true};
    int width_px = twin->width_px, height_px = twin->height_px;
    GLenum format = target_format_gl(twin->format);
    enum status status = check_size(gl, width_px, height_px, error);
    if (status == STATUS_OK && (samples < 1 || samples > gl->samples_max))
        return error_set(error, STATUS_INVALID, "samples: %d is outside 1..%d of %s", samples,
                         gl->samples_max, gl->renderer);
    if (status != STATUS_OK)
        return status;
    if (samples == 1) {
        twin->color = gl_texture(gl, GL_TEXTURE_2D, 1, format, width_px, height_px, 1);
        twin->depth =
            gl_texture(gl, GL_TEXTURE_2D, 1, GL_DEPTH32F_STENCIL8, width_px, height_px, 1);
    } else {
        twin->color = gl_texture_multisample(gl, samples, format, width_px, height_px);
        twin->depth =
            gl_texture_multisample(gl, samples, GL_DEPTH32F_STENCIL8, width_px, height_px);
    }
    return frame_textures(gl, twin, samples, error);
}

void gl_target_resolve(struct gl *gl, const struct target *multisampled,
                       const struct target *target)
{
    gl->BlitNamedFramebuffer(multisampled->framebuffer, target->framebuffer, 0, 0,
                             multisampled->width_px, multisampled->height_px, 0, 0,
                             target->width_px, target->height_px, GL_COLOR_BUFFER_BIT, GL_NEAREST);
}

void gl_target_read(struct gl *gl, const struct target *target, float *rgba)
{
    size_t row = (size_t)target->width_px * 4;
    gl->GetTextureImage(target->color, 0, GL_RGBA, GL_FLOAT,
                        (GLsizei)(row * (size_t)target->height_px * sizeof *rgba), rgba);
    /* OpenGL's row 0 is at the bottom. */
    for (int low = 0, high = target->height_px - 1; low < high; low++, high--) {
        float *a = rgba + row * (size_t)low, *b = rgba + row * (size_t)high;
        for (size_t i = 0; i < row; i++) {
            float swap = a[i];
            a[i] = b[i];
            b[i] = swap;
        }
    }
}
