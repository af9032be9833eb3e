/* The static plots of error against what the camera changes along its path: its distance to the
 * trees or, where it keeps that, the elevation and the azimuth that it sees them from; and of frame
 * time and of wrong shadows against the distance. */
#include "report/plot.h"

#include <math.h>
#include <stdlib.h>

/* In order of enum view_axis. */
static const struct {
    enum figure_kind kind;
    const char *slug, *label;
} kinds[] = {
    {FIGURE_DISTANCE, "distance", "median distance to the trees in view [m]"},
    {FIGURE_ELEVATION, "elevation", "elevation of the eye above the trees [degrees]"},
    {FIGURE_AZIMUTH, "azimuth", "azimuth of the eye around the trees [degrees]"},
};

struct sight {
    double at, value, noise; /* noise: of the reference, where the value is an error */
};

static int compare_sights(const void *a, const void *b)
{
    const struct sight *x = a, *y = b;
    return (x->at > y->at) - (x->at < y->at);
}

/* A row's compared views in order of the axis; sights has a place for each view. */
static size_t sights_of(const struct row *row, enum view_axis axis, struct sight *sights)
{
    size_t count = 0;
    for (size_t i = 0; i < row->seen->views_count && row->compared && !row->is_floor; i++) {
        const struct result_view *view = &row->seen->views[i];
        double at = axis == VIEW_DISTANCE    ? view->distance_m
                    : axis == VIEW_ELEVATION ? view->elevation_deg
                                             : view->azimuth_deg;
        if (view->compared && !isnan(at) && (axis != VIEW_DISTANCE || at > 0))
            sights[count++] = (struct sight){at, view->same.value.flip, view->same.floor.flip};
    }
    qsort(sights, count, sizeof *sights, compare_sights);
    return count;
}

/* The noise of the references at each view: the largest of any row, as rows differ in the effects
 * that their references have. */
struct noise {
    struct sight *sights;
    size_t count;
    double most;
};

/* A group's views along the axis. */
struct span {
    struct axis x, y;
    double low, high;   /* along the axis, any sign */
    size_t views_least; /* of a compared row */
    struct noise noise;
};

static void span_add(struct span *span, const struct sight *sights, size_t count)
{
    if (!count)
        return;
    span->views_least = span->views_least && span->views_least < count ? span->views_least : count;
    bool first = span->noise.count == 0;
    for (size_t i = 0; i < count; i++) {
        axis_add(&span->x, sights[i].at);
        axis_add(&span->y, sights[i].value);
        span->low = fmin(span->low, sights[i].at);
        span->high = fmax(span->high, sights[i].at);
        span->noise.most = fmax(span->noise.most, sights[i].noise);
        if (first)
            span->noise.sights[span->noise.count++] = sights[i];
        else if (count == span->noise.count)
            span->noise.sights[i].noise = fmax(span->noise.sights[i].noise, sights[i].noise);
    }
}

static struct span span_of(const struct book *book, const struct group *group, enum view_axis axis)
{
    struct span span = {.x = axis_empty(), .y = axis_empty(), .low = INFINITY, .high = -INFINITY};
    size_t most = 0;
    for (size_t i = 0; i < group->rows_count; i++) {
        size_t count = book->rows[group->rows[i]].seen->views_count;
        most = count > most ? count : most;
    }
    struct sight *sights = ARENA_ARRAY(book->arena, struct sight, most);
    span.noise.sights = ARENA_ARRAY(book->arena, struct sight, most);
    for (size_t i = 0; i < group->rows_count; i++)
        span_add(&span, sights, sights_of(&book->rows[group->rows[i]], axis, sights));
    return span;
}

bool views_go(const struct book *book, const struct group *group, enum view_axis axis)
{
    static const double NEARER = 1.1, TURNED_DEG = 10;
    static const size_t VIEWS_LEAST = 3;
    struct span span = span_of(book, group, VIEW_DISTANCE);
    bool walks = span.x.high > NEARER * span.x.low;
    if (axis == VIEW_DISTANCE || walks)
        return axis == VIEW_DISTANCE && walks;
    span = span_of(book, group, axis);
    return span.high - span.low >= TURNED_DEG && span.views_least >= VIEWS_LEAST;
}

static void put_curve(struct plot *plot, const struct row *row, enum view_axis axis)
{
    const struct book *book = plot->book;
    struct sight *sights = ARENA_ARRAY(book->arena, struct sight, row->seen->views_count);
    size_t count = sights_of(row, axis, sights);
    if (count == 0)
        return;
    int block = plot_block(plot, row->label);
    for (size_t i = 0; i < count; i++)
        fprintf(plot->dat, "%.9g %.9g\n", sights[i].at, fmax(sights[i].value, plot->y.low));
    plot_row_line(plot, row, block);
}

static void put_noise(struct plot *plot, const struct noise *noise)
{
    int block = plot_block(plot, "noise of the reference");
    for (size_t i = 0; i < noise->count; i++)
        fprintf(plot->dat, "%.9g %.9g\n", noise->sights[i].at,
                fmax(noise->sights[i].noise, plot->y.low));
    plot_curve(plot);
    fprintf(plot->gp,
            "\"%s.dat\" index %d with lines linewidth 1 dashtype 3 linecolor rgb \"#%06x\" title "
            "\"noise of the reference\"",
            plot->name, block, tint_rgb(TINT_MUTED));
    plot->key_rows++;
}

