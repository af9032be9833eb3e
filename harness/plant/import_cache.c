/* An imported mesh as bytes for the disk cache. */
#include "plant/import_steps.h"

#include <string.h>

/* All sizes in one place; what they count follows in the order of `layout`. */
struct packed {
    uint64_t vertices_count, triangles_count, parts_count, materials_count;
    uint32_t has_uvs, has_colors;
};

struct packed_material {
    float albedo[3];
    uint32_t kind;
    int32_t texture_width_px, texture_height_px; /* 0: none */
    uint32_t name_size;                          /* with its NUL */
};

struct packed_part {
    uint32_t first_triangle, triangles_count, material, elements_count;
};

struct cursor {
    char *bytes; /* NULL: only count */
    size_t at, size;
};

static void put(struct cursor *cursor, const void *from, size_t count, size_t size)
{
    if (cursor->bytes && count * size > 0)
        memcpy(cursor->bytes + cursor->at, from, count * size);
    cursor->at += count * size;
}

/* The next count items in place, or NULL when the bytes end before. */
static void *take(struct cursor *cursor, uint64_t count, size_t size)
{
    size_t left = cursor->size - cursor->at;
    if (!cursor->bytes || count > left / size) {
        cursor->bytes = NULL;
        return NULL;
    }
    void *here = cursor->bytes + cursor->at;
    cursor->at += (size_t)count * size;
    return here;
}

static size_t texels(const struct texture *texture)
{
    return texture ? (size_t)texture->width_px * (size_t)texture->height_px : 0;
}

static void put_mesh(struct cursor *cursor, const struct mesh *mesh)
{
    size_t n = mesh->vertices_count;
    struct packed head = {n,
                          mesh->triangles_count,
                          mesh->parts_count,
                          mesh->materials_count,
                          mesh->uvs != NULL,
                          mesh->colors != NULL};
    put(cursor, &head, 1, sizeof head);
    put(cursor, mesh->positions, n, sizeof(float[3]));
    put(cursor, mesh->normals, n, sizeof(float[3]));
    put(cursor, mesh->uvs, mesh->uvs ? n : 0, sizeof(float[2]));
    put(cursor, mesh->colors, mesh->colors ? n : 0, sizeof(float[3]));
    put(cursor, mesh->triangles, mesh->triangles_count, sizeof(uint32_t[3]));
    for (size_t i = 0; i < mesh->parts_count; i++) {
        const struct mesh_part *part = &mesh->parts[i];
        struct packed_part packed = {part->first_triangle, part->triangles_count, part->material,
                                     part->elements_count};
        put(cursor, &packed, 1, sizeof packed);
        put(cursor, part->element_first, part->element_first ? part->elements_count + 1 : 0,
            sizeof(uint32_t));
    }
    for (size_t i = 0; i < mesh->materials_count; i++) {
        const struct material *m = &mesh->materials[i];
        struct packed_material packed = {
            .kind = m->kind,
            .texture_width_px = m->texture ? m->texture->width_px : 0,
            .texture_height_px = m->texture ? m->texture->height_px : 0,
            .name_size = (uint32_t)strlen(m->name) + 1,
        };
        memcpy(packed.albedo, m->albedo, sizeof packed.albedo);
        put(cursor, &packed, 1, sizeof packed);
        put(cursor, m->texture ? m->texture->rgba : NULL, texels(m->texture), sizeof(float[4]));
    }
    for (size_t i = 0; i < mesh->materials_count; i++)
        put(cursor, mesh->materials[i].name, strlen(mesh->materials[i].name) + 1, 1);
}

void *import_encode(struct arena *arena, const struct mesh *mesh, size_t *size)
{
    struct cursor cursor = {0};
    put_mesh(&cursor, mesh);
    *size = cursor.at;
    cursor = (struct cursor){.bytes = arena_alloc(arena, *size, 1)};
    put_mesh(&cursor, mesh);
    return cursor.bytes;
}

static bool take_parts(struct arena *arena, struct cursor *cursor, struct mesh *mesh)
{
    if (mesh->parts_count > cursor->size)
        return false;
    mesh->parts = ARENA_ARRAY(arena, struct mesh_part, mesh->parts_count);
    for (size_t i = 0; i < mesh->parts_count; i++) {
        const struct packed_part *packed = take(cursor, 1, sizeof *packed);
        if (!packed)
            return false;
        mesh->parts[i] = (struct mesh_part){packed->first_triangle, packed->triangles_count,
                                            packed->material, NULL, packed->elements_count};
        if (packed->elements_count > 0)
            mesh->parts[i].element_first =
                take(cursor, (uint64_t)packed->elements_count + 1, sizeof(uint32_t));
    }
    return cursor->bytes != NULL;
}

static bool take_materials(struct arena *arena, struct cursor *cursor, struct mesh *mesh)
{
    if (mesh->materials_count > cursor->size)
        return false;
    mesh->materials = ARENA_ARRAY(arena, struct material, mesh->materials_count);
    uint32_t *name_sizes = ARENA_ARRAY(arena, uint32_t, mesh->materials_count);
    for (size_t i = 0; i < mesh->materials_count; i++) {
        const struct packed_material *packed = take(cursor, 1, sizeof *packed);
        if (!packed || packed->texture_width_px < 0 || packed->texture_height_px < 0)
            return false;
        struct material *m = &mesh->materials[i];
        memcpy(m->albedo, packed->albedo, sizeof m->albedo);
        m->kind = (enum material_kind)packed->kind;
        name_sizes[i] = packed->name_size;
        if (packed->texture_width_px > 0) {
            struct texture *texture = ARENA_NEW(arena, struct texture);
            texture->width_px = packed->texture_width_px;
            texture->height_px = packed->texture_height_px;
            texture->rgba = take(cursor, texels(texture), sizeof(float[4]));
            m->texture = texture;
        }
    }
    for (size_t i = 0; i < mesh->materials_count; i++) {
        char *name = take(cursor, name_sizes[i], 1);
        if (!name || name_sizes[i] == 0 || name[name_sizes[i] - 1] != '\0')
            return false;
        mesh->materials[i].name = name;
    }
    return cursor->bytes != NULL;
}

struct mesh *import_decode(struct arena *arena, void *bytes, size_t size)
{
    struct cursor cursor = {.bytes = bytes, .size = size};
    const struct packed *head = take(&cursor, 1, sizeof *head);
    if (!head)
        return NULL;
    struct mesh *mesh = ARENA_NEW(arena, struct mesh);
    mesh->vertices_count = head->vertices_count;
    mesh->triangles_count = head->triangles_count;
    mesh->parts_count = head->parts_count;
    mesh->materials_count = head->materials_count;
    mesh->positions = take(&cursor, head->vertices_count, sizeof(float[3]));
    mesh->normals = take(&cursor, head->vertices_count, sizeof(float[3]));
    mesh->uvs = head->has_uvs ? take(&cursor, head->vertices_count, sizeof(float[2])) : NULL;
    mesh->colors = head->has_colors ? take(&cursor, head->vertices_count, sizeof(float[3])) : NULL;
    mesh->triangles = take(&cursor, head->triangles_count, sizeof(uint32_t[3]));
    if (!cursor.bytes || !take_parts(arena, &cursor, mesh) ||
        !take_materials(arena, &cursor, mesh) || cursor.at != size)
        return NULL;
    mesh_bounds(mesh);
    return mesh;
}
