/* Errors of single pixels and of boxes of pixels, with the closed forms of their noise. */
#include "truth/compare.h"

#include <math.h>

#define RELATIVE_OFFSET 0.01
#define PI 3.14159265358979323846

/* Sums over a row, added up in the order of rows, so that the number of threads does not matter. */
struct sums {
    double squared, absolute, relative, color[3], cover_absolute, cover_signed;
    double variance, deviation, relative_variance, cover_deviation, cover_variance;
};

static void add_color(double test, double reference, double variance, struct sums *sums)
{
    double difference = test - reference;
    double scale = 1 / (reference * reference + RELATIVE_OFFSET);
    sums->squared += difference * difference;
    sums->absolute += fabs(difference);
    sums->relative += difference * difference * scale;
    sums->variance += variance;
    sums->deviation += sqrt(variance);
    sums->relative_variance += variance * scale;
}

static void add_coverage(double difference, double variance, struct sums *sums)
{
    sums->cover_absolute += fabs(difference);
    sums->cover_signed += difference;
    sums->cover_variance += variance;
    sums->cover_deviation += sqrt(variance);
}

static struct sums row_sums(const struct frame *test, const struct frame *reference, int y)
{
    struct sums sums = {0};
    size_t width = (size_t)test->width_px;
    for (size_t i = (size_t)y * width * 4; i < ((size_t)y + 1) * width * 4; i += 4) {
        for (size_t c = 0; c < 3; c++) {
            double a = (double)test->rgba[i + c], b = (double)reference->rgba[i + c];
            add_color(a, b, compare_variance(test, reference, i + c), &sums);
            sums.color[c] += a - b;
        }
        add_coverage((double)test->rgba[i + 3] - (double)reference->rgba[i + 3],
                     compare_variance(test, reference, i + 3), &sums);
    }
    return sums;
}

static void add_sums(const struct sums *row, struct sums *total)
{
    total->squared += row->squared;
    total->absolute += row->absolute;
    total->relative += row->relative;
    for (int c = 0; c < 3; c++)
        total->color[c] += row->color[c];
    total->cover_absolute += row->cover_absolute;
    total->cover_signed += row->cover_signed;
    total->variance += row->variance;
    total->deviation += row->deviation;
    total->relative_variance += row->relative_variance;
    total->cover_deviation += row->cover_deviation;
    total->cover_variance += row->cover_variance;
}

static struct sums picture_sums(const struct frame *test, const struct frame *reference)
{
    struct arena *scratch = arena_create(0);
    struct sums *rows = ARENA_ARRAY(scratch, struct sums, (size_t)test->height_px);
#pragma omp parallel for
    for (int y = 0; y < test->height_px; y++)
        rows[y] = row_sums(test, reference, y);
    struct sums total = {0};
    for (int y = 0; y < test->height_px; y++)
        add_sums(&rows[y], &total);
    arena_destroy(scratch);
    return total;
}

/* Squared error and variance of the means over one box, weighted by its pixels. */
static void add_box(const struct frame *test, const struct frame *reference, int left, int top,
                    int size, double *squared, double *variance)
{
    int right = left + size < test->width_px ? left + size : test->width_px;
    int bottom = top + size < test->height_px ? top + size : test->height_px;
    double difference[3] = {0}, noise = 0, pixels = (double)(right - left) * (bottom - top);
    for (int y = top; y < bottom; y++)
        for (int x = left; x < right; x++)
            for (size_t c = 0; c < 3; c++) {
                size_t i = ((size_t)y * (size_t)test->width_px + (size_t)x) * 4 + c;
                difference[c] += (double)test->rgba[i] - (double)reference->rgba[i];
                noise += compare_variance(test, reference, i);
            }
    for (int c = 0; c < 3; c++)
        *squared += difference[c] * difference[c] / pixels;
    *variance += noise / pixels;
}

/* Means over RGB and pixels of the boxes' squared error and of its variance. */
static void box_means(const struct frame *test, const struct frame *reference, int size,
                      double *squared, double *variance)
{
    struct arena *scratch = arena_create(0);
    int rows_count = (test->height_px + size - 1) / size;
    double(*rows)[2] = arena_alloc(scratch, (size_t)rows_count, sizeof *rows);
#pragma omp parallel for
    for (int row = 0; row < rows_count; row++)
        for (int left = 0; left < test->width_px; left += size)
            add_box(test, reference, left, row * size, size, &rows[row][0], &rows[row][1]);
    double sums[2] = {0}, values = 3.0 * test->width_px * test->height_px;
    for (int row = 0; row < rows_count; row++) {
        sums[0] += rows[row][0];
        sums[1] += rows[row][1];
    }
    *squared = sums[0] / values;
    *variance = sums[1] / values;
    arena_destroy(scratch);
}

/* A root mean square with the mean variance taken out. */
static void set_root(double squared, double variance, double *value, double *raw, double *floor_)
{
    *raw = sqrt(squared);
    *value = sqrt(fmax(squared - variance, 0));
    *floor_ = sqrt(variance);
}

static void set_boxes(const struct frame *test, const struct frame *reference,
                      struct comparison *out)
{
    double squared, variance;
    box_means(test, reference, 2, &squared, &variance);
    set_root(squared, variance, &out->value.rmse_box2, &out->raw.rmse_box2, &out->floor.rmse_box2);
    box_means(test, reference, 4, &squared, &variance);
    set_root(squared, variance, &out->value.rmse_box4, &out->raw.rmse_box4, &out->floor.rmse_box4);
    box_means(test, reference, 8, &squared, &variance);
    set_root(squared, variance, &out->value.rmse_box8, &out->raw.rmse_box8, &out->floor.rmse_box8);
}

void compare_pixels(const struct frame *test, const struct frame *reference, struct comparison *out)
{
    struct sums sums = picture_sums(test, reference);
    double pixels = (double)test->width_px * test->height_px, values = 3 * pixels;
    set_root(sums.squared / values, sums.variance / values, &out->value.rmse, &out->raw.rmse,
             &out->floor.rmse);
    out->value.mae = out->raw.mae = sums.absolute / values;
    out->floor.mae = sqrt(2 / PI) * sums.deviation / values;
    out->raw.relmse = sums.relative / values;
    out->floor.relmse = sums.relative_variance / values;
    out->value.relmse = fmax(out->raw.relmse - out->floor.relmse, 0);
    out->value.coverage = out->raw.coverage = sums.cover_absolute / pixels;
    out->floor.coverage = sqrt(2 / PI) * sums.cover_deviation / pixels;
    out->value.coverage_bias = out->raw.coverage_bias = sums.cover_signed / pixels;
    out->floor.coverage_bias = sqrt(sums.cover_variance) / pixels;
    double color = 0;
    for (int c = 0; c < 3; c++)
        color += sums.color[c] * sums.color[c] / (pixels * pixels);
    set_root(color, sums.variance / (pixels * pixels), &out->value.mean_color, &out->raw.mean_color,
             &out->floor.mean_color);
    set_boxes(test, reference, out);
}
