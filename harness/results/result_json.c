/* A result as one line of JSON and back; results/README.md documents the keys. */
#include "results/result.h"

#include "results/fields.h"

#include <float.h>
#include <math.h>
#include <string.h>

void result_init(struct result *result, const struct cell *cell, int repetition)
{
    *result = (struct result){
        .cell = *cell, .repetition = repetition, .status = STATUS_OK, .message = "", .started = ""};
#define COLUMN_INIT(field, unit, better, doc) result->field = NAN;
    RESULT_COLUMNS(COLUMN_INIT)
#undef COLUMN_INIT
}

static void metrics_put(struct json_out *out, const char *key, const struct metrics *metrics)
{
    json_open(out, key, '{');
#define METRIC_PUT(field, word, better, domain, doc) json_put_number(out, #field, metrics->field);
    METRIC_LIST(METRIC_PUT)
#undef METRIC_PUT
    json_close(out);
}

static void comparison_put(struct json_out *out, const char *key,
                           const struct comparison *comparison)
{
    json_open(out, key, '{');
    metrics_put(out, "value", &comparison->value);
    metrics_put(out, "raw", &comparison->raw);
    metrics_put(out, "floor", &comparison->floor);
    json_close(out);
}

static void cell_put(struct json_out *out, const struct cell *cell)
{
    json_put_text(out, "cell", cell->name);
    json_put_text(out, "scene", cell->scene);
    json_put_text(out, "method", cell->method_name);
    json_put_text(out, "options", cell->options);
    json_put_number(out, "trees", (double)cell->trees);
    json_put_text(out, "lod", lod_word(cell->lod));
    json_put_number(out, "width_px", cell->width_px);
    json_put_number(out, "height_px", cell->height_px);
    json_put_text(out, "target", target_format_word(cell->format));
    json_put_u64(out, "seed", cell->seed);
}

static void view_put(struct json_out *out, const struct result_view *view)
{
    json_open(out, NULL, '{');
    json_put_number(out, "time", view->time);
    json_put_number(out, "distance_m", view->distance_m);
    json_put_number(out, "elevation_deg", view->elevation_deg);
    json_put_number(out, "azimuth_deg", view->azimuth_deg);
    json_put_u64(out, "picture_hash", view->picture_hash);
    json_put_text(out, "picture", view->picture);
    json_put_u64(out, "same_key", view->same_key);
    json_put_u64(out, "full_key", view->full_key);
    json_put_bool(out, "compared", view->compared);
    if (view->compared) {
        comparison_put(out, "same", &view->same);
        comparison_put(out, "full", &view->full);
        json_put_number(out, "same_standard_error", view->same_standard_error);
        json_put_number(out, "full_standard_error", view->full_standard_error);
    }
    if (view->masked) {
        json_open(out, "mask", '{');
#define MASK_PUT(field, word, better, unit, doc) json_put_number(out, #field, view->mask.field);
        MASK_LIST(MASK_PUT)
#undef MASK_PUT
        json_close(out);
    }
    json_close(out);
}

char *result_to_json(struct arena *arena, const struct result *result)
{
    struct json_out *out = json_out(arena);
    json_open(out, NULL, '{');
    json_put_number(out, "version", RESULT_VERSION);
    cell_put(out, &result->cell);
    json_put_number(out, "repetition", result->repetition);
    json_put_text(out, "status", status_word(result->status));
    json_put_text(out, "message", result->message);
    json_put_number(out, "signal", result->signal);
    json_put_text(out, "started", result->started);
    json_put_number(out, "seconds", result->seconds);
    effects_put(out, "effects", result->effects);
    effects_put(out, "scene_effects", result->scene_effects);
    json_put_number(out, "instances", (double)result->instances);
    json_put_u64(out, "scene_hash", result->scene_hash);
    json_put_text(out, "backend", result->backend);
    json_put_text(out, "renderer", result->renderer);
    json_put_text(out, "gl_version", result->gl_version);
    json_put_number(out, "threads", result->threads);
#define COLUMN_PUT(field, unit, better, doc) json_put_number(out, #field, result->field);
    RESULT_COLUMNS(COLUMN_PUT)
#undef COLUMN_PUT
    json_open(out, "frame_seconds", '[');
    for (size_t i = 0; i < result->frames_count; i++)
        json_put_number(out, NULL, result->frame_seconds[i]);
    json_close(out);
    json_open(out, "views", '[');
    for (size_t i = 0; i < result->views_count; i++)
        view_put(out, &result->views[i]);
    json_close(out);
    if (result->has_flicker) {
        json_open(out, "flicker", '{');
        json_put_number(out, "mean", result->flicker.mean);
        json_put_number(out, "peak", result->flicker.peak);
        json_put_number(out, "floor", result->flicker.floor);
        json_put_number(out, "peak_frame", (double)result->flicker.peak_frame);
        json_close(out);
    }
    json_close(out);
    return json_out_text(out);
}

