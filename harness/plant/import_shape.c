/* Connected pieces of a soup, and which of them are as thin as leaves: flat and open. */
#include "plant/import_steps.h"
#include "plant/normals.h"

#include <math.h>

/* |vector area| / area: 1 for what is flat, 0 for what is closed, r / 2h for a tube with one open
 * end, 2 / pi for half a tube. */
static const double flat_from = 0.5;

static uint32_t root_of(uint32_t *parent, uint32_t i)
{
    while (parent[i] != i) {
        parent[i] = parent[parent[i]];
        i = parent[i];
    }
    return i;
}

uint32_t *import_connect(struct arena *arena, const struct import_soup *soup, const uint32_t *point,
                         const bool *take)
{
    size_t points = soup->vertices_count;
    uint32_t *parent = ARENA_ARRAY(arena, uint32_t, points);
    uint32_t *size = ARENA_ARRAY(arena, uint32_t, points);
    for (size_t i = 0; i < points; i++)
        parent[i] = (uint32_t)i, size[i] = 1;
    for (size_t i = 0; i < soup->triangles_count; i++) {
        if (!take[i])
            continue;
        uint32_t a = root_of(parent, point[soup->triangles[i][0]]);
        for (int k = 1; k < 3; k++) {
            uint32_t b = root_of(parent, point[soup->triangles[i][k]]);
            if (a == b)
                continue;
            uint32_t big = size[a] >= size[b] ? a : b, small = big == a ? b : a;
            parent[small] = big;
            size[big] += size[small];
            a = big;
        }
    }
    for (size_t i = 0; i < points; i++)
        parent[i] = root_of(parent, (uint32_t)i);
    return parent;
}

bool *import_flat(struct arena *arena, const struct import_soup *soup, const uint32_t *point,
                  const bool *keep)
{
    struct sum {
        double area, vector[3];
    } *sums = ARENA_ARRAY(arena, struct sum, soup->vertices_count);
    bool *flat = ARENA_ARRAY(arena, bool, soup->triangles_count);
    const uint32_t *root = import_connect(arena, soup, point, keep);
    for (int pass = 0; pass < 2; pass++)
        for (size_t i = 0; i < soup->triangles_count; i++) {
            if (!keep[i])
                continue;
            const uint32_t *t = soup->triangles[i];
            struct sum *sum = &sums[root[point[t[0]]]];
            const double *v = sum->vector;
            if (pass == 1) {
                flat[i] = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]) > flat_from * sum->area;
                continue;
            }
            double cross[3];
            float(*p)[3] = soup->positions;
            triangle_cross((const float *)p[t[0]], (const float *)p[t[1]], (const float *)p[t[2]],
                           cross);
            sum->area += sqrt(cross[0] * cross[0] + cross[1] * cross[1] + cross[2] * cross[2]);
            for (int k = 0; k < 3; k++)
                sum->vector[k] += cross[k];
        }
    return flat;
}
