/* The quadtree over a terrain's quads and its descent, near cells first. */
#include "bake/terrain_rays.h"

enum { LEVELS_MAX = 16 };

/* Cells of 2^level quads a side, from level 1 on. */
struct cells {
    uint32_t across, down;
    float (*range_m)[2]; /* the least and the largest height */
};

struct terrain_rays {
    const struct terrain *terrain;
    float *x_m, *z_m; /* of the samples, as terrain_mesh() rounds them */
    int levels_count; /* the last one is a single cell */
    struct cells levels[LEVELS_MAX];
};

static void range_add(float range_m[2], float low_m, float high_m)
{
    range_m[0] = low_m < range_m[0] ? low_m : range_m[0];
    range_m[1] = high_m > range_m[1] ? high_m : range_m[1];
}

/* Level 1 from the samples of two by two quads. */
static void range_of_samples(const struct terrain *terrain, uint32_t x, uint32_t z,
                             float range_m[2])
{
    for (uint32_t j = 2 * z; j <= 2 * z + 2 && j < terrain->samples_z; j++)
        for (uint32_t i = 2 * x; i <= 2 * x + 2 && i < terrain->samples_x; i++) {
            float height_m = terrain->heights_m[(size_t)j * terrain->samples_x + i];
            range_add(range_m, height_m, height_m);
        }
}

static void range_of_cells(const struct cells *finer, uint32_t x, uint32_t z, float range_m[2])
{
    for (uint32_t j = 2 * z; j < 2 * z + 2 && j < finer->down; j++)
        for (uint32_t i = 2 * x; i < 2 * x + 2 && i < finer->across; i++) {
            const float *cell = finer->range_m[(size_t)j * finer->across + i];
            range_add(range_m, cell[0], cell[1]);
        }
}

static void level_build(struct arena *arena, struct terrain_rays *rays, int level)
{
    const struct terrain *terrain = rays->terrain;
    struct cells *cells = &rays->levels[level];
    const uint32_t side = 1u << level;
    cells->across = (terrain->samples_x - 1 + side - 1) / side;
    cells->down = (terrain->samples_z - 1 + side - 1) / side;
    cells->range_m =
        arena_alloc(arena, (size_t)cells->across * cells->down, sizeof *cells->range_m);
    for (uint32_t z = 0; z < cells->down; z++)
        for (uint32_t x = 0; x < cells->across; x++) {
            float *range_m = cells->range_m[(size_t)z * cells->across + x];
            range_m[0] = INFINITY;
            range_m[1] = -INFINITY;
            if (level == 1)
                range_of_samples(terrain, x, z, range_m);
            else
                range_of_cells(&rays->levels[level - 1], x, z, range_m);
        }
}

static float *places(struct arena *arena, uint32_t samples, float size_m)
{
    float *at_m = ARENA_ARRAY(arena, float, samples);
    for (uint32_t i = 0; i < samples; i++)
        at_m[i] = (float)(((double)i / (samples - 1) - 0.5) * (double)size_m);
    return at_m;
}

struct terrain_rays *terrain_rays_create(struct arena *arena, const struct terrain *terrain)
{
    struct terrain_rays *rays = ARENA_NEW(arena, struct terrain_rays);
    rays->terrain = terrain;
    rays->x_m = places(arena, terrain->samples_x, terrain->size_x_m);
    rays->z_m = places(arena, terrain->samples_z, terrain->size_z_m);
    do {
        rays->levels_count++;
        level_build(arena, rays, rays->levels_count);
    } while (rays->levels[rays->levels_count].across > 1 ||
             rays->levels[rays->levels_count].down > 1);
    return rays;
}

/* A ray and what it has met. */
struct descent {
    double origin[3], direction[3], inverse[3];
    double distance; /* of the first hit so far, or the farthest */
    struct terrain_hit *hit;
    bool found, any;
};

