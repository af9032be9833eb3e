/* The calibration of a run: in a child process before a round, once for each target format of its
 * cells. */
#include "cell/cell.h"

#include "cell/process.h"
#include "results/calibration.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* In the child: one line with the calibration. */
static enum status calibration_work(void *context, int out)
{
    const struct calibrate_request *request = context;
    struct arena *arena = arena_create(0);
    struct calibration calibration;
    struct error error = {0};
    enum status status = calibrate_run(arena, request, &calibration, &error);
    if (!status && dprintf(out, "%s\n", calibration_to_json(arena, &calibration)) < 0)
        return STATUS_IO;
    if (status)
        fprintf(stderr, "\n%s\n", error.text);
    return status;
}

/* Measures and keeps one; what fails is told, and the run goes on without. */
static enum status calibration_do(struct arena *arena, struct calibrate_request *request,
                                  const char *folder, int round, struct error *error)
{
    struct process_request process = {
        .work = calibration_work, .context = request, .timeout_seconds = 60 + 4 * request->seconds};
    struct process_outcome outcome;
    struct calibration calibration;
    struct error why = {0};
    enum status status = process_run(arena, &process, &outcome, &why);
    if (!status && outcome.interrupted)
        return error_set(error, STATUS_INTERRUPTED, "stopped while the machine was calibrated");
    char *line = status ? NULL : outcome.output;
    if (line && *line) {
        line[strcspn(line, "\n")] = 0;
        status =
            calibration_from_json(arena, line, "the calibration's process", &calibration, &why);
    }
    calibration.round = round;
    if (!status && line && *line && !outcome.signal && !outcome.exit_code)
        return run_append_calibration(folder, &calibration, error);
    fprintf(stderr, "treeline: the machine was not calibrated for %s, no limits are told: %s\n",
            target_format_word(request->format),
            status              ? why.text
            : outcome.timed_out ? "it took too long"
            : outcome.signal    ? strsignal(outcome.signal)
                                : outcome.errors);
    return STATUS_OK;
}

static bool all_without_gl(const struct plan *plan)
{
    for (size_t i = 0; i < plan->cells_count; i++)
        if (!(plan->cells[i].method->traits & TRAIT_CPU))
            return false;
    return plan->cells_count > 0;
}

/* The cells of this format that OpenGL draws: their largest picture. Where it draws none, the first
 * cell's picture stands for all, for rays and memory do not ask for its size. False when there is
 * none. */
static bool largest_picture(const struct plan *plan, enum target_format format,
                            struct calibrate_request *request)
{
    double most = 0;
    if (all_without_gl(plan)) {
        request->width_px = plan->cells->width_px;
        request->height_px = plan->cells->height_px;
        return plan->cells->format == format;
    }
    for (size_t i = 0; i < plan->cells_count; i++) {
        const struct cell *cell = &plan->cells[i];
        double pixels = (double)cell->width_px * cell->height_px;
        if (cell->format != format || cell->method->traits & TRAIT_CPU || pixels <= most)
            continue;
        most = pixels;
        request->width_px = cell->width_px;
        request->height_px = cell->height_px;
    }
    return most > 0;
}

enum status cell_calibrate(struct arena *arena, const struct plan *plan, const char *folder,
                           int round, double seconds, struct error *error)
{
    struct run *run;
    enum status status = run_read(arena, folder, &run, error);
    for (int format = TARGET_RGBA8; format <= TARGET_RGBA32F && !status; format++) {
        struct calibrate_request request = {.backend = plan->backend,
                                            .threads = plan->threads,
                                            .format = (enum target_format)format,
                                            .seconds = seconds};
        bool kept = false;
        if (!largest_picture(plan, request.format, &request))
            continue;
        request = calibrate_held(&request);
        for (size_t i = 0; i < run->measured_count; i++) {
            const struct calibration *one = &run->measured[i];
            kept |= one->round == round && one->format == request.format &&
                    one->threads == request.threads && one->width_px == request.width_px &&
                    one->height_px == request.height_px;
        }
        if (!kept)
            status = calibration_do(arena, &request, folder, round, error);
    }
    return status;
}
