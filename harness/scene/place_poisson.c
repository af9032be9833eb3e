/* Poisson disc points by dart throwing on a shrinking list of cells that are not yet covered.
 *
 * Ebeida, Mitchell, Patney, Davidson, Owens 2012, A Simple Algorithm for Maximal Poisson-Disk
 * Sampling in High Dimensions, Computer Graphics Forum 31(2), doi:10.1111/j.1467-8659.2012.03059.x.
 * Base cells have a diagonal of one radius and hold one point at most. Darts are thrown anywhere
 * first; when that no longer pays, into an active cell taken at random, and after each pass the
 * active cells are quartered and quarters that lie within a disc are dropped. Darts are uniform
 * over what is still free, so the points are evenly spread whenever the wanted number stops the
 * game. */
#include "scene/place.h"

#include "scene/place_random.h"

#include <string.h>

enum { LEVELS_MAX = 16, PASSES_ANYWHERE = 4 };
static const float EMPTY = 1e30f; /* far from everything */

struct cell_at {
    uint32_t x, z;
};

struct discs {
    double half_m, cell_m, radius2_m2, clearing2_m2;
    int64_t cells_side;
    float (*points_m)[2]; /* cells_side x cells_side; one a base cell, or EMPTY */
    size_t count, wanted;
    struct random random;
};

/* The base cells that can hold a point within one radius of a base cell. */
static void neighbours_of(const struct discs *discs, uint32_t x, uint32_t z, int64_t range[4])
{
    range[0] = (int64_t)x > 2 ? (int64_t)x - 2 : 0;
    range[1] = (int64_t)x + 2 < discs->cells_side ? (int64_t)x + 2 : discs->cells_side - 1;
    range[2] = (int64_t)z > 2 ? (int64_t)z - 2 : 0;
    range[3] = (int64_t)z + 2 < discs->cells_side ? (int64_t)z + 2 : discs->cells_side - 1;
}

/* A dart at a point of a base cell, rounded first, so that the distances hold for the floats that
 * an instance keeps; true when it sticks. */
static bool dart_sticks(struct discs *discs, double point_x_m, double point_z_m, uint32_t base_x,
                        uint32_t base_z)
{
    float x_m = (float)point_x_m, z_m = (float)point_z_m;
    if ((double)x_m * x_m + (double)z_m * z_m < discs->clearing2_m2)
        return false;
    int64_t range[4];
    neighbours_of(discs, base_x, base_z, range);
    for (int64_t j = range[2]; j <= range[3]; j++)
        for (int64_t i = range[0]; i <= range[1]; i++) {
            const float *point = discs->points_m[j * discs->cells_side + i];
            double dx = (double)point[0] - x_m, dz = (double)point[1] - z_m;
            if (dx * dx + dz * dz < discs->radius2_m2)
                return false;
        }
    float *slot = discs->points_m[base_z * discs->cells_side + base_x];
    slot[0] = x_m;
    slot[1] = z_m;
    discs->count++;
    return true;
}

/* A dart into an active cell of a level. */
static bool dart_throw(struct discs *discs, struct cell_at at, int level)
{
    double side_m = discs->cell_m / (double)(1u << level);
    double inside_x = random_double(&discs->random), inside_z = random_double(&discs->random);
    return dart_sticks(discs, (at.x + inside_x) * side_m - discs->half_m,
                       (at.z + inside_z) * side_m - discs->half_m, at.x >> level, at.z >> level);
}

/* Darts anywhere in the square, as many as there are cells, or until the wanted number sticks. They
 * are drawn some ahead, so that the memory around one is fetched while others are judged. */
static void pass_anywhere(struct discs *discs)
{
    enum { AHEAD = 32 };
    double last = (double)(discs->cells_side - 1);
    int64_t batches = discs->cells_side * discs->cells_side / AHEAD + 1;
    for (int64_t b = 0; b < batches && discs->count < discs->wanted; b++) {
        double darts[AHEAD][2];
        struct cell_at bases[AHEAD];
        for (int k = 0; k < AHEAD; k++) {
            for (int a = 0; a < 2; a++)
                darts[k][a] = random_double(&discs->random) * (double)discs->cells_side;
            bases[k].x = (uint32_t)fmin(darts[k][0], last);
            bases[k].z = (uint32_t)fmin(darts[k][1], last);
            int64_t range[4];
            neighbours_of(discs, bases[k].x, bases[k].z, range);
            for (int64_t j = range[2]; j <= range[3]; j++)
                __builtin_prefetch(discs->points_m[j * discs->cells_side + range[0]]);
        }
        for (int k = 0; k < AHEAD && discs->count < discs->wanted; k++)
            dart_sticks(discs, darts[k][0] * discs->cell_m - discs->half_m,
                        darts[k][1] * discs->cell_m - discs->half_m, bases[k].x, bases[k].z);
    }
}

static bool base_is_taken(const struct discs *discs, struct cell_at at, int level)
{
    int64_t base = (at.z >> level) * discs->cells_side + (at.x >> level);
    return discs->points_m[base][0] < EMPTY;
}

