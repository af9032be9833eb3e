/* Strict JSON reading: cJSON parses, our own nodes remember their place and which keys were asked
 * for. */
#include "wall/json.h"

#include "base/file.h"
#include "base/nearest.h"
#include "wall/json_text.h"

#include <cjson/cJSON.h>
#include <inttypes.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { FILE_BYTES_MAX = 16 << 20 };

enum json_type { JSON_NULL, JSON_BOOL, JSON_NUMBER, JSON_TEXT, JSON_ARRAY, JSON_OBJECT };
static const char *const type_words[] = {"null",   "true or false", "a number",
                                         "a text", "a list",        "an object"};

/* The keys that a reader asked an object for: what is allowed there. */
struct asked {
    const struct asked *before;
    char key[];
};

struct json {
    struct json_doc *doc;
    const struct json *parent;
    const char *key; /* NULL for elements of arrays and the root */
    size_t index;
    enum json_type type;
    bool asked;
    double number; /* bool: 0 or 1 */
    const char *text;
    size_t children_count;
    struct json *children;
    const struct asked *asked_keys; /* the last one first */
};

struct json_doc {
    struct arena *arena;
    const char *where;
    struct error *error;
    enum status status;
    struct json root;
};

/* "camera.keys[2].eye" */
static void path_print(const struct json *node, char *path, size_t size)
{
    *path = 0;
    if (!node || !node->parent)
        return;
    path_print(node->parent, path, size);
    size_t used = strlen(path);
    if (node->key)
        snprintf(path + used, size - used, "%s%s", used ? "." : "", node->key);
    else
        snprintf(path + used, size - used, "[%zu]", node->index);
}

static enum status fail(struct json_doc *doc, const struct json *node, const char *key,
                        const char *text)
{
    if (doc->status != STATUS_OK)
        return doc->status;
    char path[256];
    path_print(node, path, sizeof path);
    return doc->status =
               error_set(doc->error, STATUS_INVALID, "%s: %s%s%s%s%s", doc->where, path,
                         *path && key ? "." : "", key ? key : "", *path || key ? ": " : "", text);
}

enum status json_fail(struct json *object, const char *key, const char *format, ...)
{
    char text[512];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    return fail(object->doc, object, key, text);
}

static void convert(struct json *node, const cJSON *item);

static void convert_children(struct json *node, const cJSON *item)
{
    struct json_doc *doc = node->doc;
    for (const cJSON *child = item->child; child; child = child->next)
        node->children_count++;
    node->children = ARENA_ARRAY(doc->arena, struct json, node->children_count);
    size_t index = 0;
    for (const cJSON *child = item->child; child; child = child->next, index++) {
        struct json *to = &node->children[index];
        *to = (struct json){.doc = doc, .parent = node, .index = index};
        if (child->string)
            to->key = arena_strdup(doc->arena, child->string);
        for (size_t i = 0; i < index && to->key && node->children_count <= 4096; i++)
            if (node->children[i].key && strcmp(node->children[i].key, to->key) == 0)
                fail(doc, to, NULL, "stands here twice");
        convert(to, child);
    }
}

static void convert(struct json *node, const cJSON *item)
{
    if (cJSON_IsBool(item)) {
        node->type = JSON_BOOL;
        node->number = cJSON_IsTrue(item);
    } else if (cJSON_IsNumber(item)) {
        node->type = JSON_NUMBER;
        node->number = item->valuedouble;
        if (!isfinite(node->number))
            fail(node->doc, node, NULL, "is too large a number");
    } else if (cJSON_IsString(item)) {
        node->type = JSON_TEXT;
        node->text = arena_strdup(node->doc->arena, item->valuestring);
    } else if (cJSON_IsArray(item) || cJSON_IsObject(item)) {
        node->type = cJSON_IsArray(item) ? JSON_ARRAY : JSON_OBJECT;
        convert_children(node, item);
    }
}

