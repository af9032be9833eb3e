/* Placement from a file of positions: a row a tree. */
#include "scene/place.h"

#include "base/file.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { COLUMNS_MAX = 6 };
static const double PLACE_MAX_M = 1e6;
static const double DEGREE = 0.017453292519943295;

/* One line of the file, cut into columns in place. */
struct row {
    const char *path;
    size_t line;
    char *columns[COLUMNS_MAX];
    size_t columns_count;
};

static const char *const COLUMN_NAMES[COLUMNS_MAX] = {"x",     "z",       "rotation_deg",
                                                      "scale", "species", "stretch"};

static enum status row_number(const struct row *row, size_t column, double minimum, double maximum,
                              double *value, struct error *error)
{
    char *end = NULL;
    *value = strtod(row->columns[column], &end);
    if (end != row->columns[column] && *end == '\0' && *value >= minimum && *value <= maximum)
        return STATUS_OK;
    return error_set(error, STATUS_INVALID,
                     "%s:%zu: %s: value is '%s'; allowed: a number in %g..%g", row->path, row->line,
                     COLUMN_NAMES[column], row->columns[column], minimum, maximum);
}

/* Cuts a line into columns; a comment or an empty line has none. */
static enum status row_split(struct row *row, char *line, struct error *error)
{
    char *rest = NULL;
    line[strcspn(line, "#")] = '\0';
    row->columns_count = 0;
    for (char *column = strtok_r(line, " \t\r,;", &rest); column;
         column = strtok_r(NULL, " \t\r,;", &rest)) {
        if (row->columns_count == COLUMNS_MAX)
            return error_set(error, STATUS_INVALID,
                             "%s:%zu: column 7 is '%s'; allowed: x z [rotation_deg [scale "
                             "[species [stretch]]]]",
                             row->path, row->line, column);
        row->columns[row->columns_count++] = column;
    }
    if (row->columns_count == 1)
        return error_set(error, STATUS_INVALID, "%s:%zu: only '%s'; allowed: at least x and z",
                         row->path, row->line, row->columns[0]);
    return STATUS_OK;
}

static enum status row_species(const struct row *row, const struct description *description,
                               uint32_t *species, struct error *error)
{
    for (uint32_t k = 0; k < description->plants_count; k++)
        if (strcmp(description->plants[k].name, row->columns[4]) == 0) {
            *species = k;
            return STATUS_OK;
        }
    char names[512] = "";
    for (size_t k = 0, used = 0; k < description->plants_count && used < sizeof names; k++)
        used += (size_t)snprintf(names + used, sizeof names - used, "%s%s", k > 0 ? ", " : "",
                                 description->plants[k].name);
    return error_set(error, STATUS_INVALID, "%s:%zu: species: value is '%s'; allowed: %s",
                     row->path, row->line, row->columns[4], names);
}

static enum status row_place(const struct row *row, const struct description *description,
                             uint64_t seed, size_t index, struct instance *instance,
                             struct error *error)
{
    double limit_m = PLACE_MAX_M, at_m[2], value;
    if (description->placement.extent_m > 0)
        limit_m = 0.5 * description->placement.extent_m;
    for (size_t a = 0; a < 2; a++)
        if (row_number(row, a, -limit_m, limit_m, &at_m[a], error) != STATUS_OK)
            return STATUS_INVALID;
    place_tree(description, seed, index, at_m[0], at_m[1], instance);
    if (row->columns_count > 2) {
        if (row_number(row, 2, -3600, 3600, &value, error) != STATUS_OK)
            return STATUS_INVALID;
        instance->rotation_rad = (float)(value * DEGREE);
    }
    if (row->columns_count > 3) {
        if (row_number(row, 3, 0.001, 1000, &value, error) != STATUS_OK)
            return STATUS_INVALID;
        instance->scale = (float)value;
    }
    if (row->columns_count > 4 &&
        row_species(row, description, &instance->species, error) != STATUS_OK)
        return STATUS_INVALID;
    if (row->columns_count > 5) {
        if (row_number(row, 5, STRETCH_MIN, STRETCH_MAX, &value, error) != STATUS_OK)
            return STATUS_INVALID;
        instance->stretch = (float)value;
    }
    return STATUS_OK;
}

/* Half the side of the smallest centred square that holds the trees. */
static double instances_half(const struct instance *instances, size_t count)
{
    float half_m = 0;
    for (size_t k = 0; k < count; k++) {
        half_m = fmaxf(half_m, fabsf(instances[k].position_m[0]));
        half_m = fmaxf(half_m, fabsf(instances[k].position_m[2]));
    }
    return half_m;
}

enum status place_file(struct arena *arena, const struct description *description,
                       size_t trees_count, uint64_t seed, struct instance *instances,
                       double *half_m, struct error *error)
{
    char *text = NULL;
    size_t size = 0, placed = 0;
    struct row row = {.path = description->placement.file};
    if (file_read(arena, row.path, 0, &text, &size, error) != STATUS_OK)
        return error_context(error, "%s: placement.file", description->path);
    if (strlen(text) != size)
        return error_set(error, STATUS_INVALID, "%s: a NUL byte at %zu; allowed: text", row.path,
                         strlen(text));
    /* Every row is checked, also those that are not asked for. */
    for (char *line = text; line; row.line++) {
        char *next = strchr(line, '\n');
        if (next)
            *next++ = '\0';
        struct row current = row;
        current.line = row.line + 1;
        struct instance instance;
        if (row_split(&current, line, error) != STATUS_OK)
            return STATUS_INVALID;
        line = next;
        if (current.columns_count == 0)
            continue;
        if (row_place(&current, description, seed, placed, &instance, error) != STATUS_OK)
            return STATUS_INVALID;
        if (placed < trees_count)
            instances[placed] = instance;
        placed++;
    }
    if (placed < trees_count)
        return error_set(error, STATUS_INVALID,
                         "%s: trees: value is %zu; allowed: 0..%zu, the "
                         "rows of %s",
                         description->path, trees_count, placed, row.path);
    *half_m = description->placement.extent_m > 0 ? 0.5 * description->placement.extent_m
                                                  : instances_half(instances, trees_count);
    return STATUS_OK;
}
