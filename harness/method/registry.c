/* Methods by name, and plugins by the path of their shared object. */
#include "base/child.h"
#include "base/nearest.h"
#include "method/method.h"

#include <dlfcn.h>
#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

/* "dir/cross-quads.so" -> "cross_quads_method" */
static bool symbol_name(const char *path, char *symbol, size_t size)
{
    const char *base = strrchr(path, '/');
    base = base ? base + 1 : path;
    int length = (int)strcspn(base, ".");
    if (snprintf(symbol, size, "%.*s_method", length, base) >= (int)size)
        return false;
    for (char *c = symbol; *c; c++)
        if (*c == '-')
            *c = '_';
    return length > 0;
}

enum { LOAD_SECONDS = 20, LOADED = 42 };

/* Loads the file in a child first: a cut or damaged one crashes the dynamic loader, a pipe keeps it
 * waiting, and what its constructors do is theirs. A file that is loaded already is not tried
 * again. */
static enum status load_try(const char *path, const char *real, struct error *error)
{
    struct stat info;
    if (stat(real, &info) != 0 || !S_ISREG(info.st_mode))
        return error_set(error, STATUS_INVALID, "plugin %s: is not a regular file", path);
    void *loaded = dlopen(real, RTLD_NOW | RTLD_LOCAL | RTLD_NOLOAD);
    if (loaded)
        return dlclose(loaded), STATUS_OK;
    int state = 0;
    fflush(NULL);
    pid_t child = fork();
    if (child == 0) {
        child_begin(LOAD_SECONDS);
        dlopen(real, RTLD_NOW | RTLD_LOCAL);
        _exit(LOADED); /* what a constructor leaves by is not likely to be this */
    }
    if (child < 0)
        return error_errno(error, STATUS_INTERNAL, "plugin %s: cannot be tried", path);
    while (waitpid(child, &state, 0) < 0)
        if (errno != EINTR)
            return error_errno(error, STATUS_INTERNAL, "plugin %s: its trial was lost", path);
    if (WIFSIGNALED(state) && WTERMSIG(state) == SIGALRM)
        return error_set(error, STATUS_TIMEOUT, "plugin %s: takes more than %d s to load", path,
                         LOAD_SECONDS);
    if (WIFSIGNALED(state))
        return error_set(error, STATUS_CRASH, "plugin %s: dies of signal %d (%s) when it is loaded",
                         path, WTERMSIG(state), strsignal(WTERMSIG(state)));
    if (WEXITSTATUS(state) != LOADED)
        return error_set(error, STATUS_CRASH, "plugin %s: leaves by exit code %d when it is loaded",
                         path, WEXITSTATUS(state));
    return STATUS_OK;
}

static enum status method_load(const char *path, const struct method **method, struct error *error)
{
    char symbol[128];
    /* dlopen searches its own folders for a name without a slash. */
    char *real = realpath(path, NULL);
    if (!real)
        return error_errno(error, STATUS_NOT_FOUND, "plugin %s", path);
    enum status status = load_try(path, real, error);
    void *library = status == STATUS_OK ? dlopen(real, RTLD_NOW | RTLD_LOCAL) : NULL;
    free(real);
    if (status != STATUS_OK)
        return status;
    if (!library)
        return error_set(error, STATUS_INVALID, "plugin %s: is not a loadable method: %s", path,
                         dlerror());
    if (!symbol_name(path, symbol, sizeof symbol))
        return error_set(error, STATUS_INVALID, "plugin %s: its name must be NAME.so", path);
    const struct method *found = dlsym(library, symbol);
    if (!found)
        return error_set(error, STATUS_INVALID,
                         "plugin %s: does not define 'const struct method %s'", path, symbol);
    if (found->abi != METHOD_ABI)
        return error_set(error, STATUS_INVALID,
                         "plugin %s: was built for method ABI %u; this treeline has %u", path,
                         found->abi, METHOD_ABI);
    if (!found->name || !found->prepare || !found->draw || (found->options && !found->options_size))
        return error_set(error, STATUS_INVALID,
                         "plugin %s: %s lacks a name, prepare, draw or options_size", path, symbol);
    *method = found;
    return STATUS_OK;
}

enum status method_needs_no_stretch(const struct scene *scene, const char **reason)
{
    if (!scene_is_stretched(scene))
        return STATUS_OK;
    *reason = "its trees keep their plants' ratio of height to width; this scene has `stretch`";
    return STATUS_UNSUPPORTED;
}

enum status method_find(const char *name, const struct method **method, struct error *error)
{
    size_t length = strlen(name);
    if (strchr(name, '/') || (length > 3 && strcmp(name + length - 3, ".so") == 0))
        return method_load(name, method, error);
    const char *nearest = NULL;
    for (const struct method *const *each = methods_builtin; *each; each++) {
        if (strcmp((*each)->name, name) == 0) {
            *method = *each;
            return STATUS_OK;
        }
        nearest = nearest_of(name, nearest, (*each)->name);
    }
    return error_set(
        error, STATUS_NOT_FOUND, "no method '%s'%s%s%s; `treeline list methods` has them all", name,
        nearest ? "; did you mean '" : "", nearest ? nearest : "", nearest ? "'?" : "");
}
