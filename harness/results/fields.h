/* Fields that several kinds of lines of a run have, written and read alike. */
#ifndef TREELINE_RESULTS_FIELDS_H
#define TREELINE_RESULTS_FIELDS_H

#include "wall/gl.h"
#include "wall/json.h"

/* A list of the effects' words. */
void effects_put(struct json_out *out, const char *key, unsigned effects);
unsigned effects_get(struct json *object, const char *key);
/* A number of at least the least that may be null: NaN, "not measured". */
double number_or_nan(struct json *object, const char *key, double least);
/* The pixels along the sides of a picture. */
void size_get(struct json *object, int *width_px, int *height_px);
/* Key "target". */
enum target_format target_get(struct json *object);
/* The line's version is one that this program reads, and its key "kind" is this; else the
 * document's error is set. */
enum status kind_check(struct json *root, const char *kind);

#endif
