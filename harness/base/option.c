/* The option table: defaults, parsing with ranges, canonical text. */
#include "base/option.h"

#include "base/nearest.h"

#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

static void store(const struct option *option, void *values, double value)
{
    void *field = (char *)values + option->offset;
    switch (option->type) {
    case OPTION_BOOL:
        *(bool *)field = value != 0;
        break;
    case OPTION_INT:
    case OPTION_CHOICE:
        *(int *)field = (int)value;
        break;
    case OPTION_FLOAT:
        *(float *)field = (float)value;
        break;
    case OPTION_DOUBLE:
        *(double *)field = value;
        break;
    }
}

static double fetch(const struct option *option, const void *values)
{
    const void *field = (const char *)values + option->offset;
    switch (option->type) {
    case OPTION_BOOL:
        return *(const bool *)field;
    case OPTION_INT:
    case OPTION_CHOICE:
        return *(const int *)field;
    case OPTION_FLOAT:
        return *(const float *)field;
    case OPTION_DOUBLE:
        return *(const double *)field;
    }
    return 0;
}

void options_default(const struct option *table, void *values)
{
    for (const struct option *option = table; option && option->name; option++)
        store(option, values, option->fallback);
}

/* Index of a word in "a|b|c", -1 when it is none of them. */
static int word_index(const char *words, const char *word, size_t length)
{
    for (int index = 0; words; index++) {
        const char *end = strchrnul(words, '|');
        if ((size_t)(end - words) == length && memcmp(words, word, length) == 0)
            return index;
        words = *end ? end + 1 : NULL;
    }
    return -1;
}

static bool parse_bool(const char *text, double *value)
{
    static const char *const on[] = {"on", "1", "true", "yes"}, *const off[] = {"off", "0", "false",
                                                                                "no"};
    for (size_t i = 0; i < 4; i++) {
        if (strcasecmp(text, on[i]) == 0) {
            *value = 1;
            return true;
        }
        if (strcasecmp(text, off[i]) == 0) {
            *value = 0;
            return true;
        }
    }
    return false;
}

static bool parse_number(const char *text, bool whole, double *value)
{
    char *end;
    if (*text == 0 || *text == ' ')
        return false;
    *value = strtod(text, &end);
    return *end == 0 && !isnan(*value) && (!whole || *value == floor(*value));
}

static enum status bad_value(const struct option *option, const char *value, struct error *error)
{
    char allowed[256];
    option_allowed(option, allowed, sizeof allowed);
    const char *relation = option->type == OPTION_BOOL || option->type == OPTION_CHOICE
                               ? "is not one of"
                               : "is outside";
    double number;
    if (option->type == OPTION_INT && !parse_number(value, true, &number))
        relation = "is not a whole number in";
    else if (option->type != OPTION_BOOL && option->type != OPTION_CHOICE &&
             !parse_number(value, false, &number))
        relation = "is not a number in";
    return error_set(error, STATUS_INVALID, "%s: '%s' %s %s", option->name, value, relation,
                     allowed);
}

static enum status unknown_name(const struct option *table, const char *name, struct error *error)
{
    char names[512] = "";
    const char *nearest = NULL;
    for (const struct option *option = table; option && option->name; option++) {
        size_t used = strlen(names);
        snprintf(names + used, sizeof names - used, "%s%s", used ? ", " : "", option->name);
        nearest = nearest_of(name, nearest, option->name);
    }
    if (!nearest)
        return error_set(error, STATUS_INVALID, "no option '%s'; there are no options", name);
    return error_set(error, STATUS_INVALID, "no option '%s'; did you mean '%s'? options are %s",
                     name, nearest, names);
}

