/* One repetition of a cell: in this process, in a child, and what became of the child. */
#include "cell/cell.h"

#include "base/clock.h"
#include "cell/process.h"
#include "cell/stage.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

static const char *now_iso(struct arena *arena)
{
    struct timespec now;
    struct tm parts;
    char text[32];
    clock_gettime(CLOCK_REALTIME, &now);
    gmtime_r(&now.tv_sec, &parts);
    strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%S", &parts);
    return arena_printf(arena, "%s.%03ldZ", text, now.tv_nsec / 1000000);
}

/* The order of things. */
static enum status passes_run(struct stage *stage)
{
    enum status status = stage_open(stage);
    if (!status)
        status = stage_prepare(stage);
    if (!status)
        status = stage_time(stage);
    if (!status)
        status = stage_relight(stage);
    if (!status)
        status = stage_pictures(stage);
    if (!status)
        status = stage_build_cold(stage);
    return status;
}

static enum status repetition_run(struct arena *arena, const struct plan *plan,
                                  const struct cell *cell, int repetition, const char *folder,
                                  int announce, struct result *result)
{
    double start = clock_wall_seconds();
    struct error error = {0};
    result_init(result, cell, repetition);
    struct stage stage = {.plan = plan,
                          .cell = cell,
                          .folder = folder,
                          .result_arena = arena,
                          .result = result,
                          .error = &error,
                          .announce = announce};
    result->started = now_iso(arena);
    result->status = passes_run(&stage);
    stage_close(&stage);
    if (result->status)
        result->message = arena_strdup(arena, error.text);
    result->seconds = clock_wall_seconds() - start;
    return result->status;
}

struct order {
    const struct plan *plan;
    const struct cell *cell;
    int repetition;
    const char *folder;
};

/* In the child: everything, then one line with the result. */
static enum status order_work(void *context, int out)
{
    const struct order *order = context;
    struct arena *arena = arena_create(0);
    struct result result;
    repetition_run(arena, order->plan, order->cell, order->repetition, order->folder, out, &result);
    const char *line = result_to_json(arena, &result);
    if (dprintf(out, "%s\n", line) < 0)
        return STATUS_IO;
    return result.status;
}

/* What the child said last: its result, or the pass it was in. */
static void output_read(struct arena *arena, char *output, char **result, const char **pass)
{
    *result = NULL;
    *pass = "the start";
    for (char *line; (line = strsep(&output, "\n"));) {
        if (*line == '#')
            *pass = arena_strdup(arena, line + 1);
        else if (*line == '{' && output)
            *result = line;
    }
}

static bool status_listed(int code)
{
    return *status_meaning((enum status)code) && code != STATUS_OK;
}

/* Classifies a child that gave no result. */
static void outcome_tell(struct arena *arena, const struct plan *plan,
                         const struct process_outcome *outcome, const char *pass,
                         struct result *result)
{
    const char *colon = *outcome->errors ? ": " : "";
    result->signal = outcome->timed_out ? 0 : outcome->signal;
    if (outcome->timed_out) {
        result->status = STATUS_TIMEOUT;
        result->message =
            arena_printf(arena, "ran past its limit of %g s in %s", plan->timeout_seconds, pass);
    } else if (outcome->out_of_memory) {
        result->status = STATUS_MEMORY;
        result->message = arena_printf(arena, "the system had no memory left in %s", pass);
    } else if (outcome->signal) {
        result->status = STATUS_CRASH;
        result->message = arena_printf(arena, "died of signal %d (%s) in %s%s%s", outcome->signal,
                                       strsignal(outcome->signal), pass, colon, outcome->errors);
    } else if (status_listed(outcome->exit_code)) {
        result->status = (enum status)outcome->exit_code;
        result->message = arena_printf(arena, "in %s%s%s", pass, colon, outcome->errors);
    } else {
        result->status = STATUS_CRASH;
        result->message = arena_printf(arena, "left by exit code %d in %s%s%s", outcome->exit_code,
                                       pass, colon, outcome->errors);
    }
}

enum status cell_run(struct arena *arena, const struct plan *plan, const struct cell *cell,
                     int repetition, const char *folder, struct result *result)
{
    struct order order = {plan, cell, repetition, folder};
    struct process_request request = {
        .work = order_work, .context = &order, .timeout_seconds = plan->timeout_seconds};
    struct process_outcome outcome;
    struct error error = {0};
    const char *started = now_iso(arena), *pass;
    char *line;
    result_init(result, cell, repetition);
    result->started = started;
    result->status = process_run(arena, &request, &outcome, &error);
    if (result->status) {
        result->message = arena_strdup(arena, error.text);
        return result->status;
    }
    result->seconds = outcome.seconds;
    if (outcome.interrupted) {
        result->status = STATUS_INTERRUPTED;
        result->message = "stopped before its end";
        return STATUS_INTERRUPTED;
    }
    output_read(arena, outcome.output, &line, &pass);
    if (!line || outcome.signal || outcome.timed_out) {
        outcome_tell(arena, plan, &outcome, pass, result);
        return result->status;
    }
    struct result told;
    if (result_from_json(arena, line, "the cell's process", &told, &error)) {
        result->status = STATUS_INTERNAL;
        result->message = arena_strdup(arena, error.text);
        return result->status;
    }
    *result = told;
    result->cell = *cell;
    result->seconds = outcome.seconds;
    return result->status;
}

/* A stage outside a run: nothing of its result is kept. */
static struct stage stage_for_pictures(struct arena *arena, const struct plan *plan,
                                       const struct cell *cell, struct result *result,
                                       struct error *error)
{
    result_init(result, cell, 0);
    return (struct stage){.plan = plan,
                          .cell = cell,
                          .result_arena = arena,
                          .result = result,
                          .error = error,
                          .announce = -1};
}

/* One picture of a prepared cell, checked. */
static enum status picture_of(struct stage *stage, const struct view *view, struct arena *arena,
                              struct frame **frame)
{
    enum status status = stage_draw(stage, view, NULL);
    if (!status)
        status = stage_check(stage, "draw");
    if (status)
        return status;
    *frame = stage_read(stage, arena);
    return frame_check(*frame, stage->error);
}

enum status cell_render(struct arena *arena, const struct cell *cell, double time,
                        const struct view *view, const char *backend, struct frame **frame,
                        struct error *error)
{
    struct plan plan = {.backend = backend};
    struct result result;
    struct stage stage = stage_for_pictures(arena, &plan, cell, &result, error);
    struct view along;
    enum status status = stage_open(&stage);
    if (!status)
        status = stage_prepare(&stage);
    if (!status) {
        view_at(stage.scene, time, &along);
        status = picture_of(&stage, view ? view : &along, arena, frame);
    }
    stage_close(&stage);
    return status;
}

enum status cell_render_views(const struct cell *cell, const struct view *views, size_t count,
                              const char *backend, const struct cell_taker *taker,
                              struct error *error)
{
    struct arena *arena = arena_create(0);
    struct plan plan = {.backend = backend};
    struct result result;
    struct stage stage = stage_for_pictures(arena, &plan, cell, &result, error);
    enum status status = stage_open(&stage);
    if (!status)
        status = stage_prepare(&stage);
    for (size_t i = 0; i < count && !status; i++) {
        struct arena *scratch = arena_create(0);
        struct frame *frame;
        status = picture_of(&stage, &views[i], scratch, &frame);
        if (!status)
            status = taker->take(taker->context, i, frame, error);
        arena_destroy(scratch);
    }
    stage_close(&stage);
    arena_destroy(arena);
    return status;
}