struct json_doc *json_parse(struct arena *arena, const char *text, const char *where,
                            struct error *error)
{
    struct json_doc *doc = ARENA_NEW(arena, struct json_doc);
    *doc = (struct json_doc){.arena = arena, .where = arena_strdup(arena, where), .error = error};
    doc->root.doc = doc;
    if (json_text_check(text, where, error) != STATUS_OK)
        return NULL;
    const char *end = text;
    cJSON *item = cJSON_ParseWithOpts(text, &end, true);
    if (!item) {
        int line = 1;
        for (const char *c = text; c < end; c++)
            line += *c == '\n';
        error_set(error, STATUS_INVALID, "%s:%d: not JSON near '%.24s'", where, line, end);
        return NULL;
    }
    convert(&doc->root, item);
    cJSON_Delete(item);
    return doc->status == STATUS_OK ? doc : NULL;
}

struct json_doc *json_load(struct arena *arena, const char *path, struct error *error)
{
    char *text;
    size_t size;
    if (file_read(arena, path, FILE_BYTES_MAX, &text, &size, error) != STATUS_OK)
        return NULL;
    if (strlen(text) != size) {
        error_set(error, STATUS_INVALID, "%s: not JSON: a NUL byte at %zu", path, strlen(text));
        return NULL;
    }
    return json_parse(arena, text, path, error);
}

struct json *json_root(struct json_doc *doc)
{
    if (doc->root.type != JSON_OBJECT)
        fail(doc, NULL, NULL, "is not an object");
    return &doc->root;
}

static bool asked_before(const struct asked *asked, const char *key)
{
    for (; asked; asked = asked->before)
        if (strcmp(asked->key, key) == 0)
            return true;
    return false;
}

/* "is not a key known here (did you mean 'size'?); allowed: doc, size, trees" */
static void fail_unknown(const struct json *child)
{
    char allowed[400] = "";
    const char *nearest = NULL;
    size_t used = sizeof allowed - 1; /* filled from its end, since the last asked key is first */
    for (const struct asked *at = child->parent->asked_keys; at; at = at->before) {
        size_t length = strlen(at->key) + (nearest ? 2 : 0);
        if (asked_before(at->before, at->key) || length > used)
            continue;
        used -= length;
        memcpy(allowed + used, at->key, strlen(at->key));
        if (nearest)
            memcpy(allowed + used + strlen(at->key), ", ", 2);
        nearest = nearest_of(child->key, nearest, at->key);
    }
    char text[512];
    snprintf(text, sizeof text, "is not a key known here%s%s%s; allowed: %s",
             nearest ? " (did you mean '" : "", nearest ? nearest : "", nearest ? "'?)" : "",
             nearest ? allowed + used : "no keys");
    fail(child->doc, child, NULL, text);
}

static void check_asked(const struct json *node)
{
    for (size_t i = 0; i < node->children_count; i++) {
        const struct json *child = &node->children[i];
        if (node->type == JSON_OBJECT && !child->asked)
            fail_unknown(child);
        check_asked(child);
    }
}

enum status json_end(struct json_doc *doc)
{
    if (doc->status == STATUS_OK)
        check_asked(&doc->root);
    return doc->status;
}

/* The child, marked as asked for; NULL when absent or null, after an error, or when object is NULL.
 */
static struct json *child_get(struct json *object, const char *key)
{
    if (!object || object->doc->status != STATUS_OK || object->type != JSON_OBJECT)
        return NULL;
    struct asked *asked = arena_alloc(object->doc->arena, 1, sizeof *asked + strlen(key) + 1);
    memcpy(asked->key, key, strlen(key));
    asked->before = object->asked_keys;
    object->asked_keys = asked;
    for (size_t i = 0; i < object->children_count; i++)
        if (strcmp(object->children[i].key, key) == 0) {
            object->children[i].asked = true;
            return object->children[i].type == JSON_NULL ? NULL : &object->children[i];
        }
    return NULL;
}

/* The child when it is of this type; says so when it is of another or missing though required. */
static struct json *child_typed(struct json *object, const char *key, enum json_type type,
                                bool required)
{
    struct json *child = child_get(object, key);
    if (!child && required && object)
        json_fail(object, key, "is missing; %s is required", type_words[type]);
    if (!child || child->type == type)
        return child;
    json_fail(child, NULL, "is %s; allowed: %s", type_words[child->type], type_words[type]);
    return NULL;
}

bool json_has(struct json *object, const char *key)
{
    return child_get(object, key) != NULL;
}

static bool in_range(struct json *node, double minimum, double maximum)
{
    if (node->number >= minimum && node->number <= maximum)
        return true;
    json_fail(node, NULL, "value is %.10g; allowed: %.10g..%.10g", node->number, minimum, maximum);
    return false;
}

