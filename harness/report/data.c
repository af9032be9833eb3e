/* The page's data as JSON: columns of numbers, and tables of what the numbers belong to. Numbers
 * are rounded to five digits; the CSV has them exactly. */
#include "report/book.h"

#include "method/method.h"
#include "wall/json.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The errors that the page switches between: part of a picture's metrics, so that a page of ten
 * thousand cells stays small. They stand in the order of the views' values. */
static const struct {
    const char *heading;
    enum column_index same, full, floor;
    bool one_minus; /* 1 is identical: 1 less the value is shown */
} metrics[] = {
    {"FLIP", COLUMN_same_flip, COLUMN_full_flip, COLUMN_floor_flip, false},
    {"RMSE", COLUMN_same_rmse, COLUMN_full_rmse, COLUMN_floor_rmse, false},
    {"RMSE-8", COLUMN_same_rmse_box8, COLUMN_full_rmse_box8, COLUMN_floor_rmse_box8, false},
    {"HDR-FLIP", COLUMN_same_hdr_flip, COLUMN_full_hdr_flip, COLUMN_floor_hdr_flip, false},
    {"1 \u2212 SSIM", COLUMN_same_ssim, COLUMN_full_ssim, COLUMN_floor_ssim, true},
    {"coverage error", COLUMN_same_coverage, COLUMN_full_coverage, COLUMN_floor_coverage, false},
};
enum { METRICS_COUNT = sizeof metrics / sizeof *metrics };

static double rounded(double value)
{
    char text[40];
    if (!isfinite(value))
        return NAN;
    snprintf(text, sizeof text, "%.5g", value);
    return strtod(text, NULL);
}

static void put_number(struct json_out *out, const char *key, double value)
{
    json_put_number(out, key, rounded(value));
}

static const char *source_of(const char *method)
{
    for (size_t i = 0; methods_builtin[i]; i++)
        if (strcmp(methods_builtin[i]->name, method) == 0)
            return methods_builtin[i]->source;
    return NULL;
}

static void put_texts(struct json_out *out, const char *key, const char *const *texts, size_t count)
{
    json_open(out, key, '[');
    for (size_t i = 0; i < count; i++)
        json_put_text(out, NULL, texts[i]);
    json_close(out);
}

static void put_names(struct json_out *out, const struct book *book)
{
    json_put_text(out, "run", book->run_name);
    json_put_text(out, "folder", book->run->folder);
    json_put_text(out, "settings", book->run->provenance.settings);
    json_put_bool(out, "effects_differ", book->effects_differ);
    json_open(out, "methods", '[');
    for (size_t i = 0; i < book->methods_count; i++) {
        json_open(out, NULL, '{');
        json_put_text(out, "name", book->methods[i]);
        json_put_text(out, "color", tint_variable(tint_method(book, i)));
        json_put_text(out, "symbol", symbol_html(book, i));
        json_put_text(out, "source", source_of(book->methods[i]));
        json_close(out);
    }
    json_close(out);
    put_texts(out, "series", book->series, book->series_count);
    put_texts(out, "families", book->families, book->families_count);
}

static void put_groups(struct json_out *out, const struct book *book)
{
    json_open(out, "groups", '[');
    for (size_t g = 0; g < book->groups_count; g++) {
        const struct group *group = &book->groups[g];
        json_open(out, NULL, '{');
        json_put_number(out, "family", (double)group->family);
        json_put_number(out, "trees", (double)group->trees);
        json_put_text(out, "title", group->title);
        json_put_text(out, "slug", group->slug);
        json_put_number(out, "first", (double)group->rows[0]);
        json_put_number(out, "count", (double)group->rows_count);
        json_close(out);
    }
    json_close(out);
}

static void put_fronts(struct json_out *out, const struct book *book)
{
    struct arena *arena = arena_create(0);
    size_t *front = ARENA_ARRAY(arena, size_t, book->rows_count + 1), count;
    const struct group *group = answer_group(book, front, &count);
    json_put_number(out, "main_group", group ? (double)(group - book->groups) : 0);
    json_open(out, "front", '[');
    for (size_t i = 0; i < book->rows_count; i++)
        if (book->rows[i].summary->on_front)
            json_put_number(out, NULL, (double)i);
    json_close(out);
    arena_destroy(arena);
}

