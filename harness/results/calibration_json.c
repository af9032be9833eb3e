/* A calibration as one line of JSON and back; results/README.md documents the keys. */
#include "results/calibration.h"

#include "results/fields.h"
#include "results/result.h"

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

enum status calibration_from_json(struct arena *arena, const char *text, const char *where,
                                  struct calibration *calibration, struct error *error)
{
    *calibration = (struct calibration){0};
    struct json_doc *doc = json_parse(arena, text, where, error);
    if (!doc)
        return STATUS_INVALID;
    struct json *root = json_root(doc);
    if (kind_check(root, CALIBRATION_KIND))
        return json_end(doc);
    calibration->round = (int)json_integer(root, "round", 0, 0, INT32_MAX);
    size_get(root, &calibration->width_px, &calibration->height_px);
    calibration->format = target_get(root);
    calibration->threads = (int)json_integer(root, "threads", 0, 1, 65536);
    calibration->core_ghz = number_or_nan(root, "core_ghz", 0);
    calibration->seconds = number_or_nan(root, "seconds", 0);
    calibration->backend = json_text(root, "backend", "none");
    calibration->renderer = json_text(root, "renderer", "none");
    struct json *measures = json_object(root, "measures");
    for (size_t i = 0; i < CALIBRATION_COUNT; i++) {
        struct calibration_measure *measure = &calibration->measures[i];
        struct json *object = json_object(measures, calibration_table[i].field);
        measure->rate.value = number_or_nan(object, "rate", 0);
        measure->rate.low = number_or_nan(object, "low", 0);
        measure->rate.high = number_or_nan(object, "high", 0);
        measure->fragments_per_triangle = number_or_nan(object, "fragments_per_triangle", 0);
    }
    return json_end(doc);
}
