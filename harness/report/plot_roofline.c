/* The static plots of how near cells come to what their machine can do: all cells of a group in
 * frames a second under the limit that binds each, and rooflines of a resource after Williams et
 * al. 2009, doi:10.1145/1498765.1498785: work a second against work a byte moved, or, of triangles,
 * against fragments in the place of bytes. */
#include "report/plot.h"
#include "results/limit.h"

#include <math.h>
#include <string.h>

/* One of the plots being made. */
struct roofline {
    const struct kind *kind;
    struct plot plot;
    const struct group *group;
    const struct calibration *calibration;
};

struct point {
    double x, y, low, high; /* x NaN or 0: not in this plot */
};

/* A horizontal limit of a plot of work a byte. */
struct ceiling {
    enum calibration_index rate;
    const char *title;
};

struct kind {
    const char *name, *x_label, *y_label;
    struct point (*point)(const struct roofline *roofline, const struct row *row);
    /* The highest there is above x. */
    double (*roof)(const struct roofline *roofline, double x);
    void (*lines)(struct roofline *roofline);
    enum column_index counts[2]; /* per frame; COLUMNS_COUNT: none */
    struct ceiling ceilings[3];  /* highest first; ends with a NULL title */
};

enum { CEILINGS = 3, STEPS = 240 };
static const struct kind kinds[ROOFLINES_COUNT];

static double per_second(const struct row *row, double count, enum column_index seconds)
{
    return 1e-6 * count / row->values[seconds];
}

static struct point point_of(const struct row *row, double x, double count)
{
    return (struct point){x, per_second(row, count, COLUMN_frame_seconds),
                          per_second(row, count, COLUMN_frame_seconds_high),
                          per_second(row, count, COLUMN_frame_seconds_low)};
}

/* Cells of the group that this calibration fits; a backdrop's few large triangles would stretch the
 * plot. */
static struct point triangles_point(const struct roofline *roofline, const struct row *row)
{
    bool fits = !row->is_floor &&
                limit_calibration(roofline->plot.book->run, row->seen) == roofline->calibration;
    return point_of(row, fits ? row->summary->limit.fragments_per_triangle : NAN,
                    row->values[COLUMN_primitives]);
}

static double triangles_roof(const struct roofline *roofline, double x)
{
    return 1e-6 * limit_triangle_rate(roofline->calibration, x).high;
}

/* The work of a cell a byte that its frame moves. */
static struct point work_point(const struct roofline *roofline, const struct row *row)
{
    double count = 0;
    bool fits = limit_calibration(roofline->plot.book->run, row->seen) == roofline->calibration;
    for (int i = 0; i < 2; i++) {
        enum column_index column = roofline->kind->counts[i];
        if (column < COLUMNS_COUNT && row->values[column] > 0)
            count += row->values[column];
    }
    return point_of(row, fits ? count / row->values[COLUMN_moved_bytes] : NAN, count);
}

/* NaN: its rate was not measured. */
static double work_ceiling(const struct roofline *roofline, int which, double x)
{
    const struct calibration *calibration = roofline->calibration;
    double rate = calibration->measures[roofline->kind->ceilings[which].rate].rate.high;
    double memory = x * limit_memory_rate(calibration).high;
    return 1e-6 * (memory < rate ? memory : rate);
}

static double work_roof(const struct roofline *roofline, double x)
{
    double highest = NAN;
    for (int i = 0; i < CEILINGS && roofline->kind->ceilings[i].title; i++)
        highest = fmax(highest, work_ceiling(roofline, i, x));
    return highest;
}

/* Frames a second that the resource which binds a cell would allow, and those that it reached. */
static struct point frames_point(const struct roofline *roofline, const struct row *row)
{
    (void)roofline;
    return point_of(row, 1 / row->summary->limit.seconds.value, 1e6);
}

static double frames_roof(const struct roofline *roofline, double x)
{
    (void)roofline;
    return x;
}

static double place_of(const struct plot *plot, int step)
{
    return plot->x.low * pow(plot->x.high / plot->x.low, (double)step / STEPS);
}

