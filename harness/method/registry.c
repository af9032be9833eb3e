/* Methods by name, and plugins by the path of their shared object. */
#include "base/nearest.h"
#include "method/method.h"

#include <dlfcn.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

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

static enum status method_load(const char *path, const struct method **method, struct error *error)
{
    char symbol[128];
    /* dlopen searches its own folders for a name without a slash. */
    char *real = realpath(path, NULL);
    if (!real)
        return error_errno(error, STATUS_NOT_FOUND, "plugin %s", path);
    void *library = dlopen(real, RTLD_NOW | RTLD_LOCAL);
    free(real);
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