enum status option_set(const struct option *table, const char *name, const char *value,
                       void *values, struct error *error)
{
    const struct option *option = table;
    while (option && option->name && strcmp(option->name, name) != 0)
        option++;
    if (!option || !option->name)
        return unknown_name(table, name, error);
    double number = 0;
    bool good = false;
    switch (option->type) {
    case OPTION_BOOL:
        good = parse_bool(value, &number);
        break;
    case OPTION_CHOICE:
        number = word_index(option->choices, value, strlen(value));
        good = number >= 0;
        break;
    case OPTION_INT:
    case OPTION_FLOAT:
    case OPTION_DOUBLE:
        good = parse_number(value, option->type == OPTION_INT, &number) &&
               number >= option->minimum && number <= option->maximum;
        break;
    }
    if (!good)
        return bad_value(option, value, error);
    store(option, values, number);
    return STATUS_OK;
}

enum status options_parse(const struct option *table, const char *text, void *values,
                          struct error *error)
{
    while (text && *text) {
        char item[256];
        size_t length = strcspn(text, ",");
        if (length >= sizeof item)
            return error_set(error, STATUS_INVALID,
                             "option '%.40s...' is longer than %zu characters", text,
                             sizeof item - 1);
        memcpy(item, text, length);
        item[length] = 0;
        text += length + (text[length] == ',');
        char *equals = strchr(item, '=');
        if (!equals)
            return error_set(error, STATUS_INVALID, "option '%s' has no value; write %s=VALUE",
                             item, item);
        *equals = 0;
        enum status status = option_set(table, item, equals + 1, values, error);
        if (status != STATUS_OK)
            return status;
    }
    return STATUS_OK;
}

/* The shortest decimal that reads back as the same value. */
static int number_print(double value, bool single, char *text, size_t size)
{
    for (int digits = 6; digits < 17; digits++) {
        int length = snprintf(text, size, "%.*g", digits, value);
        char exact[40];
        snprintf(exact, sizeof exact, "%.*g", digits, value);
        double back = strtod(exact, NULL);
        if (single ? (float)back == (float)value : back == value)
            return length;
    }
    return snprintf(text, size, "%.17g", value);
}

size_t option_value(const struct option *option, const void *values, char *text, size_t size)
{
    double value = fetch(option, values);
    const char *word = option->choices;
    switch (option->type) {
    case OPTION_BOOL:
        return (size_t)snprintf(text, size, "%s", value != 0 ? "on" : "off");
    case OPTION_CHOICE:
        for (int i = 0; i < (int)value && word; i++) {
            const char *bar = strchr(word, '|');
            word = bar ? bar + 1 : NULL;
        }
        return (size_t)snprintf(text, size, "%.*s", word ? (int)strcspn(word, "|") : 1,
                                word ? word : "?");
    case OPTION_INT:
        return (size_t)snprintf(text, size, "%d", (int)value);
    case OPTION_FLOAT:
    case OPTION_DOUBLE:
        break;
    }
    return (size_t)number_print(value, option->type == OPTION_FLOAT, text, size);
}

size_t option_fallback(const struct option *option, char *text, size_t size)
{
    /* A struct that holds this field only. */
    double field = 0;
    struct option alone = *option;
    alone.offset = 0;
    store(&alone, &field, option->fallback);
    return option_value(&alone, &field, text, size);
}

size_t option_allowed(const struct option *option, char *text, size_t size)
{
    if (option->type == OPTION_BOOL)
        return (size_t)snprintf(text, size, "on|off");
    if (option->type == OPTION_CHOICE)
        return (size_t)snprintf(text, size, "%s", option->choices);
    return (size_t)snprintf(text, size, "%.10g..%.10g", option->minimum, option->maximum);
}

size_t options_print(const struct option *table, const void *values, char *text, size_t size)
{
    size_t used = 0;
    if (size)
        *text = 0;
    for (const struct option *option = table; option && option->name; option++) {
        bool single = option->type == OPTION_FLOAT;
        double value = fetch(option, values);
        if (value == (single ? (double)(float)option->fallback : option->fallback))
            continue;
        char item[320], number[256];
        option_value(option, values, number, sizeof number);
        int length = snprintf(item, sizeof item, "%s%s=%s", used ? "," : "", option->name, number);
        if (used < size)
            snprintf(text + used, size - used, "%s", item);
        used += (size_t)length;
    }
    return used;
}