static void metrics_get(struct json *object, const char *key, struct metrics *metrics)
{
    struct json *values = json_object(object, key);
#define METRIC_GET(field, word, better, domain, doc)                                               \
    metrics->field = number_or_nan(values, #field, -DBL_MAX);
    METRIC_LIST(METRIC_GET)
#undef METRIC_GET
}

static void comparison_get(struct json *object, const char *key, struct comparison *comparison)
{
    struct json *parts = json_object(object, key);
    metrics_get(parts, "value", &comparison->value);
    metrics_get(parts, "raw", &comparison->raw);
    metrics_get(parts, "floor", &comparison->floor);
}

/* The method is looked up among the built-in ones only: reading a run loads no plugin. */
static const struct method *method_known(const char *name)
{
    for (const struct method *const *each = methods_builtin; *each; each++)
        if (!strcmp((*each)->name, name))
            return *each;
    return NULL;
}

static void cell_get(struct json *root, struct cell *cell)
{
    cell->name = json_text(root, "cell", "");
    if (!*cell->name)
        json_fail(root, "cell", "is missing; the name of a cell is required");
    cell->scene = json_text(root, "scene", "");
    cell->method_name = json_text(root, "method", "");
    cell->method = method_known(cell->method_name);
    cell->options = json_text(root, "options", "");
    cell->trees = (size_t)json_integer(root, "trees", -1, 0, INT64_C(1) << 53);
    const char *lod = json_text(root, "lod", "");
    if (!lod_from_word(lod, &cell->lod))
        json_fail(root, "lod", "value is '%s'; allowed: low|intermediate|high|auto", lod);
    size_get(root, &cell->width_px, &cell->height_px);
    cell->format = target_get(root);
    cell->seed = json_u64(root, "seed");
}

static void view_get(struct json *object, struct result_view *view)
{
    view->time = number_or_nan(object, "time", -DBL_MAX);
    view->distance_m = number_or_nan(object, "distance_m", -DBL_MAX);
    view->elevation_deg = number_or_nan(object, "elevation_deg", -DBL_MAX);
    view->azimuth_deg = number_or_nan(object, "azimuth_deg", -DBL_MAX);
    view->picture_hash = json_u64(object, "picture_hash");
    view->picture = json_text(object, "picture", NULL);
    view->same_key = json_u64(object, "same_key");
    view->full_key = json_u64(object, "full_key");
    struct json *mask = json_object(object, "mask");
    view->masked = mask != NULL;
#define MASK_GET(field, word, better, unit, doc)                                                   \
    view->mask.field = mask ? number_or_nan(mask, #field, -DBL_MAX) : NAN;
    MASK_LIST(MASK_GET)
#undef MASK_GET
    view->compared = json_bool(object, "compared", false);
    if (!view->compared)
        return;
    comparison_get(object, "same", &view->same);
    comparison_get(object, "full", &view->full);
    view->same_standard_error = (float)number_or_nan(object, "same_standard_error", -DBL_MAX);
    view->full_standard_error = (float)number_or_nan(object, "full_standard_error", -DBL_MAX);
}

static void lists_get(struct arena *arena, struct json *root, struct result *result)
{
    result->frames_count = json_array(root, "frame_seconds");
    result->frame_seconds = ARENA_ARRAY(arena, double, result->frames_count);
    for (size_t i = 0; i < result->frames_count; i++)
        result->frame_seconds[i] = json_element_number(root, "frame_seconds", i, 0, DBL_MAX);
    result->views_count = json_array(root, "views");
    result->views = ARENA_ARRAY(arena, struct result_view, result->views_count);
    for (size_t i = 0; i < result->views_count; i++)
        view_get(json_element(root, "views", i), &result->views[i]);
    struct json *flicker = json_object(root, "flicker");
    result->has_flicker = flicker != NULL;
    if (!flicker)
        return;
    result->flicker.mean = number_or_nan(flicker, "mean", -DBL_MAX);
    result->flicker.peak = number_or_nan(flicker, "peak", -DBL_MAX);
    result->flicker.floor = number_or_nan(flicker, "floor", -DBL_MAX);
    result->flicker.peak_frame = (size_t)json_integer(flicker, "peak_frame", 0, 0, INT32_MAX);
}

enum status result_version_check(struct json *root)
{
    int version = (int)json_integer(root, "version", -1, 0, INT32_MAX);
    if (version >= RESULT_VERSION_OLDEST && version <= RESULT_VERSION)
        return STATUS_OK;
    return json_fail(root, "version", "value is %d; this treeline reads version %d to %d", version,
                     RESULT_VERSION_OLDEST, RESULT_VERSION);
}

enum status result_from_json(struct arena *arena, const char *text, const char *where,
                             struct result *result, struct error *error)
{
    *result = (struct result){0};
    struct json_doc *doc = json_parse(arena, text, where, error);
    if (!doc)
        return STATUS_INVALID;
    struct json *root = json_root(doc);
    if (result_version_check(root))
        return json_end(doc);
    cell_get(root, &result->cell);
    result->repetition = (int)json_integer(root, "repetition", -1, 0, INT32_MAX);
    const char *word = json_text(root, "status", "");
    if (!status_from_word(word, &result->status))
        json_fail(root, "status", "value is '%s'; `treeline help exit` lists the words", word);
    result->message = json_text(root, "message", "");
    result->signal = (int)json_integer(root, "signal", 0, 0, 256);
    result->started = json_text(root, "started", "");
    result->seconds = number_or_nan(root, "seconds", -DBL_MAX);
    result->effects = effects_get(root, "effects");
    result->scene_effects = effects_get(root, "scene_effects");
    result->instances = (size_t)json_integer(root, "instances", 0, 0, INT64_C(1) << 53);
    result->scene_hash = json_u64(root, "scene_hash");
    result->backend = json_text(root, "backend", NULL);
    result->renderer = json_text(root, "renderer", NULL);
    result->gl_version = json_text(root, "gl_version", NULL);
    result->threads = (int)json_integer(root, "threads", 0, 0, 65536);
#define COLUMN_GET(field, unit, better, doc) result->field = number_or_nan(root, #field, -DBL_MAX);
    RESULT_COLUMNS(COLUMN_GET)
#undef COLUMN_GET
    lists_get(arena, root, result);
    return json_end(doc);
}
