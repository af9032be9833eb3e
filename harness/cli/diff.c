/* treeline diff: two pictures compared by every metric. */
#include "base/file.h"
#include "cli/cli.h"
#include "truth/frame_image.h"
#include "truth/metrics.h"
#include "wall/json.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { KEY_JSON = 0x200, KEY_MAP };

struct request {
    const char *paths[2]; /* test, reference */
    const char *map;
    bool json;
};

static error_t parse(int key, char *text, struct argp_state *state)
{
    struct request *request = state->input;
    switch (key) {
    case KEY_JSON:
        request->json = true;
        return 0;
    case KEY_MAP:
        request->map = text;
        return 0;
    case ARGP_KEY_ARG:
        if (state->arg_num >= 2)
            argp_failure(state, STATUS_USAGE, 0, "two pictures are enough: '%s' is too much", text);
        else
            request->paths[state->arg_num] = text;
        return 0;
    case ARGP_KEY_END:
        if (state->arg_num < 2)
            argp_failure(state, STATUS_USAGE, 0, "which pictures? give the test and its reference");
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static const struct argp_option options[] = {
    {"json", KEY_JSON, NULL, 0, "JSON instead of a table", 0},
    {"map", KEY_MAP, "FILE", 0,
     "also write the FLIP map: .png in colours (0 black to 1 pale yellow), .exr its values", 0},
    {0},
};

/* What is compared, and how; NaN stands for a metric that these pictures do not have. */
struct outcome {
    int width_px, height_px;
    struct comparison comparison;
};

static void forget(struct metrics *metrics)
{
    metrics->coverage = metrics->coverage_bias = NAN;
}

static enum status write_map(struct arena *arena, const char *path, float *map, int width_px,
                             int height_px, struct error *error)
{
    if (path_ends_with(path, ".exr")) {
        struct image image = {width_px, height_px, 1, map, NULL};
        return image_write(path, &image, 32, false, error);
    }
    return image_write(path, map_to_image(arena, map, width_px, height_px, 1), 8, false, error);
}

static enum status diff(struct arena *arena, const struct request *request, struct outcome *outcome,
                        struct error *error)
{
    struct frame *frames[2];
    bool has_coverage[2];
    for (int k = 0; k < 2; k++)
        if (frame_read_image(arena, request->paths[k], &frames[k], &has_coverage[k], error))
            return error->status;
    float *map = NULL;
    enum status status = metrics_compare(arena, frames[0], frames[1], &outcome->comparison,
                                         request->map ? &map : NULL, error);
    if (status)
        return error_context(error, "%s, %s", request->paths[0], request->paths[1]);
    outcome->width_px = frames[0]->width_px;
    outcome->height_px = frames[0]->height_px;
    if (!has_coverage[0] || !has_coverage[1]) {
        forget(&outcome->comparison.value);
        forget(&outcome->comparison.raw);
        forget(&outcome->comparison.floor);
    }
    if (request->map)
        status = write_map(arena, request->map, map, outcome->width_px, outcome->height_px, error);
    return status;
}

static const char *better_word(int better)
{
    return better < 0 ? "lower" : better > 0 ? "higher" : "zero";
}

static const char *unit_of(const struct metric_info *info)
{
    return strcmp(info->word, "psnr") == 0 ? "dB" : "";
}

static void print_number(double value)
{
    if (isnan(value))
        printf(" %12s", "-");
    else
        printf(" %12.6g", value);
}

static void print_table(const struct outcome *outcome)
{
    printf("%-14s %12s %12s %12s  %-4s %-8s %-7s %s\n", "metric", "value", "raw", "floor", "unit",
           "domain", "better", "meaning");
    for (const struct metric_info *info = metric_table; info->field; info++) {
        printf("%-14s", info->word);
        print_number(metric_of(&outcome->comparison.value, info));
        print_number(metric_of(&outcome->comparison.raw, info));
        print_number(metric_of(&outcome->comparison.floor, info));
        printf("  %-4s %-8s %-7s %s\n", unit_of(info), info->domain, better_word(info->better),
               info->doc);
    }
}

static void print_json(struct arena *arena, const struct request *request,
                       const struct outcome *outcome)
{
    struct json_out *out = json_out(arena);
    json_open(out, NULL, '{');
    json_put_text(out, "test", request->paths[0]);
    json_put_text(out, "reference", request->paths[1]);
    json_put_number(out, "width_px", outcome->width_px);
    json_put_number(out, "height_px", outcome->height_px);
    json_open(out, "metrics", '{');
    for (const struct metric_info *info = metric_table; info->field; info++) {
        json_open(out, info->word, '{');
        json_put_number(out, "value", metric_of(&outcome->comparison.value, info));
        json_put_number(out, "raw", metric_of(&outcome->comparison.raw, info));
        json_put_number(out, "floor", metric_of(&outcome->comparison.floor, info));
        json_put_text(out, "unit", unit_of(info));
        json_put_text(out, "domain", info->domain);
        json_put_text(out, "better", better_word(info->better));
        json_close(out);
    }
    json_close(out);
    json_close(out);
    printf("%s\n", json_out_text(out));
}

int verb_diff(int argc, char **argv)
{
    const struct argp argp = {
        options,
        parse,
        "TEST REFERENCE",
        "Compares two pictures of one size (EXR, PNG, a run's .frame files, ...) by every metric.\v"
        "value is corrected for the noise of both pictures where that is known, raw is as "
        "measured, "
        "floor is what pure noise would give. Noise is known of frames and of EXR files with "
        "variance.R, .G, .B, .A channels. Integer files are decoded from sRGB. Coverage needs an "
        "alpha channel in both pictures, else it is -, in JSON null.",
        NULL,
        NULL,
        NULL};
    struct request request = {0};
    argp_parse(&argp, argc, argv, 0, NULL, &request);
    struct arena *arena = arena_create(0);
    struct error error = {0};
    struct outcome outcome = {0};
    enum status status = diff(arena, &request, &outcome, &error);
    if (status == STATUS_OK && request.json)
        print_json(arena, &request, &outcome);
    else if (status == STATUS_OK)
        print_table(&outcome);
    arena_destroy(arena);
    return status ? cli_fail(&error) : STATUS_OK;
}
