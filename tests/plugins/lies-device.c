/* Makes a buffer of 8 MB past the books. */
#include "wrap.h"

static enum status prepare(struct workspace *workspace, const struct scene *scene,
                           const void *options, void **state)
{
    (void)options;
    GLuint buffer;
    workspace->gl->CreateBuffers(1, &buffer);
    workspace->gl->NamedBufferStorage(buffer, 8 << 20, NULL, 0);
    return wrap_prepare(workspace, scene, state);
}

static enum status draw(struct workspace *workspace, void *state, const struct view *view,
                        struct target *target)
{
    return wrap_draw(workspace, state, view, target);
}

WRAP_METHOD(lies_device, "lies-device", WRAP_TRAITS);
