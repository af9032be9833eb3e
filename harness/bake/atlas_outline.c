/* The outline of a picture: rectangle, convex polygon of few corners, plane of depths. */
#include "bake/atlas_bake.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

/* z of (b - a) x (c - a): positive when a, b, c turn left. */
static double turn(const double a[2], const double b[2], const double c[2])
{
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

/* Lower chain of Andrew's monotone chain (1979) over points sorted by the first coordinate; returns
 * its length. */
static size_t chain(double (*points)[2], size_t count, bool backward, double (*hull)[2],
                    size_t size)
{
    size_t start = size;
    for (size_t i = 0; i < count; i++) {
        const double *point = points[backward ? count - 1 - i : i];
        while (size >= start + 2 && turn(hull[size - 2], hull[size - 1], point) <= 0)
            size--;
        memcpy(hull[size++], point, sizeof *hull);
    }
    return size;
}

/* Corners of the covered texels' rows' ends, by rows: their convex hull is that of all covered
 * texels. The hull is counter-clockwise in (row, column) axes, that is clockwise in (s, t). */
static size_t hull_of_rows(struct arena *arena, const uint8_t (*albedo)[4], int width_px,
                           int height_px, double (**hull)[2])
{
    double(*low)[2] = arena_alloc(arena, 2 * (size_t)height_px, sizeof *low);
    double(*high)[2] = arena_alloc(arena, 2 * (size_t)height_px, sizeof *high);
    size_t count = 0;
    for (int y = 0; y < height_px; y++) {
        int first = width_px, last = -1;
        for (int x = 0; x < width_px; x++)
            if (albedo[(size_t)y * (size_t)width_px + (size_t)x][3]) {
                first = x < first ? x : first;
                last = x;
            }
        for (int edge = 0; edge < 2 && last >= 0; edge++, count++) {
            low[count][0] = high[count][0] = y + edge;
            low[count][1] = first;
            high[count][1] = last + 1;
        }
    }
    *hull = arena_alloc(arena, 2 * count, sizeof **hull);
    size_t size = chain(low, count, false, *hull, 0);
    return chain(high, count, true, *hull, size);
}

/* Where the lines through (a, b) and (d, c) meet beyond b and c; false unless they do. */
static bool meet(const double a[2], const double b[2], const double c[2], const double d[2],
                 double at[2])
{
    double u[2] = {b[0] - a[0], b[1] - a[1]}, v[2] = {c[0] - d[0], c[1] - d[1]};
    double across = u[0] * v[1] - u[1] * v[0];
    if (fabs(across) < 1e-9)
        return false;
    double k = ((c[0] - b[0]) * v[1] - (c[1] - b[1]) * v[0]) / across;
    double m = ((c[0] - b[0]) * u[1] - (c[1] - b[1]) * u[0]) / across;
    at[0] = b[0] + k * u[0];
    at[1] = b[1] + k * u[1];
    return k >= 0 && m >= 0;
}

/* Drops the edge whose neighbours, prolonged until they meet, add the least area, until few are
 * left. */
static size_t hull_reduce(double (*hull)[2], size_t count, size_t wanted)
{
    while (count > wanted) {
        double least = INFINITY, corner[2] = {0, 0};
        size_t drop = count;
        for (size_t i = 0; i < count; i++) {
            const double *a = hull[(i + count - 1) % count], *b = hull[i];
            const double *c = hull[(i + 1) % count], *d = hull[(i + 2) % count];
            double at[2];
            if (!meet(a, b, c, d, at))
                continue;
            double area = fabs(turn(b, at, c));
            if (area < least) {
                least = area;
                drop = i;
                memcpy(corner, at, sizeof corner);
            }
        }
        if (drop == count)
            break;
        memcpy(hull[drop], corner, sizeof corner);
        size_t gone = (drop + 1) % count;
        memmove(hull + gone, hull + gone + 1, (count - gone - 1) * sizeof *hull);
        count--;
    }
    return count;
}

/* Where the lines through edges i and k (from corner i to i + 1) of a polygon meet; false: never.
 */
static bool lines_meet(double (*hull)[2], size_t count, size_t i, size_t k, double at[2])
{
    const double *a = hull[i], *b = hull[(i + 1) % count];
    const double *c = hull[k], *d = hull[(k + 1) % count];
    double u[2] = {b[0] - a[0], b[1] - a[1]}, v[2] = {d[0] - c[0], d[1] - c[1]};
    double across = u[0] * v[1] - u[1] * v[0];
    if (fabs(across) < 1e-9)
        return false;
    double m = ((c[0] - a[0]) * v[1] - (c[1] - a[1]) * v[0]) / across;
    at[0] = a[0] + m * u[0];
    at[1] = a[1] + m * u[1];
    return true;
}

/* The smallest triangle whose sides prolong three edges of the polygon (which turns left) and that
 * holds it; about the rectangle of a polygon that has no three such edges. */
static void triangle_about(double (*hull)[2], size_t count, const double low[2],
                           const double high[2], double best[3][2])
{
    double width = high[0] - low[0], least = 2 * width * (high[1] - low[1]);
    const double around[3][2] = {{low[0] - 0.5 * width, low[1]},
                                 {high[0] + 0.5 * width, low[1]},
                                 {low[0] + 0.5 * width, 2 * high[1] - low[1]}};
    memcpy(best, around, sizeof around);
    for (size_t i = 0; i < count; i++)
        for (size_t k = i + 1; k < count; k++) {
            double p[3][2];
            if (!lines_meet(hull, count, i, k, p[0]))
                continue;
            for (size_t m = k + 1; m < count; m++) {
                if (!lines_meet(hull, count, k, m, p[1]) || !lines_meet(hull, count, m, i, p[2]))
                    continue;
                double area = 0.5 * turn(p[0], p[1], p[2]);
                const double *edges[3][2] = {{hull[k], hull[(k + 1) % count]},
                                             {hull[m], hull[(m + 1) % count]},
                                             {hull[i], hull[(i + 1) % count]}};
                bool inside = area > 0 && area < least;
                /* each side must run as its edge does, or the triangle lies beyond the polygon */
                for (int e = 0; e < 3 && inside; e++) {
                    const double *a = edges[e][0], *b = edges[e][1];
                    const double *from = p[e], *to = p[(e + 1) % 3];
                    inside =
                        (b[0] - a[0]) * (to[0] - from[0]) + (b[1] - a[1]) * (to[1] - from[1]) > 0;
                }
                if (inside) {
                    least = area;
                    memcpy(best, p, sizeof p);
                }
            }
        }
}

/* A triangle's corners and how they move: all sides move out by r, the radius of the circle within,
 * when the corners double their distance from its centre. */
static void set_triangle(double p[3][2], const float origin[2], float texel_m,
                         struct atlas_view *view)
{
    double side[3], around = 0, center[2] = {0, 0};
    for (int i = 0; i < 3; i++) {
        const double *a = p[(i + 1) % 3], *b = p[(i + 2) % 3];
        side[i] = hypot(b[0] - a[0], b[1] - a[1]);
        around += side[i];
    }
    for (int k = 0; k < 2; k++)
        center[k] = (side[0] * p[0][k] + side[1] * p[1][k] + side[2] * p[2][k]) / around;
    double radius = turn(p[0], p[1], p[2]) / around;
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 2; k++) { /* (row, column) to (s, t), backwards to turn left there */
            const double *corner = p[2 - i];
            view->triangle[i][k] = origin[k] + (float)corner[1 - k] * texel_m;
            view->triangle[i][2 + k] = (float)((corner[1 - k] - center[1 - k]) / radius);
        }
}

