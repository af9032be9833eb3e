/* Packing a plant's triangles: batches by kind and texture, bark levels by edge collapse
 * (meshoptimizer). */
#include "bake/detail.h"
#include "bake/stout.h"
#include "wall/simplify.h"

#include <math.h>
#include <string.h>

static int16_t snorm(float value)
{
    return (int16_t)lrintf(fminf(fmaxf(value, -1.0f), 1.0f) * 32767.0f);
}

static uint16_t unorm(float value)
{
    return (uint16_t)lrintf(fminf(fmaxf(value, 0.0f), 1.0f) * 65535.0f);
}

void detail_pack_normal(const float normal[3], int16_t packed[4])
{
    for (int i = 0; i < 3; i++)
        packed[i] = snorm(normal[i]);
    packed[3] = 0;
}

void detail_pack_albedo(const float albedo[3], uint16_t packed[4])
{
    for (int i = 0; i < 3; i++)
        packed[i] = unorm(albedo[i]);
    packed[3] = 65535;
}

/* Signed count of a welded edge's uses. */
struct edge {
    uint64_t key; /* low end << 32 | high end, plus 1; 0: free */
    int balance, uses;
};

static void count_edge(struct edge *edges, size_t mask, uint32_t a, uint32_t b)
{
    uint64_t key = (a < b ? (uint64_t)a << 32 | b : (uint64_t)b << 32 | a) + 1;
    size_t at = (size_t)(key * 0x9e3779b97f4a7c15u >> 20) & mask;
    while (edges[at].key != 0 && edges[at].key != key)
        at = (at + 1) & mask;
    edges[at].key = key;
    edges[at].balance += a < b ? 1 : -1;
    edges[at].uses++;
}

bool detail_is_closed(struct arena *arena, const float (*positions)[3], size_t vertices_count,
                      const uint32_t *indices, size_t indices_count)
{
    size_t room = 16;
    while (room < 2 * indices_count)
        room *= 2;
    struct edge *edges = ARENA_ARRAY(arena, struct edge, room);
    uint32_t *welded = ARENA_ARRAY(arena, uint32_t, vertices_count);
    double volume = 0;
    simplify_weld(positions, vertices_count, welded);
    for (size_t i = 0; i + 2 < indices_count; i += 3) {
        const float *a = positions[indices[i]], *b = positions[indices[i + 1]];
        const float *c = positions[indices[i + 2]];
        volume += (double)a[0] * (b[1] * c[2] - b[2] * c[1]) +
                  (double)a[1] * (b[2] * c[0] - b[0] * c[2]) +
                  (double)a[2] * (b[0] * c[1] - b[1] * c[0]);
        for (size_t j = 0; j < 3; j++) {
            uint32_t from = welded[indices[i + j]], to = welded[indices[i + (j + 1) % 3]];
            if (from != to)
                count_edge(edges, room - 1, from, to);
        }
    }
    for (size_t i = 0; i < room; i++)
        if (edges[i].balance != 0 || edges[i].uses > 2)
            return false;
    return volume > 0;
}

