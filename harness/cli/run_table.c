/* The closing table of a run: one row a cell. */
#include "cli/run.h"

#include "report/report.h"
#include "wall/json.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Means over the compared views, same effects. */
struct errors {
    double flip, rmse;
};

static struct errors errors_of(const struct result *result)
{
    struct errors sum = {0, 0};
    size_t count = 0;
    for (size_t i = 0; i < result->views_count; i++)
        if (result->views[i].compared) {
            sum.flip += result->views[i].same.value.flip;
            sum.rmse += result->views[i].same.value.rmse;
            count++;
        }
    return count ? (struct errors){sum.flip / (double)count, sum.rmse / (double)count}
                 : (struct errors){NAN, NAN};
}

/* A number in a column, "-" when it was not measured. */
static void number_print(int width, int digits, double value)
{
    if (isnan(value))
        printf(" %*s", width, "-");
    else
        printf(" %*.*f", width, digits, value);
}

static void row_print(const struct summary *summary, int width)
{
    const struct result *result = summary->first;
    struct errors errors = errors_of(result);
    printf("%-*s", width, result->cell.name);
    number_print(10, 3, 1e3 * summary->frame_seconds.value);
    number_print(10, 3, 1e3 * summary->frame_seconds.low);
    number_print(10, 3, 1e3 * summary->frame_seconds.high);
    number_print(8, 1, 1 / summary->frame_seconds.value);
    number_print(8, 4, errors.flip);
    number_print(8, 4, errors.rmse);
    number_print(8, 1, 100 * summary->limit.fraction.value);
    printf("  %-10s", limit_word(summary->limit.resource));
    if (summary->failures)
        printf("  %s (%zu of %zu failed)\n",
               summary->repetitions ? "partly" : status_word(result->status), summary->failures,
               summary->failures + summary->repetitions);
    else
        printf("  ok%s\n", summary->on_front ? ", on the front" : "");
}

static void rows_json(struct arena *arena, const struct summary *rows, size_t count,
                      const char *folder)
{
    struct json_out *out = json_out(arena);
    json_open(out, NULL, '{');
    json_put_text(out, "run", folder);
    json_open(out, "cells", '[');
    for (size_t i = 0; i < count; i++) {
        struct errors errors = errors_of(rows[i].first);
        json_open(out, NULL, '{');
        json_put_text(out, "cell", rows[i].first->cell.name);
        json_put_text(out, "status", status_word(rows[i].first->status));
        json_put_text(out, "message", rows[i].first->message);
        json_put_number(out, "repetitions", (double)rows[i].repetitions);
        json_put_number(out, "failures", (double)rows[i].failures);
        json_put_number(out, "frame_seconds", rows[i].frame_seconds.value);
        json_put_number(out, "frame_seconds_low", rows[i].frame_seconds.low);
        json_put_number(out, "frame_seconds_high", rows[i].frame_seconds.high);
        json_put_number(out, "flip", errors.flip);
        json_put_number(out, "rmse", errors.rmse);
        json_put_text(out, "bound_by", limit_word(rows[i].limit.resource));
        json_put_number(out, "limit_fraction", rows[i].limit.fraction.value);
        json_put_number(out, "limit_fraction_low", rows[i].limit.fraction.low);
        json_put_number(out, "limit_fraction_high", rows[i].limit.fraction.high);
        json_put_bool(out, "on_front", rows[i].on_front);
        json_close(out);
    }
    json_close(out);
    json_close(out);
    printf("%s\n", json_out_text(out));
}

/* By scene, tree count and time, what failed last. */
static int row_order(const void *a, const void *b)
{
    const struct summary *x = a, *y = b;
    const struct cell *p = &x->first->cell, *q = &y->first->cell;
    int scene = strcmp(p->scene, q->scene);
    if (scene)
        return scene;
    if (p->trees != q->trees)
        return p->trees < q->trees ? -1 : 1;
    double s = x->frame_seconds.value, t = y->frame_seconds.value;
    if (isnan(s) || isnan(t))
        return isnan(s) - isnan(t);
    return (s > t) - (s < t);
}

enum status run_table(struct arena *arena, const char *folder, bool json, struct error *error)
{
    struct run *run;
    enum status status = run_read(arena, folder, &run, error);
    if (status)
        return status;
    size_t count;
    struct summary *rows = report_summaries(arena, run, &count);
    qsort(rows, count, sizeof *rows, row_order);
    if (json) {
        rows_json(arena, rows, count, folder);
        return STATUS_OK;
    }
    int width = 4;
    for (size_t i = 0; i < count; i++) {
        int length = (int)strlen(rows[i].first->cell.name);
        width = length > width ? length : width;
    }
    printf("%-*s %10s %10s %10s %8s %8s %8s %8s  %-10s  %s\n", width, "cell", "ms", "low", "high",
           "fps", "flip", "rmse", "% limit", "of", "status");
    for (size_t i = 0; i < count; i++)
        row_print(&rows[i], width);
    return STATUS_OK;
}
