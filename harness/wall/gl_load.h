/* Between gl.c and its back ends: what a back end answers, and the generated table of functions. */
#ifndef TREELINE_WALL_GL_LOAD_H
#define TREELINE_WALL_GL_LOAD_H

#include "wall/gl.h"

#include <stddef.h>

struct gl_entry {
    const char *name;
    size_t offset; /* in struct gl */
};
extern const struct gl_entry gl_entries[]; /* ends with a NULL name */

/* Back ends load their library with dlopen when they are first asked: one binary runs where either
 * is absent, a process that draws nothing pays for neither, and a CPU method's peak memory holds no
 * LLVM. */
struct gl_backend {
    const char *name;
    /* Makes a GL 4.5 core context current on this thread. STATUS_UNAVAILABLE with the reason.
     * want_gpu: refuse a software device (used by the probe order of gl_context_create). */
    enum status (*create)(bool want_gpu, void **context, struct error *error);
    void (*destroy)(void *context);
    void (*(*address)(void *context, const char *name))(void);
};
extern const struct gl_backend *const gl_backend_list[]; /* generated; ends with NULL */

/* dlopen of a foreign library, one name after the other; NULL and an error that names the first. */
void *gl_library(const char *const *names, struct error *error);
/* dlsym as a function pointer; NULL when absent. */
void (*gl_symbol(void *library, const char *name))(void);

/* The books of one context (gl_objects.c). */
enum gl_kind {
    GL_KIND_BUFFER,
    GL_KIND_TEXTURE,
    GL_KIND_FRAMEBUFFER,
    GL_KIND_VERTEX_ARRAY,
    GL_KIND_PROGRAM
};
struct gl_object {
    enum gl_kind kind;
    GLuint name;
    size_t bytes;
};
struct gl_books {
    struct arena *arena; /* of struct gl and of this */
    const struct gl_backend *backend;
    void *context; /* the back end's */
    struct gl_object *objects;
    size_t objects_count, objects_room;
    size_t device_bytes;
    GLuint statistics_queries[3], timer_query; /* made when first used */
};
/* Enters an object in the books and returns its name. */
GLuint gl_books_add(struct gl *gl, enum gl_kind kind, GLuint name, size_t bytes);
/* Deletes every object and query alive. */
void gl_books_clear(struct gl *gl);

#endif
