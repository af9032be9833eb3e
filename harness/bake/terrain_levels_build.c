/* The triangles of a chunk at every level, and how far each is from the full surface. */
#include "bake/terrain_levels_parts.h"

#include <stdlib.h>
#include <string.h>

/* A place on a border moves back to the coarser neighbour's vertex before it; ends stay. */
static uint16_t snapped(uint32_t at, uint32_t stride, uint32_t end)
{
    return (uint16_t)(at == end ? at : at - at % (2 * stride));
}

static struct corner corner_at(const struct chunk_kind *kind, uint32_t x, uint32_t z,
                               uint32_t stride, int sides)
{
    struct corner corner = {(uint16_t)(x < kind->width ? x : kind->width),
                            (uint16_t)(z < kind->height ? z : kind->height)};
    bool west = sides & SIDE_WEST && corner.x == 0;
    bool east = sides & SIDE_EAST && corner.x == kind->width;
    bool north = sides & SIDE_NORTH && corner.z == 0;
    bool south = sides & SIDE_SOUTH && corner.z == kind->height;
    if (west || east)
        corner.z = snapped(corner.z, stride, kind->height);
    if (north || south)
        corner.x = snapped(corner.x, stride, kind->width);
    return corner;
}

static bool same(struct corner a, struct corner b)
{
    return a.x == b.x && a.z == b.z;
}

/* The two triangles of each cell, as terrain_mesh() cuts a quad; those that snapping has emptied
 * are left out. */
static struct pattern pattern_build(struct arena *arena, const struct chunk_kind *kind,
                                    uint32_t stride, int sides)
{
    uint32_t across = (kind->width + stride - 1) / stride;
    uint32_t down = (kind->height + stride - 1) / stride;
    struct pattern pattern = {0, NULL};
    pattern.triangles = arena_alloc(arena, 2 * (size_t)across * down, sizeof *pattern.triangles);
    for (uint32_t z = 0; z < down * stride; z += stride)
        for (uint32_t x = 0; x < across * stride; x += stride) {
            struct corner a = corner_at(kind, x, z, stride, sides);
            struct corner b = corner_at(kind, x + stride, z, stride, sides);
            struct corner c = corner_at(kind, x, z + stride, stride, sides);
            struct corner d = corner_at(kind, x + stride, z + stride, stride, sides);
            struct corner pair[2][3] = {{a, d, b}, {a, c, d}};
            for (int k = 0; k < 2; k++)
                if (!same(pair[k][0], pair[k][1]) && !same(pair[k][1], pair[k][2]) &&
                    !same(pair[k][2], pair[k][0]))
                    memcpy(pattern.triangles[pattern.count++], pair[k], sizeof pair[k]);
        }
    return pattern;
}

static int by_bytes(const void *a, const void *b)
{
    return memcmp(a, b, sizeof(struct corner[3]));
}

static bool on_border(const struct chunk_kind *kind, const struct corner triangle[3])
{
    bool border = false;
    for (int k = 0; k < 3; k++)
        border |= triangle[k].x == 0 || triangle[k].x == kind->width || triangle[k].z == 0 ||
                  triangle[k].z == kind->height;
    return border;
}

/* Sides change triangles on the border alone, and at a stride of 1 the others are exact. */
static void pattern_add(const struct chunk_kind *kind, int level, int sides, struct pattern *all)
{
    const struct pattern *one = &kind->patterns[level][sides];
    for (size_t k = 0; k < one->count; k++)
        if ((sides == 0 && level > 0) || (sides > 0 && on_border(kind, one->triangles[k])))
            memcpy(all->triangles[all->count++], one->triangles[k], sizeof *one->triangles);
}

void chunk_kind_build(struct arena *arena, struct chunk_kind *kind, uint32_t width, uint32_t height)
{
    kind->width = width;
    kind->height = height;
    for (int level = 0; level < LEVELS_COUNT; level++) {
        struct pattern *all = &kind->all[level];
        size_t room = 0;
        for (int sides = 0; sides < SIDES_COUNT; sides++) {
            kind->patterns[level][sides] = pattern_build(arena, kind, 1u << level, sides);
            room += kind->patterns[level][sides].count;
        }
        all->triangles = arena_alloc(arena, room, sizeof *all->triangles);
        for (int sides = 0; sides < SIDES_COUNT; sides++)
            pattern_add(kind, level, sides, all);
        qsort(all->triangles, all->count, sizeof *all->triangles, by_bytes);
        size_t kept = 0;
        for (size_t k = 0; k < all->count; k++)
            if (kept == 0 || by_bytes(all->triangles[kept - 1], all->triangles[k]) != 0)
                memmove(all->triangles[kept++], all->triangles[k], sizeof *all->triangles);
        all->count = kept;
    }
}