/* Squared distance of a cell's far corner from a point. */
static double far_corner2(double x_m, double z_m, const double low_m[2], double side_m)
{
    double dx = fmax(fabs(low_m[0] - x_m), fabs(low_m[0] + side_m - x_m));
    double dz = fmax(fabs(low_m[1] - z_m), fabs(low_m[1] + side_m - z_m));
    return dx * dx + dz * dz;
}

static bool cell_is_covered(const struct discs *discs, struct cell_at at, int level)
{
    double side_m = discs->cell_m / (double)(1u << level);
    double low_m[2] = {at.x * side_m - discs->half_m, at.z * side_m - discs->half_m};
    if (far_corner2(0, 0, low_m, side_m) < discs->clearing2_m2)
        return true;
    int64_t range[4];
    neighbours_of(discs, at.x >> level, at.z >> level, range);
    for (int64_t j = range[2]; j <= range[3]; j++)
        for (int64_t i = range[0]; i <= range[1]; i++) {
            const float *point = discs->points_m[j * discs->cells_side + i];
            if (far_corner2(point[0], point[1], low_m, side_m) < discs->radius2_m2)
                return true;
        }
    return false;
}

/* One pass: as many darts as there are active cells; returns how many cells stay active. */
static size_t pass_throw(struct discs *discs, struct cell_at *active, size_t active_count,
                         int level)
{
    for (size_t darts = active_count; darts > 0 && active_count > 0; darts--) {
        if (discs->count == discs->wanted)
            return 0;
        size_t k = random_below(&discs->random, (uint32_t)active_count);
        if (base_is_taken(discs, active[k], level) || dart_throw(discs, active[k], level))
            active[k] = active[--active_count];
    }
    return active_count;
}

/* Quarters the active cells and keeps those that a point may still hit. */
static size_t pass_quarter(const struct discs *discs, const struct cell_at *active,
                           size_t active_count, int level, struct cell_at *quarters)
{
    size_t kept = 0;
    for (size_t k = 0; k < active_count; k++) {
        if (base_is_taken(discs, active[k], level))
            continue;
        for (uint32_t corner = 0; corner < 4; corner++) {
            struct cell_at quarter = {2 * active[k].x + (corner & 1),
                                      2 * active[k].z + (corner >> 1)};
            if (!cell_is_covered(discs, quarter, level + 1))
                quarters[kept++] = quarter;
        }
    }
    return kept;
}

/* The base cells that a point may still hit. */
static size_t active_list(const struct discs *discs, struct arena *arena, struct cell_at **active)
{
    size_t kept = 0, side = (size_t)discs->cells_side;
    *active = ARENA_ARRAY(arena, struct cell_at, side * side);
    for (size_t k = 0; k < side * side; k++) {
        struct cell_at at = {(uint32_t)(k % side), (uint32_t)(k / side)};
        if (!base_is_taken(discs, at, 0) && !cell_is_covered(discs, at, 0))
            (*active)[kept++] = at;
    }
    return kept;
}

/* An arena of its own, since the lists are many times the points. */
static size_t discs_fill(struct discs *discs, double (*points_m)[2])
{
    struct arena *scratch = arena_create(0);
    size_t cells = (size_t)(discs->cells_side * discs->cells_side);
    discs->points_m = arena_alloc(scratch, cells, sizeof *discs->points_m);
    for (size_t k = 0; k < cells; k++)
        discs->points_m[k][0] = discs->points_m[k][1] = EMPTY;
    for (int pass = 0; pass < PASSES_ANYWHERE && discs->count < discs->wanted; pass++)
        pass_anywhere(discs);
    struct cell_at *active = NULL;
    size_t active_count = discs->count < discs->wanted ? active_list(discs, scratch, &active) : 0;
    for (int level = 0; level < LEVELS_MAX && active_count > 0; level++) {
        active_count = pass_throw(discs, active, active_count, level);
        if (active_count > POISSON_CELLS_MAX)
            break;
        struct cell_at *quarters = ARENA_ARRAY(scratch, struct cell_at, 4 * active_count);
        active_count = pass_quarter(discs, active, active_count, level, quarters);
        active = quarters;
    }
    size_t count = 0;
    for (size_t k = 0; k < cells; k++)
        if (discs->points_m[k][0] < EMPTY) {
            points_m[count][0] = discs->points_m[k][0];
            points_m[count++][1] = discs->points_m[k][1];
        }
    arena_destroy(scratch);
    return count;
}

size_t place_poisson(double half_m, double min_distance_m, double clearing_m, uint64_t seed,
                     size_t wanted, double (*points_m)[2])
{
    if (wanted == 0)
        return 0;
    struct discs discs = {.half_m = half_m,
                          .radius2_m2 = min_distance_m * min_distance_m,
                          .clearing2_m2 = clearing_m * clearing_m,
                          .wanted = wanted,
                          .random = place_random(seed, SALT_DART, 0)};
    discs.cells_side = (int64_t)ceil(2 * half_m / (min_distance_m * 0.7071067811865475));
    if (discs.cells_side < 1)
        discs.cells_side = 1;
    discs.cell_m = 2 * half_m / (double)discs.cells_side;
    return discs_fill(&discs, points_m);
}
