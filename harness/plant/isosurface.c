/* Marching tetrahedra. */
#include "plant/isosurface.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

/* An edge of the triangulation goes from a point to one that is a step further along one, two or
 * three axes; its number is the sum of 1 (x), 2 (y), 4 (z). */
enum { EDGES = 8 };

struct extraction {
    struct arena *arena;
    const struct field *field;
    struct isosurface surface;
    size_t vertices_capacity, triangles_capacity;
    uint32_t *layers[2]; /* vertices + 1 on the edges from the points of two layers: points x EDGES
                            each; 0: none yet */
};

static void *grown(struct arena *arena, const void *from, size_t count, size_t *capacity,
                   size_t size)
{
    *capacity = *capacity ? 2 * *capacity : 4096;
    void *to = arena_alloc(arena, *capacity, size);
    if (count > 0)
        memcpy(to, from, count * size);
    return to;
}

static float value_at(const struct field *field, const size_t at[3])
{
    return field->values[(at[2] * field->points[1] + at[1]) * field->points[0] + at[0]];
}

static uint32_t vertex_new(struct extraction *extraction, const size_t from[3], int edge)
{
    const struct field *field = extraction->field;
    struct isosurface *surface = &extraction->surface;
    if (surface->vertices_count == extraction->vertices_capacity)
        surface->positions_m =
            grown(extraction->arena, surface->positions_m, surface->vertices_count,
                  &extraction->vertices_capacity, sizeof *surface->positions_m);
    size_t to[3];
    for (int i = 0; i < 3; i++)
        to[i] = from[i] + (size_t)(edge >> i & 1);
    double a = (double)value_at(field, from), b = (double)value_at(field, to);
    double t = fmin(fmax(a / (a - b), 0.02), 0.98);
    for (int i = 0; i < 3; i++)
        surface->positions_m[surface->vertices_count][i] =
            (float)(field->minimum_m[i] +
                    field->cell_m * ((double)from[i] + (edge >> i & 1 ? t : 0)));
    return (uint32_t)surface->vertices_count++;
}

/* The vertex between two corners of the cell at base; corners are sums of 1, 2, 4 like edges. */
static uint32_t vertex_between(struct extraction *extraction, const size_t base[3], int a, int b)
{
    int low = a & b, edge = a ^ b;
    size_t from[3];
    for (int i = 0; i < 3; i++)
        from[i] = base[i] + (size_t)(low >> i & 1);
    const size_t *points = extraction->field->points;
    uint32_t *kept =
        &extraction
             ->layers[from[2] - base[2]][(from[1] * points[0] + from[0]) * EDGES + (size_t)edge];
    if (*kept == 0)
        *kept = vertex_new(extraction, from, edge) + 1;
    return *kept - 1;
}

static void triangle_add(struct extraction *extraction, uint32_t a, uint32_t b, uint32_t c)
{
    struct isosurface *surface = &extraction->surface;
    if (surface->triangles_count == extraction->triangles_capacity)
        surface->triangles = grown(extraction->arena, surface->triangles, surface->triangles_count,
                                   &extraction->triangles_capacity, sizeof *surface->triangles);
    uint32_t *triangle = surface->triangles[surface->triangles_count++];
    triangle[0] = a, triangle[1] = b, triangle[2] = c;
}

/* corners: of a tetrahedron of positive volume; inside: which of them are. They are put in order
 * [inside..., outside...] by even permutations, so that the volume stays positive. */
static void tetrahedron(struct extraction *extraction, const size_t base[3], const int corners[4],
                        const bool inside[4])
{
    static const unsigned char even[12][4] = {
        {0, 1, 2, 3}, {0, 2, 3, 1}, {0, 3, 1, 2}, {1, 0, 3, 2}, {1, 2, 0, 3}, {1, 3, 2, 0},
        {2, 0, 1, 3}, {2, 1, 3, 0}, {2, 3, 0, 1}, {3, 0, 2, 1}, {3, 1, 0, 2}, {3, 2, 1, 0},
    };
    int count = inside[0] + inside[1] + inside[2] + inside[3];
    if (count == 0 || count == 4)
        return;
    int p = 0;
    for (bool sorted = false; !sorted; p += !sorted) {
        sorted = true;
        for (int k = 0; k < 4; k++)
            sorted = sorted && inside[even[p][k]] == (k < count);
    }
    int v[4];
    for (int k = 0; k < 4; k++)
        v[k] = corners[even[p][k]];
    uint32_t ad = vertex_between(extraction, base, v[0], v[3]);
    if (count == 1) {
        uint32_t ab = vertex_between(extraction, base, v[0], v[1]);
        triangle_add(extraction, ab, vertex_between(extraction, base, v[0], v[2]), ad);
        return;
    }
    uint32_t bd = vertex_between(extraction, base, v[1], v[3]);
    if (count == 3) {
        triangle_add(extraction, ad, bd, vertex_between(extraction, base, v[2], v[3]));
        return;
    }
    uint32_t ac = vertex_between(extraction, base, v[0], v[2]);
    triangle_add(extraction, ac, ad, bd);
    triangle_add(extraction, ac, bd, vertex_between(extraction, base, v[1], v[2]));
}

static void cell(struct extraction *extraction, const size_t base[3])
{
    /* From corner 0 to corner 7, an axis after another; positive volumes. */
    static const int tetrahedra[6][4] = {
        {0, 1, 3, 7}, {0, 3, 2, 7}, {0, 2, 6, 7}, {0, 6, 4, 7}, {0, 4, 5, 7}, {0, 5, 1, 7},
    };
    bool inside[8];
    int count = 0;
    for (int corner = 0; corner < 8; corner++) {
        size_t at[3];
        for (int i = 0; i < 3; i++)
            at[i] = base[i] + (size_t)(corner >> i & 1);
        inside[corner] = value_at(extraction->field, at) < 0;
        count += inside[corner];
    }
    if (count == 0 || count == 8)
        return;
    for (int k = 0; k < 6; k++) {
        const int *c = tetrahedra[k];
        tetrahedron(extraction, base, c,
                    (bool[4]){inside[c[0]], inside[c[1]], inside[c[2]], inside[c[3]]});
    }
}

struct isosurface isosurface_extract(struct arena *arena, const struct field *field)
{
    struct extraction extraction = {.arena = arena, .field = field};
    size_t layer = field->points[0] * field->points[1] * EDGES;
    for (int k = 0; k < 2; k++)
        extraction.layers[k] = ARENA_ARRAY(arena, uint32_t, layer);
    for (size_t z = 0; z + 1 < field->points[2]; z++) {
        for (size_t y = 0; y + 1 < field->points[1]; y++)
            for (size_t x = 0; x + 1 < field->points[0]; x++)
                cell(&extraction, (size_t[3]){x, y, z});
        uint32_t *done = extraction.layers[0];
        extraction.layers[0] = extraction.layers[1];
        extraction.layers[1] = memset(done, 0, layer * sizeof *done);
    }
    return extraction.surface;
}
