/* Bends one rule: fails in the check that the environment variable BENDS names, where that check
 * looks. */
#include "wrap.h"

#include <stdlib.h>
#include <string.h>

struct options {
    int detail;
};

static const struct option options[] = {
    OPTION(struct options, detail, 1, 1, 10, "", "ten is too much"),
    OPTION_END,
};

struct state {
    void *wrapped;
    const struct scene *scene;
    int detail;
    float sun[3]; /* of the first picture */
    bool lit;
};

static bool bends(const char *check)
{
    const char *wanted = getenv("BENDS");
    return wanted && strcmp(wanted, check) == 0;
}

static enum status prepare(struct workspace *workspace, const struct scene *scene,
                           const void *values, void **state)
{
    struct state *made = *state = ARENA_NEW(workspace->arena, struct state);
    made->scene = scene;
    made->detail = ((const struct options *)values)->detail;
    if (bends("million") && scene->instances_count > 100000)
        return STATUS_MEMORY;
    return wrap_prepare(workspace, scene, &made->wrapped);
}

/* Covers the lower half, or all, by one colour without coverage. */
static void blot(struct gl *gl, const struct target *target, float red, bool all)
{
    const float color[4] = {red, 0, 0, 0};
    gl->Enable(GL_SCISSOR_TEST);
    gl->Scissor(0, 0, target->width_px, all ? target->height_px : (target->height_px + 1) / 2);
    gl->ClearNamedFramebufferfv(target->framebuffer, GL_COLOR, 0, color);
    gl->Disable(GL_SCISSOR_TEST);
}

static enum status draw(struct workspace *workspace, void *own, const struct view *view,
                        struct target *target)
{
    struct state *state = own;
    const struct scene *scene = state->scene;
    struct gl *gl = workspace->gl;
    struct view used = *view;
    const float near2 = view->eye_m[0] * view->eye_m[0] + view->eye_m[2] * view->eye_m[2];
    if (!state->lit)
        memcpy(state->sun, view->sun_direction, sizeof state->sun);
    state->lit = true;
    if (bends("sun-moved"))
        memcpy(used.sun_direction, state->sun, sizeof state->sun);
    enum status status = wrap_draw(workspace, state->wrapped, &used, target);
    if ((bends("lod") && workspace->lod == LOD_HIGH) ||
        (bends("empty") && !scene->instances_count) || (bends("scale") && view->far_m > 1e6f) ||
        (bends("huge") && target->width_px > 4096) || (bends("down") && view->forward[1] <= -1) ||
        (bends("sun") && view->sun_direction[1] < 0) ||
        (bends("offset") && strstr(scene->path, "tree-999000")))
        blot(gl, target, 1, false);
    if ((bends("close") && near2 < 100 && target->width_px == 64) ||
        (bends("user-mesh") && strstr(scene->path, "tree-0")) ||
        (bends("pixel") && scene->instances_count == 2500))
        blot(gl, target, 0.5f, true);
    if ((bends("options") && state->detail == 10) || (bends("tiny") && target->width_px == 1))
        blot(gl, target, NAN, true);
    return status;
}

extern const struct method bends_method;
const struct method bends_method = {
    .abi = METHOD_ABI,
    .name = "bends",
    .summary = "cross quads that misbehave",
    .source = "this project",
    .traits = WRAP_TRAITS,
    .options = options,
    .options_size = sizeof(struct options),
    .prepare = prepare,
    .draw = draw,
};