/* Cuts *first..*last to where the ray is between two planes; a little too wide, by rounding. */
static inline bool slab(const struct descent *ray, int axis, double low, double high, double *first,
                        double *last)
{
    static const double SLACK = 1e-14;
    double from = low - ray->origin[axis], to = high - ray->origin[axis];
    if (!(ray->direction[axis] < 0 || ray->direction[axis] > 0))
        return from <= 0 && to >= 0;
    from *= ray->inverse[axis];
    to *= ray->inverse[axis];
    double enter = from < to ? from : to, leave = from < to ? to : from;
    enter -= SLACK * fabs(enter);
    leave += SLACK * fabs(leave);
    *first = enter > *first ? enter : *first;
    *last = leave < *last ? leave : *last;
    return *first <= *last;
}

/* A triangle is met where the ray has the planes through its origin and the edges on one side
 * (Olano and Greer 1997); an edge gives the same product, of the other sign, to the triangle beyond
 * it. */
static void triangle_meet(struct descent *ray, const uint32_t corners[3], const double *const p[3])
{
    double planes[3][3], weights[3];
    for (int k = 0; k < 3; k++) {
        const double *a = p[(k + 1) % 3], *b = p[(k + 2) % 3];
        for (int i = 0; i < 3; i++) {
            int j = (i + 1) % 3, l = (i + 2) % 3;
            planes[k][i] = a[j] * b[l] - a[l] * b[j];
        }
        weights[k] = ray->direction[0] * planes[k][0] + ray->direction[1] * planes[k][1] +
                     ray->direction[2] * planes[k][2];
    }
    bool front = weights[0] <= 0 && weights[1] <= 0 && weights[2] <= 0;
    bool back = weights[0] >= 0 && weights[1] >= 0 && weights[2] >= 0;
    double sum = weights[0] + weights[1] + weights[2];
    if ((!front && !back) || !(sum < 0 || sum > 0))
        return;
    double volume = p[0][0] * planes[0][0] + p[0][1] * planes[0][1] + p[0][2] * planes[0][2];
    double distance = volume / sum;
    if (!(distance > 0 && distance < ray->distance))
        return;
    ray->found = true;
    ray->distance = distance;
    if (!ray->hit)
        return;
    ray->hit->distance = distance;
    ray->hit->front = front;
    for (int k = 0; k < 3; k++) {
        ray->hit->corners[k] = corners[k];
        ray->hit->weights[k] = (float)(weights[k] / sum);
    }
}

static void quad_meet(const struct terrain_rays *rays, struct descent *ray, uint32_t x, uint32_t z)
{
    const uint32_t samples = rays->terrain->samples_x;
    const uint32_t a = z * samples + x, corners[4] = {a, a + 1, a + samples, a + samples + 1};
    double p[4][3], first = 0, last = ray->distance, low = INFINITY, high = -INFINITY;
    for (int k = 0; k < 4; k++) {
        double height = (double)rays->terrain->heights_m[corners[k]];
        p[k][0] = (double)rays->x_m[x + (k & 1)] - ray->origin[0];
        p[k][1] = height - ray->origin[1];
        p[k][2] = (double)rays->z_m[z + (k >> 1)] - ray->origin[2];
        low = height < low ? height : low;
        high = height > high ? height : high;
    }
    if (!slab(ray, 0, (double)rays->x_m[x], (double)rays->x_m[x + 1], &first, &last) ||
        !slab(ray, 2, (double)rays->z_m[z], (double)rays->z_m[z + 1], &first, &last) ||
        !slab(ray, 1, low, high, &first, &last))
        return;
    triangle_meet(ray, (uint32_t[3]){a, corners[3], corners[1]},
                  (const double *const[3]){p[0], p[3], p[1]});
    triangle_meet(ray, (uint32_t[3]){a, corners[2], corners[3]},
                  (const double *const[3]){p[0], p[2], p[3]});
}

struct cell {
    uint32_t x, z;
    int level;
};

