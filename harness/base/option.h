/* One table of typed options: parsing, defaults, ranges, help, documentation and canonical names.
 */
#ifndef TREELINE_BASE_OPTION_H
#define TREELINE_BASE_OPTION_H

#include "base/error.h"

#include <stdbool.h>
#include <stddef.h>

enum option_type { OPTION_BOOL, OPTION_INT, OPTION_FLOAT, OPTION_DOUBLE, OPTION_CHOICE };

struct option {
    const char *name; /* the field's name; NULL ends the table */
    enum option_type type;
    size_t offset;                     /* of the field in the options struct */
    double fallback, minimum, maximum; /* bool: 0 or 1; choice: index */
    const char *unit;                  /* "px", "m", "" */
    const char *doc;                   /* one sentence, no full stop */
    const char *choices;               /* "blend|test|coverage"; NULL unless OPTION_CHOICE */
};

/* clang-format off */
#define OPTION_TYPE(type, field)                                                                   \
    _Generic(((type *)0)->field, bool: OPTION_BOOL, int: OPTION_INT, float: OPTION_FLOAT,          \
             double: OPTION_DOUBLE)
/* bool fields: OPTION(struct options, blend, 1, 0, 1, "", "..."). Values are on|off (also 1|0, true|false). */
#define OPTION(type, field, fallback, minimum, maximum, unit, doc)                                 \
    { #field, OPTION_TYPE(type, field), offsetof(type, field), (fallback), (minimum), (maximum), unit, doc, NULL }
/* The field is an int that holds the index of the word; fallback is an index too. */
#define OPTION_WORD(type, field, fallback, words, doc)                                             \
    { #field, OPTION_CHOICE,                                                                       \
      offsetof(type, field) + 0 * sizeof(_Generic(((type *)0)->field, int: 1)),                    \
      (fallback), 0, 0, "", doc, words }
/* The same of a field of an inner struct, which several methods share. */
#define OPTION_IN(type, inner, field, fallback, minimum, maximum, unit, doc)                       \
    { #field, OPTION_TYPE(type, inner.field), offsetof(type, inner.field), (fallback), (minimum),  \
      (maximum), unit, doc, NULL }
#define OPTION_WORD_IN(type, inner, field, fallback, words, doc)                                   \
    { #field, OPTION_CHOICE,                                                                       \
      offsetof(type, inner.field) + 0 * sizeof(_Generic(((type *)0)->inner.field, int: 1)),        \
      (fallback), 0, 0, "", doc, words }
#define OPTION_END { NULL, OPTION_INT, 0, 0, 0, 0, NULL, NULL, NULL }
/* clang-format on */

/* Fills the struct with every option's default. table may be NULL (no options). */
void options_default(const struct option *table, void *values);

/* Sets one option. Errors (STATUS_INVALID): "views: 900 is outside 1..512", "alpha: 'x' is not one
 * of blend|test|coverage", "no option 'vews'; options are views, alpha" with the nearest name
 * first. */
enum status option_set(const struct option *table, const char *name, const char *value,
                       void *values, struct error *error);

/* Parses "views=16,alpha=test" over values already holding defaults; NULL or "" changes nothing. */
enum status options_parse(const struct option *table, const char *text, void *values,
                          struct error *error);

/* Canonical text of the options that differ from their defaults, in table order:
 * "views=16,alpha=test". Parses back to the same values. Returns the length that was needed, as
 * snprintf does. */
size_t options_print(const struct option *table, const void *values, char *text, size_t size);

/* One option's value as text ("on", "16", "0.5", "blend"); returns the length needed. */
size_t option_value(const struct option *option, const void *values, char *text, size_t size);

/* The default of one option as text, whatever struct it belongs to; returns the length needed. */
size_t option_fallback(const struct option *option, char *text, size_t size);

/* "1..512", "on|off" or the words; returns the length needed. */
size_t option_allowed(const struct option *option, char *text, size_t size);

#endif
