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

struct gl_backend {
    const char *name;
    /* Makes a GL 4.5 core context current on this thread. STATUS_UNAVAILABLE with the reason.
     * want_gpu: refuse a software device (used by the probe order of gl_context_create). */
    enum status (*create)(bool want_gpu, void **context, struct error *error);
    void (*destroy)(void *context);
    void (*(*address)(const char *name))(void);
};
extern const struct gl_backend *const gl_backend_list[]; /* generated; ends with NULL */

#endif