/* One line of the roof through the values at STEPS places along x; NaN: not there. */
static void roof_line(struct plot *plot, const double *values, const char *title, int dash)
{
    int block = -1;
    for (int i = 0; i <= STEPS; i++) {
        double at = place_of(plot, i);
        if (isnan(values[i]))
            continue;
        if (block < 0)
            block = plot_block(plot, title);
        fprintf(plot->dat, "%.9g %.9g\n", at, values[i]);
    }
    if (block < 0)
        return;
    plot_curve(plot);
    fprintf(plot->gp,
            "\"%s.dat\" index %d with lines linewidth %g dashtype %d linecolor rgb \"#%06x\" title "
            "\"%s\"",
            plot->name, block, dash == 1 ? 1.6 : 1.0, dash,
            tint_rgb(dash == 1 ? TINT_INK : TINT_MUTED), title);
    plot->key_rows++;
}

/* The roof, and lowered to what dearer fill leaves of it. */
static void triangles_lines(struct roofline *roofline)
{
    static const struct ceiling fills[] = {{CALIBRATION_fill_blended, "the same, blended"},
                                           {CALIBRATION_fill_textured, "blended and textured"}};
    double values[STEPS + 1];
    for (int i = 0; i <= STEPS; i++)
        values[i] = triangles_roof(roofline, place_of(&roofline->plot, i));
    roof_line(&roofline->plot, values, "limit, one colour", 1);
    for (int f = 0; f < 2; f++) {
        double rate = roofline->calibration->measures[fills[f].rate].rate.high;
        for (int i = 0; i <= STEPS; i++) {
            double at = place_of(&roofline->plot, i), fill = 1e-6 * rate / at;
            values[i] = triangles_roof(roofline, at) < fill ? NAN : fill;
        }
        roof_line(&roofline->plot, values, fills[f].title, 2 + f);
    }
}

static void work_lines(struct roofline *roofline)
{
    double values[STEPS + 1];
    for (int c = 0; c < CEILINGS && roofline->kind->ceilings[c].title; c++) {
        for (int i = 0; i <= STEPS; i++)
            values[i] = work_ceiling(roofline, c, place_of(&roofline->plot, i));
        roof_line(&roofline->plot, values, roofline->kind->ceilings[c].title, 1 + c);
    }
}

static void frames_lines(struct roofline *roofline)
{
    double values[STEPS + 1];
    for (int i = 0; i <= STEPS; i++)
        values[i] = place_of(&roofline->plot, i);
    roof_line(&roofline->plot, values, "the machine's limit", 1);
}

/* Shares of the limit below its line, each named where it leaves the plot. These are settings, so
 * they stand before the first curve. */
static void frames_notes(struct roofline *roofline)
{
    static const int shares[] = {2, 10, 100};
    struct plot *plot = &roofline->plot;
    unsigned muted = tint_rgb(TINT_MUTED);
    for (int i = 0; i < 3; i++) {
        double end = plot->x.high / shares[i], start = fmax(plot->x.low, plot->y.low * shares[i]);
        if (end <= plot->y.low)
            continue;
        fprintf(
            plot->gp,
            "set arrow %d from first %.9g, first %.9g to first %.9g, first %.9g nohead dashtype "
            "3 linecolor rgb \"#%06x\"\nset label %d \"1/%d\" at first %.9g, first %.9g right "
            "offset -1.2,0.3 font \",10\" textcolor rgb \"#%06x\"\n",
            i + 1, start, start / shares[i], plot->x.high, end, muted, i + 1, shares[i],
            plot->x.high, end, muted);
    }
}

static bool point_find(const struct roofline *roofline, size_t index, struct point *point)
{
    const struct row *row = &roofline->plot.book->rows[roofline->group->rows[index]];
    if (!row->ok || !(row->values[COLUMN_frame_seconds] > 0))
        return false;
    *point = roofline->kind->point(roofline, row);
    return point->x > 0 && point->y > 0;
}