static bool cell_may_be_met(const struct terrain_rays *rays, const struct descent *ray,
                            const struct cell *cell)
{
    const struct cells *cells = &rays->levels[cell->level];
    const float *range_m = cells->range_m[(size_t)cell->z * cells->across + cell->x];
    const uint32_t quads_x = rays->terrain->samples_x - 1, quads_z = rays->terrain->samples_z - 1;
    uint32_t x = cell->x << cell->level, end_x = (cell->x + 1) << cell->level;
    uint32_t z = cell->z << cell->level, end_z = (cell->z + 1) << cell->level;
    end_x = end_x < quads_x ? end_x : quads_x;
    end_z = end_z < quads_z ? end_z : quads_z;
    double first = 0, last = ray->distance;
    return slab(ray, 0, (double)rays->x_m[x], (double)rays->x_m[end_x], &first, &last) &&
           slab(ray, 2, (double)rays->z_m[z], (double)rays->z_m[end_z], &first, &last) &&
           slab(ray, 1, (double)range_m[0], (double)range_m[1], &first, &last);
}

/* Children that are there, the farthest first, so that the nearest is on top. */
static size_t push_children(const struct terrain_rays *rays, const struct descent *ray,
                            const struct cell *cell, struct cell *stack, size_t count)
{
    const struct cells *finer = &rays->levels[cell->level - 1];
    const uint32_t near_x = ray->direction[0] < 0, near_z = ray->direction[2] < 0;
    for (uint32_t k = 4; k-- > 0;) {
        struct cell child = {2 * cell->x + ((k & 1) ^ near_x), 2 * cell->z + ((k >> 1) ^ near_z),
                             cell->level - 1};
        if (child.x < finer->across && child.z < finer->down)
            stack[count++] = child;
    }
    return count;
}

static void quads_meet(const struct terrain_rays *rays, struct descent *ray,
                       const struct cell *cell)
{
    const uint32_t near_x = ray->direction[0] < 0, near_z = ray->direction[2] < 0;
    for (uint32_t k = 0; k < 4; k++) {
        uint32_t x = 2 * cell->x + ((k & 1) ^ near_x), z = 2 * cell->z + ((k >> 1) ^ near_z);
        if (x + 1 < rays->terrain->samples_x && z + 1 < rays->terrain->samples_z)
            quad_meet(rays, ray, x, z);
    }
}

static void descend(const struct terrain_rays *rays, struct descent *ray)
{
    struct cell stack[3 * LEVELS_MAX + 4];
    size_t count = 0;
    stack[count++] = (struct cell){0, 0, rays->levels_count};
    while (count > 0 && !(ray->any && ray->found)) {
        const struct cell cell = stack[--count];
        if (!cell_may_be_met(rays, ray, &cell))
            continue;
        if (cell.level == 1)
            quads_meet(rays, ray, &cell);
        else
            count = push_children(rays, ray, &cell, stack, count);
    }
}

static struct descent descent_of(const float origin_m[3], const float direction[3], double farthest)
{
    struct descent ray = {.distance = farthest};
    for (int i = 0; i < 3; i++) {
        ray.origin[i] = (double)origin_m[i];
        ray.direction[i] = (double)direction[i];
        ray.inverse[i] = 1 / ray.direction[i];
    }
    return ray;
}

bool terrain_rays_hit(const struct terrain_rays *rays, const float origin_m[3],
                      const float direction[3], double farthest, struct terrain_hit *hit)
{
    struct descent ray = descent_of(origin_m, direction, farthest);
    ray.hit = hit;
    descend(rays, &ray);
    return ray.found;
}

bool terrain_rays_blocked(const struct terrain_rays *rays, const float origin_m[3],
                          const float direction[3], double farthest)
{
    struct descent ray = descent_of(origin_m, direction, farthest);
    ray.any = true;
    descend(rays, &ray);
    return ray.found;
}
