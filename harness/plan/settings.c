/* The measuring settings: their defaults, ranges and meaning. */
#include "plan/settings.h"

#include <stdio.h>
#include <string.h>

/* clang-format off */
const struct option plan_settings_table[] = {
    OPTION(struct plan_settings, rounds, 5, 1, 10000, "",
           "repetitions of each cell, each in a fresh process, in random order"),
    OPTION(struct plan_settings, frame_seconds, 1, 0.001, 3600, "s",
           "measuring time of a repetition, after the warm-up"),
    OPTION(struct plan_settings, frames_max, 1000, 1, 100000, "",
           "timed frames of a repetition at most"),
    OPTION(struct plan_settings, timeout_seconds, 300, 0.05, 86400, "s",
           "time limit of one repetition, pictures included"),
    OPTION(struct plan_settings, memory_bytes, 0, 0, 1e15, "B",
           "budget of a method's host memory, 0 for none"),
    OPTION(struct plan_settings, reference_error, 0.004, 1e-5, 1, "",
           "standard error asked of the references, RMS over the picture, linear RGB"),
    OPTION(struct plan_settings, reference_samples_max, 1024, 16, 1048576, "",
           "samples a pixel of the references at most"),
    OPTION(struct plan_settings, threads, 0, 0, 1024, "",
           "threads of llvmpipe and of CPU methods, 0 for all"),
    OPTION(struct plan_settings, views, 5, 1, 64, "",
           "pictures compared along the camera path, one where the camera stands still"),
    OPTION_END,
};
/* clang-format on */

void plan_settings_put(struct plan_settings *settings, const struct option *option, double value)
{
    char *field = (char *)settings + option->offset;
    if (option->type == OPTION_INT)
        memcpy(field, &(int){(int)value}, sizeof(int));
    else
        memcpy(field, &value, sizeof value);
}

enum status plan_settings_override(struct plan_settings *settings,
                                   const struct plan_request *request, struct error *error)
{
    const struct {
        const char *name;
        double value;
        bool zero; /* 0 was given, not left out */
    } given[] = {
        {"rounds", request->rounds, false},
        {"frame_seconds", request->frame_seconds, false},
        {"frames_max", request->frames_max, false},
        {"timeout_seconds", request->timeout_seconds, false},
        {"memory_bytes", (double)request->memory_bytes, request->memory_given},
        {"reference_error", request->reference_error, false},
        {"reference_samples_max", request->reference_samples_max, false},
        {"threads", request->threads, request->threads_given},
        {"views", (double)request->views_count, false},
    };
    for (size_t i = 0; i < sizeof given / sizeof *given; i++) {
        if (given[i].value == 0 && !given[i].zero)
            continue;
        char text[32];
        snprintf(text, sizeof text, "%.17g", given[i].value);
        enum status status = option_set(plan_settings_table, given[i].name, text, settings, error);
        if (status)
            return status;
    }
    return STATUS_OK;
}

const char *plan_settings_command(struct arena *arena, const struct plan *plan)
{
    const struct {
        const char *name, *option;
        double value;
    } rows[] = {
        {"frame_seconds", "frame-seconds", plan->frame_seconds},
        {"frames_max", "frames-max", plan->frames_max},
        {"timeout_seconds", "timeout", plan->timeout_seconds},
        {"memory_bytes", "memory", (double)plan->memory_bytes},
        {"reference_error", "reference-error", plan->reference_error},
        {"reference_samples_max", "reference-samples", plan->reference_samples_max},
        {"threads", "threads", plan->threads},
        {"views", "views", (double)plan->views_count},
    };
    const char *text = plan->backend ? arena_printf(arena, "--backend %s", plan->backend) : "";
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
        for (const struct option *o = plan_settings_table; o->name; o++)
            if (!strcmp(o->name, rows[i].name) && o->fallback != rows[i].value)
                text = arena_printf(arena, "%s%s--%s %.15g", text, *text ? " " : "", rows[i].option,
                                    rows[i].value);
    return text;
}
