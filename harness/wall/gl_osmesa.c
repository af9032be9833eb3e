/* The OSMesa back end: llvmpipe without a window system, up to Mesa 25.0. */
#include "wall/gl_load.h"

#include <GL/osmesa.h>
#include <stdlib.h>

/* OSMesa wants a buffer of its own; everything is drawn into framebuffer objects instead. */
enum { DUMMY_SIDE_PX = 16 };

struct osmesa {
    OSMesaContext context;
    GLboolean (*make_current)(OSMesaContext, void *, GLenum, GLsizei, GLsizei);
    void (*destroy)(OSMesaContext);
    OSMESAproc (*address)(const char *);
    uint8_t dummy[DUMMY_SIDE_PX * DUMMY_SIDE_PX * 4];
};

static enum status create(bool want_gpu, void **context, struct error *error)
{
    if (want_gpu)
        return error_set(error, STATUS_UNAVAILABLE, "osmesa: is software, not a GPU");
    static const char *const names[] = {"libOSMesa.so.8", "libOSMesa.so", NULL};
    void *library = gl_library(names, error);
    if (!library)
        return error_context(error, "osmesa");
    OSMesaContext (*make)(const int *, OSMesaContext) =
        (OSMesaContext(*)(const int *, OSMesaContext))gl_symbol(library,
                                                                "OSMesaCreateContextAttribs");
    struct osmesa *osmesa = calloc(1, sizeof *osmesa);
    if (!osmesa)
        return error_set(error, STATUS_MEMORY, "osmesa: no memory for a context");
    osmesa->make_current = (GLboolean(*)(OSMesaContext, void *, GLenum, GLsizei, GLsizei))gl_symbol(
        library, "OSMesaMakeCurrent");
    osmesa->destroy = (void (*)(OSMesaContext))gl_symbol(library, "OSMesaDestroyContext");
    osmesa->address = (OSMESAproc(*)(const char *))gl_symbol(library, "OSMesaGetProcAddress");
    static const int attributes[] = {OSMESA_FORMAT,
                                     OSMESA_RGBA,
                                     OSMESA_DEPTH_BITS,
                                     0,
                                     OSMESA_PROFILE,
                                     OSMESA_CORE_PROFILE,
                                     OSMESA_CONTEXT_MAJOR_VERSION,
                                     4,
                                     OSMESA_CONTEXT_MINOR_VERSION,
                                     5,
                                     0};
    if (make && osmesa->make_current && osmesa->destroy && osmesa->address)
        osmesa->context = make(attributes, NULL);
    if (!osmesa->context) {
        free(osmesa);
        return error_set(error, STATUS_UNAVAILABLE, "osmesa: gives no OpenGL 4.5 core context");
    }
    if (!osmesa->make_current(osmesa->context, osmesa->dummy, GL_UNSIGNED_BYTE, DUMMY_SIDE_PX,
                              DUMMY_SIDE_PX)) {
        osmesa->destroy(osmesa->context);
        free(osmesa);
        return error_set(error, STATUS_UNAVAILABLE, "osmesa: cannot make its context current");
    }
    *context = osmesa;
    return STATUS_OK;
}

static void destroy(void *context)
{
    struct osmesa *osmesa = context;
    osmesa->make_current(NULL, NULL, 0, 0, 0);
    osmesa->destroy(osmesa->context);
    free(osmesa);
}

static void (*address(void *context, const char *name))(void)
{
    struct osmesa *osmesa = context;
    return (void (*)(void))osmesa->address(name);
}

extern const struct gl_backend gl_osmesa;
const struct gl_backend gl_osmesa = {"osmesa", create, destroy, address};
