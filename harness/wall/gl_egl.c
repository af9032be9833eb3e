/* The EGL back ends: Mesa's surfaceless platform, and a device (a GPU first, the software device
 * last). */
#include "wall/gl_load.h"

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <stdlib.h>
#include <string.h>

enum { DEVICES_MAX = 32 };

struct egl {
    EGLDisplay display;
    EGLContext context;
    __typeof__(&eglGetProcAddress) get_proc_address;
    __typeof__(&eglQueryString) query_string;
    __typeof__(&eglInitialize) initialize;
    __typeof__(&eglTerminate) terminate;
    __typeof__(&eglBindAPI) bind_api;
    __typeof__(&eglChooseConfig) choose_config;
    __typeof__(&eglCreateContext) create_context;
    __typeof__(&eglDestroyContext) destroy_context;
    __typeof__(&eglMakeCurrent) make_current;
    __typeof__(&eglReleaseThread) release_thread;
    PFNEGLGETPLATFORMDISPLAYEXTPROC get_platform_display;
};

/* A word of a list parted by spaces. */
static bool has_word(const char *list, const char *word)
{
    size_t length = strlen(word);
    for (const char *at = list; at && (at = strstr(at, word)); at += length)
        if ((at == list || at[-1] == ' ') && (at[length] == ' ' || at[length] == 0))
            return true;
    return false;
}

static enum status load(struct egl *egl, struct error *error)
{
    static const char *const names[] = {"libEGL.so.1", "libEGL.so", NULL};
    void *library = gl_library(names, error);
    if (!library)
        return STATUS_UNAVAILABLE;
#define LOAD(field, name)                                                                          \
    if (!(egl->field = (__typeof__(egl->field))gl_symbol(library, name)))                          \
    return error_set(error, STATUS_UNAVAILABLE, "libEGL lacks %s", name)
    LOAD(get_proc_address, "eglGetProcAddress");
    LOAD(query_string, "eglQueryString");
    LOAD(initialize, "eglInitialize");
    LOAD(terminate, "eglTerminate");
    LOAD(bind_api, "eglBindAPI");
    LOAD(choose_config, "eglChooseConfig");
    LOAD(create_context, "eglCreateContext");
    LOAD(destroy_context, "eglDestroyContext");
    LOAD(make_current, "eglMakeCurrent");
    LOAD(release_thread, "eglReleaseThread");
#undef LOAD
    egl->get_platform_display =
        (PFNEGLGETPLATFORMDISPLAYEXTPROC)egl->get_proc_address("eglGetPlatformDisplayEXT");
    if (!egl->get_platform_display)
        return error_set(error, STATUS_UNAVAILABLE, "libEGL lacks EGL_EXT_platform_base");
    return STATUS_OK;
}

/* A current core context on a display; undoes everything when it cannot. */
static enum status open_display(struct egl *egl, EGLDisplay display, struct error *error)
{
    static const EGLint config_wanted[] = {EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_SURFACE_TYPE, 0,
                                           EGL_NONE};
    static const EGLint context_wanted[] = {EGL_CONTEXT_MAJOR_VERSION,
                                            4,
                                            EGL_CONTEXT_MINOR_VERSION,
                                            5,
                                            EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                            EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                            EGL_NONE};
    EGLint major, minor, configs_count = 0;
    EGLConfig config;
    if (display == EGL_NO_DISPLAY || !egl->initialize(display, &major, &minor))
        return error_set(error, STATUS_UNAVAILABLE, "no display");
    const char *what = NULL;
    EGLContext context = EGL_NO_CONTEXT;
    if (!has_word(egl->query_string(display, EGL_EXTENSIONS), "EGL_KHR_surfaceless_context"))
        what = "no EGL_KHR_surfaceless_context";
    else if (!egl->bind_api(EGL_OPENGL_API) ||
             !egl->choose_config(display, config_wanted, &config, 1, &configs_count) ||
             configs_count < 1)
        what = "no configuration for OpenGL";
    else if ((context = egl->create_context(display, config, EGL_NO_CONTEXT, context_wanted)) ==
             EGL_NO_CONTEXT)
        what = "no OpenGL 4.5 core context";
    else if (!egl->make_current(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context)) {
        what = "cannot make its context current";
        egl->destroy_context(display, context);
    }
    if (what) {
        egl->terminate(display);
        return error_set(error, STATUS_UNAVAILABLE, "%s", what);
    }
    egl->display = display;
    egl->context = context;
    return STATUS_OK;
}