static void put_columns(struct json_out *out, const struct book *book)
{
    json_open(out, "columns", '[');
    for (size_t c = 0; c < COLUMNS_COUNT; c++) {
        const struct column *column = &column_table[c];
        json_open(out, NULL, '{');
        json_put_text(out, "key", column->key);
        json_put_text(out, "unit", column->unit);
        json_put_text(out, "doc", column->doc);
        bool known = book_knows(book, (enum column_index)c);
        json_open(out, "values", '[');
        for (size_t i = 0; i < book->rows_count && known; i++)
            put_number(out, NULL, book->rows[i].values[c]);
        json_close(out);
        json_close(out);
    }
    json_close(out);
    json_open(out, "shown", '[');
    for (size_t i = 0; i < book->shown_count; i++) {
        json_open(out, NULL, '{');
        json_put_number(out, "column", book->shown[i].column);
        json_put_text(out, "heading", book->shown[i].heading);
        json_put_text(out, "unit", book->shown[i].unit);
        json_put_number(out, "scale", book->shown[i].scale);
        json_close(out);
    }
    json_close(out);
}

static void put_metrics(struct json_out *out)
{
    json_open(out, "metrics", '[');
    for (size_t m = 0; m < METRICS_COUNT; m++) {
        json_open(out, NULL, '{');
        json_put_text(out, "heading", metrics[m].heading);
        json_put_text(out, "key", column_table[metrics[m].same].key + strlen("same_"));
        json_put_text(out, "doc", column_table[metrics[m].same].doc);
        json_put_bool(out, "one_minus", metrics[m].one_minus);
        json_close(out);
    }
    json_close(out);
}

static double error_of(const struct metrics *values, size_t m)
{
    return metric_of(values, &metric_table[metrics[m].same - COLUMN_same_rmse]);
}

/* A row's compared views: time, distance, angles, the errors of either reference, the noise of the
 * one with the same effects. */
static void put_views(struct json_out *out, const struct row *row)
{
    json_open(out, NULL, '[');
    for (size_t v = 0; v < row->seen->views_count; v++) {
        const struct result_view *view = &row->seen->views[v];
        json_open(out, NULL, '[');
        put_number(out, NULL, view->time);
        put_number(out, NULL, view->distance_m);
        put_number(out, NULL, view->elevation_deg);
        put_number(out, NULL, view->azimuth_deg);
        for (size_t m = 0; m < METRICS_COUNT && view->compared; m++)
            put_number(out, NULL, error_of(&view->same.value, m));
        for (size_t m = 0; m < METRICS_COUNT && view->compared; m++)
            put_number(out, NULL, error_of(&view->full.value, m));
        for (size_t m = 0; m < METRICS_COUNT && view->compared; m++)
            put_number(out, NULL, error_of(&view->same.floor, m));
        json_close(out);
    }
    json_close(out);
}

static const char *state_of(const struct row *row)
{
    return row->ok ? row->is_floor ? "floor" : "ok" : status_word(row->seen->status);
}

static void put_rows(struct json_out *out, const struct book *book)
{
    json_open(out, "rows", '[');
    for (size_t i = 0; i < book->rows_count; i++) {
        const struct row *row = &book->rows[i];
        json_open(out, NULL, '[');
        json_put_number(out, NULL, (double)row->group);
        json_put_number(out, NULL, (double)row->series);
        json_put_number(out, NULL, (double)row->method_index);
        json_put_text(out, NULL, state_of(row));
        json_put_text(out, NULL, row->seen->cell.name);
        json_put_text(out, NULL, row->variant);
        json_put_text(out, NULL, row->seen->message);
        put_views(out, row);
        json_put_text(out, NULL, limit_word(row->summary->limit.resource));
        json_close(out);
    }
    json_close(out);
}

static void put_laws(struct json_out *out, const struct book *book)
{
    json_open(out, "laws", '[');
    for (size_t i = 0; i < book->laws_count; i++) {
        const struct law *law = &book->laws[i];
        json_open(out, NULL, '{');
        json_put_number(out, "family", (double)law->points->family);
        json_put_number(out, "series", (double)law->points->series);
        json_open(out, "rows", '[');
        for (size_t k = 0; k < law->points_count; k++)
            json_put_number(out, NULL, (double)law->points[k].row);
        json_close(out);
        if (law->is_fitted) {
            put_number(out, "a", law->time.a);
            put_number(out, "b", law->time.b.value);
            put_number(out, "low", law->time.b.low);
            put_number(out, "high", law->time.b.high);
            put_number(out, "r2", law->time.r2);
        }
        json_close(out);
    }
    json_close(out);
}

const char *data_json(const struct book *book, struct arena *arena)
{
    struct json_out *out = json_out(arena);
    json_open(out, NULL, '{');
    put_names(out, book);
    put_groups(out, book);
    put_fronts(out, book);
    put_columns(out, book);
    put_metrics(out);
    put_laws(out, book);
    put_rows(out, book);
    json_close(out);
    return json_out_text(out);
}
