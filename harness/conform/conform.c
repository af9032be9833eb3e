/* The runner: a child a check, and what became of it. */
#include "conform/conform.h"

#include "base/pattern.h"
#include "cell/process.h"
#include "conform/subject.h"

#include <errno.h>
#include <ftw.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const struct check *const groups[] = {checks_contract, checks_resources, checks_pictures,
                                             checks_extremes, checks_tally};

const char *conform_word(enum conform_result result)
{
    static const char *const words[] = {"ok", "skipped", "refused", "FAILED"};
    return words[result];
}

static const struct check *check_at(size_t index)
{
    for (size_t g = 0; g < sizeof groups / sizeof *groups; g++)
        for (const struct check *check = groups[g]; check->name; check++)
            if (!index--)
                return check;
    return NULL;
}

bool conform_check_at(size_t index, const char **name, const char **doc)
{
    const struct check *check = check_at(index);
    if (check) {
        *name = check->name;
        *doc = check->doc;
    }
    return check;
}

struct order {
    const struct conform_request *request;
    const struct check *check;
    const char *folder;
};

/* In the child: its last line is "=" with "skipped", "refused" or nothing, and the message. */
static enum status order_work(void *context, int out)
{
    const struct order *order = context;
    struct error error = {0};
    struct subject subject = {.name = order->request->method,
                              .folder = order->folder,
                              .backend = order->request->backend,
                              .arena = arena_create(0),
                              .error = &error,
                              .out = out};
    subject_say(&subject, "loading the method");
    enum status status = method_find(subject.name, &subject.method, &error);
    subject_say(&subject, "%s", order->check->name);
    if (!status)
        status = order->check->run(&subject);
    const char *kind = status == STATUS_UNSUPPORTED ? "refused"
                       : !status && subject.skipped ? "skipped"
                                                    : "";
    if (dprintf(out, "=%s\t%s\n", kind, status ? error.text : subject.note) < 0)
        return STATUS_IO;
    return status;
}

/* What the child said last: its verdict, or the thing it was at. */
static void output_read(char *output, const char **kind, const char **message, const char **at)
{
    *kind = *message = NULL;
    *at = "the start";
    for (char *line; (line = strsep(&output, "\n"));) {
        if (*line == '#')
            *at = line + 1;
        if (*line != '=')
            continue;
        *kind = strsep(&line, "\t") + 1;
        *message = line ? line : "";
    }
}

static void row_judge(struct arena *arena, const struct conform_request *request,
                      const struct process_outcome *outcome, struct conform_row *row)
{
    const char *kind, *message, *at, *colon = *outcome->errors ? ": " : "";
    double limit = request->timeout_seconds;
    output_read(outcome->output, &kind, &message, &at);
    row->seconds = outcome->seconds;
    row->result = CONFORM_FAILED;
    if (outcome->timed_out) {
        row->status = STATUS_TIMEOUT;
        row->message = arena_printf(arena, "ran past its limit of %g s in: %s", limit, at);
    } else if (outcome->out_of_memory) {
        row->status = STATUS_MEMORY;
        row->message = arena_printf(arena, "the system had no memory left in: %s", at);
    } else if (outcome->signal) {
        row->status = STATUS_CRASH;
        row->message = arena_printf(arena, "died of signal %d (%s) in: %s%s%s", outcome->signal,
                                    strsignal(outcome->signal), at, colon, outcome->errors);
    } else if (message) {
        row->status = (enum status)outcome->exit_code;
        row->message = message;
        row->result = !strcmp(kind, "skipped")   ? CONFORM_SKIPPED
                      : !strcmp(kind, "refused") ? CONFORM_REFUSED
                      : row->status              ? CONFORM_FAILED
                                                 : CONFORM_OK;
    } else if (outcome->exit_code && *status_meaning((enum status)outcome->exit_code)) {
        row->status = (enum status)outcome->exit_code;
        row->message = arena_printf(arena, "in %s%s%s", at, colon, outcome->errors);
    } else {
        row->status = STATUS_CRASH;
        row->message = arena_printf(arena, "left by exit code %d in: %s%s%s", outcome->exit_code,
                                    at, colon, outcome->errors);
    }
}