/* The full surface between samples; x, z: from the grid's first sample. */
static double surface_at(const struct terrain *terrain, double x, double z)
{
    uint32_t i = (uint32_t)x, j = (uint32_t)z;
    i = i < terrain->samples_x - 1 ? i : terrain->samples_x - 2;
    j = j < terrain->samples_z - 1 ? j : terrain->samples_z - 2;
    double u = x - i, v = z - j;
    const float *row = terrain->heights_m + (size_t)j * terrain->samples_x + i;
    const float *next = row + terrain->samples_x;
    double base = (double)row[0], corner = (double)next[1];
    double side = (double)(u >= v ? row[1] : next[0]);
    return base + (u >= v ? u : v) * (side - base) + (u >= v ? v : u) * (corner - side);
}

/* Where an edge crosses the lines of the grid in one direction: `lines` of them, evenly. */
static double crossings_error(const struct terrain *terrain, const double from[3],
                              const double to[3], int lines)
{
    double worst = 0;
    for (int k = 1; k < lines; k++) {
        double t = (double)k / lines, at[3];
        for (int i = 0; i < 3; i++)
            at[i] = from[i] + t * (to[i] - from[i]);
        worst = fmax(worst, fabs(at[1] - surface_at(terrain, at[0], at[2])));
    }
    return worst;
}

static double edge_error(const struct terrain *terrain, const double from[3], const double to[3])
{
    int x = abs((int)(to[0] - from[0])), z = abs((int)(to[2] - from[2]));
    int diagonal = abs((int)(to[0] - from[0]) - (int)(to[2] - from[2]));
    if (x == 0 || z == 0 || diagonal == 0)
        return 0; /* along the grid's own edges */
    return fmax(
        crossings_error(terrain, from, to, x),
        fmax(crossings_error(terrain, from, to, z), crossings_error(terrain, from, to, diagonal)));
}

/* At the samples within. corners: x, height, z, counted from the grid's first sample. */
static double samples_error(const struct terrain *terrain, const double corners[3][3])
{
    const double *a = corners[0], *b = corners[1], *c = corners[2];
    double bx = b[0] - a[0], bz = b[2] - a[2], cx = c[0] - a[0], cz = c[2] - a[2];
    double area = bx * cz - bz * cx, rise_b = b[1] - a[1], rise_c = c[1] - a[1];
    double slope_x = (rise_b * cz - rise_c * bz) / area;
    double slope_z = (rise_c * bx - rise_b * cx) / area, worst = 0;
    for (int z = (int)fmin(a[2], fmin(b[2], c[2])); z <= (int)fmax(a[2], fmax(b[2], c[2])); z++) {
        double low = INFINITY, high = -INFINITY;
        for (int k = 0; k < 3; k++) { /* the row's ends, where edges cross it */
            const double *from = corners[k], *to = corners[(k + 1) % 3];
            if (z < fmin(from[2], to[2]) || z > fmax(from[2], to[2]))
                continue;
            double t = to[2] > from[2] || to[2] < from[2] ? (z - from[2]) / (to[2] - from[2]) : 0;
            double ends[2] = {from[0] + t * (to[0] - from[0]), to[2] > from[2] || to[2] < from[2]
                                                                   ? from[0] + t * (to[0] - from[0])
                                                                   : to[0]};
            low = fmin(low, fmin(ends[0], ends[1]));
            high = fmax(high, fmax(ends[0], ends[1]));
        }
        const float *row = terrain->heights_m + (size_t)z * terrain->samples_x;
        double at = a[1] + slope_z * (z - a[2]) - slope_x * a[0];
        int first = (int)ceil(low - 1e-9), last = (int)floor(high + 1e-9);
        for (int x = first; x <= last; x++) {
            double away = fabs(at + slope_x * x - (double)row[x]);
            worst = away > worst ? away : worst;
        }
    }
    return worst;
}

float triangle_error(const struct terrain *terrain, uint32_t x, uint32_t z,
                     const struct corner triangle[3])
{
    double corners[3][3], worst;
    for (int k = 0; k < 3; k++) {
        uint32_t i = x + triangle[k].x, j = z + triangle[k].z;
        corners[k][0] = i;
        corners[k][1] = (double)terrain->heights_m[(size_t)j * terrain->samples_x + i];
        corners[k][2] = j;
    }
    worst = samples_error(terrain, (const double(*)[3])corners);
    for (int k = 0; k < 3; k++)
        worst = fmax(worst, edge_error(terrain, corners[k], corners[(k + 1) % 3]));
    return (float)worst * (1 + 1e-6f);
}