static enum status open_surfaceless(struct egl *egl, bool want_gpu, struct error *error)
{
    if (want_gpu) /* it does not say which device it takes */
        return error_set(error, STATUS_UNAVAILABLE, "is not asked for a GPU");
    const char *extensions = egl->query_string(EGL_NO_DISPLAY, EGL_EXTENSIONS);
    if (!has_word(extensions, "EGL_MESA_platform_surfaceless"))
        return error_set(error, STATUS_UNAVAILABLE, "no EGL_MESA_platform_surfaceless");
    return open_display(
        egl, egl->get_platform_display(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, NULL),
        error);
}

static enum status open_device(struct egl *egl, bool want_gpu, struct error *error)
{
    PFNEGLQUERYDEVICESEXTPROC query_devices =
        (PFNEGLQUERYDEVICESEXTPROC)egl->get_proc_address("eglQueryDevicesEXT");
    PFNEGLQUERYDEVICESTRINGEXTPROC query_device_string =
        (PFNEGLQUERYDEVICESTRINGEXTPROC)egl->get_proc_address("eglQueryDeviceStringEXT");
    const char *extensions = egl->query_string(EGL_NO_DISPLAY, EGL_EXTENSIONS);
    EGLDeviceEXT devices[DEVICES_MAX];
    EGLint count = 0;
    if (!query_devices || !query_device_string || !has_word(extensions, "EGL_EXT_platform_device"))
        return error_set(error, STATUS_UNAVAILABLE, "no EGL_EXT_platform_device");
    if (!query_devices(DEVICES_MAX, devices, &count) || count < 1)
        return error_set(error, STATUS_UNAVAILABLE, "no device");
    error_set(error, STATUS_UNAVAILABLE, "no device that is a GPU");
    for (int software = 0; software <= (want_gpu ? 0 : 1); software++)
        for (EGLint i = 0; i < count; i++) {
            const char *words = query_device_string(devices[i], EGL_EXTENSIONS);
            if (has_word(words, "EGL_MESA_device_software") != (bool)software)
                continue;
            EGLDisplay display =
                egl->get_platform_display(EGL_PLATFORM_DEVICE_EXT, devices[i], NULL);
            if (open_display(egl, display, error) == STATUS_OK)
                return STATUS_OK;
            error_context(error, "device %d of %d", (int)i + 1, (int)count);
        }
    return STATUS_UNAVAILABLE;
}

static enum status create(const char *name, enum status (*open)(struct egl *, bool, struct error *),
                          bool want_gpu, void **context, struct error *error)
{
    struct error unread = {0}; /* the openers read back what they set */
    error = error ? error : &unread;
    struct egl *egl = calloc(1, sizeof *egl);
    if (!egl)
        return error_set(error, STATUS_MEMORY, "%s: no memory for a context", name);
    if (load(egl, error) != STATUS_OK || open(egl, want_gpu, error) != STATUS_OK) {
        free(egl);
        return error_context(error, "%s", name);
    }
    *context = egl;
    return STATUS_OK;
}

static enum status create_surfaceless(bool want_gpu, void **context, struct error *error)
{
    return create("egl-surfaceless", open_surfaceless, want_gpu, context, error);
}

static enum status create_device(bool want_gpu, void **context, struct error *error)
{
    return create("egl-device", open_device, want_gpu, context, error);
}

/* The display stays initialised until the process ends: it is shared, the next context wants it
 * again, and terminating it would unload the driver. */
static void destroy(void *context)
{
    struct egl *egl = context;
    egl->make_current(egl->display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    egl->destroy_context(egl->display, egl->context);
    egl->release_thread();
    free(egl);
}

static void (*address(void *context, const char *name))(void)
{
    struct egl *egl = context;
    return (void (*)(void))egl->get_proc_address(name);
}

extern const struct gl_backend gl_egl_surfaceless, gl_egl_device;
const struct gl_backend gl_egl_surfaceless = {"egl-surfaceless", create_surfaceless, destroy,
                                              address};
const struct gl_backend gl_egl_device = {"egl-device", create_device, destroy, address};
