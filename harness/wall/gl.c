/* The OpenGL context: probing the back ends, loading the functions, errors. */
#include "wall/gl_load.h"

#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void *gl_library(const char *const *names, struct error *error)
{
    void *library = NULL;
    for (size_t i = 0; names[i] && !library; i++)
        library = dlopen(names[i], RTLD_NOW | RTLD_LOCAL);
    if (!library)
        error_set(error, STATUS_UNAVAILABLE, "%s is not installed", names[0]);
    return library;
}

void (*gl_symbol(void *library, const char *name))(void)
{
    void *object = dlsym(library, name);
    void (*function)(void) = NULL;
    memcpy(&function, &object, sizeof function); /* POSIX: the two are of one size */
    return function;
}

/* Fills the table; STATUS_UNAVAILABLE names the first function that is absent. */
static enum status load_functions(struct gl *gl, struct error *error)
{
    const struct gl_books *books = gl->books;
    for (const struct gl_entry *entry = gl_entries; entry->name; entry++) {
        void (*function)(void) = books->backend->address(books->context, entry->name);
        if (!function)
            return error_set(error, STATUS_UNAVAILABLE, "%s: lacks %s of OpenGL 4.5",
                             books->backend->name, entry->name);
        memcpy((char *)gl + entry->offset, &function, sizeof function);
    }
    return STATUS_OK;
}

static bool has_extension(struct gl *gl, const char *name)
{
    GLint count = 0;
    gl->GetIntegerv(GL_NUM_EXTENSIONS, &count);
    for (GLint i = 0; i < count; i++)
        if (!strcmp((const char *)gl->GetStringi(GL_EXTENSIONS, (GLuint)i), name))
            return true;
    return false;
}

static void learn(struct gl *gl)
{
    struct arena *arena = gl->books->arena;
    gl->backend = gl->books->backend->name;
    gl->vendor = arena_strdup(arena, (const char *)gl->GetString(GL_VENDOR));
    gl->renderer = arena_strdup(arena, (const char *)gl->GetString(GL_RENDERER));
    gl->version = arena_strdup(arena, (const char *)gl->GetString(GL_VERSION));
    gl->GetIntegerv(GL_MAX_SAMPLES, &gl->samples_max);
    gl->software = strstr(gl->renderer, "llvmpipe") || strstr(gl->renderer, "softpipe") ||
                   strstr(gl->renderer, "swrast") || strstr(gl->renderer, "Software");
    gl->has_timer = !gl->software;
    gl->has_pipeline_statistics = has_extension(gl, "GL_ARB_pipeline_statistics_query");
    gl->Disable(GL_DITHER); /* the same value gives the same byte everywhere */
    gl->PixelStorei(GL_PACK_ALIGNMENT, 1);
    gl->PixelStorei(GL_UNPACK_ALIGNMENT, 1);
}

/* One back end, or why not. */
static enum status open_backend(const struct gl_backend *backend, bool want_gpu, struct gl **gl,
                                struct error *error)
{
    void *context;
    enum status status = backend->create(want_gpu, &context, error);
    if (status != STATUS_OK)
        return status;
    struct arena *arena = arena_create(0);
    struct gl *made = ARENA_NEW(arena, struct gl);
    made->books = ARENA_NEW(arena, struct gl_books);
    made->books->arena = arena;
    made->books->backend = backend;
    made->books->context = context;
    status = load_functions(made, error);
    if (status == STATUS_OK) {
        learn(made);
        if (want_gpu && made->software)
            status = error_set(error, STATUS_UNAVAILABLE, "%s: %s is software, not a GPU",
                               backend->name, made->renderer);
    }
    if (status != STATUS_OK) {
        backend->destroy(context);
        arena_destroy(arena);
        return status;
    }
    *gl = made;
    return STATUS_OK;
}

static const struct gl_backend *find_backend(const char *name)
{
    for (size_t i = 0; gl_backend_list[i]; i++)
        if (!strcmp(gl_backend_list[i]->name, name))
            return gl_backend_list[i];
    return NULL;
}

enum status gl_backend_check(const char *name, const char *who, struct error *error)
{
    if (find_backend(name))
        return STATUS_OK;
    char words[128] = "";
    for (size_t i = 0; gl_backends[i]; i++)
        snprintf(words + strlen(words), sizeof words - strlen(words), "%s%s", i ? "|" : "",
                 gl_backends[i]);
    return error_set(error, STATUS_INVALID, "%s: '%s' is not one of %s", who, name,
                     *words ? words : "none (built without OpenGL)");
}

static enum status open_named(const char *name, const char *who, struct gl **gl,
                              struct error *error)
{
    enum status status = gl_backend_check(name, who, error);
    return status ? status : open_backend(find_backend(name), false, gl, error);
}

enum status gl_context_create(const char *backend, int threads, struct gl **gl, struct error *error)
{
    static const struct {
        const char *name;
        bool want_gpu;
    } order[] = {
        {"egl-device", true}, {"osmesa", false}, {"egl-surfaceless", false}, {"egl-device", false}};
    *gl = NULL;
    if (threads > 0) {
        char text[16];
        snprintf(text, sizeof text, "%d", threads);
        setenv("LP_NUM_THREADS", text, 1);
    }
    const char *wanted = getenv("TREELINE_GL");
    if (backend)
        return open_named(backend, "GL back end", gl, error);
    if (wanted && *wanted)
        return open_named(wanted, "TREELINE_GL", gl, error);
    char answers[512] = "";
    for (size_t i = 0; i < sizeof order / sizeof *order; i++) {
        const struct gl_backend *candidate = find_backend(order[i].name);
        struct error answer = {STATUS_UNAVAILABLE, "not built in"};
        if (candidate && open_backend(candidate, order[i].want_gpu, gl, &answer) == STATUS_OK)
            return STATUS_OK;
        snprintf(answers + strlen(answers), sizeof answers - strlen(answers), "%s%s%s%.100s",
                 i ? "; " : "", candidate ? "" : order[i].name, candidate ? "" : ": ", answer.text);
    }
    return error_set(error, STATUS_UNAVAILABLE, "no OpenGL 4.5 here: %s", answers);
}

void gl_context_destroy(struct gl *gl)
{
    if (!gl)
        return;
    gl_books_clear(gl);
    gl->books->backend->destroy(gl->books->context);
    arena_destroy(gl->books->arena);
}

static const char *error_word(GLenum code)
{
    switch (code) {
    case GL_INVALID_ENUM:
        return "GL_INVALID_ENUM";
    case GL_INVALID_VALUE:
        return "GL_INVALID_VALUE";
    case GL_INVALID_OPERATION:
        return "GL_INVALID_OPERATION";
    case GL_INVALID_FRAMEBUFFER_OPERATION:
        return "GL_INVALID_FRAMEBUFFER_OPERATION";
    case GL_OUT_OF_MEMORY:
        return "GL_OUT_OF_MEMORY";
    default:
        return "an unknown error";
    }
}

enum status gl_check(struct gl *gl, const char *where, struct error *error)
{
    char words[256] = "";
    /* A lost context answers with an error for ever. */
    for (int i = 0; i < 8; i++) {
        GLenum code = gl->GetError();
        if (code == GL_NO_ERROR)
            break;
        snprintf(words + strlen(words), sizeof words - strlen(words), "%s%s", i ? ", " : "",
                 error_word(code));
    }
    return *words ? error_set(error, STATUS_GL, "%s: OpenGL reported %s", where, words) : STATUS_OK;
}