double json_number(struct json *object, const char *key, double fallback, double minimum,
                   double maximum)
{
    struct json *child = child_typed(object, key, JSON_NUMBER, isnan(fallback));
    return child && in_range(child, minimum, maximum) ? child->number
           : isnan(fallback)                          ? minimum
                                                      : fallback;
}

int64_t json_integer(struct json *object, const char *key, int64_t fallback, int64_t minimum,
                     int64_t maximum)
{
    struct json *child = child_typed(object, key, JSON_NUMBER, fallback < minimum);
    int64_t safe = fallback < minimum ? minimum : fallback;
    if (!child || !in_range(child, (double)minimum, (double)maximum))
        return safe;
    if (child->number == floor(child->number))
        return (int64_t)child->number;
    json_fail(child, NULL, "value is %.10g; allowed: whole numbers %" PRId64 "..%" PRId64,
              child->number, minimum, maximum);
    return safe;
}

bool json_bool(struct json *object, const char *key, bool fallback)
{
    struct json *child = child_typed(object, key, JSON_BOOL, false);
    return child ? child->number != 0 : fallback;
}

const char *json_text(struct json *object, const char *key, const char *fallback)
{
    struct json *child = child_typed(object, key, JSON_TEXT, false);
    return child ? child->text : fallback;
}

int json_word(struct json *object, const char *key, const char *words, int fallback)
{
    struct json *child = child_typed(object, key, JSON_TEXT, fallback < 0);
    if (!child)
        return fallback < 0 ? 0 : fallback;
    const char *word = words;
    for (int index = 0; word; index++) {
        size_t length = strcspn(word, "|");
        if (strlen(child->text) == length && memcmp(child->text, word, length) == 0)
            return index;
        word = word[length] ? word + length + 1 : NULL;
    }
    json_fail(child, NULL, "value is '%.64s'; allowed: %s", child->text, words);
    return fallback < 0 ? 0 : fallback;
}

bool json_vector(struct json *object, const char *key, float *values, size_t count, double minimum,
                 double maximum)
{
    struct json *child = child_typed(object, key, JSON_ARRAY, false);
    if (!child)
        return false;
    if (child->children_count != count) {
        json_fail(child, NULL, "has %zu values; allowed: %zu", child->children_count, count);
        return false;
    }
    for (size_t i = 0; i < count; i++) {
        struct json *element = &child->children[i];
        if (element->type != JSON_NUMBER) {
            json_fail(element, NULL, "is %s; allowed: a number", type_words[element->type]);
            return false;
        }
        if (!in_range(element, minimum, maximum))
            return false;
        values[i] = (float)element->number;
    }
    return true;
}

struct json *json_object(struct json *object, const char *key)
{
    return child_typed(object, key, JSON_OBJECT, false);
}

size_t json_array(struct json *object, const char *key)
{
    struct json *child = child_typed(object, key, JSON_ARRAY, false);
    return child ? child->children_count : 0;
}

static struct json *element_typed(struct json *object, const char *key, size_t index,
                                  enum json_type type)
{
    struct json *child = child_typed(object, key, JSON_ARRAY, true);
    if (!child || index >= child->children_count)
        return NULL;
    struct json *element = &child->children[index];
    if (element->type == type)
        return element;
    json_fail(element, NULL, "is %s; allowed: %s", type_words[element->type], type_words[type]);
    return NULL;
}

struct json *json_element(struct json *object, const char *key, size_t index)
{
    return element_typed(object, key, index, JSON_OBJECT);
}

double json_element_number(struct json *object, const char *key, size_t index, double minimum,
                           double maximum)
{
    struct json *element = element_typed(object, key, index, JSON_NUMBER);
    return element && in_range(element, minimum, maximum) ? element->number : minimum;
}

const char *json_element_text(struct json *object, const char *key, size_t index)
{
    struct json *element = element_typed(object, key, index, JSON_TEXT);
    return element ? element->text : "";
}

uint64_t json_u64(struct json *object, const char *key)
{
    const char *text = json_text(object, key, NULL);
    if (!text)
        return 0;
    char *end;
    uint64_t value = strtoull(text, &end, 16);
    if (strlen(text) != 16 || *end)
        json_fail(object, key, "value is '%.40s'; allowed: 16 hexadecimal digits", text);
    return value;
}
