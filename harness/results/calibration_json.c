/* A calibration as one line of JSON and back; results/README.md documents the keys. */
#include "results/calibration.h"

#include "results/result.h"
#include "wall/json.h"

#include <float.h>
#include <math.h>
#include <string.h>

char *calibration_to_json(struct arena *arena, const struct calibration *calibration)
{
    struct json_out *out = json_out(arena);
    json_open(out, NULL, '{');
    json_put_number(out, "version", RESULT_VERSION);
    json_put_text(out, "kind", CALIBRATION_KIND);
    json_put_number(out, "round", calibration->round);
    json_put_number(out, "width_px", calibration->width_px);
    json_put_number(out, "height_px", calibration->height_px);
    json_put_text(out, "target", target_format_word(calibration->format));
    json_put_number(out, "threads", calibration->threads);
    json_put_number(out, "core_ghz", calibration->core_ghz);
    json_put_number(out, "seconds", calibration->seconds);
    json_put_text(out, "backend", calibration->backend);
    json_put_text(out, "renderer", calibration->renderer);
    json_open(out, "measures", '{');
    for (size_t i = 0; i < CALIBRATION_COUNT; i++) {
        const struct calibration_measure *measure = &calibration->measures[i];
        json_open(out, calibration_table[i].field, '{');
        json_put_number(out, "rate", measure->rate.value);
        json_put_number(out, "low", measure->rate.low);
        json_put_number(out, "high", measure->rate.high);
        json_put_number(out, "fragments_per_triangle", measure->fragments_per_triangle);
        json_close(out);
    }
    json_close(out);
    json_close(out);
    return json_out_text(out);
}

/* A number of at least 0 that may be null: NaN. */
static double positive_or_nan(struct json *object, const char *key)
{
    return json_has(object, key) ? json_number(object, key, NAN, 0, DBL_MAX) : NAN;
}

enum status calibration_from_json(struct arena *arena, const char *text, const char *where,
                                  struct calibration *calibration, struct error *error)
{
    *calibration = (struct calibration){0};
    struct json_doc *doc = json_parse(arena, text, where, error);
    if (!doc)
        return STATUS_INVALID;
    struct json *root = json_root(doc);
    if (result_version_check(root))
        return json_end(doc);
    const char *kind = json_text(root, "kind", "");
    if (strcmp(kind, CALIBRATION_KIND) != 0)
        json_fail(root, "kind", "value is '%s'; allowed: " CALIBRATION_KIND, kind);
    calibration->round = (int)json_integer(root, "round", 0, 0, INT32_MAX);
    calibration->width_px = (int)json_integer(root, "width_px", 0, 1, 1 << 20);
    calibration->height_px = (int)json_integer(root, "height_px", 0, 1, 1 << 20);
    const char *target = json_text(root, "target", "");
    if (!target_format_from_word(target, &calibration->format))
        json_fail(root, "target", "value is '%s'; allowed: rgba8|rgba16f|rgba32f", target);
    calibration->threads = (int)json_integer(root, "threads", 0, 1, 65536);
    calibration->core_ghz = positive_or_nan(root, "core_ghz");
    calibration->seconds = positive_or_nan(root, "seconds");
    calibration->backend = json_text(root, "backend", "none");
    calibration->renderer = json_text(root, "renderer", "none");
    struct json *measures = json_object(root, "measures");
    for (size_t i = 0; i < CALIBRATION_COUNT; i++) {
        struct calibration_measure *measure = &calibration->measures[i];
        struct json *object = json_object(measures, calibration_table[i].field);
        measure->rate.value = positive_or_nan(object, "rate");
        measure->rate.low = positive_or_nan(object, "low");
        measure->rate.high = positive_or_nan(object, "high");
        measure->fragments_per_triangle = positive_or_nan(object, "fragments_per_triangle");
    }
    return json_end(doc);
}
