/* Orthographic casting of a grid of lines through triangles: every hit, sorted by depth. */
#include "bake/slices_raster.h"

#include <stdbool.h>
#include <stdlib.h>

enum { UNIT = 1024, HALF = UNIT / 2 };

/* Twice the area of (a, b, p). */
static int64_t edge(const int32_t a[2], const int32_t b[2], int64_t x, int64_t y)
{
    return (int64_t)(b[0] - a[0]) * (y - a[1]) - (int64_t)(b[1] - a[1]) * (x - a[0]);
}

int64_t raster_area(const struct raster_plane *plane, uint32_t triangle)
{
    const uint32_t *corner = plane->triangles[triangle];
    const int32_t *c = plane->points[corner[2]];
    return edge(plane->points[corner[0]], plane->points[corner[1]], c[0], c[1]);
}

/* First and last grid line between the triangle's extremes along an axis, within [0, size). */
static void extent(const struct raster_plane *plane, uint32_t triangle, int axis, int size,
                   int *first, int *last)
{
    const uint32_t *corner = plane->triangles[triangle];
    int32_t low = plane->points[corner[0]][axis], high = low;
    for (int k = 1; k < 3; k++) {
        int32_t p = plane->points[corner[k]][axis];
        low = p < low ? p : low;
        high = p > high ? p : high;
    }
    /* Ceiling of (low - half) / unit and floor of (high - half) / unit; shifts round downward. */
    *first = (low - HALF + UNIT - 1) >> 10;
    *last = (high - HALF) >> 10;
    *first = *first < 0 ? 0 : *first;
    *last = *last >= size ? size - 1 : *last;
}

void raster_rows(const struct raster_plane *plane, uint32_t triangle, int *first, int *last)
{
    extent(plane, triangle, 1, plane->height, first, last);
}

void raster_weights(const struct raster_plane *plane, uint32_t triangle, int i, int j,
                    float weights[3])
{
    const uint32_t *corner = plane->triangles[triangle];
    const int32_t *a = plane->points[corner[0]], *b = plane->points[corner[1]],
                  *c = plane->points[corner[2]];
    int64_t x = (int64_t)i * UNIT + HALF, y = (int64_t)j * UNIT + HALF;
    double area = (double)edge(a, b, c[0], c[1]);
    weights[1] = (float)((double)edge(c, a, x, y) / area);
    weights[2] = (float)((double)edge(a, b, x, y) / area);
    weights[0] = 1 - weights[1] - weights[2];
}

/* A triangle set up for scanning: counter-clockwise. */
struct scan {
    const int32_t *points[3];
    float depths[3];
    int64_t step_x[3], step_y[3]; /* change of edge k (opposite to corner k) to the next line */
    int64_t bias[3];              /* -1 where a line on the edge is another triangle's */
    double inverse_area;
};

static bool scan_set(const struct raster_plane *plane, uint32_t triangle, struct scan *scan)
{
    int64_t area = raster_area(plane, triangle);
    if (area == 0)
        return false;
    const uint32_t *corner = plane->triangles[triangle];
    for (int k = 0; k < 3; k++) {
        uint32_t vertex = corner[area > 0 || k == 0 ? k : 3 - k];
        scan->points[k] = plane->points[vertex];
        scan->depths[k] = plane->depths[vertex];
    }
    for (int k = 0; k < 3; k++) {
        const int32_t *a = scan->points[(k + 1) % 3], *b = scan->points[(k + 2) % 3];
        int64_t dx = b[0] - a[0], dy = b[1] - a[1];
        scan->step_x[k] = -dy * UNIT;
        scan->step_y[k] = dx * UNIT;
        scan->bias[k] = dy < 0 || (dy == 0 && dx < 0) ? 0 : -1;
    }
    scan->inverse_area = 1 / (double)llabs(area);
    return true;
}

/* Counts a triangle's hits into first[n + 1], or places them at first[n]++. */
static void scan_run(const struct raster_plane *plane, uint32_t triangle, struct raster_band *band,
                     bool place)
{
    struct scan scan;
    int columns[2], rows[2];
    extent(plane, triangle, 0, plane->width, &columns[0], &columns[1]);
    raster_rows(plane, triangle, &rows[0], &rows[1]);
    rows[0] = rows[0] < band->row ? band->row : rows[0];
    rows[1] = rows[1] >= band->row + band->rows ? band->row + band->rows - 1 : rows[1];
    if (columns[0] > columns[1] || rows[0] > rows[1] || !scan_set(plane, triangle, &scan))
        return;
    int64_t start[3];
    for (int k = 0; k < 3; k++)
        start[k] = edge(scan.points[(k + 1) % 3], scan.points[(k + 2) % 3],
                        (int64_t)columns[0] * UNIT + HALF, (int64_t)rows[0] * UNIT + HALF);
    for (int j = rows[0]; j <= rows[1]; j++) {
        int64_t e[3] = {start[0], start[1], start[2]};
        size_t at = (size_t)(j - band->row) * (size_t)plane->width + (size_t)columns[0];
        bool inside = false;
        for (int i = columns[0]; i <= columns[1]; i++, at++) {
            if ((e[0] + scan.bias[0]) >= 0 && e[1] + scan.bias[1] >= 0 &&
                e[2] + scan.bias[2] >= 0) {
                inside = true;
                if (place) {
                    double depth = ((double)e[0] * scan.depths[0] + (double)e[1] * scan.depths[1] +
                                    (double)e[2] * scan.depths[2]) *
                                   scan.inverse_area;
                    band->hits[band->first[at]++] = (struct raster_hit){(float)depth, triangle};
                } else {
                    band->first[at + 1]++;
                }
            } else if (inside) {
                break;
            }
            for (int k = 0; k < 3; k++)
                e[k] += scan.step_x[k];
        }
        for (int k = 0; k < 3; k++)
            start[k] += scan.step_y[k];
    }
}

static bool before(const struct raster_hit *a, const struct raster_hit *b)
{
    return a->depth > b->depth || (a->depth == b->depth && a->triangle < b->triangle);
}

static int compare(const void *a, const void *b)
{
    return before(a, b) ? -1 : before(b, a);
}

static void sort(struct raster_hit *hits, size_t count)
{
    if (count > 64) {
        qsort(hits, count, sizeof *hits, compare);
        return;
    }
    for (size_t i = 1; i < count; i++) {
        struct raster_hit hit = hits[i];
        size_t at = i;
        for (; at > 0 && before(&hit, &hits[at - 1]); at--)
            hits[at] = hits[at - 1];
        hits[at] = hit;
    }
}

void raster_cast(struct arena *arena, const struct raster_plane *plane, const uint32_t *list,
                 size_t count, int row, int rows, struct raster_band *band)
{
    size_t lines = (size_t)plane->width * (size_t)rows;
    *band = (struct raster_band){.row = row, .rows = rows};
    band->first = ARENA_ARRAY(arena, size_t, lines + 1);
    for (size_t i = 0; i < count; i++)
        scan_run(plane, list[i], band, false);
    for (size_t i = 0; i < lines; i++)
        band->first[i + 1] += band->first[i];
    band->hits = ARENA_ARRAY(arena, struct raster_hit, band->first[lines]);
    for (size_t i = 0; i < count; i++)
        scan_run(plane, list[i], band, true);
    /* Each first has become the next line's. */
    for (size_t i = lines; i > 0; i--)
        band->first[i] = band->first[i - 1];
    band->first[0] = 0;
    for (size_t i = 0; i < lines; i++)
        sort(band->hits + band->first[i], band->first[i + 1] - band->first[i]);
}
