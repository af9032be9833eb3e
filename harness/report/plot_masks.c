/* The static plot of shadow masks: what is wrong against what shadows cost. */
#include "report/pairs.h"
#include "report/plot.h"
#include "stats/stats.h"

#include <math.h>
#include <string.h>

/* Draws all triangles in the same light without shadows: what those methods add to that have
 * shadows alone. */
static const char unshaded[] = "polygons";

struct masks {
    struct plot plot;
    const struct group *group;
    struct axis x, y;
    double *bases;  /* seconds of the frame without shadows, a row of the book; 0: none here */
    bool any_base;  /* of what is drawn */
    double floor;   /* what the truth's noise gives; NaN: far below */
    bool *on_front; /* a row of the group */
};

static bool is_drawn(const struct row *row)
{
    return row->ok && !isnan(row->values[COLUMN_mask_wrong]) &&
           !isnan(row->values[COLUMN_frame_seconds]);
}

/* Milliseconds that shadows add; what measures as less than the axis shows stands at its foot. */
static double cost_ms(const struct masks *masks, const struct row *row, enum column_index column)
{
    const double base = masks->bases[row - masks->plot.book->rows];
    return fmax(1e3 * (row->values[column] - base), masks->y.low);
}

static double wrong_percent(const struct masks *masks, const struct row *row)
{
    return fmax(100 * row->values[COLUMN_mask_wrong], masks->x.low);
}

/* Smallest and largest percent over a row's views. */
static struct axis views_range(const struct row *row)
{
    struct axis range = {.low = INFINITY, .high = -INFINITY};
    for (size_t i = 0; i < row->seen->views_count; i++) {
        const struct result_view *view = &row->seen->views[i];
        if (view->masked && !isnan(view->mask.wrong)) {
            range.low = fmin(range.low, 100 * view->mask.wrong);
            range.high = fmax(range.high, 100 * view->mask.wrong);
        }
    }
    return range;
}

/* Of the same cell without shadows, else of the fastest that only draws the triangles. */
static void masks_bases(struct masks *masks)
{
    const struct book *book = masks->plot.book;
    const struct group *group = masks->group;
    double fastest = 0;
    size_t count;
    masks->bases = ARENA_ARRAY(book->arena, double, book->rows_count);
    for (size_t i = 0; i < group->rows_count; i++) {
        const struct row *row = &book->rows[group->rows[i]];
        double seconds = row->values[COLUMN_frame_seconds];
        if (row->ok && strcmp(row->method, unshaded) == 0 && seconds > 0 &&
            !(fastest > 0 && fastest < seconds))
            fastest = seconds;
    }
    for (size_t i = 0; i < group->rows_count; i++)
        masks->bases[group->rows[i]] = fastest;
    const struct shadow_pair *pairs = shadow_pairs(book, group, &count);
    for (size_t i = 0; i < count; i++)
        masks->bases[pairs[i].with] = book->rows[pairs[i].without].values[COLUMN_frame_seconds];
}

static void masks_survey(struct masks *masks)
{
    const struct book *book = masks->plot.book;
    const struct group *group = masks->group;
    double *cost = ARENA_ARRAY(book->arena, double, group->rows_count);
    double *error = ARENA_ARRAY(book->arena, double, group->rows_count);
    masks->on_front = ARENA_ARRAY(book->arena, bool, group->rows_count);
    masks->floor = NAN;
    masks_bases(masks);
    for (size_t i = 0; i < group->rows_count; i++) {
        const struct row *row = &book->rows[group->rows[i]];
        const double base = masks->bases[group->rows[i]];
        bool drawn = is_drawn(row);
        cost[i] = drawn ? row->values[COLUMN_frame_seconds] - base : NAN;
        error[i] = drawn ? row->values[COLUMN_mask_wrong] : NAN;
        if (!drawn)
            continue;
        struct axis range = views_range(row);
        axis_add(&masks->x, range.low);
        axis_add(&masks->x, range.high);
        masks->any_base |= base > 0;
        axis_add(&masks->y, 1e3 * cost[i]);
        axis_add(&masks->y, 1e3 * (row->values[COLUMN_frame_seconds_high] - base));
        masks->floor = fmax(masks->floor, 100 * row->values[COLUMN_mask_floor]);
    }
    stats_pareto(cost, error, group->rows_count, masks->on_front);
    if (masks->floor > masks->x.low / 30)
        axis_add(&masks->x, masks->floor);
    else
        masks->floor = NAN;
    axis_widen(&masks->x, 0.08, 0.08);
    axis_widen(&masks->y, 0.08, 0.1);
}