static enum status check_child(struct arena *arena, const struct order *order,
                               struct conform_row *row, struct error *error)
{
    struct process_request request = {.work = order_work,
                                      .context = (void *)order,
                                      .timeout_seconds = order->request->timeout_seconds};
    struct process_outcome outcome;
    enum status status = process_run(arena, &request, &outcome, error);
    if (status)
        return status;
    if (outcome.interrupted)
        return error_set(error, STATUS_INTERRUPTED, "stopped before its end");
    row_judge(arena, order->request, &outcome, row);
    if (row->result == CONFORM_FAILED && row->status == STATUS_UNAVAILABLE)
        return error_set(error, STATUS_UNAVAILABLE, "%s", row->message);
    return STATUS_OK;
}

/* One check of one method, in one child or in two that must say the same. */
static enum status check_run(struct arena *arena, const struct order *order,
                             struct conform_row *row, struct error *error)
{
    *row = (struct conform_row){.method = order->request->method, .check = order->check->name};
    enum status status = check_child(arena, order, row, error);
    if (status || !order->check->twice || row->result != CONFORM_OK)
        return status;
    struct conform_row again = *row;
    status = check_child(arena, order, &again, error);
    again.seconds += row->seconds;
    if (!status && again.result == CONFORM_OK && strcmp(again.message, row->message) != 0) {
        again.result = CONFORM_FAILED;
        again.status = STATUS_NONCONFORMING;
        again.message =
            arena_printf(arena, "two processes disagree: %s and %s", row->message, again.message);
    }
    *row = again;
    return status;
}

static int remove_one(const char *path, const struct stat *info, int kind, struct FTW *walk)
{
    (void)info, (void)kind, (void)walk;
    return remove(path);
}

static enum status checks_run(struct arena *arena, const struct conform_request *request,
                              const regex_t *pattern, const char *folder, enum status *result,
                              struct error *error)
{
    struct order order = {.request = request, .folder = folder};
    for (size_t i = 0; (order.check = check_at(i)); i++) {
        struct conform_row row;
        bool wanted = !pattern || !regexec(pattern, order.check->name, 0, NULL, 0);
        if (i && !wanted)
            continue;
        enum status status = check_run(arena, &order, &row, error);
        if (status)
            return status;
        if (wanted || row.result == CONFORM_FAILED)
            request->heard(request->listener, &row);
        if (row.result == CONFORM_FAILED)
            *result = i ? STATUS_NONCONFORMING : row.status;
        if (!i && *result)
            return STATUS_OK; /* not loaded: nothing to check */
    }
    return STATUS_OK;
}

enum status conform_run(struct arena *arena, const struct conform_request *given,
                        enum status *result, struct error *error)
{
    struct conform_request request = *given;
    regex_t pattern;
    *result = STATUS_OK;
    if (!(request.timeout_seconds > 0))
        request.timeout_seconds = CONFORM_TIMEOUT_SECONDS;
    enum status status = STATUS_OK;
    if (request.pattern)
        status = pattern_compile(request.pattern, "--check", STATUS_USAGE, &pattern, error);
    if (status)
        return status;
    const char *base = getenv("TMPDIR");
    char *folder = arena_printf(arena, "%s/treeline-conform-XXXXXX", base && *base ? base : "/tmp");
    if (!mkdtemp(folder))
        status = error_errno(error, STATUS_IO, "%s", folder);
    if (!status) {
        status =
            checks_run(arena, &request, request.pattern ? &pattern : NULL, folder, result, error);
        nftw(folder, remove_one, 8, FTW_DEPTH | FTW_PHYS);
    }
    if (request.pattern)
        regfree(&pattern);
    return status;
}
