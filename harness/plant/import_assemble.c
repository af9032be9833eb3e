/* The placed triangles of an import as a mesh: ordered by part and leaf, with normals, welded. */
#include "base/hash.h"
#include "plant/import_parts.h"
#include "plant/normals.h"

#include <math.h>
#include <string.h>

struct set set_new(struct arena *arena, size_t count)
{
    size_t size = 16;
    while (size < count * 2)
        size *= 2;
    struct set set = {ARENA_ARRAY(arena, uint32_t, size), size - 1};
    memset(set.slots, 0xff, size * sizeof *set.slots);
    return set;
}

uint32_t set_find(struct set *set, const void *records, size_t size, uint32_t number)
{
    const char *all = records, *record = all + size * number;
    size_t slot = hash_bytes(0, record, size) & set->mask;
    while (set->slots[slot] != IMPORT_NONE) {
        if (memcmp(all + size * set->slots[slot], record, size) == 0)
            return set->slots[slot];
        slot = (slot + 1) & set->mask;
    }
    set->slots[slot] = number;
    return number;
}

static bool is_leaf(const struct convert *convert, size_t triangle)
{
    uint32_t material = convert->soup->triangle_material[triangle];
    return convert->mesh->materials[material].kind == MATERIAL_LEAF;
}

void import_cross(const struct convert *convert, size_t triangle, double cross[3])
{
    const uint32_t *t = convert->soup->triangles[triangle];
    float(*p)[3] = convert->soup->positions;
    triangle_cross((const float *)p[t[0]], (const float *)p[t[1]], (const float *)p[t[2]], cross);
}

static void connect_leaves(struct convert *convert)
{
    size_t count = convert->soup->triangles_count;
    bool *leaf = ARENA_ARRAY(convert->scratch, bool, count);
    for (size_t i = 0; i < count; i++)
        leaf[i] = convert->keep[i] && is_leaf(convert, i);
    convert->leaf_root = import_connect(convert->scratch, convert->soup, convert->point, leaf);
}

/* Orders the part's triangles by leaf, leaves by their first triangle; fills the part's elements.
 */
static void order_leaves(struct convert *convert, struct mesh_part *part, uint32_t *leaf_number,
                         const uint32_t *members)
{
    uint32_t count = part->triangles_count, leaves = 0;
    uint32_t *leaf_of = ARENA_ARRAY(convert->scratch, uint32_t, count);
    for (uint32_t i = 0; i < count; i++) {
        uint32_t vertex = convert->soup->triangles[members[i]][0];
        uint32_t root = convert->leaf_root[convert->point[vertex]];
        if (leaf_number[root] == IMPORT_NONE)
            leaf_number[root] = leaves++;
        leaf_of[i] = leaf_number[root];
    }
    uint32_t *first = ARENA_ARRAY(convert->arena, uint32_t, (size_t)leaves + 1);
    for (uint32_t i = 0; i < count; i++)
        first[leaf_of[i] + 1]++;
    for (uint32_t i = 0; i < leaves; i++)
        first[i + 1] += first[i];
    uint32_t *next = ARENA_ARRAY(convert->scratch, uint32_t, leaves);
    memcpy(next, first, leaves * sizeof *next);
    for (uint32_t i = 0; i < count; i++)
        convert->order[part->first_triangle + next[leaf_of[i]]++] = members[i];
    for (uint32_t i = 0; i <= leaves; i++)
        first[i] += part->first_triangle;
    for (uint32_t i = 0; i < count; i++) {
        uint32_t vertex = convert->soup->triangles[members[i]][0];
        leaf_number[convert->leaf_root[convert->point[vertex]]] = IMPORT_NONE;
    }
    part->element_first = first;
    part->elements_count = leaves;
}

static void make_parts(struct convert *convert, size_t kept)
{
    const struct import_soup *soup = convert->soup;
    struct mesh *mesh = convert->mesh;
    uint32_t *counts = ARENA_ARRAY(convert->scratch, uint32_t, mesh->materials_count);
    uint32_t *starts = ARENA_ARRAY(convert->scratch, uint32_t, mesh->materials_count);
    uint32_t *leaf_number = ARENA_ARRAY(convert->scratch, uint32_t, soup->vertices_count);
    uint32_t *members = ARENA_ARRAY(convert->scratch, uint32_t, kept);
    memset(leaf_number, 0xff, soup->vertices_count * sizeof *leaf_number);
    for (size_t i = 0; i < soup->triangles_count; i++)
        counts[soup->triangle_material[i]] += convert->keep[i];
    mesh->parts = ARENA_ARRAY(convert->arena, struct mesh_part, mesh->materials_count);
    uint32_t next = 0;
    for (int kind = MATERIAL_BARK; kind <= MATERIAL_LEAF; kind++)
        for (size_t m = 0; m < mesh->materials_count; m++) {
            if ((int)mesh->materials[m].kind != kind || counts[m] == 0)
                continue;
            mesh->parts[mesh->parts_count++] =
                (struct mesh_part){next, counts[m], (uint32_t)m, NULL, 0};
            starts[m] = next;
            next += counts[m];
        }
    for (size_t i = 0; i < soup->triangles_count; i++)
        if (convert->keep[i])
            members[starts[soup->triangle_material[i]]++] = (uint32_t)i;
    convert->order = ARENA_ARRAY(convert->scratch, uint32_t, kept);
    memcpy(convert->order, members, kept * sizeof *members);
    for (size_t i = 0; i < mesh->parts_count; i++)
        if (mesh->materials[mesh->parts[i].material].kind == MATERIAL_LEAF)
            order_leaves(convert, &mesh->parts[i], leaf_number,
                         members + mesh->parts[i].first_triangle);
}

