/* The static plot of error against time, with its front. */
#include "report/plot.h"
#include "stats/stats.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Smallest and largest error over a row's views. */
static struct axis view_range(const struct row *row, bool full)
{
    struct axis range = {.low = INFINITY, .high = -INFINITY};
    for (size_t i = 0; i < row->seen->views_count; i++) {
        const struct result_view *view = &row->seen->views[i];
        double value = full ? view->full.value.flip : view->same.value.flip;
        if (view->compared && !isnan(value)) {
            range.low = fmin(range.low, value);
            range.high = fmax(range.high, value);
        }
    }
    return range;
}

struct trade {
    struct plot plot;
    const struct group *group;
    bool full; /* the reference has all effects */
    enum column_index metric;
    struct axis x, y;
    double noise, floor_ms; /* NaN: none */
    bool *on_front;         /* a row of the group */
};

/* The front of this metric (the summaries' front is FLIP's) and the range of both axes. */
static void trade_survey(struct trade *trade)
{
    const struct book *book = trade->plot.book;
    const struct group *group = trade->group;
    double *cost = ARENA_ARRAY(book->arena, double, group->rows_count);
    double *error = ARENA_ARRAY(book->arena, double, group->rows_count);
    trade->on_front = ARENA_ARRAY(book->arena, bool, group->rows_count);
    trade->x = trade->y = axis_empty();
    trade->noise = trade->floor_ms = NAN;
    for (size_t i = 0; i < group->rows_count; i++) {
        const struct row *row = &book->rows[group->rows[i]];
        cost[i] = row->is_floor ? NAN : row->values[COLUMN_frame_seconds];
        error[i] = row->is_floor ? NAN : row->values[trade->metric];
        if (row->is_floor && row->ok)
            trade->floor_ms = 1e3 * row->values[COLUMN_frame_seconds];
        if (isnan(cost[i]) || isnan(error[i]))
            continue;
        struct axis range = view_range(row, trade->full);
        axis_add(&trade->x, 1e3 * row->values[COLUMN_frame_seconds_low]);
        axis_add(&trade->x, 1e3 * row->values[COLUMN_frame_seconds_high]);
        axis_add(&trade->y, range.low);
        axis_add(&trade->y, range.high);
        if (!trade->full)
            trade->noise = fmax(trade->noise, row->values[COLUMN_floor_flip]);
    }
    stats_pareto(cost, error, group->rows_count, trade->on_front);
    if (trade->noise > trade->y.low / 20)
        axis_add(&trade->y, trade->noise);
    else
        trade->noise = NAN;
    if (trade->floor_ms > trade->x.low / 30)
        axis_add(&trade->x, trade->floor_ms);
    else
        trade->floor_ms = NAN;
    axis_widen(&trade->x, 0.1, 0.06);
    axis_widen(&trade->y, 0.1, 0.08);
}

static bool is_drawn(const struct trade *trade, const struct row *row)
{
    return !row->is_floor && !isnan(row->values[COLUMN_frame_seconds]) &&
           !isnan(row->values[trade->metric]);
}

/* One block a method and kind of point: ms, low, high, error, smallest and largest over views. */
static void trade_points(struct trade *trade, size_t method, bool front)
{
    struct plot *plot = &trade->plot;
    const struct book *book = plot->book;
    int block = -1;
    for (size_t i = 0; i < trade->group->rows_count; i++) {
        const struct row *row = &book->rows[trade->group->rows[i]];
        if (row->method_index != method || trade->on_front[i] != front || !is_drawn(trade, row))
            continue;
        if (block < 0)
            block = plot_block(plot, "ms low high error smallest largest");
        struct axis range = view_range(row, trade->full);
        double lowest = trade->y.low;
        fprintf(
            plot->dat, "%.9g %.9g %.9g %.9g %.9g %.9g # %s\n",
            1e3 * row->values[COLUMN_frame_seconds], 1e3 * row->values[COLUMN_frame_seconds_low],
            1e3 * row->values[COLUMN_frame_seconds_high], fmax(row->values[trade->metric], lowest),
            fmax(range.low, lowest), fmax(range.high, lowest), row->label);
    }
    if (block < 0)
        return;
    plot_points(plot, block, "using 1:4:2:3:5:6 with xyerrorbars", method, front, NULL);
}

