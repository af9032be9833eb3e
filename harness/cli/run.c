/* treeline run: plan, folder, references, rounds, table, report. */
#include "cli/run.h"

#include "base/clock.h"
#include "base/hash.h"
#include "base/plural.h"
#include "base/progress.h"
#include "cell/cell.h"
#include "plan/settings.h"
#include "report/report.h"
#include "results/run.h"

#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

static const char *folder_choose(struct arena *arena, const struct run_request *request,
                                 const struct plan *plan)
{
    if (!request->out) {
        time_t now = time(NULL);
        struct tm parts;
        char text[32];
        gmtime_r(&now, &parts);
        strftime(text, sizeof text, "%Y%m%d-%H%M%S", &parts);
        return arena_printf(arena, "results/%s-%s", plan->name, text);
    }
    char *folder = arena_strdup(arena, request->out);
    for (size_t end = strlen(folder); end > 1 && folder[end - 1] == '/'; end--)
        folder[end - 1] = 0;
    return folder;
}

/* A word that a shell reads back as this text. */
static const char *shell_word(struct arena *arena, const char *text)
{
    static const char plain[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789"
                                "-_./:=,+@%";
    if (*text && !text[strspn(text, plain)])
        return text;
    const char *word = "'";
    for (const char *quote; (quote = strchr(text, '\'')); text = quote + 1)
        word = arena_printf(arena, "%s%.*s'\\''", word, (int)(quote - text), text);
    return arena_printf(arena, "%s%s'", word, text);
}

static const char *command_join(struct arena *arena, int argc, char **argv)
{
    const char *text = argv[0];
    for (int i = 1; i < argc; i++)
        text = arena_printf(arena, "%s %s", text, shell_word(arena, argv[i]));
    return text;
}

/* What one repetition takes about: start-up, warm-up, the timed frames, pictures. */
static double repetition_guess_seconds(const struct plan *plan)
{
    return 1 + 1.7 * plan->frame_seconds;
}

/* The repetitions already told in the folder, as a set of hashes of cell and repetition. */
struct done {
    size_t slots_count;
    uint64_t *slots;
    size_t failed; /* of them */
};

static uint64_t repetition_hash(const char *cell, int repetition)
{
    uint64_t hash = hash_u64(hash_text(0, cell), (uint64_t)repetition);
    return hash ? hash : 1;
}

static uint64_t *done_slot(const struct done *done, uint64_t hash)
{
    size_t i = hash & (done->slots_count - 1);
    while (done->slots[i] && done->slots[i] != hash)
        i = (i + 1) & (done->slots_count - 1);
    return &done->slots[i];
}

static enum status done_read(struct arena *arena, const char *folder, bool retry, struct done *done,
                             struct error *error)
{
    struct run *run;
    enum status status = run_read(arena, folder, &run, error);
    if (status)
        return status;
    for (done->slots_count = 16; done->slots_count < 4 * run->results_count;)
        done->slots_count *= 2;
    done->slots = ARENA_ARRAY(arena, uint64_t, done->slots_count);
    for (int failures = 0; failures <= (int)!retry; failures++)
        for (size_t i = 0; i < run->results_count; i++) {
            const struct result *result = &run->results[i];
            uint64_t hash = repetition_hash(result->cell.name, result->repetition);
            uint64_t *slot = done_slot(done, hash);
            if ((result->status != STATUS_OK) != failures || *slot == hash)
                continue;
            *slot = hash;
            done->failed += (size_t)failures;
        }
    return STATUS_OK;
}

struct rounds {
    const struct run_request *request;
    const struct plan *plan;
    const char *folder;
    struct done done;
    struct progress *progress;
    size_t count, finished, failed;
};

static enum status repetition_do(struct rounds *rounds, const struct cell *cell, int repetition,
                                 struct error *error)
{
    uint64_t hash = repetition_hash(cell->name, repetition);
    if (*done_slot(&rounds->done, hash) == hash)
        return STATUS_OK;
    struct arena *arena = arena_create(0);
    struct result result;
    progress_update(rounds->progress, (double)rounds->finished, cell->name);
    enum status status = cell_run(arena, rounds->plan, cell, repetition, rounds->folder, &result);
    if (status == STATUS_INTERRUPTED) {
        arena_destroy(arena);
        return error_set(error, status,
                         "stopped; finished repetitions are in %s, --resume continues",
                         rounds->folder);
    }
    if (result.status && !rounds->request->quiet)
        fprintf(stderr, "%streeline: %s: %s: %s\n", isatty(STDERR_FILENO) ? "\r\033[K" : "",
                cell->name, status_word(result.status), result.message);
    rounds->failed += result.status != STATUS_OK;
    status = run_append(rounds->folder, &result, error);
    rounds->finished++;
    progress_update(rounds->progress, (double)rounds->finished, cell->name);
    arena_destroy(arena);
    return status;
}

/* What a calibration takes beside its measuring, and the least that it measures. */
static const double calibration_setup_seconds = 0.5, calibration_least_seconds = 0.2;

/* The machine drifts, so calibrations are spread over the rounds: as many as a twentieth of the
 * plan's measuring, at most CALIBRATE_SECONDS, has room for. */
static int calibrations_count(const struct plan *plan, double *seconds)
{
    double share = 0.05 * (double)plan->cells_count * plan->rounds * repetition_guess_seconds(plan);
    double all = fmin(share, CALIBRATE_SECONDS);
    double room = floor(all / (calibration_setup_seconds + calibration_least_seconds));
    double count = fmin(fmax(room, 1), plan->rounds);
    *seconds = fmax(all / count - calibration_setup_seconds, calibration_least_seconds);
    return (int)count;
}

/* The first round and others evenly spaced. */
static enum status round_calibrate(struct arena *arena, const struct rounds *rounds, int round,
                                   struct error *error)
{
    const struct plan *plan = rounds->plan;
    double seconds;
    int64_t count = calibrations_count(plan, &seconds);
    if (rounds->request->no_calibrate ||
        (round && round * count / plan->rounds == (round - 1) * count / plan->rounds))
        return STATUS_OK;
    progress_update(rounds->progress, (double)rounds->finished, "what this machine can do at most");
    return cell_calibrate(arena, plan, rounds->folder, round, seconds, error);
}

/* Repetitions of the round that are not told yet. */
static size_t round_left(const struct rounds *rounds, int round)
{
    size_t left = 0;
    for (size_t i = 0; i < rounds->plan->cells_count; i++) {
        uint64_t hash = repetition_hash(rounds->plan->cells[i].name, round);
        left += *done_slot(&rounds->done, hash) != hash;
    }
    return left;
}

static enum status round_do(struct arena *arena, struct rounds *rounds, int round, size_t *order,
                            struct error *error)
{
    const struct plan *plan = rounds->plan;
    if (!round_left(rounds, round))
        return STATUS_OK;
    enum status status = round_calibrate(arena, rounds, round, error);
    plan_order(plan, round, order);
    for (size_t i = 0; i < plan->cells_count && !status; i++)
        status = repetition_do(rounds, &plan->cells[order[i]], round, error);
    return status;
}

static enum status rounds_do(struct arena *arena, struct rounds *rounds, struct error *error)
{
    const struct plan *plan = rounds->plan;
    size_t *order = ARENA_ARRAY(arena, size_t, plan->cells_count);
    for (int round = 0; round < plan->rounds; round++)
        rounds->count += round_left(rounds, round);
    if (!rounds->request->quiet)
        fprintf(stderr,
                "treeline: %zu repetition%s of %zu cell%s into %s, about %.0f s of measuring\n",
                rounds->count, plural(rounds->count), plan->cells_count, plural(plan->cells_count),
                rounds->folder, (double)rounds->count * repetition_guess_seconds(plan));
    if (rounds->done.failed && !rounds->request->quiet)
        fprintf(stderr, "treeline: %zu repetition%s failed before; --retry runs them again\n",
                rounds->done.failed, plural(rounds->done.failed));
    if (!rounds->count)
        return STATUS_OK;
    enum status status =
        cell_references(arena, plan, rounds->folder, rounds->request->quiet, error);
    if (status)
        return status;
    rounds->progress = progress_start("cells", (double)rounds->count, rounds->request->quiet);
    for (int round = 0; round < plan->rounds && !status; round++)
        status = round_do(arena, rounds, round, order, error);
    progress_end(rounds->progress);
    return status;
}

/* All that runs: lock, provenance, references, rounds. folder must hold the run's path.
 * STATUS_CELLS_FAILED when a cell failed, STATUS_INTERRUPTED after a signal. */
static enum status run_all(struct arena *arena, const struct run_request *request,
                           const struct plan *plan, const char *folder, const char *command,
                           struct error *error)
{
    /* Held back here, so that they reach whoever waits for a child, and never cut a line of the
     * results. */
    sigset_t held, before;
    sigemptyset(&held);
    sigaddset(&held, SIGINT);
    sigaddset(&held, SIGTERM);
    sigaddset(&held, SIGHUP);
    sigprocmask(SIG_BLOCK, &held, &before);
    int lock = -1;
    struct provenance provenance;
    struct rounds rounds = {.request = request, .plan = plan, .folder = folder};
    provenance_here(arena, plan, command, plan_settings_command(arena, plan), &provenance);
    enum status status = run_lock(folder, &lock, error);
    if (status)
        return status;
    status = run_open(folder, &provenance, request->resume, error);
    if (!status)
        status = done_read(arena, folder, request->retry, &rounds.done, error);
    if (!status)
        status = rounds_do(arena, &rounds, error);
    run_unlock(lock);
    if (status !=
        STATUS_INTERRUPTED) /* a second Ctrl-C must not cut what is said about the first */
        sigprocmask(SIG_SETMASK, &before, NULL);
    if (!status && rounds.failed)
        return error_set(error, STATUS_CELLS_FAILED, "%zu of %zu repetition%s failed",
                         rounds.failed, rounds.count, plural(rounds.count));
    return status;
}

static enum status plan_print(const struct plan *plan)
{
    for (size_t i = 0; i < plan->cells_count; i++)
        printf("%s\n", plan->cells[i].name);
    double seconds = (double)plan->cells_count * plan->rounds * repetition_guess_seconds(plan);
    fprintf(stderr, "treeline: %zu cell%s, %d round%s, about %.0f s of measuring\n",
            plan->cells_count, plural(plan->cells_count), plan->rounds,
            plural((size_t)plan->rounds), seconds);
    return STATUS_OK;
}

/* Where JSON goes to stdout, the page's path goes to stderr. */
static enum status report_make(struct arena *arena, const char *folder, bool json,
                               struct error *error)
{
    const char *slash = strrchr(folder, '/');
    const char *out = arena_printf(arena, "reports/%s", slash ? slash + 1 : folder);
    enum status status = report_write(folder, out, error);
    if (!status)
        fprintf(json ? stderr : stdout, "%s/index.html\n", out);
    return status;
}

int verb_run(int argc, char **argv)
{
    struct arena *arena = arena_create(0);
    struct error error = {0}, later = {0};
    struct run_request request = {0};
    struct plan *plan;
    const char *command = command_join(arena, argc, argv);
    run_request_parse(arena, argc, argv, &request);
    enum status status = plan_load(arena, &request.plan, &plan, &error);
    if (status || request.dry_run) {
        int code = status ? cli_fail(&error) : (int)plan_print(plan);
        arena_destroy(arena);
        return code;
    }
    const char *folder = folder_choose(arena, &request, plan);
    status = run_all(arena, &request, plan, folder, command, &error);
    bool finished = status == STATUS_OK || status == STATUS_CELLS_FAILED;
    enum status then = STATUS_OK;
    if (finished)
        then = run_table(arena, folder, request.json, &later);
    if (finished && !then && request.report)
        then = report_make(arena, folder, request.json, &later);
    arena_destroy(arena);
    if (then)
        cli_fail(&later);
    return status ? cli_fail(&error) : (int)then;
}
