/* Neighbours of a mesh's triangles, and the boundary of their shadow. */
#include "bake/shadow_caster.h"

#include <math.h>
#include <string.h>

#define NONE UINT32_MAX

static size_t table_size(size_t entries)
{
    size_t size = 16;
    while (size < 2 * entries)
        size *= 2;
    return size;
}

static size_t mix(uint64_t a, uint64_t b, uint64_t c)
{
    uint64_t hash = a * 0x9e3779b97f4a7c15u ^ b * 0xc2b2ae3d27d4eb4fu ^ c * 0x165667b19e3779f9u;
    hash ^= hash >> 29;
    return (size_t)(hash * 0xbf58476d1ce4e5b9u >> 17);
}

/* Number of the point at a place, known or new. */
static uint32_t point_at(struct shadow_caster *caster, uint32_t *table, size_t size,
                         const float place[3])
{
    float point[3] = {place[0] + 0.0f, place[1] + 0.0f, place[2] + 0.0f}; /* no -0 */
    uint32_t bits[3];
    memcpy(bits, point, sizeof bits);
    size_t at = mix(bits[0], bits[1], bits[2]) & (size - 1);
    for (; table[at]; at = (at + 1) & (size - 1))
        if (memcmp(caster->points[table[at] - 1], point, sizeof point) == 0)
            return table[at] - 1;
    memcpy(caster->points[caster->points_count], point, sizeof point);
    table[at] = (uint32_t)++caster->points_count;
    return table[at] - 1;
}

static void weld(struct arena *arena, struct arena *passing, const struct mesh *mesh,
                 struct shadow_caster *caster)
{
    size_t size = table_size(mesh->vertices_count);
    uint32_t *table = ARENA_ARRAY(passing, uint32_t, size);
    uint32_t *points = ARENA_ARRAY(passing, uint32_t, mesh->vertices_count);
    caster->points = arena_alloc(arena, mesh->vertices_count, sizeof *caster->points);
    for (size_t i = 0; i < mesh->vertices_count; i++)
        points[i] = point_at(caster, table, size, mesh->positions[i]);
    caster->triangles = arena_alloc(arena, mesh->triangles_count, sizeof *caster->triangles);
    caster->kinds = ARENA_ARRAY(arena, uint8_t, mesh->triangles_count);
    for (size_t p = 0; p < mesh->parts_count; p++) {
        const struct mesh_part *part = &mesh->parts[p];
        bool leaf = material_is_thin(&mesh->materials[part->material]);
        for (uint32_t t = 0; t < part->triangles_count; t++) {
            const uint32_t *from = mesh->triangles[part->first_triangle + t];
            uint32_t *to = caster->triangles[caster->triangles_count];
            for (int i = 0; i < 3; i++)
                to[i] = points[from[i]];
            if (to[0] == to[1] || to[1] == to[2] || to[2] == to[0])
                continue;
            caster->kinds[caster->triangles_count++] = leaf ? SHADOW_LEAF : SHADOW_SOLID;
        }
    }
}

static void find_normals(struct arena *arena, struct shadow_caster *caster)
{
    caster->normals = arena_alloc(arena, caster->triangles_count, sizeof *caster->normals);
    for (size_t t = 0; t < caster->triangles_count; t++) {
        const uint32_t *corner = caster->triangles[t];
        float u[3], v[3];
        for (int i = 0; i < 3; i++) {
            u[i] = caster->points[corner[1]][i] - caster->points[corner[0]][i];
            v[i] = caster->points[corner[2]][i] - caster->points[corner[0]][i];
        }
        for (int i = 0; i < 3; i++)
            caster->normals[t][i] =
                u[(i + 1) % 3] * v[(i + 2) % 3] - u[(i + 2) % 3] * v[(i + 1) % 3];
    }
}

static uint32_t edge_at(struct shadow_caster *caster, uint32_t *table, size_t size, uint32_t low,
                        uint32_t high)
{
    size_t at = mix(low, high, 0) & (size - 1);
    for (; table[at]; at = (at + 1) & (size - 1))
        if (caster->edges[table[at] - 1][0] == low && caster->edges[table[at] - 1][1] == high)
            return table[at] - 1;
    caster->edges[caster->edges_count][0] = low;
    caster->edges[caster->edges_count][1] = high;
    table[at] = (uint32_t)++caster->edges_count;
    return table[at] - 1;
}

