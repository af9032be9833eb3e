/* JSON writing: a growing text in an arena. Strings are escaped by cJSON's rules, bytes that
 * are not UTF-8 become U+FFFD; doubles read back exactly. */
#include "wall/json.h"

#include "wall/json_text.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { DEPTH_MAX = 64 };

struct json_out {
    struct arena *arena;
    char *text;
    size_t length, capacity;
    int depth;
    char closing[DEPTH_MAX];
    bool comma[DEPTH_MAX + 1]; /* something stands before at this depth */
};

struct json_out *json_out(struct arena *arena)
{
    struct json_out *out = ARENA_NEW(arena, struct json_out);
    out->arena = arena;
    return out;
}

static void put(struct json_out *out, const char *text, size_t length)
{
    if (out->length + length + 1 > out->capacity) {
        size_t capacity = 2 * (out->length + length) + 256;
        char *more = arena_alloc(out->arena, capacity, 1);
        if (out->length)
            memcpy(more, out->text, out->length);
        out->text = more;
        out->capacity = capacity;
    }
    memcpy(out->text + out->length, text, length);
    out->length += length;
    out->text[out->length] = 0;
}

static void put_string(struct json_out *out, const char *text)
{
    put(out, "\"", 1);
    size_t step;
    for (const char *c = text; *c; c += step) {
        char escape[8];
        step = utf8_length(c);
        if (step == 0)
            put(out, "\xef\xbf\xbd", 3), step = 1; /* U+FFFD */
        else if (*c == '"' || *c == '\\')
            put(out, (char[]){'\\', *c}, 2);
        else if (*c == '\n')
            put(out, "\\n", 2);
        else if (*c == '\t')
            put(out, "\\t", 2);
        else if ((unsigned char)*c < 0x20)
            put(out, escape, (size_t)snprintf(escape, sizeof escape, "\\u%04x", (unsigned)*c));
        else
            put(out, c, step);
    }
    put(out, "\"", 1);
}

static void put_key(struct json_out *out, const char *key)
{
    if (out->comma[out->depth])
        put(out, ",", 1);
    out->comma[out->depth] = true;
    if (key) {
        put_string(out, key);
        put(out, ":", 1);
    }
}

void json_open(struct json_out *out, const char *key, char bracket)
{
    put_key(out, key);
    put(out, &bracket, 1);
    if (out->depth == DEPTH_MAX)
        abort();
    out->closing[out->depth++] = bracket == '{' ? '}' : ']';
    out->comma[out->depth] = false;
}

void json_close(struct json_out *out)
{
    put(out, &out->closing[--out->depth], 1);
}

void json_put_number(struct json_out *out, const char *key, double value)
{
    char text[40];
    put_key(out, key);
    if (!isfinite(value)) {
        put(out, "null", 4);
        return;
    }
    for (int digits = 15; digits <= 17; digits++) {
        snprintf(text, sizeof text, "%.*g", digits, value);
        if (strtod(text, NULL) == value)
            break;
    }
    put(out, text, strlen(text));
}

void json_put_u64(struct json_out *out, const char *key, uint64_t value)
{
    char text[24];
    snprintf(text, sizeof text, "%016" PRIx64, value);
    json_put_text(out, key, text);
}

void json_put_text(struct json_out *out, const char *key, const char *value)
{
    put_key(out, key);
    if (value)
        put_string(out, value);
    else
        put(out, "null", 4);
}

void json_put_bool(struct json_out *out, const char *key, bool value)
{
    put_key(out, key);
    put(out, value ? "true" : "false", value ? 4 : 5);
}

char *json_out_text(struct json_out *out)
{
    while (out->depth)
        json_close(out);
    return out->text ? out->text : arena_strdup(out->arena, "");
}