enum status plot_views(const struct book *book, const struct group *group, enum view_axis axis,
                       const char *folder, struct figure *figure, struct error *error)
{
    if (!views_go(book, group, axis) || group->rows_count > PLOT_LINES_MAX)
        return STATUS_OK;
    struct span span = span_of(book, group, axis);
    bool noisy = span.noise.most > span.y.low / 20;
    for (size_t i = 0; i < span.noise.count && noisy; i++)
        axis_add(&span.y, span.noise.sights[i].noise);
    if (axis == VIEW_DISTANCE)
        axis_widen(&span.x, 0.05, 0.05);
    else
        span.x = axis_degrees(span.low, span.high);
    axis_widen(&span.y, 0.08, 0.08);
    struct plot plot;
    figure->kind = kinds[axis].kind;
    plot_open(&plot, book, folder,
              arena_printf(book->arena, "%s-%s", kinds[axis].slug, group->slug), group->title);
    plot_axes(&plot, &span.x, &span.y, kinds[axis].label, "FLIP, reference with same effects");
    fputs("set key maxcols 1\n", plot.gp);
    for (size_t i = 0; i < group->rows_count; i++)
        put_curve(&plot, &book->rows[group->rows[i]], axis);
    if (noisy)
        put_noise(&plot, &span.noise);
    return plot_close(&plot, figure, error);
}

/* What stands above the distance of a view. */
struct height {
    enum figure_kind kind;
    const char *slug, *label;
    double (*of)(const struct row *, size_t view); /* not above 0: not known */
};

/* A row's views of which both are known, by distance; sights has a place for each view. */
static size_t heights_of(const struct row *row, const struct height *height, struct sight *sights)
{
    size_t count = 0;
    for (size_t i = 0; i < row->seen->views_count; i++) {
        double at = row->seen->views[i].distance_m, value = height->of(row, i);
        if (at > 0 && value > 0)
            sights[count++] = (struct sight){at, value, 0};
    }
    qsort(sights, count, sizeof *sights, compare_sights);
    return count;
}

static void put_heights(struct plot *plot, const struct row *row, const struct height *height)
{
    const struct book *book = plot->book;
    struct sight *sights = ARENA_ARRAY(book->arena, struct sight, row->seen->views_count);
    size_t count = heights_of(row, height, sights);
    if (!count)
        return;
    int block = plot_block(plot, row->label);
    for (size_t i = 0; i < count; i++)
        fprintf(plot->dat, "%.9g %.9g\n", sights[i].at, sights[i].value);
    plot_row_line(plot, row, block);
}

static enum status plot_heights(const struct book *book, const struct group *group,
                                const struct height *height, const char *folder,
                                struct figure *figure, struct error *error)
{
    if (!views_go(book, group, VIEW_DISTANCE) || group->rows_count > PLOT_LINES_MAX)
        return STATUS_OK;
    struct axis x = axis_empty(), y = axis_empty();
    for (size_t i = 0; i < group->rows_count; i++) {
        const struct row *row = &book->rows[group->rows[i]];
        struct sight *sights = ARENA_ARRAY(book->arena, struct sight, row->seen->views_count);
        size_t count = heights_of(row, height, sights);
        for (size_t k = 0; k < count; k++) {
            axis_add(&x, sights[k].at);
            axis_add(&y, sights[k].value);
        }
    }
    if (x.low > x.high)
        return STATUS_OK;
    axis_widen(&x, 0.05, 0.05);
    axis_widen(&y, 0.08, 0.08);
    struct plot plot;
    figure->kind = height->kind;
    plot_open(&plot, book, folder, arena_printf(book->arena, "%s-%s", height->slug, group->slug),
              group->title);
    plot_axes(&plot, &x, &y, kinds[VIEW_DISTANCE].label, height->label);
    fputs("set key maxcols 1\n", plot.gp);
    for (size_t i = 0; i < group->rows_count; i++)
        put_heights(&plot, &book->rows[group->rows[i]], height);
    return plot_close(&plot, figure, error);
}

/* The time of a row's frame at a view, the median over its repetitions: known where each timed just
 * the views that are compared (frames_max of the run is its views). */
static double milliseconds_at(const struct row *row, size_t view)
{
    const struct summary *summary = row->summary;
    double *seconds = malloc((summary->repetitions + summary->failures + 1) * sizeof *seconds);
    size_t count = 0;
    for (size_t i = 0; seconds && i < summary->repetitions + summary->failures; i++) {
        const struct result *result = summary->results[i];
        if (result->status == STATUS_OK && result->frames_count == row->seen->views_count)
            seconds[count++] = result->frame_seconds[view];
    }
    double median = stats_median(seconds, count);
    free(seconds);
    return 1e3 * median;
}

enum status plot_pace(const struct book *book, const struct group *group, const char *folder,
                      struct figure *figure, struct error *error)
{
    static const struct height pace = {FIGURE_PACE, "pace", "frame time [ms]", milliseconds_at};
    return plot_heights(book, group, &pace, folder, figure, error);
}

static double wrong_percent_at(const struct row *row, size_t view)
{
    const struct result_view *at = &row->seen->views[view];
    return at->masked ? 100 * at->mask.wrong : 0;
}

enum status plot_masks_distance(const struct book *book, const struct group *group,
                                const char *folder, struct figure *figure, struct error *error)
{
    static const struct height wrong = {FIGURE_MASKS_DISTANCE, "masks-distance",
                                        "surface in wrong shadow [%]", wrong_percent_at};
    return plot_heights(book, group, &wrong, folder, figure, error);
}
