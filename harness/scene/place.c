/* Placement: the jittered grid of Senegas 2001, 5.8, and what every placement shares. */
#include "scene/place.h"

#include "base/random.h"
#include "scene/place_random.h"

#include <string.h>

static const double TWO_PI = 6.283185307179586;

struct random place_random(uint64_t seed, enum place_salt salt, uint64_t index)
{
    uint64_t salted = random_mix(seed + (uint64_t)salt * 0x9e3779b97f4a7c15u);
    return random_seed(random_mix(salted ^ random_mix(index)), (uint64_t)salt);
}

/* A species with the odds of the weights. */
static uint32_t place_species(const struct description *description, struct random *random)
{
    double total = 0;
    for (size_t k = 0; k < description->plants_count; k++)
        total += description->plants[k].weight;
    double at = random_double(random) * total;
    uint32_t last = 0;
    for (uint32_t k = 0; k < description->plants_count; k++) {
        double weight = description->plants[k].weight;
        if (weight > 0 && at < weight)
            return k;
        at -= weight;
        if (weight > 0)
            last = k;
    }
    return last;
}

void place_tree(const struct description *description, uint64_t seed, size_t index, double x_m,
                double z_m, struct instance *instance)
{
    struct random random = place_random(seed, SALT_TREE, index);
    instance->position_m[0] = (float)(x_m - description->origin_m[0]);
    instance->position_m[1] = 0;
    instance->position_m[2] = (float)(z_m - description->origin_m[2]);
    instance->species = place_species(description, &random);
    const float *scale = description->plants[instance->species].scale;
    instance->scale = scale[0] + (float)random_double(&random) * (scale[1] - scale[0]);
    double turn = random_double(&random);
    instance->rotation_rad = description->placement.rotate ? (float)(turn * TWO_PI) : 0;
    /* Last, so that the other draws are the same with and without it. */
    const float *stretch = description->plants[instance->species].stretch;
    instance->stretch = stretch[0] + (float)random_double(&random) * (stretch[1] - stretch[0]);
}

/* Whether a tree's foot may stand at (x, z): the slope and the height of the triangle there. */
static bool place_allows(const struct placement *placement, double x_m, double z_m)
{
    if (!placement->bounded)
        return true;
    float x = (float)x_m, z = (float)z_m;
    double height_m = (double)terrain_height(placement->terrain, x, z);
    return height_m >= placement->heights_m[0] && height_m <= placement->heights_m[1] &&
           (double)terrain_slope_deg(placement->terrain, x, z) <= placement->slope_max_deg;
}

/* The share of the square where trees are allowed, from 256 x 256 points. */
static double share_allowed(const struct placement *placement, double half_m)
{
    enum { SIDE = 256 };
    size_t allowed = 0;
    for (int k = 0; k < SIDE * SIDE && placement->bounded; k++)
        allowed += place_allows(placement, ((k % SIDE + 0.5) / SIDE * 2 - 1) * half_m,
                                ((k / SIDE + 0.5) / SIDE * 2 - 1) * half_m);
    return placement->bounded ? (double)allowed / (SIDE * SIDE) : 1;
}

static enum status refuse_bounds(const struct description *description, size_t trees_count,
                                 uint64_t found, double half_m, struct error *error)
{
    const struct placement *placement = &description->placement;
    return error_set(error, STATUS_INVALID,
                     "%s: placement: %zu trees do not fit where the slope is up to %g degrees and "
                     "the height %g..%g m in a square of %g m; allowed: up to about %llu trees "
                     "here, or wider slope_max_deg and heights_m",
                     description->path, trees_count, placement->slope_max_deg,
                     placement->heights_m[0], placement->heights_m[1], 2 * half_m,
                     (unsigned long long)found);
}

/* The square cut into quads_side x quads_side quads, one tree at most in each. */
struct quad_grid {
    const struct placement *placement;
    double side_m, jitter, clearing_m;
    uint64_t seed, quads_side;
};

/* The place of a quad's tree; false when chance puts it in the clearing, or where none is allowed,
 * again and again. */