/* Least squares plane of the depths over the covered texels, weighted by coverage. */
static void fit_depth(const uint8_t (*albedo)[4], const uint16_t *depth, int width_px,
                      int height_px, float texel_m, float radius_m, struct atlas_view *view)
{
    double n = 0, x = 0, y = 0, z = 0, xx = 0, xy = 0, yy = 0, xz = 0, yz = 0;
    for (int row = 0; row < height_px; row++)
        for (int column = 0; column < width_px; column++) {
            size_t at = (size_t)row * (size_t)width_px + (size_t)column;
            double w = albedo[at][3] / 255.0, d = (depth[at] / 65535.0 * 2 - 1) * radius_m;
            double s = view->origin_s + (column + 0.5) * texel_m;
            double t = view->origin_t + (row + 0.5) * texel_m;
            n += w, x += w * s, y += w * t, z += w * d;
            xx += w * s * s, xy += w * s * t, yy += w * t * t, xz += w * s * d, yz += w * t * d;
        }
    if (n <= 0)
        return;
    view->covered_m2 = (float)(n * texel_m * texel_m);
    x /= n, y /= n, z /= n;
    xx = xx / n - x * x, xy = xy / n - x * y, yy = yy / n - y * y;
    xz = xz / n - x * z, yz = yz / n - y * z;
    double det = xx * yy - xy * xy, a = 0, b = 0;
    if (det > 1e-6 * (xx * yy) && xx * yy > 0) {
        a = (xz * yy - yz * xy) / det;
        b = (yz * xx - xz * xy) / det;
    }
    view->depth_plane[0] = (float)(z - a * x - b * y);
    view->depth_plane[1] = (float)a;
    view->depth_plane[2] = (float)b;
}

void atlas_outline(struct arena *arena, const uint8_t (*albedo)[4], const uint16_t *depth,
                   int width_px, int height_px, float texel_m, float radius_m,
                   struct atlas_view *view)
{
    double(*hull)[2];
    size_t count = hull_of_rows(arena, albedo, width_px, height_px, &hull);
    float origin[2] = {view->origin_s, view->origin_t};
    for (int k = 0; k < 2; k++) {
        double low = INFINITY, high = -INFINITY;
        for (size_t i = 0; i < count; i++) {
            low = fmin(low, hull[i][1 - k]);
            high = fmax(high, hull[i][1 - k]);
        }
        view->low[k] = count ? origin[k] + (float)low * texel_m : 0;
        view->high[k] = count ? origin[k] + (float)high * texel_m : 0;
    }
    if (count >= 3) {
        double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY}, triangle[3][2];
        for (size_t i = 0; i < count; i++)
            for (int k = 0; k < 2; k++) {
                low[k] = fmin(low[k], hull[i][k]);
                high[k] = fmax(high[k], hull[i][k]);
            }
        triangle_about(hull, count, (const double *)low, (const double *)high, triangle);
        set_triangle(triangle, origin, texel_m, view);
    }
    count = hull_reduce(hull, count, ATLAS_HULL);
    for (size_t i = 0; i < ATLAS_HULL; i++) {
        /* backwards: counter-clockwise in (s, t) */
        const double *corner = count ? hull[i < count ? count - 1 - i : 0] : NULL;
        for (int k = 0; k < 2; k++)
            view->hull[i][k] = corner ? origin[k] + (float)corner[1 - k] * texel_m : 0;
    }
    fit_depth(albedo, depth, width_px, height_px, texel_m, radius_m, view);
}
