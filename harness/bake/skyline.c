/* Sweeps over the height field, one for each azimuth. */
#include "bake/skyline.h"

#include <string.h>

/* A sweep along columns, the axis that the azimuth runs along faster, or along rows turned around.
 */
struct sweep {
    const struct terrain *terrain;
    float *tangents;   /* of this azimuth */
    int along, across; /* samples of the two axes */
    size_t stride_along, stride_across;
    bool ascending; /* the azimuth runs toward higher numbers along */
    double slope;   /* across a step along, in samples */
    float step_m;   /* level distance of a step along */
};

/* Points of a line, from far to near: all that were passed, or the upper hull of some. */
struct hull {
    float *at_m, *height_m;
    int count;
};

/* What is this many steps ahead, or nearer, each sample looks at itself: a line beside it would
 * show it other slopes. */
static const int near_steps = 4;

static struct sweep sweep_of(const struct terrain *terrain, double azimuth_rad)
{
    double x = sin(azimuth_rad) * (terrain->samples_x - 1) / terrain->size_x_m;
    double z = cos(azimuth_rad) * (terrain->samples_z - 1) / terrain->size_z_m;
    bool by_x = fabs(x) >= fabs(z);
    double fast = by_x ? x : z, other = by_x ? z : x;
    return (struct sweep){.terrain = terrain,
                          .along = (int)(by_x ? terrain->samples_x : terrain->samples_z),
                          .across = (int)(by_x ? terrain->samples_z : terrain->samples_x),
                          .stride_along = by_x ? 1 : terrain->samples_x,
                          .stride_across = by_x ? terrain->samples_x : 1,
                          .ascending = fast > 0,
                          .slope = other / fast,
                          .step_m = (float)(1 / fabs(fast))};
}

/* Of the surface at a place in samples; places beyond the border are on it. */
static float height_at(const struct sweep *sweep, double along, double across)
{
    along = fmin(fmax(along, 0), sweep->along - 1);
    across = fmin(fmax(across, 0), sweep->across - 1);
    int a = (int)fmin(along, sweep->along - 2), b = (int)fmin(across, sweep->across - 2);
    double u = along - a, v = across - b;
    const float *at = sweep->terrain->heights_m + (size_t)a * sweep->stride_along +
                      (size_t)b * sweep->stride_across;
    double base = at[0], corner = at[sweep->stride_along + sweep->stride_across];
    double by_along = at[sweep->stride_along], by_across = at[sweep->stride_across];
    return (float)(u >= v ? base + u * (by_along - base) + v * (corner - by_along)
                          : base + v * (by_across - base) + u * (corner - by_across));
}

void skyline_refine(struct arena *arena, const struct terrain *terrain, int parts,
                    struct terrain *fine)
{
    const struct sweep rows = {.terrain = terrain,
                               .along = (int)terrain->samples_x,
                               .across = (int)terrain->samples_z,
                               .stride_along = 1,
                               .stride_across = terrain->samples_x};
    *fine = *terrain;
    fine->samples_x = (terrain->samples_x - 1) * (uint32_t)parts + 1;
    fine->samples_z = (terrain->samples_z - 1) * (uint32_t)parts + 1;
    fine->heights_m = ARENA_ARRAY(arena, float, (size_t)fine->samples_x * fine->samples_z);
    for (uint32_t z = 0; z < fine->samples_z; z++)
        for (uint32_t x = 0; x < fine->samples_x; x++)
            fine->heights_m[(size_t)z * fine->samples_x + x] =
                height_at(&rows, (double)x / parts, (double)z / parts);
}

/* A point joins, nearer than all before; those that it hides from all after leave. */
static void hull_add(struct hull *hull, float at_m, float height_m)
{
    while (hull->count > 1) {
        const float *at = hull->at_m + hull->count - 2, *height = hull->height_m + hull->count - 2;
        if ((height[1] - height_m) * (at_m - at[0]) > (height[0] - height_m) * (at_m - at[1]))
            break;
        hull->count--;
    }
    hull->at_m[hull->count] = at_m;
    hull->height_m[hull->count++] = height_m;
}

