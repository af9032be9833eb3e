/* OpenGL 4.5 core behind one small context: OSMesa and EGL (surfaceless, device) as equal back
 * ends. */
#ifndef TREELINE_WALL_GL_H
#define TREELINE_WALL_GL_H

#include "base/arena.h"
#include "base/error.h"

#include <GL/glcorearb.h>
#include <stdbool.h>

struct gl_counters {
    uint64_t draw_calls, triangles; /* submitted through gl_draw_*; instanced ones multiplied */
};

/* All of OpenGL 4.5 core as function pointers (gl->Clear), from the system's glcorearb.h, and the
 * books of one context. Everything made through gl_* dies with gl_context_destroy. */
struct gl {
#include "gl_functions.inc"                  /* generated: PFNGLCLEARPROC Clear; ... */
    struct gl_books *books;                  /* private to gl.c */
    const char *backend;                     /* "osmesa", "egl-surfaceless", "egl-device" */
    const char *vendor, *renderer, *version; /* GL strings */
    int samples_max;                         /* GL_MAX_SAMPLES */
    bool software;                           /* llvmpipe, softpipe, swrast */
    bool has_timer, has_pipeline_statistics;
    struct gl_counters counters; /* since gl_counters_reset */
};

/* Back ends built in, best first, ends with NULL. */
extern const char *const gl_backends[];
/* STATUS_INVALID, named after who, unless it is one of them. */
enum status gl_backend_check(const char *name, const char *who, struct error *error);

/* backend: a name from gl_backends, or NULL: $TREELINE_GL, else an EGL device that is a GPU, else
 * OSMesa, else EGL surfaceless, else EGL's software device. threads: for llvmpipe (LP_NUM_THREADS;
 * set before the first context of a process), 0: all. STATUS_UNAVAILABLE says what each back end
 * answered; a name that is none is STATUS_INVALID. */
enum status gl_context_create(const char *backend, int threads, struct gl **gl,
                              struct error *error);
void gl_context_destroy(struct gl *gl);

/* STATUS_GL with the names of the pending errors and WHERE; clears them. */
enum status gl_check(struct gl *gl, const char *where, struct error *error);
/* Bytes of the buffers, textures and renderbuffers alive, by their sizes and formats. */
size_t gl_device_bytes(const struct gl *gl);
/* The same of all that OpenGL itself knows, also what was made without the functions below. */
size_t gl_alive_bytes(struct gl *gl);

/* Counted objects. Sizes are recorded for gl_device_bytes. data may be NULL. */
GLuint gl_buffer(struct gl *gl, GLsizeiptr size_bytes, const void *data, GLbitfield storage_flags);
/* target: GL_TEXTURE_2D, _2D_ARRAY, _3D, _CUBE_MAP; levels 0: a full pyramid. Immutable storage. */
GLuint gl_texture(struct gl *gl, GLenum target, int levels, GLenum internal_format, int width_px,
                  int height_px, int layers);
GLuint gl_texture_multisample(struct gl *gl, int samples, GLenum internal_format, int width_px,
                              int height_px);
/* A buffer seen as a row of texels; STATUS_UNSUPPORTED where it has more than the driver fetches.
 */
enum status gl_texture_buffer(struct gl *gl, GLenum internal_format, size_t texel_bytes,
                              GLuint buffer, GLuint *texture, struct error *error);
GLuint gl_framebuffer(struct gl *gl);
GLuint gl_vertex_array(struct gl *gl);
void gl_delete_buffer(struct gl *gl, GLuint buffer);
void gl_delete_texture(struct gl *gl, GLuint texture);

/* source: one text with the stages after lines "#pragma stage vertex", "#pragma stage fragment"
 * (also geometry, tess_control, tess_evaluation, compute); what stands before the first goes to
 * every stage. "#version 450 core", the defines ("NAME VALUE\n..." lines, NULL: none) and the
 * shared chunk bake/shade.glsl are put in front. Compile and link errors are STATUS_GL with name,
 * stage, line and the driver's first message. */
enum status gl_program(struct gl *gl, const char *name, const char *source, const char *defines,
                       GLuint *program, struct error *error);
/* A uniform's location; -1 for one that the compiler removed (setting it does nothing). */
GLint gl_uniform(struct gl *gl, GLuint program, const char *name);

/* Draws, counted. */
void gl_draw_arrays(struct gl *gl, GLenum mode, GLint first, GLsizei count, GLsizei instances);
void gl_draw_elements(struct gl *gl, GLenum mode, GLsizei count, GLenum type, size_t offset_bytes,
                      GLsizei instances, GLint base_vertex, GLuint base_instance);
/* count commands of DrawElementsIndirectCommand in the bound GL_DRAW_INDIRECT_BUFFER; triangles is
 * what they add up to (the caller filled them). */
void gl_multi_draw_elements_indirect(struct gl *gl, GLenum mode, GLenum type, size_t offset_bytes,
                                     GLsizei count, uint64_t triangles);
void gl_counters_reset(struct gl *gl);

/* The picture being drawn into. Linear; alpha is plant coverage. */
enum target_format { TARGET_RGBA8, TARGET_RGBA16F, TARGET_RGBA32F };
const char *target_format_word(enum target_format format);
bool target_format_from_word(const char *word, enum target_format *format);
GLenum target_format_gl(enum target_format format);

struct target {
    int width_px, height_px;
    enum target_format format;
    GLuint
        framebuffer; /* color texture of the format and a 32-bit float depth; 0 for a CPU method */
    GLuint color, depth; /* textures */
    float *pixels;       /* CPU methods: height x width x 4, row 0 on top; else NULL */
    bool stencil;        /* depth has 8 bits of stencil too: of a twin alone */
};
enum status gl_target(struct gl *gl, int width_px, int height_px, enum target_format format,
                      struct target *target, struct error *error);
/* A multisampled twin of a target (samples > 1) to draw into; resolve averages it into target. */
enum status gl_target_multisample(struct gl *gl, const struct target *target, int samples,
                                  struct target *multisampled, struct error *error);
/* The same with a stencil buffer of 8 bits, also of 1 sample. */
enum status gl_target_stencil(struct gl *gl, const struct target *target, int samples,
                              struct target *twin, struct error *error);
void gl_target_resolve(struct gl *gl, const struct target *multisampled,
                       const struct target *target);
/* Reads a target as float RGBA, row 0 on top. Not timed with the drawing. */
void gl_target_read(struct gl *gl, const struct target *target, float *rgba);

/* Fragments, primitives and vertices of the draws between begin and end; zeros where not supported.
 */
struct gl_statistics {
    uint64_t vertices, primitives, fragments;
};
void gl_statistics_begin(struct gl *gl);
struct gl_statistics gl_statistics_end(struct gl *gl);
/* GPU time of what was submitted between, in seconds; a negative number where not supported. */
void gl_timer_begin(struct gl *gl);
double gl_timer_end(struct gl *gl);

#endif
