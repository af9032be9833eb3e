/* JSON through cJSON: strict readers that name file, key path, value and allowance; a writer into
 * the arena.
 *
 * Reading is sticky: after the first error every getter returns its fallback, and json_end tells
 * the error. So a loader reads straight down:
 *
 *     struct json_doc *doc = json_load(arena, path, error);         NULL on error
 *     struct json *root = json_root(doc);
 *     double height = json_number(root, "height_m", 20, 0.1, 200);
 *     struct json *light = json_object(root, "light");              NULL when absent; getters
 * accept NULL return json_end(doc);                                         unknown keys are errors
 *
 * A key whose value is null counts as absent. */
#ifndef TREELINE_WALL_JSON_H
#define TREELINE_WALL_JSON_H

#include "base/arena.h"
#include "base/error.h"

#include <stdbool.h>

struct json_doc;
struct json;

/* STATUS_NOT_FOUND, STATUS_IO, or STATUS_INVALID "FILE:LINE: not JSON near '...'". Files above 16
 * MiB, what json_text_check refuses, duplicate keys and NaN are refused. error must outlive the
 * document. */
struct json_doc *json_load(struct arena *arena, const char *path, struct error *error);
/* The same from text; where stands for the file's name in errors. */
struct json_doc *json_parse(struct arena *arena, const char *text, const char *where,
                            struct error *error);
struct json *json_root(struct json_doc *doc); /* an object; anything else is an error */
/* Checks that every key was asked for, and says for one that was not which ones were; frees cJSON's
 * memory. Returns the document's status. Texts stay valid. */
enum status json_end(struct json_doc *doc);

bool json_has(struct json *object, const char *key);
/* Values in [minimum, maximum]; a fallback of NaN means the key is required. */
double json_number(struct json *object, const char *key, double fallback, double minimum,
                   double maximum);
/* Whole numbers up to 2^53. fallback < minimum means the key is required. */
int64_t json_integer(struct json *object, const char *key, int64_t fallback, int64_t minimum,
                     int64_t maximum);
bool json_bool(struct json *object, const char *key, bool fallback);
/* In the arena. fallback NULL: NULL when absent. */
const char *json_text(struct json *object, const char *key, const char *fallback);
/* Index of the text in words "still|orbit|walk"; fallback -1: required. */
int json_word(struct json *object, const char *key, const char *words, int fallback);
/* Exactly count numbers in [minimum, maximum] into values, which hold the fallback; false when
 * absent. */
bool json_vector(struct json *object, const char *key, float *values, size_t count, double minimum,
                 double maximum);
struct json *json_object(struct json *object, const char *key); /* NULL when absent */
/* An array: its length (0 when absent) and its elements, objects or numbers or texts. */
size_t json_array(struct json *object, const char *key);
struct json *json_element(struct json *object, const char *key,
                          size_t index); /* an object element */
double json_element_number(struct json *object, const char *key, size_t index, double minimum,
                           double maximum);
const char *json_element_text(struct json *object, const char *key, size_t index);
/* A semantic error at a key, in the same form; sticky. */
enum status json_fail(struct json *object, const char *key, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* Writing: appends to a growing text in the arena. Doubles are shortest round-trip; NaN and
 * infinity become null. */
struct json_out;
struct json_out *json_out(struct arena *arena);
void json_open(struct json_out *out, const char *key,
               char bracket); /* '{' or '['; key NULL in arrays */
void json_close(struct json_out *out);
void json_put_number(struct json_out *out, const char *key, double value);
void json_put_u64(struct json_out *out, const char *key,
                  uint64_t value); /* as 16 hex digits in a text */
void json_put_text(struct json_out *out, const char *key, const char *value); /* NULL: null */
void json_put_bool(struct json_out *out, const char *key, bool value);
char *json_out_text(struct json_out *out); /* one line, no newline */
/* A u64 written by json_put_u64. */
uint64_t json_u64(struct json *object, const char *key);

#endif