static bool quad_point(const struct quad_grid *grid, uint64_t quad, double point_m[2])
{
    enum { TRIES = 8 };
    struct random random = place_random(grid->seed, SALT_QUAD, quad);
    double corner[2] = {(double)(quad % grid->quads_side), (double)(quad / grid->quads_side)};
    for (int k = 0; k < TRIES; k++) {
        for (int a = 0; a < 2; a++) {
            double inside = 0.5 + grid->jitter * (random_double(&random) - 0.5);
            point_m[a] = ((corner[a] + inside) / (double)grid->quads_side - 0.5) * grid->side_m;
        }
        double distance2 = point_m[0] * point_m[0] + point_m[1] * point_m[1];
        if (distance2 >= grid->clearing_m * grid->clearing_m &&
            place_allows(grid->placement, point_m[0], point_m[1]))
            return true;
    }
    return false;
}

static uint64_t quads_usable(const struct quad_grid *grid)
{
    uint64_t quads = grid->quads_side * grid->quads_side, usable = 0;
    if (grid->clearing_m <= 0 && !grid->placement->bounded)
        return quads;
    double point_m[2];
    for (uint64_t quad = 0; quad < quads; quad++)
        usable += quad_point(grid, quad, point_m);
    return usable;
}

static uint64_t square_root_up(uint64_t value)
{
    uint64_t root = (uint64_t)sqrt((double)value);
    while (root * root < value)
        root++;
    return root;
}

/* The coarsest grid with a usable quad for each tree; a random choice of its quads, each as likely
 * as any other (selection sampling, Knuth, The Art of Computer Programming 2, 3.4.2, algorithm S).
 */
static enum status place_grid(const struct description *description, size_t trees_count,
                              uint64_t seed, struct instance *instances, double half_m,
                              struct error *error)
{
    const struct placement *placement = &description->placement;
    struct quad_grid grid = {.placement = placement,
                             .side_m = 2 * half_m,
                             .jitter = placement->jitter,
                             .clearing_m = placement->clearing_m,
                             .seed = seed,
                             .quads_side = square_root_up(trees_count)};
    const double share = share_allowed(placement, half_m);
    const double quads_max = share > 0 ? 4096 + 16 * (double)trees_count / share : 0;
    uint64_t usable = share > 0 ? quads_usable(&grid) : 0;
    while (usable < trees_count) {
        if (placement->bounded && (double)(grid.quads_side * grid.quads_side) > quads_max)
            return refuse_bounds(description, trees_count, usable, half_m, error);
        grid.quads_side += 1 + grid.quads_side / (placement->bounded ? 8 : 64);
        usable = quads_usable(&grid);
    }
    struct random choice = place_random(seed, SALT_CHOICE, 0);
    size_t placed = 0;
    for (uint64_t quad = 0; placed < trees_count; quad++) {
        double point_m[2];
        if (!quad_point(&grid, quad, point_m))
            continue;
        uint64_t wanted = trees_count - placed;
        if (wanted == usable || random_double(&choice) * (double)usable < (double)wanted) {
            place_tree(description, seed, placed, point_m[0], point_m[1], &instances[placed]);
            placed++;
        }
        usable--;
    }
    return STATUS_OK;
}

/* Points where trees are allowed: more than are wanted are thrown, and of those that stay a random
 * choice of `wanted` is kept, each as likely as any other. Returns how many, at most wanted;
 * fewer: no further point fits at this distance. */
static size_t discs_allowed(struct arena *arena, const struct placement *placement, double half_m,
                            double distance_m, uint64_t seed, size_t wanted, double (*points_m)[2])
{
    size_t thrown = wanted, count = 0, kept = 0, room = 2 * wanted + 64;
    double(*all_m)[2] = NULL;
    if (!placement->bounded)
        return place_poisson(half_m, distance_m, placement->clearing_m, seed, wanted, points_m);
    for (;; room *= 2) {
        all_m = arena_alloc(arena, room, sizeof *all_m);
        thrown = place_poisson(half_m, distance_m, placement->clearing_m, seed, room, all_m);
        count = 0;
        for (size_t k = 0; k < thrown; k++)
            if (place_allows(placement, all_m[k][0], all_m[k][1])) {
                memmove(all_m[count], all_m[k], sizeof all_m[k]);
                count++;
            }
        if (count >= wanted || thrown < room)
            break;
    }
    struct random choice = place_random(seed, SALT_CHOICE, 0);
    for (size_t k = 0; k < count && kept < wanted; k++)
        if (random_double(&choice) * (double)(count - k) < (double)(wanted - kept))
            memcpy(points_m[kept++], all_m[k], sizeof all_m[k]);
    return kept;
}

