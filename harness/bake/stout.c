/* Widths of stems, from the connected pieces of bark. */
#include "bake/stout.h"
#include "bake/cull.h"
#include "wall/simplify.h"

#include <math.h>
#include <string.h>

/* A connected piece; of a root, the sums. */
struct piece {
    uint32_t parent;
    float low[3], high[3];
    double area_m2;
};

static uint32_t piece_root(struct piece *pieces, uint32_t at)
{
    while (pieces[at].parent != at) {
        pieces[at].parent = pieces[pieces[at].parent].parent;
        at = pieces[at].parent;
    }
    return at;
}

uint16_t stout_pack(float width_m)
{
    return (uint16_t)lrintf(fminf(fmaxf(width_m * 16384, 0), 65535));
}

static double triangle_m2(const float *a, const float *b, const float *c)
{
    double n2 = 0;
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        double n = ((double)b[j] - a[j]) * ((double)c[k] - a[k]) -
                   ((double)b[k] - a[k]) * ((double)c[j] - a[j]);
        n2 += n * n;
    }
    return 0.5 * sqrt(n2);
}

/* Joins the corners of a triangle and adds its area and extent to their piece. */
static void join_triangle(struct piece *pieces, const struct mesh *mesh, const uint32_t *welded,
                          const uint32_t *corners, bool measure)
{
    uint32_t root = piece_root(pieces, welded[corners[0]]);
    for (int i = 1; i < 3 && !measure; i++)
        pieces[piece_root(pieces, welded[corners[i]])].parent = root;
    if (!measure)
        return;
    struct piece *piece = &pieces[root];
    for (int i = 0; i < 3; i++)
        for (int axis = 0; axis < 3; axis++) {
            float at = mesh->positions[corners[i]][axis];
            piece->low[axis] = piece->area_m2 > 0 || i > 0 ? fminf(piece->low[axis], at) : at;
            piece->high[axis] = piece->area_m2 > 0 || i > 0 ? fmaxf(piece->high[axis], at) : at;
        }
    piece->area_m2 += triangle_m2(mesh->positions[corners[0]], mesh->positions[corners[1]],
                                  mesh->positions[corners[2]]) +
                      1e-30;
}

static void walk_bark(struct piece *pieces, const struct mesh *mesh, const uint32_t *welded,
                      bool measure)
{
    for (size_t p = 0; p < mesh->parts_count; p++) {
        const struct mesh_part *part = &mesh->parts[p];
        bool bark = mesh->materials[part->material].kind == MATERIAL_BARK;
        for (uint32_t t = 0; bark && t < part->triangles_count; t++)
            join_triangle(pieces, mesh, welded, mesh->triangles[part->first_triangle + t], measure);
    }
}

/* Vertices up to the last that bark has: a conifer's needles have a hundred times as many behind.
 */
static size_t bark_vertices(const struct mesh *mesh)
{
    size_t end = 0;
    for (size_t p = 0; p < mesh->parts_count; p++) {
        const struct mesh_part *part = &mesh->parts[p];
        bool bark = mesh->materials[part->material].kind == MATERIAL_BARK;
        for (uint32_t t = 0; bark && t < part->triangles_count; t++)
            for (int i = 0; i < 3; i++) {
                size_t vertex = mesh->triangles[part->first_triangle + t][i];
                end = vertex >= end ? vertex + 1 : end;
            }
    }
    return end;
}

uint16_t *stout_widths(struct arena *arena, const struct mesh *mesh)
{
    uint16_t *widths = ARENA_ARRAY(arena, uint16_t, mesh->vertices_count);
    size_t count = bark_vertices(mesh);
    struct arena *passing = arena_create(0);
    uint32_t *welded = ARENA_ARRAY(passing, uint32_t, count);
    struct piece *pieces = ARENA_ARRAY(passing, struct piece, count);
    simplify_weld((const float(*)[3])mesh->positions, count, welded);
    for (size_t i = 0; i < count; i++)
        pieces[i].parent = (uint32_t)i;
    walk_bark(pieces, mesh, welded, false);
    walk_bark(pieces, mesh, welded, true);
    for (size_t i = 0; i < count; i++) {
        const struct piece *piece = &pieces[piece_root(pieces, welded[i])];
        float length = 0;
        for (int axis = 0; axis < 3; axis++) {
            float extent = piece->high[axis] - piece->low[axis];
            length += extent * extent;
        }
        length = sqrtf(length);
        if (piece->area_m2 > 0 && length > 0)
            widths[i] = stout_pack((float)(piece->area_m2 / 3.14159265358979324) / length);
    }
    arena_destroy(passing);
    return widths;
}

void stout_order(uint32_t *indices, size_t indices_count, const uint16_t *widths)
{
    size_t count = indices_count / 3;
    struct arena *passing = arena_create(0);
    float *keys = ARENA_ARRAY(passing, float, 2 * count);
    uint32_t *order = ARENA_ARRAY(passing, uint32_t, 2 * count);
    uint32_t *copy = ARENA_ARRAY(passing, uint32_t, indices_count);
    memcpy(copy, indices, indices_count * sizeof *copy);
    for (size_t t = 0; t < count; t++) {
        keys[t] = widths[indices[3 * t]];
        order[t] = (uint32_t)t;
    }
    cull_sort(keys, order, keys + count, order + count, count, true);
    for (size_t t = 0; t < count; t++)
        memcpy(indices + 3 * t, copy + 3 * (size_t)order[t], 3 * sizeof *indices);
    arena_destroy(passing);
}

size_t stout_count(const uint32_t *indices, size_t indices_count, const uint16_t *widths,
                   uint16_t least)
{
    size_t count = 0;
    while (count < indices_count && widths[indices[count]] >= least)
        count += 3;
    return count;
}
