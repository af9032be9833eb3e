/* Fields that several kinds of lines of a run have. */
#include "results/fields.h"

#include "results/result.h"

#include <float.h>
#include <math.h>
#include <string.h>

void effects_put(struct json_out *out, const char *key, unsigned effects)
{
    json_open(out, key, '[');
#define EFFECT_PUT(name, bit, word, meaning)                                                       \
    if (effects & (name))                                                                          \
        json_put_text(out, NULL, word);
    EFFECT_LIST(EFFECT_PUT)
#undef EFFECT_PUT
    json_close(out);
}

unsigned effects_get(struct json *object, const char *key)
{
    unsigned effects = 0;
    for (size_t i = 0; i < json_array(object, key); i++) {
        const char *text = json_element_text(object, key, i);
        unsigned found = 0;
#define EFFECT_GET(name, bit, word, meaning) found |= !strcmp(text, word) ? (unsigned)(name) : 0u;
        EFFECT_LIST(EFFECT_GET)
#undef EFFECT_GET
        if (!found && *text)
            json_fail(object, key, "'%s' is no effect", text);
        effects |= found;
    }
    return effects;
}

double number_or_nan(struct json *object, const char *key, double least)
{
    return json_has(object, key) ? json_number(object, key, NAN, least, DBL_MAX) : NAN;
}

void size_get(struct json *object, int *width_px, int *height_px)
{
    *width_px = (int)json_integer(object, "width_px", 0, 1, 1 << 20);
    *height_px = (int)json_integer(object, "height_px", 0, 1, 1 << 20);
}

enum target_format target_get(struct json *object)
{
    enum target_format format = TARGET_RGBA8;
    const char *target = json_text(object, "target", "");
    if (!target_format_from_word(target, &format))
        json_fail(object, "target", "value is '%s'; allowed: rgba8|rgba16f|rgba32f", target);
    return format;
}

enum status kind_check(struct json *root, const char *kind)
{
    enum status status = result_version_check(root);
    const char *told = json_text(root, "kind", "");
    if (!status && strcmp(told, kind) != 0)
        return json_fail(root, "kind", "value is '%s'; allowed: %s", told, kind);
    return status;
}