static bool triangle_is_flat(const struct mesh *mesh, const uint32_t *corners)
{
    const float *a = mesh->positions[corners[0]], *b = mesh->positions[corners[1]];
    const float *c = mesh->positions[corners[2]];
    float u[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
    float v[3] = {c[0] - a[0], c[1] - a[1], c[2] - a[2]};
    float n[3] = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
    float length = sqrtf(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    for (int i = 0; i < 3; i++) {
        const float *m = mesh->normals[corners[i]];
        if (n[0] * m[0] + n[1] * m[1] + n[2] * m[2] < 0.99999f * length)
            return false;
        if (mesh->colors &&
            memcmp(mesh->colors[corners[0]], mesh->colors[corners[i]], sizeof *mesh->colors) != 0)
            return false;
    }
    return true;
}

/* What detail_create fills, with room for everything. */
struct packer {
    struct detail *detail;
    const struct mesh *mesh;
    uint32_t *renumbered;  /* mesh vertex -> packed vertex + 1 of the part at work */
    uint16_t *widths;      /* of the mesh's vertices */
    float (*positions)[3]; /* of the packed vertices, for the simplifier */
    size_t *ends; /* of a batch: its vertices come before, so that a pass over them does not
                     walk over those of a million needles that were packed behind */
};

static uint32_t pack_vertex(struct packer *packer, uint32_t vertex, const struct material *material)
{
    const struct mesh *mesh = packer->mesh;
    struct detail *detail = packer->detail;
    if (packer->renumbered[vertex] > 0)
        return packer->renumbered[vertex] - 1;
    uint32_t at = (uint32_t)detail->vertices_count++;
    struct detail_vertex *packed = &detail->vertices[at];
    float albedo[3];
    for (int i = 0; i < 3; i++)
        albedo[i] = material->albedo[i] * (mesh->colors ? mesh->colors[vertex][i] : 1.0f);
    memcpy(packed->position_m, mesh->positions[vertex], sizeof packed->position_m);
    memcpy(packer->positions[at], mesh->positions[vertex], sizeof *packer->positions);
    detail_pack_normal(mesh->normals[vertex], packed->normal);
    detail_pack_albedo(albedo, packed->albedo);
    if (detail->uvs)
        memcpy(detail->uvs[at], mesh->uvs[vertex], sizeof *detail->uvs);
    detail->widths[at] = packer->widths[vertex];
    packer->renumbered[vertex] = at + 1;
    return at;
}

static void pack_part(struct packer *packer, const struct mesh_part *part,
                      struct detail_batch *batch)
{
    const struct mesh *mesh = packer->mesh;
    struct detail *detail = packer->detail;
    const struct material *material = &mesh->materials[part->material];
    memset(packer->renumbered, 0, mesh->vertices_count * sizeof *packer->renumbered);
    for (uint32_t t = 0; t < part->triangles_count; t++) {
        const uint32_t *corners = mesh->triangles[part->first_triangle + t];
        for (int i = 0; i < 3; i++)
            detail->indices[detail->indices_count++] = pack_vertex(packer, corners[i], material);
        batch->flat = batch->flat && triangle_is_flat(mesh, corners);
    }
    batch->levels[0].indices_count += 3 * part->triangles_count;
}

static const struct texture *part_texture(const struct mesh *mesh, size_t part)
{
    return mesh->uvs ? mesh->materials[mesh->parts[part].material].texture : NULL;
}

static enum material_kind part_kind(const struct mesh *mesh, size_t part)
{
    return mesh->materials[mesh->parts[part].material].kind;
}

static bool part_is_thin(const struct mesh *mesh, size_t part)
{
    return material_is_thin(&mesh->materials[mesh->parts[part].material]);
}

static bool parts_are_alike(const struct mesh *mesh, size_t a, size_t b)
{
    return part_texture(mesh, a) == part_texture(mesh, b) &&
           part_kind(mesh, a) == part_kind(mesh, b) &&
           part_is_thin(mesh, a) == part_is_thin(mesh, b);
}

/* A better order for the vertex cache, and bark from wide to thin. */
static void order_indices(const struct detail *detail, enum material_kind kind, uint32_t *indices,
                          size_t count, size_t vertices_count)
{
    simplify_order(indices, count, vertices_count);
    if (kind == MATERIAL_BARK)
        stout_order(indices, count, detail->widths);
}

/* All parts of one kind and texture, from the first of them on. That solid leaves are closed is
 * what they are; bark is looked at. */
static void pack_batch(struct packer *packer, struct arena *arena, size_t first_part)
{
    const struct mesh *mesh = packer->mesh;
    struct detail *detail = packer->detail;
    const struct texture *texture = part_texture(mesh, first_part);
    enum material_kind kind = part_kind(mesh, first_part);
    for (size_t p = 0; p < first_part; p++)
        if (parts_are_alike(mesh, p, first_part))
            return;
    struct detail_batch *batch = &detail->batches[detail->batches_count++];
    *batch = (struct detail_batch){
        .kind = kind, .texture = texture, .thin = part_is_thin(mesh, first_part), .flat = true};
    batch->levels[0].first_index = (uint32_t)detail->indices_count;
    for (size_t p = first_part; p < mesh->parts_count; p++)
        if (parts_are_alike(mesh, p, first_part))
            pack_part(packer, &mesh->parts[p], batch);
    packer->ends[batch - detail->batches] = detail->vertices_count;
    uint32_t *indices = detail->indices + batch->levels[0].first_index;
    size_t count = batch->levels[0].indices_count;
    if (kind == MATERIAL_BARK)
        batch->closed = !texture && detail_is_closed(arena, (const float(*)[3])packer->positions,
                                                     detail->vertices_count, indices, count);
    else
        batch->closed = !texture && !batch->thin;
    if (kind == MATERIAL_BARK || batch->thin) /* needles are in order, one after the other */
        order_indices(detail, kind, indices, count, detail->vertices_count);
}

static size_t level_triangles(const struct detail *detail, size_t level)
{
    size_t indices = 0;
    for (size_t b = 0; b < detail->batches_count; b++)
        indices += detail->batches[b].levels[level].indices_count;
    return indices / 3;
}

struct detail_range detail_stout(const struct detail *detail, size_t batch, size_t level,
                                 uint16_t least)
{
    struct detail_range range = detail->batches[batch].levels[level];
    range.indices_count = (uint32_t)stout_count(detail->indices + range.first_index,
                                                range.indices_count, detail->widths, least);
    return range;
}

/* Adds a level of bark within an error; false when it saves too little to be worth its memory. */
static bool add_level(struct packer *packer, float error_m)
{
    struct detail *detail = packer->detail;
    size_t level = detail->levels_count, begin = detail->indices_count, bark = 0, last_bark = 0;
    float worst_m = 0;
    for (size_t b = 0; b < detail->batches_count; b++) {
        struct detail_batch *batch = &detail->batches[b];
        struct detail_range full = batch->levels[0];
        batch->levels[level] = full;
        if (batch->kind != MATERIAL_BARK)
            continue;
        float reached_m;
        uint32_t *indices = detail->indices + detail->indices_count;
        size_t count = simplify_indices((const float(*)[3])packer->positions, packer->ends[b],
                                        detail->indices + full.first_index, full.indices_count,
                                        error_m, indices, &reached_m);
        order_indices(detail, batch->kind, indices, count, packer->ends[b]);
        batch->levels[level] =
            (struct detail_range){(uint32_t)detail->indices_count, (uint32_t)count};
        detail->indices_count += count;
        worst_m = fmaxf(worst_m, reached_m);
        bark += count;
        last_bark += batch->levels[level - 1].indices_count;
    }
    if (4 * bark > 3 * last_bark || bark == 0) {
        detail->indices_count = begin;
        return false;
    }
    detail->errors_m[level] = worst_m;
    detail->triangles_count[level] = level_triangles(detail, level);
    detail->levels_count++;
    return true;
}

struct detail *detail_create(struct arena *arena, const struct mesh *mesh, bool simplify)
{
    struct detail *detail = ARENA_NEW(arena, struct detail);
    size_t bark_indices = 0, corners = 3 * mesh->triangles_count;
    for (size_t p = 0; p < mesh->parts_count; p++)
        if (part_kind(mesh, p) == MATERIAL_BARK)
            bark_indices += 3 * (size_t)mesh->parts[p].triangles_count;
    struct packer packer = {.detail = detail,
                            .mesh = mesh,
                            .renumbered = ARENA_ARRAY(arena, uint32_t, mesh->vertices_count),
                            .positions = arena_alloc(arena, corners, sizeof(float[3])),
                            .ends = ARENA_ARRAY(arena, size_t, mesh->parts_count)};
    packer.widths = stout_widths(arena, mesh);
    detail->widths = ARENA_ARRAY(arena, uint16_t, corners);
    detail->vertices = ARENA_ARRAY(arena, struct detail_vertex, corners);
    detail->uvs = mesh->uvs ? arena_alloc(arena, corners, sizeof(float[2])) : NULL;
    /* a level holds at most 3/4 of the bark before it: 4 times the bark in all, and one that is
     * tried */
    detail->indices = ARENA_ARRAY(arena, uint32_t, corners + (simplify ? 4 * bark_indices : 0));
    detail->batches = ARENA_ARRAY(arena, struct detail_batch, mesh->parts_count);
    for (size_t p = 0; p < mesh->parts_count; p++)
        pack_batch(&packer, arena, p);
    detail->levels_count = 1;
    detail->triangles_count[0] = level_triangles(detail, 0);
    float extent_m = fmaxf(mesh->maximum_m[1] - mesh->minimum_m[1], 2 * mesh->radius_m);
    for (int bits = 14; bits >= 4 && simplify && detail->levels_count < DETAIL_LEVELS_MAX; bits--)
        add_level(&packer, ldexpf(extent_m, -bits));
    return detail;
}
