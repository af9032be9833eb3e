/* Which options a run sweeps, from the canonical options of its cells and the methods' tables. */
#include "report/sweep.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { VALUES_MIN = 3 };

static bool is_numeric(const struct option *option)
{
    return option->type == OPTION_INT || option->type == OPTION_FLOAT ||
           option->type == OPTION_DOUBLE;
}

/* What the options say without this one. */
static const char *rest_of(struct arena *arena, const struct method *method, const void *values,
                           const struct option *option)
{
    void *others = arena_alloc(arena, 1, method->options_size);
    char fallback[64];
    memcpy(others, values, method->options_size);
    option_fallback(option, fallback, sizeof fallback);
    option_set(method->options, option->name, fallback, others, NULL);
    size_t length = options_print(method->options, others, NULL, 0);
    char *text = arena_alloc(arena, length + 1, 1);
    options_print(method->options, others, text, length + 1);
    return text;
}

/* A point for every numeric option of a row; methods that are not built in have no table here. */
static void add_points(const struct book *book, size_t index, struct sweep_point **points,
                       size_t *count, size_t *capacity)
{
    struct arena *arena = book->arena;
    const struct row *row = &book->rows[index];
    const struct cell *cell = &row->seen->cell;
    const struct method *method = cell->method;
    if (!row->ok || row->is_floor || !method || !method->options)
        return;
    void *values = arena_alloc(arena, 1, method->options_size);
    options_default(method->options, values);
    if (options_parse(method->options, cell->options, values, NULL) != STATUS_OK)
        return;
    for (const struct option *option = method->options; option->name; option++) {
        char text[64];
        option_value(option, values, text, sizeof text);
        double value = is_numeric(option) ? strtod(text, NULL) : 0;
        if (!(value > 0))
            continue;
        if (*count == *capacity) {
            struct sweep_point *old = *points;
            *capacity = *capacity ? 2 * *capacity : 256;
            *points = ARENA_ARRAY(arena, struct sweep_point, *capacity);
            if (*count)
                memcpy(*points, old, *count * sizeof **points);
        }
        (*points)[(*count)++] = (struct sweep_point){index, value, option->name, option->unit,
                                                     rest_of(arena, method, values, option)};
    }
}

/* By family and option, groups with the most trees first, then what makes a curve, then value. */
static int compare_curves(const struct book *book, const struct sweep_point *x,
                          const struct sweep_point *y)
{
    const struct row *a = &book->rows[x->row], *b = &book->rows[y->row];
    size_t fa = book->groups[a->group].family, fb = book->groups[b->group].family;
    int order = (fa > fb) - (fa < fb);
    if (!order)
        order = strcmp(x->option, y->option);
    if (!order)
        order = (a->group < b->group) - (a->group > b->group);
    if (!order)
        order = (a->method_index > b->method_index) - (a->method_index < b->method_index);
    if (!order)
        order = (int)a->seen->cell.lod - (int)b->seen->cell.lod;
    if (!order)
        order = (int)a->seen->cell.format - (int)b->seen->cell.format;
    return order ? order : strcmp(x->rest, y->rest);
}

static int compare_points(const void *a, const void *b, void *book)
{
    const struct sweep_point *x = a, *y = b;
    int order = compare_curves(book, x, y);
    return order ? order : (x->value > y->value) - (x->value < y->value);
}

static const char *label_of(const struct book *book, const struct sweep_point *point)
{
    const struct row *row = &book->rows[point->row];
    const struct cell *cell = &row->seen->cell;
    const char *label =
        arena_printf(book->arena, "%s%s%s", row->method, *point->rest ? " " : "", point->rest);
    if (cell->lod != LOD_AUTO)
        label = arena_printf(book->arena, "%s lod=%s", label, lod_word(cell->lod));
    if (cell->format != TARGET_RGBA16F)
        label = arena_printf(book->arena, "%s %s", label, target_format_word(cell->format));
    return label;
}

static bool same_option(const struct book *book, const struct sweep_point *x,
                        const struct sweep_point *y)
{
    return book->groups[book->rows[x->row].group].family ==
               book->groups[book->rows[y->row].group].family &&
           strcmp(x->option, y->option) == 0;
}

/* The curves among sorted points of one family and option, of the first group that has some. */
static struct sweep make_sweep(const struct book *book, const struct sweep_point *points,
                               size_t count)
{
    struct sweep_curve *curves = ARENA_ARRAY(book->arena, struct sweep_curve, count);
    struct sweep sweep = {.option = points->option, .unit = points->unit, .curves = curves};
    for (size_t start = 0, end; start < count; start = end) {
        size_t values = 1;
        for (end = start + 1;
             end < count && compare_curves(book, &points[start], &points[end]) == 0; end++)
            values += points[end].value > points[end - 1].value;
        size_t group = book->rows[points[start].row].group;
        if (values < VALUES_MIN || (sweep.curves_count && group != sweep.group))
            continue;
        sweep.group = group;
        curves[sweep.curves_count++] =
            (struct sweep_curve){&points[start], end - start, label_of(book, &points[start])};
    }
    return sweep;
}

struct sweep *sweeps_find(const struct book *book, size_t *count)
{
    struct sweep_point *points = NULL;
    size_t points_count = 0, capacity = 0;
    for (size_t i = 0; i < book->rows_count; i++)
        add_points(book, i, &points, &points_count, &capacity);
    if (points_count)
        qsort_r(points, points_count, sizeof *points, compare_points, (void *)book);
    struct sweep *sweeps = ARENA_ARRAY(book->arena, struct sweep, points_count + 1);
    *count = 0;
    for (size_t start = 0, end; start < points_count; start = end) {
        for (end = start + 1;
             end < points_count && same_option(book, &points[start], &points[end]);)
            end++;
        sweeps[*count] = make_sweep(book, points + start, end - start);
        *count += sweeps[*count].curves_count > 0;
    }
    return sweeps;
}