/* Area-weighted means over all bark triangles at a point. */
static void smooth_bark(struct convert *convert)
{
    const struct import_soup *soup = convert->soup;
    convert->smooth = arena_alloc(convert->scratch, soup->vertices_count, sizeof(float[3]));
    for (size_t i = 0; i < soup->triangles_count; i++) {
        if (!convert->keep[i] || is_leaf(convert, i))
            continue;
        double cross[3];
        import_cross(convert, i, cross);
        for (int corner = 0; corner < 3; corner++)
            for (int k = 0; k < 3; k++)
                convert->smooth[convert->point[soup->triangles[i][corner]]][k] += (float)cross[k];
    }
}

static bool unit(const float from[3], float to[3])
{
    double v[3] = {(double)from[0], (double)from[1], (double)from[2]};
    double length = import_length(v);
    if (!(length > 1e-30) || !isfinite(length))
        return false;
    for (int k = 0; k < 3; k++)
        to[k] = (float)(v[k] / length);
    return true;
}

/* The file's normal, else the smooth one on bark, else the triangle's. */
static void corner_normal(const struct convert *convert, size_t triangle, uint32_t vertex,
                          float normal[3])
{
    if (unit(convert->soup->normals[vertex], normal))
        return;
    if (!is_leaf(convert, triangle) && unit(convert->smooth[convert->point[vertex]], normal))
        return;
    double cross[3];
    import_cross(convert, triangle, cross);
    double length = import_length(cross);
    for (int k = 0; k < 3; k++)
        normal[k] = (float)(cross[k] / length);
}

/* A vertex with all that belongs to it; equal bytes are one vertex. */
struct corner {
    float position[3], normal[3], uv[2], color[3];
};

static void fill_corner(const struct convert *convert, size_t triangle, uint32_t vertex,
                        struct corner *corner)
{
    const struct import_soup *soup = convert->soup;
    const struct import_request *request = convert->request;
    memset(corner, 0, sizeof *corner);
    memcpy(corner->position, soup->positions[vertex], sizeof corner->position);
    corner_normal(convert, triangle, vertex, corner->normal);
    bool overridden = is_leaf(convert, triangle) ? request->leaf_albedo : request->bark_albedo;
    if (soup->uvs)
        memcpy(corner->uv, soup->uvs[vertex], sizeof corner->uv);
    for (int k = 0; k < 3; k++)
        corner->color[k] = soup->colors && !overridden ? soup->colors[vertex][k] : 1;
}

static void make_vertices(struct convert *convert, size_t kept)
{
    const struct import_soup *soup = convert->soup;
    struct mesh *mesh = convert->mesh;
    struct set set = set_new(convert->scratch, 3 * kept);
    struct corner *corners = ARENA_ARRAY(convert->scratch, struct corner, 3 * kept);
    mesh->triangles_count = kept;
    mesh->triangles = arena_alloc(convert->arena, kept, sizeof(uint32_t[3]));
    uint32_t count = 0;
    for (size_t i = 0; i < kept; i++)
        for (int k = 0; k < 3; k++) {
            uint32_t triangle = convert->order[i];
            fill_corner(convert, triangle, soup->triangles[triangle][k], &corners[count]);
            uint32_t number = set_find(&set, corners, sizeof *corners, count);
            mesh->triangles[i][k] = number;
            count += number == count;
        }
    mesh->vertices_count = count;
    mesh->positions = arena_alloc(convert->arena, count, sizeof(float[3]));
    mesh->normals = arena_alloc(convert->arena, count, sizeof(float[3]));
    mesh->uvs = soup->uvs ? arena_alloc(convert->arena, count, sizeof(float[2])) : NULL;
    mesh->colors = soup->colors ? arena_alloc(convert->arena, count, sizeof(float[3])) : NULL;
    for (uint32_t i = 0; i < count; i++) {
        memcpy(mesh->positions[i], corners[i].position, sizeof(float[3]));
        memcpy(mesh->normals[i], corners[i].normal, sizeof(float[3]));
        if (mesh->uvs)
            memcpy(mesh->uvs[i], corners[i].uv, sizeof(float[2]));
        if (mesh->colors)
            memcpy(mesh->colors[i], corners[i].color, sizeof(float[3]));
    }
}

void import_assemble(struct convert *convert, size_t kept)
{
    connect_leaves(convert);
    make_parts(convert, kept);
    smooth_bark(convert);
    make_vertices(convert, kept);
    mesh_bounds(convert->mesh);
}
