/* A method that goes wrong in the way its option names; for the tests of cells and of the command
 * line. */
#include "method/method.h"

#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>
#include <unistd.h>

#define WAYS                                                                                       \
    "none|hang|hang-hard|crash|exit-0|exit-1|memory|nan|undrawn|gl-error|silent|random|orphan|"    \
    "noisy|slow"

enum way {
    NONE,
    HANG,
    HANG_HARD,
    CRASH,
    EXIT_0,
    EXIT_1,
    MEMORY,
    PICTURE_NAN,
    UNDRAWN,
    GL_ERROR,
    SILENT,
    RANDOM,
    ORPHAN,
    NOISY,
    SLOW
};

struct options {
    int way;
};

static const struct option options[] = {
    OPTION_WORD(struct options, way, NONE, WAYS, "how it goes wrong"),
    OPTION_END,
};

struct state {
    enum way way;
    void *memory;
};

static enum status supported(const struct scene *scene, const char **reason)
{
    *reason = "four trees are too many";
    return scene->instances_count == 4 ? STATUS_UNSUPPORTED : STATUS_OK;
}

static void wait_forever(bool hard)
{
    sigset_t alarm_signal;
    sigemptyset(&alarm_signal);
    sigaddset(&alarm_signal, SIGALRM);
    if (hard)
        sigprocmask(SIG_BLOCK, &alarm_signal, NULL);
    for (;;)
        nanosleep(&(struct timespec){.tv_sec = 1}, NULL);
}

static enum status prepare(struct workspace *workspace, const struct scene *scene,
                           const void *given, void **state)
{
    (void)scene;
    struct state *made = *state = ARENA_NEW(workspace->arena, struct state);
    made->way = (enum way)((const struct options *)given)->way;
    if (made->way == HANG || made->way == HANG_HARD)
        wait_forever(made->way == HANG_HARD);
    if (made->way == CRASH) {
        fprintf(stderr, "about to abort\n");
        abort();
    }
    if (made->way == EXIT_0 || made->way == EXIT_1)
        _exit(made->way == EXIT_1); /* exit would let a leak checker change the code */
    if (made->way == MEMORY)
        made->memory = arena_alloc(workspace->arena, 256, 1 << 20);
    if (made->way == ORPHAN && !fork())
        wait_forever(true);
    if (made->way == NOISY)
        printf("a library says something on stdout\n");
    return STATUS_OK;
}

static enum status draw(struct workspace *workspace, void *state, const struct view *view,
                        struct target *target)
{
    (void)view;
    const struct state *own = state;
    struct gl *gl = workspace->gl;
    float color[4] = {0.25f, 0.5f, 0.75f, 0};
    if (own->way == PICTURE_NAN)
        color[1] = NAN;
    if (own->way == RANDOM) {
        struct timespec now;
        clock_gettime(CLOCK_REALTIME, &now);
        color[0] = (float)(now.tv_nsec % 1000) / 1000;
        color[1] = (float)(now.tv_nsec / 1000 % 1000) / 1000;
    }
    if (own->way == SILENT)
        return STATUS_GL;
    if (own->way == GL_ERROR)
        gl->Enable(GL_RGBA);
    if (own->way == SLOW)
        nanosleep(&(struct timespec){.tv_nsec = 50000000}, NULL);
    if (own->way != UNDRAWN)
        gl->ClearNamedFramebufferfv(target->framebuffer, GL_COLOR, 0, color);
    return STATUS_OK;
}

extern const struct method bad_method;
const struct method bad_method = {
    .abi = METHOD_ABI,
    .name = "bad",
    .summary = "goes wrong as asked",
    .source = "this project",
    .traits = EFFECT_TWO_SIDED,
    .options = options,
    .options_size = sizeof(struct options),
    .supported = supported,
    .prepare = prepare,
    .draw = draw,
};