/* A reference of the group's scene and size: its picture, of float RGBA, is the least it moves. */
static bool tracing_find(const struct roofline *roofline, size_t index, struct point *point)
{
    const struct group *group = roofline->group;
    const struct tracing *one = &roofline->plot.book->run->tracings[index];
    double rays = one->primary_rays + one->shadow_rays + one->occlusion_rays;
    if (roofline->kind != &kinds[ROOFLINE_RAYS] || strcmp(one->scene, group->scene) != 0 ||
        one->trees != group->trees || one->width_px != group->width_px ||
        one->height_px != group->height_px || !(one->trace_seconds > 0))
        return false;
    point->x = rays / (16.0 * one->width_px * one->height_px);
    point->y = point->low = point->high = 1e-6 * rays / one->trace_seconds;
    return point->x > 0;
}

static void tracing_points(struct roofline *roofline)
{
    struct plot *plot = &roofline->plot;
    struct point at;
    int block = -1;
    for (size_t i = 0; i < plot->book->run->tracings_count; i++) {
        if (!tracing_find(roofline, i, &at))
            continue;
        if (block < 0)
            block = plot_block(plot, "references: rays a byte, million rays a second");
        fprintf(plot->dat, "%.9g %.9g\n", at.x, at.y);
    }
    if (block < 0)
        return;
    plot_curve(plot);
    fprintf(
        plot->gp,
        "\"%s.dat\" index %d with points pointtype 2 pointsize 0.9 linecolor rgb \"#%06x\" title "
        "\"references\"",
        plot->name, block, tint_rgb(TINT_INK));
    plot->key_rows++;
}

/* The points of a method; bound: only those that this resource binds, LIMIT_COUNT: all. False:
 * there are none. */
static bool method_points(struct roofline *roofline, size_t method, enum limit_resource bound,
                          bool filled)
{
    struct plot *plot = &roofline->plot;
    const struct book *book = plot->book;
    struct point at;
    int block = -1;
    for (size_t i = 0; i < roofline->group->rows_count; i++) {
        const struct row *row = &book->rows[roofline->group->rows[i]];
        enum limit_resource resource = row->summary->limit.resource;
        if (row->method_index != method || (bound != LIMIT_COUNT && resource != bound) ||
            !point_find(roofline, i, &at))
            continue;
        if (block < 0)
            block =
                plot_block(plot, arena_printf(book->arena, "%s, %s, low, high",
                                              roofline->kind->x_label, roofline->kind->y_label));
        fprintf(plot->dat, "%.9g %.9g %.9g %.9g # %s: %s\n", at.x, at.y, at.low, at.high,
                row->label, limit_word(resource));
    }
    if (block < 0)
        return false;
    plot_points(plot, block, "with yerrorbars", method, filled,
                bound == LIMIT_COUNT ? book->methods[method]
                                     : arena_printf(book->arena, "%s: %s", book->methods[method],
                                                    limit_word(bound)));
    return true;
}

/* A method's cells that different resources bind differ by their symbols, where that is told. */
static void points(struct roofline *roofline, size_t method)
{
    bool filled = true;
    if (roofline->kind != &kinds[ROOFLINE_FRAMES]) {
        method_points(roofline, method, LIMIT_COUNT, filled);
        return;
    }
    for (int bound = LIMIT_UNKNOWN + 1; bound < LIMIT_COUNT; bound++)
        filled &= !method_points(roofline, method, (enum limit_resource)bound, filled);
}

