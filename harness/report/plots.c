/* The plots of the report: error against time, frame rate against trees, error against distance. */
#include "report/plot.h"
#include "stats/stats.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char *metric_name(enum column_index metric)
{
    return metric == COLUMN_same_rmse || metric == COLUMN_full_rmse ? "RMSE" : "FLIP";
}

static bool is_full(enum column_index metric)
{
    return metric == COLUMN_full_flip || metric == COLUMN_full_rmse;
}

/* Smallest and largest error over a row's views. */
static struct axis view_range(const struct row *row, enum column_index metric)
{
    struct axis range = {INFINITY, -INFINITY};
    for (size_t i = 0; i < row->seen->views_count; i++) {
        const struct result_view *view = &row->seen->views[i];
        const struct metrics *errors = is_full(metric) ? &view->full.value : &view->same.value;
        double value = strcmp(metric_name(metric), "RMSE") == 0 ? errors->rmse : errors->flip;
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
        struct axis range = view_range(row, trade->metric);
        axis_add(&trade->x, 1e3 * row->values[COLUMN_frame_seconds_low]);
        axis_add(&trade->x, 1e3 * row->values[COLUMN_frame_seconds_high]);
        axis_add(&trade->y, range.low);
        axis_add(&trade->y, range.high);
        double noise = trade->metric == COLUMN_same_flip   ? row->values[COLUMN_floor_flip]
                       : trade->metric == COLUMN_same_rmse ? row->values[COLUMN_floor_rmse]
                                                           : NAN;
        trade->noise = fmax(trade->noise, noise);
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
    size_t tint = tint_method(book, method);
    int block = -1;
    for (size_t i = 0; i < trade->group->rows_count; i++) {
        const struct row *row = &book->rows[trade->group->rows[i]];
        if (row->method_index != method || trade->on_front[i] != front || !is_drawn(trade, row))
            continue;
        if (block < 0)
            block = plot_block(plot, "ms low high error smallest largest");
        struct axis range = view_range(row, trade->metric);
        double lowest = trade->y.low;
        fprintf(
            plot->dat, "%.9g %.9g %.9g %.9g %.9g %.9g # %s\n",
            1e3 * row->values[COLUMN_frame_seconds], 1e3 * row->values[COLUMN_frame_seconds_low],
            1e3 * row->values[COLUMN_frame_seconds_high], fmax(row->values[trade->metric], lowest),
            fmax(range.low, lowest), fmax(range.high, lowest), row->label);
    }
    if (block < 0)
        return;
    plot_curve(plot);
    fprintf(plot->gp,
            "\"%s.dat\" index %d using 1:4:2:3:5:6 with xyerrorbars pointtype %d pointsize 0.9 "
            "linewidth 1 linecolor rgb \"#%06x\" notitle",
            plot->name, block, symbol_gnuplot(book, method, front), tint_rgb(tint));
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
    FILE *gp = trade->plot.gp;
    unsigned muted = tint_rgb(TINT_MUTED);
    if (!isnan(trade->noise))
        fprintf(gp,
                "set arrow 1 from graph 0, first %.9g to graph 1, first %.9g nohead dashtype 3 "
                "linecolor rgb \"#%06x\"\nset label 1 \"noise of the reference\" at graph 0.99, "
                "first %.9g right offset 0,0.5 font \",10\" textcolor rgb \"#%06x\"\n",
                trade->noise, trade->noise, muted, trade->noise, muted);
    if (!isnan(trade->floor_ms))
        fprintf(gp,
                "set arrow 2 from first %.9g, graph 0 to first %.9g, graph 1 nohead dashtype 3 "
                "linecolor rgb \"#%06x\"\nset label 2 \"no trees (null)\" at first %.9g, graph "
                "0.98 right rotate by 90 offset 0.8,0 font \",10\" textcolor rgb \"#%06x\"\n",
                trade->floor_ms, trade->floor_ms, muted, trade->floor_ms, muted);
}

static void key_of_methods(struct plot *plot, const bool *used)
{
    int entries = 1;
    for (size_t m = 0; m < plot->book->methods_count; m++) {
        if (!used[m])
            continue;
        plot_curve(plot);
        fprintf(plot->gp,
                "keyentry with points pointtype %d pointsize 0.9 linecolor rgb \"#%06x\" "
                "title ",
                symbol_gnuplot(plot->book, m, true), tint_rgb(tint_method(plot->book, m)));
        plot_text(plot->gp, plot->book->methods[m]);
        entries++;
    }
    plot->key_rows += (entries + 2) / 3;
    plot->columns = 3;
}

enum status plot_trade(const struct book *book, const struct group *group, enum column_index metric,
                       const char *folder, struct figure *figure, struct error *error)
{
    struct trade trade = {.group = group, .metric = metric};
    const char *kind = is_full(metric) ? "all effects" : "same effects";
    const char *label =
        arena_printf(book->arena, "%s, reference with %s", metric_name(metric), kind);
    const char *name = arena_printf(book->arena, "trade-%s-%s-%s", group->slug,
                                    metric_name(metric)[0] == 'F' ? "flip" : "rmse",
                                    is_full(metric) ? "all" : "same");
    plot_open(&trade.plot, book, folder, name, group->title);
    trade_survey(&trade);
    plot_axes(&trade.plot, &trade.x, &trade.y, "time a frame [ms]", label);
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

/* One series of a family: frame rate by trees, with its law. */
static bool growth_series(struct plot *plot, size_t family, size_t series, int variant)
{
    const struct book *book = plot->book;
    double *trees = ARENA_ARRAY(book->arena, double, book->rows_count);
    double *fps = ARENA_ARRAY(book->arena, double, book->rows_count);
    size_t count = 0, method = 0;
    int block = -1;
    for (size_t i = 0; i < book->rows_count; i++) {
        const struct row *row = &book->rows[i];
        if (row->series != series || book->groups[row->group].family != family ||
            isnan(row->values[COLUMN_fps]) || row->trees == 0)
            continue;
        if (block < 0)
            block = plot_block(plot, row->label);
        trees[count] = (double)row->trees;
        fps[count++] = row->values[COLUMN_fps];
        method = row->method_index;
        fprintf(plot->dat, "%zu %.9g %.9g %.9g\n", row->trees, row->values[COLUMN_fps],
                1 / row->values[COLUMN_frame_seconds_high],
                1 / row->values[COLUMN_frame_seconds_low]);
    }
    if (block < 0)
        return false;
    struct power_law law = stats_power_law(trees, fps, count);
    unsigned color = tint_rgb(tint_method(book, method));
    plot_curve(plot);
    fprintf(plot->gp,
            "\"%s.dat\" index %d with yerrorbars pointtype %d pointsize 0.9 linewidth 1 "
            "linecolor rgb \"#%06x\" notitle",
            plot->name, block, symbol_gnuplot(book, method, variant == 0), color);
    if (count >= 3) {
        int line = plot_block(plot, "its power law");
        for (int end = 0; end < 2; end++) {
            double at = trees[end ? count - 1 : 0];
            fprintf(plot->dat, "%.9g %.9g\n", at, law.a * pow(at, law.b.value));
        }
        block = line;
    }
    plot_curve(plot);
    fprintf(plot->gp,
            "\"%s.dat\" index %d using 1:2 with lines linewidth 1.3 dashtype %d linecolor rgb "
            "\"#%06x\" notitle, \\\n    keyentry with linespoints pointtype %d pointsize 0.9 "
            "linewidth 1.3 dashtype %d linecolor rgb \"#%06x\" title ",
            plot->name, block, 1 + variant % 5, color, symbol_gnuplot(book, method, variant == 0),
            1 + variant % 5, color);
    char text[256];
    snprintf(text, sizeof text, "%s%s", book->series[series],
             count < 3 ? "" : arena_printf(book->arena, ": N^(%.2f)", law.b.value));
    plot_text(plot->gp, text);
    plot->key_rows++;
    return true;
}

/* How many series of the same method come before this one. */
static int variant_of(const struct book *book, size_t series)
{
    size_t *method_of = ARENA_ARRAY(book->arena, size_t, book->series_count);
    for (size_t i = 0; i < book->rows_count; i++)
        method_of[book->rows[i].series] = book->rows[i].method_index;
    int before = 0;
    for (size_t s = 0; s < series; s++)
        before += method_of[s] == method_of[series];
    return before;
}

enum status plot_growth(const struct book *book, size_t family, const char *folder,
                        struct figure *figure, bool *drawn, struct error *error)
{
    struct axis x = axis_empty(), y = axis_empty();
    const char *slug = NULL;
    for (size_t g = 0; g < book->groups_count; g++)
        if (book->groups[g].family == family) {
            axis_add(&x, (double)book->groups[g].trees);
            slug = slug ? slug : book->groups[g].slug;
        }
    *drawn = x.low < x.high;
    if (!*drawn)
        return STATUS_OK;
    for (size_t i = 0; i < book->rows_count; i++)
        if (book->groups[book->rows[i].group].family == family && book->rows[i].trees > 0) {
            axis_add(&y, 1 / book->rows[i].values[COLUMN_frame_seconds_low]);
            axis_add(&y, 1 / book->rows[i].values[COLUMN_frame_seconds_high]);
        }
    axis_widen(&x, 0.05, 0.05);
    axis_widen(&y, 0.08, 0.08);
    struct plot plot;
    plot_open(&plot, book, folder, arena_printf(book->arena, "growth-%s", slug),
              book->families[family]);
    plot_axes(&plot, &x, &y, "trees", "frames a second");
    fputs("set key maxcols 1\n", plot.gp);
    for (size_t s = 0; s < book->series_count; s++)
        growth_series(&plot, family, s, variant_of(book, s));
    *drawn = plot.curves > 0;
    if (!*drawn) {
        plot_discard(&plot);
        return STATUS_OK;
    }
    return plot_close(&plot, figure, error);
}

static int compare_views(const void *a, const void *b)
{
    const struct result_view *x = *(const struct result_view *const *)a;
    const struct result_view *y = *(const struct result_view *const *)b;
    return (x->distance_m > y->distance_m) - (x->distance_m < y->distance_m);
}

static void distance_curve(struct plot *plot, const struct row *row, double lowest)
{
    const struct book *book = plot->book;
    const struct result *seen = row->seen;
    const struct result_view **views =
        ARENA_ARRAY(book->arena, const struct result_view *, seen->views_count);
    size_t count = 0;
    for (size_t i = 0; i < seen->views_count; i++)
        if (seen->views[i].compared && seen->views[i].distance_m > 0)
            views[count++] = &seen->views[i];
    if (count == 0)
        return;
    qsort(views, count, sizeof *views, compare_views);
    int block = plot_block(plot, row->label);
    for (size_t i = 0; i < count; i++)
        fprintf(plot->dat, "%.9g %.9g\n", views[i]->distance_m,
                fmax(views[i]->same.value.flip, lowest));
    int variant = variant_of(book, row->series);
    plot_curve(plot);
    fprintf(
        plot->gp,
        "\"%s.dat\" index %d with linespoints pointtype %d pointsize 0.8 linewidth 1.2 dashtype "
        "%d linecolor rgb \"#%06x\" title ",
        plot->name, block, symbol_gnuplot(book, row->method_index, variant == 0), 1 + variant % 5,
        tint_rgb(tint_method(book, row->method_index)));
    plot_text(plot->gp, row->label);
    plot->key_rows++;
}

enum status plot_distance(const struct book *book, const struct group *group, const char *folder,
                          struct figure *figure, bool *drawn, struct error *error)
{
    struct axis x = axis_empty(), y = axis_empty();
    for (size_t i = 0; i < group->rows_count; i++) {
        const struct row *row = &book->rows[group->rows[i]];
        for (size_t k = 0; k < row->seen->views_count && row->compared && !row->is_floor; k++)
            if (row->seen->views[k].compared) {
                axis_add(&x, row->seen->views[k].distance_m);
                axis_add(&y, row->seen->views[k].same.value.flip);
            }
    }
    *drawn = x.high > 1.1 * x.low;
    if (!*drawn)
        return STATUS_OK;
    axis_widen(&x, 0.05, 0.05);
    axis_widen(&y, 0.08, 0.08);
    struct plot plot;
    plot_open(&plot, book, folder, arena_printf(book->arena, "distance-%s", group->slug),
              group->title);
    plot_axes(&plot, &x, &y, "median distance to the trees in view [m]",
              "FLIP, reference with same effects");
    fputs("set key maxcols 1\n", plot.gp);
    for (size_t i = 0; i < group->rows_count; i++) {
        const struct row *row = &book->rows[group->rows[i]];
        if (row->compared && !row->is_floor)
            distance_curve(&plot, row, y.low);
    }
    return plot_close(&plot, figure, error);
}
