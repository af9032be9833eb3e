/* The cost of a reference as one line of JSON and back; results/README.md documents the keys. */
#include "results/tracing.h"

#include "results/fields.h"
#include "results/result.h"

char *tracing_to_json(struct arena *arena, const struct tracing *tracing)
{
    struct json_out *out = json_out(arena);
    json_open(out, NULL, '{');
    json_put_number(out, "version", RESULT_VERSION);
    json_put_text(out, "kind", TRACING_KIND);
    json_put_text(out, "scene", tracing->scene);
    json_put_number(out, "trees", (double)tracing->trees);
    json_put_number(out, "width_px", tracing->width_px);
    json_put_number(out, "height_px", tracing->height_px);
    json_put_number(out, "threads", tracing->threads);
    effects_put(out, "effects", tracing->effects);
    json_put_u64(out, "key", tracing->key);
#define NUMBER_PUT(field, doc) json_put_number(out, #field, tracing->field);
    TRACING_NUMBERS(NUMBER_PUT)
#undef NUMBER_PUT
    json_put_bool(out, "from_cache", tracing->from_cache);
    json_close(out);
    return json_out_text(out);
}

enum status tracing_from_json(struct arena *arena, const char *text, const char *where,
                              struct tracing *tracing, struct error *error)
{
    *tracing = (struct tracing){0};
    struct json_doc *doc = json_parse(arena, text, where, error);
    if (!doc)
        return STATUS_INVALID;
    struct json *root = json_root(doc);
    if (kind_check(root, TRACING_KIND))
        return json_end(doc);
    tracing->scene = json_text(root, "scene", "");
    tracing->trees = (size_t)json_integer(root, "trees", -1, 0, INT64_C(1) << 53);
    size_get(root, &tracing->width_px, &tracing->height_px);
    tracing->threads = (int)json_integer(root, "threads", 0, 1, 65536);
    tracing->effects = effects_get(root, "effects");
    tracing->key = json_u64(root, "key");
#define NUMBER_GET(field, doc) tracing->field = number_or_nan(root, #field, 0);
    TRACING_NUMBERS(NUMBER_GET)
#undef NUMBER_GET
    tracing->from_cache = json_bool(root, "from_cache", false);
    return json_end(doc);
}