static void trade_front(struct trade *trade)
{
    struct plot *plot = &trade->plot;
    const struct group *group = trade->group;
    size_t *order = ARENA_ARRAY(plot->book->arena, size_t, group->rows_count), count = 0;
    for (size_t i = 0; i < group->rows_count; i++) {
        if (!trade->on_front[i])
            continue;
        size_t place = count++;
        double cost = plot->book->rows[group->rows[i]].values[COLUMN_frame_seconds];
        for (; place > 0; place--) {
            if (plot->book->rows[order[place - 1]].values[COLUMN_frame_seconds] <= cost)
                break;
            order[place] = order[place - 1];
        }
        order[place] = group->rows[i];
    }
    if (count == 0)
        return;
    for (size_t i = 0; i < group->rows_count; i++) {
        const struct row *row = &plot->book->rows[group->rows[i]];
        if (is_drawn(trade, row))
            plot_keep_clear(plot, 1e3 * row->values[COLUMN_frame_seconds],
                            fmax(row->values[trade->metric], trade->y.low));
    }
    int block = plot_block(plot, "front: ms error, as a staircase from edge to edge");
    for (size_t i = 0; i < count; i++) {
        const struct row *row = &plot->book->rows[order[i]];
        double ms = 1e3 * row->values[COLUMN_frame_seconds];
        double error = fmax(row->values[trade->metric], trade->y.low);
        if (i == 0)
            fprintf(plot->dat, "%.9g %.9g\n", ms, trade->y.high);
        fprintf(plot->dat, "%.9g %.9g\n", ms, error);
        if (i + 1 == count)
            fprintf(plot->dat, "%.9g %.9g\n", trade->x.high, error);
        if (*row->variant)
            plot_note(plot, ms, error, row->variant);
    }
    plot_curve(plot);
    fprintf(plot->gp,
            "\"%s.dat\" index %d with steps linewidth 1.4 linecolor rgb \"#%06x\" dashtype 2 "
            "title \"front\"",
            plot->name, block, tint_rgb(TINT_MUTED));
}

static void trade_lines(struct trade *trade)
{
    if (!isnan(trade->noise)) {
        fprintf(trade->plot.gp,
                "set arrow 1 from graph 0, first %.9g to graph 1, first %.9g nohead dashtype 3 "
                "linecolor rgb \"#%06x\"\n",
                trade->noise, trade->noise, tint_rgb(TINT_MUTED));
        plot_line_note(&trade->plot, trade->noise, "noise of the reference");
    }
    if (!isnan(trade->floor_ms))
        plot_upright(&trade->plot, 2, trade->floor_ms, "no trees (null)");
}

static void key_of_methods(struct plot *plot, const bool *used)
{
    enum { LONG_NAME = 11 }; /* of such three in a row do not fit */
    int entries = 1;
    size_t longest = 0;
    for (size_t m = 0; m < plot->book->methods_count; m++) {
        if (!used[m])
            continue;
        size_t length = strlen(plot->book->methods[m]);
        longest = length > longest ? length : longest;
        plot_curve(plot);
        fprintf(plot->gp,
                "keyentry with points pointtype %d pointsize 0.9 linecolor rgb \"#%06x\" "
                "title ",
                symbol_gnuplot(plot->book, m, true), tint_rgb(tint_method(plot->book, m)));
        plot_text(plot->gp, plot->book->methods[m]);
        entries++;
    }
    plot->columns = longest > LONG_NAME ? 2 : 3;
    plot->key_rows += (entries + plot->columns - 1) / plot->columns;
}

enum status plot_trade(const struct book *book, const struct group *group, bool full,
                       const char *folder, struct figure *figure, struct error *error)
{
    struct trade trade = {
        .group = group, .full = full, .metric = full ? COLUMN_full_flip : COLUMN_same_flip};
    const char *kind = full ? "all" : "same";
    figure->kind = full ? FIGURE_TRADE_FULL : FIGURE_TRADE_SAME;
    plot_open(&trade.plot, book, folder,
              arena_printf(book->arena, "trade-%s-flip-%s", group->slug, kind), group->title);
    trade_survey(&trade);
    plot_axes(&trade.plot, &trade.x, &trade.y, "time a frame [ms]",
              arena_printf(book->arena, "FLIP, reference with %s effects", kind));
    trade_lines(&trade);
    bool *used = ARENA_ARRAY(book->arena, bool, book->methods_count + 1);
    struct plot *plot = &trade.plot;
    /* The notes of the front are settings, so they stand before the first curve. */
    trade_front(&trade);
    for (size_t m = 0; m < book->methods_count; m++)
        for (int front = 0; front < 2; front++) {
            int before = plot->curves;
            trade_points(&trade, m, front);
            used[m] = used[m] || plot->curves > before;
        }
    if (plot->curves == 0) {
        plot_discard(plot);
        return STATUS_OK;
    }
    key_of_methods(plot, used);
    return plot_close(plot, figure, error);
}