static float hull_slope(const struct hull *hull, int point, float at_m, float height_m)
{
    return (hull->height_m[point] - height_m) / (at_m - hull->at_m[point]);
}

/* The tangent from a point before the hull, at any height: slopes rise and then fall along it. */
static float hull_look(const struct hull *hull, float at_m, float height_m)
{
    int low = 0, high = hull->count - 1;
    if (high < 0)
        return SKYLINE_OPEN;
    while (low < high) {
        int middle = (low + high) / 2;
        if (hull_slope(hull, middle, at_m, height_m) < hull_slope(hull, middle + 1, at_m, height_m))
            low = middle + 1;
        else
            high = middle;
    }
    return hull_slope(hull, low, at_m, height_m);
}

/* Where a value that runs evenly from one to another is whole, as shares of the way, excluding its
 * ends. Returns how many; at most 2 of less than 2 and a bit. */
static int whole_shares(double from, double to, double *shares)
{
    int count = 0;
    double rise = to - from;
    for (double whole = ceil(fmin(from, to)); whole <= fmax(from, to) && count < 3; whole++) {
        double share = (whole - from) / rise;
        if (share > 1e-9 && share < 1 - 1e-9)
            shares[count++] = share;
    }
    return count;
}

static void line_add(struct hull *line, double at_m, float height_m)
{
    line->at_m[line->count] = (float)at_m;
    line->height_m[line->count++] = height_m;
}

/* The surface bends where the line passes from triangle to triangle: what is between two columns.
 */
static void pass_between(const struct sweep *sweep, int column, double across, struct hull *line,
                         int step)
{
    double shares[6], back = sweep->ascending ? 1 : -1;
    double from = across + back * sweep->slope;
    int count = whole_shares(from, across, shares);
    count += whole_shares(column + back - from, column - across, shares + count);
    for (int i = 1; i < count; i++)
        for (int j = i; j > 0 && shares[j] < shares[j - 1]; j--) {
            double swap = shares[j];
            shares[j] = shares[j - 1];
            shares[j - 1] = swap;
        }
    for (int i = 0; i < count; i++) {
        double along = column + back * (1 - shares[i]), at = from + shares[i] * (across - from);
        if (i == 0 || shares[i] > shares[i - 1] + 1e-9)
            line_add(line, (step - 1 + shares[i]) * (double)sweep->step_m,
                     height_at(sweep, along, at));
    }
}

/* Lines that should pass through samples do. */
static double snap(double across)
{
    double whole = rint(across);
    return fabs(across - whole) < 1e-6 ? whole : across;
}

static float *tangent_at(const struct sweep *sweep, int column, int row)
{
    return sweep->tangents + (size_t)column * sweep->stride_along +
           (size_t)row * sweep->stride_across;
}

/* One line, from its far end: gives its far horizon to the samples on both sides, as each sees it
 * from its own height. first: where it would cross column 0. line, hull: room for a line. */
static void sweep_line(const struct sweep *sweep, double first, struct hull *line,
                       struct hull *hull)
{
    const int last = sweep->across - 1;
    int added = 0; /* to the hull */
    line->count = hull->count = 0;
    for (int step = 0; step < sweep->along; step++) {
        int column = sweep->ascending ? sweep->along - 1 - step : step;
        double across = snap(first + sweep->slope * column);
        if (across < 0 || across > last)
            continue;
        if (line->count)
            pass_between(sweep, column, across, line, step);
        line_add(line, step * (double)sweep->step_m, height_at(sweep, column, across));
        float at_m = (float)step * sweep->step_m,
              far_m = ((float)near_steps - 0.001f) * sweep->step_m;
        for (; added < line->count && line->at_m[added] <= at_m - far_m; added++)
            hull_add(hull, line->at_m[added], line->height_m[added]);
        int low = (int)across;
        double share = across - low;
        for (int row = low; row <= low + (share > 0); row++) {
            /* at a border there is no line on the other side */
            bool alone = row == low ? low == 0 : row == last;
            double weight = alone ? 1 : row == low ? 1 - share : share;
            *tangent_at(sweep, column, row) +=
                (float)weight * hull_look(hull, at_m, height_at(sweep, column, row));
        }
    }
}