static void find_edges(struct arena *arena, struct arena *passing, struct shadow_caster *caster)
{
    size_t corners = 3 * caster->triangles_count, size = table_size(corners);
    uint32_t *table = ARENA_ARRAY(passing, uint32_t, size);
    uint32_t *edge = ARENA_ARRAY(passing, uint32_t, corners);
    caster->edges = arena_alloc(arena, corners, sizeof *caster->edges);
    caster->sides = ARENA_ARRAY(arena, uint32_t, corners);
    for (size_t c = 0; c < corners; c++) {
        const uint32_t *corner = caster->triangles[c / 3];
        uint32_t from = corner[c % 3], to = corner[(c + 1) % 3];
        edge[c] = edge_at(caster, table, size, from < to ? from : to, from < to ? to : from);
    }
    uint32_t *first = caster->first_side = ARENA_ARRAY(arena, uint32_t, caster->edges_count + 1);
    for (size_t c = 0; c < corners; c++)
        first[edge[c] + 1]++;
    for (size_t e = 0; e < caster->edges_count; e++)
        first[e + 1] += first[e];
    uint32_t *filled = ARENA_ARRAY(passing, uint32_t, caster->edges_count);
    for (size_t c = 0; c < corners; c++) {
        const uint32_t *corner = caster->triangles[c / 3];
        bool down = corner[c % 3] > corner[(c + 1) % 3];
        caster->sides[first[edge[c]] + filled[edge[c]]++] = (uint32_t)(2 * (c / 3) + down);
    }
}

static uint32_t root_of(uint32_t *parents, uint32_t point)
{
    while (parents[point] != point)
        point = parents[point] = parents[parents[point]];
    return point;
}

/* Six times the volume of each connected piece of bark or needles; NaN where an edge is not closed.
 */
static void find_volumes(const struct shadow_caster *caster, uint32_t *parents, double *volumes)
{
    for (uint32_t i = 0; i < caster->points_count; i++)
        parents[i] = i;
    for (size_t t = 0; t < caster->triangles_count; t++)
        for (int i = 0; i < 2 && caster->kinds[t] == SHADOW_SOLID; i++)
            parents[root_of(parents, caster->triangles[t][i])] =
                root_of(parents, caster->triangles[t][i + 1]);
    for (size_t t = 0; t < caster->triangles_count; t++) {
        uint32_t root = root_of(parents, caster->triangles[t][0]);
        const float *from = caster->points[root], *to = caster->points[caster->triangles[t][0]];
        for (int i = 0; i < 3 && caster->kinds[t] == SHADOW_SOLID; i++)
            volumes[root] += (double)caster->normals[t][i] * ((double)to[i] - from[i]);
    }
    for (size_t e = 0; e < caster->edges_count; e++) {
        int sum = 0;
        for (uint32_t s = caster->first_side[e]; s < caster->first_side[e + 1]; s++)
            if (caster->kinds[caster->sides[s] / 2] == SHADOW_SOLID)
                sum += caster->sides[s] & 1 ? -1 : 1;
        if (sum != 0)
            volumes[root_of(parents, caster->edges[e][0])] = (double)NAN;
    }
}

static void find_halves(struct arena *arena, struct arena *passing, struct shadow_caster *caster)
{
    uint32_t *parents = ARENA_ARRAY(passing, uint32_t, caster->points_count);
    for (uint32_t i = 0; i < caster->points_count; i++)
        parents[i] = i;
    for (size_t c = 0; c < 3 * caster->triangles_count; c++)
        parents[root_of(parents, caster->triangles[c / 3][c % 3])] =
            root_of(parents, caster->triangles[c / 3][(c + 1) % 3]);
    caster->halves = ARENA_ARRAY(arena, uint8_t, caster->triangles_count);
    for (size_t t = 0; t < caster->triangles_count; t++)
        caster->halves[t] = mix(root_of(parents, caster->triangles[t][0]), 0, 0) & 1;
}

