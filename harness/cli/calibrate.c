/* treeline calibrate: what this machine can do at most. */
#include "calibrate/calibrate.h"
#include "cli/cli.h"
#include "results/calibration.h"

#include <math.h>
#include <stdio.h>

enum { KEY_SIZE = 0x100, KEY_TARGET, KEY_THREADS, KEY_BACKEND, KEY_SECONDS, KEY_JSON };

struct request {
    struct calibrate_request calibrate;
    bool json;
};

static error_t parse(int key, char *text, struct argp_state *state)
{
    struct request *request = state->input;
    struct calibrate_request *calibrate = &request->calibrate;
    char rest;
    switch (key) {
    case KEY_SIZE:
        if (sscanf(text, "%dx%d%c", &calibrate->width_px, &calibrate->height_px, &rest) != 2 ||
            calibrate->width_px < CALIBRATE_SIDE_MIN || calibrate->width_px > CALIBRATE_SIDE_MAX ||
            calibrate->height_px < CALIBRATE_SIDE_MIN || calibrate->height_px > CALIBRATE_SIDE_MAX)
            argp_failure(state, STATUS_USAGE, 0,
                         "--size: '%s' is not WxH in pixels, each side in %d..%d", text,
                         CALIBRATE_SIDE_MIN, CALIBRATE_SIDE_MAX);
        return 0;
    case KEY_TARGET:
        if (!target_format_from_word(text, &calibrate->format))
            argp_failure(state, STATUS_USAGE, 0,
                         "--target: '%s' is not one of rgba8, rgba16f, rgba32f", text);
        return 0;
    case KEY_THREADS:
        calibrate->threads = cli_integer(state, "threads", text, 0, 1024);
        return 0;
    case KEY_BACKEND:
        calibrate->backend = text;
        return 0;
    case KEY_SECONDS:
        calibrate->seconds = cli_number(state, "seconds", text, 0.01, 600);
        return 0;
    case KEY_JSON:
        request->json = true;
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static const struct argp_option options[] = {
    {"size", KEY_SIZE, "WxH", 0, "picture in pixels, 800x600 by default", 1},
    {"target", KEY_TARGET, "F", 0, "target format: rgba8, rgba16f (default), rgba32f", 1},
    {"threads", KEY_THREADS, "N", 0, "threads of llvmpipe, Embree and OpenMP, 0 for all", 1},
    {"backend", KEY_BACKEND, "NAME", 0, "GL back end: osmesa, egl-surfaceless, egl-device", 1},
    {"seconds", KEY_SECONDS, "S", 0, "measuring time, 4 by default", 1},
    {"json", KEY_JSON, NULL, 0, "the record that a run keeps, as one line of JSON", 1},
    {0},
};

static void table_print(const struct calibration *calibration)
{
    printf("%s, %s, %d x %d %s, %d threads", calibration->renderer, calibration->backend,
           calibration->width_px, calibration->height_px, target_format_word(calibration->format),
           calibration->threads);
    if (!isnan(calibration->core_ghz))
        printf(" of %.2f GHz", calibration->core_ghz);
    printf("; measured in %.1f s\n\n", calibration->seconds);
    printf("%-17s %9s %-8s  %-19s %13s %9s\n", "work", "rate", "unit", "95 % interval",
           "per core cycle", "px a tri");
    for (size_t i = 0; i < CALIBRATION_COUNT; i++) {
        const struct calibration_measure *measure = &calibration->measures[i];
        const struct calibration_info *info = &calibration_table[i];
        double cycles = calibration->threads * calibration->core_ghz * 1e9, factor;
        const char *unit = calibration_unit(info->kind, &factor);
        if (isnan(measure->rate.value)) {
            printf("%-17s %9s %s\n", info->field, "-", "not measured here");
            continue;
        }
        printf("%-17s %9.4g %-8s  %8.4g to %-8.4g", info->field, measure->rate.value * factor, unit,
               measure->rate.low * factor, measure->rate.high * factor);
        if (isnan(cycles))
            printf(" %13s", "-");
        else
            printf(" %9.3g %-4s", measure->rate.value / cycles, info->unit);
        if (isnan(measure->fragments_per_triangle))
            printf(" %9s", "-");
        else
            printf(" %9.4g", measure->fragments_per_triangle);
        printf("  %s\n", info->doc);
    }
}

int verb_calibrate(int argc, char **argv)
{
    const struct argp argp = {
        options,
        parse,
        "",
        "Measures what this machine can do at most: fill, triangles, draw calls, rays, memory.\v"
        "Rates are medians of 11 interleaved repeats with their 95 % intervals. A run measures the "
        "same every few rounds and keeps it in its results; `treeline report` says of every cell "
        "which of "
        "these limits bounds it and what share of it the cell reaches.",
        NULL,
        NULL,
        NULL};
    struct request request = {.calibrate = {.width_px = 800,
                                            .height_px = 600,
                                            .format = TARGET_RGBA16F,
                                            .seconds = CALIBRATE_SECONDS}};
    argp_parse(&argp, argc, argv, 0, NULL, &request);
    struct arena *arena = arena_create(0);
    struct calibration calibration;
    struct error error = {0};
    enum status status = calibrate_run(arena, &request.calibrate, &calibration, &error);
    if (!status && error.status)
        fprintf(stderr, "treeline: %s; its rates are not measured\n", error.text);
    if (!status && request.json)
        printf("%s\n", calibration_to_json(arena, &calibration));
    else if (!status)
        table_print(&calibration);
    arena_destroy(arena);
    return status ? cli_fail(&error) : STATUS_OK;
}