static const struct kind kinds[ROOFLINES_COUNT] = {
    [ROOFLINE_FRAMES] = {.name = "limit",
                         .x_label = "frames a second at the limit that binds",
                         .y_label = "frames a second",
                         .point = frames_point,
                         .roof = frames_roof,
                         .lines = frames_lines},
    [ROOFLINE_TRIANGLES] = {.name = "roofline",
                            .x_label = "fragments a triangle, beyond one a pixel",
                            .y_label = "million triangles a second",
                            .point = triangles_point,
                            .roof = triangles_roof,
                            .lines = triangles_lines},
    [ROOFLINE_LOOKUPS] = {.name = "roofline-lookups",
                          .x_label = "lookups a byte moved",
                          .y_label = "million lookups a second",
                          .point = work_point,
                          .roof = work_roof,
                          .lines = work_lines,
                          .counts = {COLUMN_lookups, COLUMNS_COUNT},
                          .ceilings = {{CALIBRATION_lookups_near, "limit of the CPU"},
                                       {CALIBRATION_lookups_shader, "limit of shaders"}}},
    [ROOFLINE_SAMPLES] = {.name = "roofline-samples",
                          .x_label = "texture samples a byte moved",
                          .y_label = "million samples a second",
                          .point = work_point,
                          .roof = work_roof,
                          .lines = work_lines,
                          .counts = {COLUMN_samples, COLUMNS_COUNT},
                          .ceilings = {{CALIBRATION_samples_bilinear, "limit of shaders"}}},
    [ROOFLINE_RAYS] = {.name = "roofline-rays",
                       .x_label = "rays a byte moved",
                       .y_label = "million rays a second",
                       .point = work_point,
                       .roof = work_roof,
                       .lines = work_lines,
                       .counts = {COLUMN_rays, COLUMN_occlusion_rays},
                       .ceilings = {{CALIBRATION_rays_primary, "limit, rays from the eye"},
                                    {CALIBRATION_rays_shadow, "to the sun"},
                                    {CALIBRATION_rays_ambient, "into the sky"}}},
};

/* The calibration of the group's cells and the range of both axes; false: no point. */
static bool survey(struct roofline *roofline, struct axis *x, struct axis *y)
{
    const struct book *book = roofline->plot.book;
    const struct group *group = roofline->group;
    size_t places = group->rows_count + book->run->tracings_count;
    struct point at;
    *x = *y = axis_empty();
    for (size_t i = 0; i < group->rows_count && !roofline->calibration; i++)
        roofline->calibration = limit_calibration(book->run, book->rows[group->rows[i]].seen);
    if (!roofline->calibration)
        return false;
    for (size_t i = 0; i < places; i++) {
        if (i < group->rows_count ? !point_find(roofline, i, &at)
                                  : !tracing_find(roofline, i - group->rows_count, &at))
            continue;
        axis_add(x, at.x);
        axis_add(y, at.low);
        axis_add(y, at.high);
        axis_add(y, roofline->kind->roof(roofline, at.x));
    }
    if (!(x->low <= x->high))
        return false;
    if (roofline->kind->point == work_point) /* the bend, left of which memory is the limit */
        axis_add(x, 0.5e6 * work_roof(roofline, INFINITY) /
                        limit_memory_rate(roofline->calibration).high);
    axis_widen(x, 0.1, 0.1);
    axis_widen(y, 0.08, 0.08);
    return true;
}

enum status plot_roofline(const struct book *book, const struct group *group,
                          enum roofline_kind which, const char *folder, struct figure *figure,
                          struct error *error)
{
    struct roofline roofline = {.kind = &kinds[which], .group = group, .plot = {.book = book}};
    struct plot *plot = &roofline.plot;
    struct axis x, y;
    if (!survey(&roofline, &x, &y))
        return STATUS_OK;
    figure->kind = which == ROOFLINE_FRAMES ? FIGURE_LIMIT : FIGURE_ROOFLINE;
    plot_open(plot, book, folder,
              arena_printf(book->arena, "%s-%s", roofline.kind->name, group->slug), group->title);
    plot_axes(plot, &x, &y, roofline.kind->x_label, roofline.kind->y_label);
    if (which == ROOFLINE_FRAMES)
        frames_notes(&roofline);
    roofline.kind->lines(&roofline);
    for (size_t m = 0; m < book->methods_count; m++)
        points(&roofline, m);
    tracing_points(&roofline);
    plot->columns = which == ROOFLINE_FRAMES ? 1 : 2;
    plot->key_rows = (plot->key_rows + plot->columns - 1) / plot->columns;
    return plot_close(plot, figure, error);
}