/* The next row of the method, from 0 on, that is drawn: those on the front first. False: no more.
 */
static bool next_row(const struct masks *masks, size_t method, size_t *step, size_t *row)
{
    const size_t count = masks->group->rows_count;
    for (; *step < 2 * count; ++*step) {
        *row = *step < count ? *step : *step - count;
        const struct row *at = &masks->plot.book->rows[masks->group->rows[*row]];
        if (at->method_index == method && masks->on_front[*row] == (*step < count) &&
            is_drawn(at)) {
            ++*step;
            return true;
        }
    }
    return false;
}

static void keep_clear(struct masks *masks, const struct row *row)
{
    const double x = wrong_percent(masks, row), y = cost_ms(masks, row, COLUMN_frame_seconds);
    struct axis range = views_range(row);
    plot_keep_clear(&masks->plot, x, y);
    plot_keep_clear_line(&masks->plot, fmax(range.low, masks->x.low), y,
                         fmax(range.high, masks->x.low), y);
    plot_keep_clear_line(&masks->plot, x, cost_ms(masks, row, COLUMN_frame_seconds_low), x,
                         cost_ms(masks, row, COLUMN_frame_seconds_high));
}

static void put_floor(struct masks *masks)
{
    struct plot *plot = &masks->plot;
    if (isnan(masks->floor))
        return;
    plot_upright(plot, 1, masks->floor, "noise of the reference");
    for (int i = 0; i < 5; i++) { /* the line and its text */
        const double beside = (1 + 0.02 * i) * masks->floor;
        plot_keep_clear_line(plot, beside, masks->y.low, beside, masks->y.high);
    }
}

/* A number at every point, as the key counts them. */
static void masks_numbers(struct masks *masks)
{
    const struct book *book = masks->plot.book;
    size_t row, step;
    int number = 0;
    put_floor(masks);
    for (int pass = 0; pass < 2; pass++)
        for (size_t m = 0; m < book->methods_count; m++)
            for (step = 0; next_row(masks, m, &step, &row);) {
                const struct row *at = &book->rows[masks->group->rows[row]];
                if (pass == 0)
                    keep_clear(masks, at);
                else
                    plot_number(&masks->plot, wrong_percent(masks, at),
                                cost_ms(masks, at, COLUMN_frame_seconds), ++number);
            }
    fputs("set key font \",10\" spacing 1.1 maxcols 1\n", masks->plot.gp);
}

/* Percent, smallest and largest over the views, ms, low, high: filled on the front. */
static void masks_point(struct masks *masks, const struct row *row, bool front)
{
    struct plot *plot = &masks->plot;
    const struct book *book = plot->book;
    int block = plot_block(plot, "percent ms smallest largest low high");
    struct axis range = views_range(row);
    fprintf(plot->dat, "%.9g %.9g %.9g %.9g %.9g %.9g # %s\n", wrong_percent(masks, row),
            cost_ms(masks, row, COLUMN_frame_seconds), fmax(range.low, masks->x.low),
            fmax(range.high, masks->x.low), cost_ms(masks, row, COLUMN_frame_seconds_low),
            cost_ms(masks, row, COLUMN_frame_seconds_high), row->label);
    plot_points(plot, block, "using 1:2:3:4:5:6 with xyerrorbars", row->method_index, front,
                arena_printf(book->arena, "%d %s", plot->key_rows + 1, row->label));
}

enum status plot_masks(const struct book *book, const struct group *group, const char *folder,
                       struct figure *figure, struct error *error)
{
    struct masks masks = {.group = group, .x = axis_empty(), .y = axis_empty()};
    size_t drawn = 0;
    for (size_t i = 0; i < group->rows_count; i++)
        drawn += is_drawn(&book->rows[group->rows[i]]);
    if (drawn < 2)
        return STATUS_OK;
    struct plot *plot = &masks.plot;
    figure->kind = FIGURE_MASKS;
    plot_open(plot, book, folder, arena_printf(book->arena, "masks-%s", group->slug), group->title);
    masks_survey(&masks);
    plot_axes(plot, &masks.x, &masks.y, "share of the surface whose shadow is wrong [%]",
              masks.any_base ? "time a frame that shadows add [ms]" : "time a frame [ms]");
    masks_numbers(&masks); /* before the first curve */
    size_t row, step;
    for (size_t m = 0; m < book->methods_count; m++)
        for (step = 0; next_row(&masks, m, &step, &row);)
            masks_point(&masks, &book->rows[group->rows[row]], masks.on_front[row]);
    return plot_close(plot, figure, error);
}
