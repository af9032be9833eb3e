/* Shadow masks compared: wrong shares, their sign, their distance to the true edges, shimmer. */
#include "truth/mask.h"

#include <math.h>

#define STRAY_PX 2.0
#define PARTLY 0.05f
#define FAR_SQUARED 1e12

const struct metric_info mask_table[] = {
#define MASK_INFO(field, word, better, unit, doc)                                                  \
    {#field, word, "linear", doc, better, offsetof(struct mask_error, field)},
    MASK_LIST(MASK_INFO)
#undef MASK_INFO
        {NULL, NULL, NULL, NULL, 0, 0},
};

double mask_of(const struct mask_error *mask, const struct metric_info *info)
{
    const void *field = (const char *)mask + info->offset;
    return *(const double *)field;
}

static size_t pixels_of(const struct frame *frame)
{
    return (size_t)frame->width_px * (size_t)frame->height_px;
}

static bool is_surface(const struct frame *frame, size_t pixel)
{
    return frame->rgba[4 * pixel + 1] >= 0.5f;
}

/* The sun's visibility in a pixel that is a surface. */
static float visibility(const struct frame *frame, size_t pixel)
{
    const float *rgba = frame->rgba + 4 * pixel;
    return fminf(1, fmaxf(0, rgba[0] / rgba[1]));
}

/* Lower envelope of parabolas with the given heights, in place; stride apart. Felzenszwalb and
 * Huttenlocher 2012, algorithm 1. room: 3 count + 1 values. */
static void distance_line(double *heights, size_t count, size_t stride, double *room)
{
    double *at = room, *from = room + count, *height = room + 2 * count + 1;
    size_t last = 0;
    for (size_t i = 0; i < count; i++)
        height[i] = heights[i * stride];
    at[0] = 0;
    from[0] = -INFINITY;
    from[1] = INFINITY;
    for (size_t q = 1; q < count; q++) {
        double meet;
        for (;; last--) {
            double p = at[last], x = (double)q;
            meet = ((height[q] + x * x) - (height[(size_t)p] + p * p)) / (2 * (x - p));
            if (meet > from[last] || last == 0)
                break;
        }
        if (meet > from[last])
            last++;
        at[last] = (double)q;
        from[last] = last ? meet : -INFINITY;
        from[last + 1] = INFINITY;
    }
    size_t k = 0;
    for (size_t q = 0; q < count; q++) {
        while (from[k + 1] < (double)q)
            k++;
        double away = (double)q - at[k];
        heights[q * stride] = away * away + height[(size_t)at[k]];
    }
}

/* Places of edges on a grid of half pixels: pixel (x, y) stands at (2x, 2y). 0 at an edge. */
static void edges_mark(const struct frame *truth, size_t columns, double *grid)
{
    size_t width = (size_t)truth->width_px, height = (size_t)truth->height_px;
    for (size_t y = 0; y < height; y++)
        for (size_t x = 0; x < width; x++) {
            size_t pixel = y * width + x, at = 2 * y * columns + 2 * x;
            if (!is_surface(truth, pixel))
                continue;
            float here = visibility(truth, pixel);
            if (here > PARTLY && here < 1 - PARTLY)
                grid[at] = 0;
            if (x + 1 < width && is_surface(truth, pixel + 1) &&
                (here < 0.5f) != (visibility(truth, pixel + 1) < 0.5f))
                grid[at + 1] = 0;
            if (y + 1 < height && is_surface(truth, pixel + width) &&
                (here < 0.5f) != (visibility(truth, pixel + width) < 0.5f))
                grid[at + columns] = 0;
        }
}

/* Squared distance to the nearest edge, in half pixels: (2 height - 1) x (2 width - 1). */
static const double *edges_distance(struct arena *arena, const struct frame *truth, size_t columns)
{
    size_t rows = 2 * (size_t)truth->height_px - 1, longest = rows > columns ? rows : columns;
    double *grid = ARENA_ARRAY(arena, double, rows *columns);
    double *room = ARENA_ARRAY(arena, double, 3 * longest + 1);
    for (size_t i = 0; i < rows * columns; i++)
        grid[i] = FAR_SQUARED;
    edges_mark(truth, columns, grid);
    for (size_t x = 0; x < columns; x++)
        distance_line(grid + x, rows, columns, room);
    for (size_t y = 0; y < rows; y++)
        distance_line(grid + y * columns, columns, 1, room);
    return grid;
}

static enum status check_pair(const struct frame *test, const struct frame *truth,
                              struct error *error)
{
    if (test->width_px != truth->width_px || test->height_px != truth->height_px)
        return error_set(error, STATUS_INVALID,
                         "the masks differ in size: test %d x %d, truth %d x %d", test->width_px,
                         test->height_px, truth->width_px, truth->height_px);
    if (frame_check(test, error))
        return error_context(error, "the test's mask");
    if (frame_check(truth, error))
        return error_context(error, "the true mask");
    return STATUS_OK;
}

/* Sums over the judged pixels, before they are divided by their number. */
static void sums_take(const struct frame *test, const struct frame *truth, const double *squared,
                      size_t columns, struct mask_error *sums)
{
    size_t width = (size_t)truth->width_px, pixels = pixels_of(truth);
    for (size_t i = 0; i < pixels; i++) {
        if (!is_surface(test, i) || !is_surface(truth, i))
            continue;
        double real = (double)visibility(truth, i), d = (double)visibility(test, i) - real;
        double away = 0.5 * sqrt(squared[2 * (i / width) * columns + 2 * (i % width)]);
        sums->judged++;
        sums->wrong += fabs(d);
        sums->leak += fmax(0, d);
        sums->acne += fmax(0, -d);
        sums->stray += away > STRAY_PX ? fabs(d) : 0;
        sums->edge_px += fabs(d) * away;
        sums->dark += 1 - real;
        if (truth->variance)
            sums->floor += sqrt(2 / M_PI * (double)truth->variance[4 * i]);
    }
}

enum status mask_compare(const struct frame *test, const struct frame *truth,
                         struct mask_error *mask, struct error *error)
{
    struct error own;
    if (check_pair(test, truth, &own))
        return error_set(error, own.status, "%s", own.text);
    struct arena *arena = arena_create(0);
    size_t columns = 2 * (size_t)truth->width_px - 1, surface = 0;
    const double *squared = edges_distance(arena, truth, columns);
    struct mask_error sums = {0};
    sums_take(test, truth, squared, columns, &sums);
    for (size_t i = 0; i < pixels_of(truth); i++)
        surface += is_surface(truth, i);
    double count = sums.judged > 0 ? sums.judged : NAN;
    bool edged = squared[0] < FAR_SQUARED / 2 && sums.wrong > 0;
    *mask = (struct mask_error){.wrong = sums.wrong / count,
                                .leak = sums.leak / count,
                                .acne = sums.acne / count,
                                .stray = sums.stray / count,
                                .edge_px = edged ? sums.edge_px / sums.wrong : NAN,
                                .floor = sums.floor / count,
                                .judged = surface ? sums.judged / (double)surface : NAN,
                                .dark = sums.dark / count,
                                .shimmer = NAN};
    arena_destroy(arena);
    return STATUS_OK;
}

enum status mask_shimmer(const struct frame *const tests[2], const struct frame *const truths[2],
                         double *shimmer, struct error *error)
{
    struct error own;
    double sum = 0, count = 0;
    for (int k = 0; k < 2; k++)
        if (check_pair(tests[k], truths[k], &own) || check_pair(tests[k], tests[0], &own))
            return error_set(error, own.status, "%s", own.text);
    for (size_t i = 0; i < pixels_of(tests[0]); i++) {
        bool judged = true;
        for (int k = 0; k < 2; k++)
            judged &= is_surface(tests[k], i) && is_surface(truths[k], i);
        if (!judged)
            continue;
        double change = (double)visibility(tests[1], i) - (double)visibility(tests[0], i);
        double real = (double)visibility(truths[1], i) - (double)visibility(truths[0], i);
        sum += fabs(change - real);
        count++;
    }
    *shimmer = count > 0 ? sum / count : NAN;
    return STATUS_OK;
}