/* The steepest way from a sample over the edges of the next triangles. */
static float look_near(const struct sweep *sweep, int column, int row)
{
    double direction = sweep->ascending ? 1 : -1, best = (double)SKYLINE_OPEN;
    const double rates[3] = {1, fabs(sweep->slope), fabs(1 - sweep->slope)};
    float height_m = height_at(sweep, column, row);
    for (int family = 0; family < 3; family++)
        for (int k = 1; k <= near_steps * rates[family]; k++) {
            double steps = k / rates[family], along = column + direction * steps,
                   across = row + direction * steps * sweep->slope;
            if (along < 0 || across < 0 || along > sweep->along - 1 || across > sweep->across - 1)
                break;
            best = fmax(best, (double)(height_at(sweep, along, across) - height_m) /
                                  (steps * (double)sweep->step_m));
        }
    return (float)best;
}

static struct hull hull_room(struct arena *arena, const struct sweep *sweep)
{
    size_t points = 4 * (size_t)sweep->along;
    return (struct hull){.at_m = ARENA_ARRAY(arena, float, points),
                         .height_m = ARENA_ARRAY(arena, float, points)};
}

static void sweep_run(const struct sweep *sweep)
{
    struct arena *passing = arena_create(0);
    struct hull line = hull_room(passing, sweep), hull = hull_room(passing, sweep);
    double lean = sweep->slope * (sweep->along - 1);
    const int from = (int)floor(fmin(0, -lean)) - 1;
    const int to = (int)floor(sweep->across + fmax(0, -lean));
    for (int first = from; first <= to; first++)
        sweep_line(sweep, first, &line, &hull);
    for (int column = 0; column < sweep->along; column++)
        for (int row = 0; row < sweep->across; row++)
            *tangent_at(sweep, column, row) =
                fmaxf(*tangent_at(sweep, column, row), look_near(sweep, column, row));
    arena_destroy(passing);
}

void skyline_bake(struct arena *arena, const struct terrain *terrain, int azimuths, int threads,
                  struct skyline *skyline)
{
    size_t samples = (size_t)terrain->samples_x * terrain->samples_z;
    *skyline = (struct skyline){.samples_x = terrain->samples_x,
                                .samples_z = terrain->samples_z,
                                .azimuths = azimuths,
                                .tangents = ARENA_ARRAY(arena, float, samples *(size_t)azimuths)};
#pragma omp parallel for num_threads(threads) schedule(dynamic)
    for (int k = 0; k < azimuths; k++) {
        struct sweep sweep = sweep_of(terrain, 2 * M_PI * k / azimuths);
        sweep.tangents = skyline->tangents + (size_t)k * samples;
        sweep_run(&sweep);
    }
}

/* Along x, z and the diagonals of the quads the surface bends, and nowhere else. */
float skyline_exact(const struct terrain *terrain, uint32_t x, uint32_t z, double azimuth_rad)
{
    double gx = sin(azimuth_rad) * (terrain->samples_x - 1) / terrain->size_x_m;
    double gz = cos(azimuth_rad) * (terrain->samples_z - 1) / terrain->size_z_m;
    double rates[3] = {gx, gz, gx - gz}, best = SKYLINE_OPEN;
    double from = terrain->heights_m[(size_t)z * terrain->samples_x + x];
    for (int family = 0; family < 3; family++)
        for (int k = 1; fabs(rates[family]) > 1e-12; k++) {
            double distance = k / fabs(rates[family]);
            double i = x + gx * distance, j = z + gz * distance;
            if (i < -1e-6 || j < -1e-6 || i > terrain->samples_x - 1 + 1e-6 ||
                j > terrain->samples_z - 1 + 1e-6)
                break;
            double at_x = (i / (terrain->samples_x - 1) - 0.5) * terrain->size_x_m;
            double at_z = (j / (terrain->samples_z - 1) - 0.5) * terrain->size_z_m;
            double height = (double)terrain_height(terrain, (float)at_x, (float)at_z);
            best = fmax(best, (height - from) / distance);
        }
    return (float)best;
}