void shadow_caster_build(struct arena *arena, const struct mesh *mesh, bool ground,
                         struct shadow_caster *caster)
{
    struct arena *passing = arena_create(0);
    *caster = (struct shadow_caster){0};
    weld(arena, passing, mesh, caster);
    find_normals(arena, caster);
    find_edges(arena, passing, caster);
    find_halves(arena, passing, caster);
    caster->weights = ARENA_ARRAY(arena, int8_t, caster->triangles_count);
    if (!ground) {
        uint32_t *parents = ARENA_ARRAY(passing, uint32_t, caster->points_count);
        double *volumes = ARENA_ARRAY(passing, double, caster->points_count);
        find_volumes(caster, parents, volumes);
        for (size_t t = 0; t < caster->triangles_count; t++)
            if (caster->kinds[t] == SHADOW_SOLID &&
                !(volumes[root_of(parents, caster->triangles[t][0])] > 0))
                caster->kinds[t] = SHADOW_OPEN;
    }
    arena_destroy(passing);
}

size_t shadow_caster_room(const struct shadow_caster *caster)
{
    return 18 * caster->triangles_count;
}

/* The sun's side of each triangle decides how, and whether, it casts. */
static void find_weights(const struct shadow_caster *caster,
                         const struct shadow_extrusion *extrusion)
{
    const float *toward = extrusion->toward;
    for (size_t t = 0; t < caster->triangles_count; t++) {
        const float *n = caster->normals[t];
        bool facing = n[0] * toward[0] + n[1] * toward[1] + n[2] * toward[2] > 0;
        bool solid = caster->kinds[t] == SHADOW_SOLID && extrusion->silhouette;
        int weight = facing ? !solid : -1;
        caster->weights[t] = (int8_t)(caster->halves[t] == extrusion->half ? weight : 0);
    }
}

static void add_triangle(uint32_t *indices, size_t *count, uint32_t a, uint32_t b, uint32_t c)
{
    indices[*count] = a;
    indices[*count + 1] = b;
    indices[*count + 2] = c;
    *count += 3;
}

/* A reversed triangle has its first two corners swapped: drivers that turn back faces around do the
 * same, and compute the same depths. */
static void add_caps(const struct shadow_caster *caster, uint32_t base,
                     struct shadow_boundary *boundary)
{
    for (size_t t = 0; t < caster->triangles_count; t++) {
        const uint32_t *corner = caster->triangles[t];
        bool leaf = caster->kinds[t] == SHADOW_LEAF, turn = caster->weights[t] < 0;
        if (caster->weights[t])
            add_triangle(leaf ? boundary->leaf_caps : boundary->caps,
                         leaf ? &boundary->leaf_caps_count : &boundary->caps_count,
                         base + corner[turn], base + corner[!turn], base + corner[2]);
    }
}

static void add_wall(struct shadow_boundary *boundary, uint32_t a, uint32_t b, uint32_t ends)
{
    add_triangle(boundary->walls, &boundary->walls_count, a, b, b + ends);
    add_triangle(boundary->walls, &boundary->walls_count, a, b + ends, a + ends);
}

static void add_walls(const struct shadow_caster *caster, uint32_t base, uint32_t ends,
                      struct shadow_boundary *boundary)
{
    for (size_t e = 0; e < caster->edges_count; e++) {
        int sum = 0;
        for (uint32_t s = caster->first_side[e]; s < caster->first_side[e + 1]; s++) {
            int weight = caster->weights[caster->sides[s] / 2];
            sum += caster->sides[s] & 1 ? -weight : weight;
        }
        uint32_t low = base + caster->edges[e][0], high = base + caster->edges[e][1];
        for (; sum > 0; sum--)
            add_wall(boundary, high, low, ends);
        for (; sum < 0; sum++)
            add_wall(boundary, low, high, ends);
    }
}

static void add_all_walls(const struct shadow_caster *caster, uint32_t base, uint32_t ends,
                          struct shadow_boundary *boundary)
{
    for (size_t t = 0; t < caster->triangles_count; t++)
        for (int i = 0; i < 3 && caster->weights[t]; i++) {
            uint32_t a = base + caster->triangles[t][i];
            uint32_t b = base + caster->triangles[t][(i + 1) % 3];
            bool turn = caster->weights[t] < 0;
            add_wall(boundary, turn ? a : b, turn ? b : a, ends);
        }
}

void shadow_caster_extrude(const struct shadow_caster *caster,
                           const struct shadow_extrusion *extrusion,
                           struct shadow_boundary *boundary)
{
    find_weights(caster, extrusion);
    add_caps(caster, extrusion->base, boundary);
    if (extrusion->silhouette)
        add_walls(caster, extrusion->base, extrusion->ends, boundary);
    else
        add_all_walls(caster, extrusion->base, extrusion->ends, boundary);
}