/* Without a given distance: 0.7 of the side of a tree's share of the ground, less where chance
 * leaves too few. */
static enum status place_discs(struct arena *arena, const struct description *description,
                               size_t trees_count, uint64_t seed, struct instance *instances,
                               double half_m, struct error *error)
{
    static const double PI = 3.141592653589793;
    const struct placement *placement = &description->placement;
    double clearing_m = placement->clearing_m, distance_m = placement->min_distance_m;
    double area_m2 = 4 * half_m * half_m - PI * clearing_m * clearing_m;
    const double share = share_allowed(placement, half_m);
    if (!(share > 0))
        return refuse_bounds(description, trees_count, 0, half_m, error);
    area_m2 *= share;
    bool automatic = distance_m <= 0;
    double least_m = 2 * half_m * sqrt(2.0 / POISSON_CELLS_MAX);
    if (!automatic && distance_m < least_m)
        return error_set(error, STATUS_INVALID,
                         "%s: placement.min_distance_m: value is %g; allowed in a square of %g m: "
                         "from %g",
                         description->path, distance_m, 2 * half_m, least_m);
    if (automatic)
        distance_m = 0.7 * sqrt(area_m2 / (double)trees_count);
    double(*points_m)[2] = arena_alloc(arena, trees_count, sizeof *points_m);
    const double first_m = distance_m;
    struct arena *scratch = arena_create(0);
    size_t count =
        discs_allowed(scratch, placement, half_m, distance_m, seed, trees_count, points_m);
    while (automatic && count < trees_count &&
           (!placement->bounded || distance_m > 0.1 * first_m)) {
        distance_m *= 0.9;
        count = discs_allowed(scratch, placement, half_m, distance_m, seed, trees_count, points_m);
    }
    arena_destroy(scratch);
    if (count < trees_count && automatic && placement->bounded)
        return refuse_bounds(description, trees_count, count, half_m, error);
    if (count < trees_count)
        return error_set(error, STATUS_INVALID,
                         "%s: placement.min_distance_m: %zu trees do not fit at %g m in a square "
                         "of %g m; allowed: up to %zu trees here, or a smaller distance",
                         description->path, trees_count, distance_m, 2 * half_m, count);
    for (size_t k = 0; k < trees_count; k++)
        place_tree(description, seed, k, points_m[k][0], points_m[k][1], &instances[k]);
    return STATUS_OK;
}

enum status place_trees(struct arena *arena, const struct description *description,
                        size_t trees_count, uint64_t seed, struct instance **instances,
                        double *half_m, struct error *error)
{
    const struct placement *placement = &description->placement;
    *instances = ARENA_ARRAY(arena, struct instance, trees_count);
    if (placement->kind == PLACEMENT_FILE)
        return place_file(arena, description, trees_count, seed, *instances, half_m, error);
    size_t shares = trees_count > 0 ? trees_count : 1;
    *half_m = 0.5 * (placement->extent_m > 0 ? placement->extent_m
                                             : placement->spacing_m * sqrt((double)shares));
    if (placement->clearing_m >= *half_m)
        return error_set(error, STATUS_INVALID,
                         "%s: placement.clearing_m: value is %g, but the forest's half side is "
                         "%g m at %zu trees; allowed: less than that",
                         description->path, placement->clearing_m, *half_m, trees_count);
    if (trees_count == 0)
        return STATUS_OK;
    if (placement->kind == PLACEMENT_POISSON)
        return place_discs(arena, description, trees_count, seed, *instances, *half_m, error);
    return place_grid(description, trees_count, seed, *instances, *half_m, error);
}
