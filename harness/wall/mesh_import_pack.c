/* A soup of triangles as the bytes of a file, to carry it between two processes of the same
 * program. */
#include "wall/mesh_import_parts.h"

#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

struct head {
    uint64_t vertices_count, triangles_count, materials_count;
    uint64_t has_uvs, has_colors;
};

struct material_head {
    float albedo[3], alpha_cutoff;
    uint32_t alpha_ignored, has_color, has_opacity, name_size;
};

struct texture_head {
    uint64_t bytes_size;
    int32_t width_px, height_px;
    uint32_t path_size; /* with its NUL; 0: none */
    char format[16];
};

static void put(FILE *file, const void *from, size_t count, size_t size)
{
    if (count > 0)
        fwrite(from, size, count, file);
}

static void put_texture(FILE *file, const struct import_texture *texture)
{
    if (!texture)
        return;
    struct texture_head head = {.bytes_size = texture->bytes_size,
                                .width_px = texture->width_px,
                                .height_px = texture->height_px,
                                .path_size =
                                    texture->path ? (uint32_t)strlen(texture->path) + 1 : 0};
    memcpy(head.format, texture->format, sizeof head.format);
    put(file, &head, 1, sizeof head);
    put(file, texture->path, head.path_size, 1);
    put(file, texture->bytes, texture->bytes_size, 1);
}

bool soup_write(int descriptor, const struct import_soup *soup)
{
    FILE *file = fdopen(dup(descriptor), "wb");
    if (!file)
        return false;
    size_t n = soup->vertices_count;
    struct head head = {n, soup->triangles_count, soup->materials_count, soup->uvs != NULL,
                        soup->colors != NULL};
    put(file, &head, 1, sizeof head);
    put(file, soup->positions, n, sizeof(float[3]));
    put(file, soup->normals, n, sizeof(float[3]));
    put(file, soup->uvs, soup->uvs ? n : 0, sizeof(float[2]));
    put(file, soup->colors, soup->colors ? n : 0, sizeof(float[3]));
    put(file, soup->triangles, soup->triangles_count, sizeof(uint32_t[3]));
    put(file, soup->triangle_material, soup->triangles_count, sizeof(uint32_t));
    for (size_t i = 0; i < soup->materials_count; i++) {
        const struct import_material *m = &soup->materials[i];
        struct material_head material = {.alpha_cutoff = m->alpha_cutoff,
                                         .alpha_ignored = m->alpha_ignored,
                                         .has_color = m->color != NULL,
                                         .has_opacity = m->opacity != NULL,
                                         .name_size = (uint32_t)strlen(m->name) + 1};
        memcpy(material.albedo, m->albedo, sizeof material.albedo);
        put(file, &material, 1, sizeof material);
        put(file, m->name, material.name_size, 1);
        put_texture(file, m->color);
        put_texture(file, m->opacity);
    }
    bool good = !ferror(file);
    return fclose(file) == 0 && good;
}

struct cursor {
    struct arena *arena;
    const char *bytes;
    size_t at, size;
    bool torn;
};

/* A copy of the next count items; NULL when the bytes end before. */
static void *take(struct cursor *cursor, uint64_t count, size_t size)
{
    if (cursor->torn || count > (cursor->size - cursor->at) / size) {
        cursor->torn = true;
        return NULL;
    }
    void *copy = arena_alloc(cursor->arena, (size_t)count, size);
    memcpy(copy, cursor->bytes + cursor->at, (size_t)count * size);
    cursor->at += (size_t)count * size;
    return copy;
}

/* The next size bytes as a text; NULL when they do not end in a NUL. */
static const char *take_text(struct cursor *cursor, uint32_t size)
{
    const char *text = take(cursor, size, 1);
    if (text && size > 0 && text[size - 1] == '\0')
        return text;
    cursor->torn = true;
    return NULL;
}

/* A path, the bytes of a picture, or as many texels as its size says. */
static bool texture_is_whole(const struct import_texture *texture)
{
    if (texture->path || memchr(texture->format, '\0', sizeof texture->format) == NULL)
        return texture->path != NULL;
    if (texture->format[0] || texture->width_px <= 0)
        return texture->width_px == 0 && texture->height_px == 0;
    return texture->height_px > 0 &&
           texture->bytes_size / 4 / (size_t)texture->width_px == (size_t)texture->height_px;
}

static const struct import_texture *take_texture(struct cursor *cursor)
{
    const struct texture_head *head = take(cursor, 1, sizeof *head);
    if (!head)
        return NULL;
    struct import_texture *texture = ARENA_NEW(cursor->arena, struct import_texture);
    texture->width_px = head->width_px;
    texture->height_px = head->height_px;
    texture->bytes_size = head->bytes_size;
    memcpy(texture->format, head->format, sizeof texture->format);
    texture->path = head->path_size ? take_text(cursor, head->path_size) : NULL;
    texture->bytes = take(cursor, head->bytes_size, 1);
    cursor->torn |= !texture_is_whole(texture);
    return texture;
}

static void take_material(struct cursor *cursor, struct import_material *to)
{
    const struct material_head *head = take(cursor, 1, sizeof *head);
    if (!head)
        return;
    memcpy(to->albedo, head->albedo, sizeof to->albedo);
    to->alpha_cutoff = head->alpha_cutoff;
    to->alpha_ignored = head->alpha_ignored;
    to->name = take_text(cursor, head->name_size);
    to->color = head->has_color ? take_texture(cursor) : NULL;
    to->opacity = head->has_opacity ? take_texture(cursor) : NULL;
}

/* Every corner is a vertex, every triangle has a material. */
static bool triangles_are_whole(const struct import_soup *soup)
{
    for (size_t i = 0; i < soup->triangles_count; i++) {
        if (soup->triangle_material[i] >= soup->materials_count)
            return false;
        for (int k = 0; k < 3; k++)
            if (soup->triangles[i][k] >= soup->vertices_count)
                return false;
    }
    return true;
}

static struct import_soup *take_soup(struct cursor *cursor)
{
    const struct head *head = take(cursor, 1, sizeof *head);
    if (!head)
        return NULL;
    struct import_soup *soup = ARENA_NEW(cursor->arena, struct import_soup);
    uint64_t n = head->vertices_count;
    soup->vertices_count = n;
    soup->positions = take(cursor, n, sizeof(float[3]));
    soup->normals = take(cursor, n, sizeof(float[3]));
    soup->uvs = head->has_uvs ? take(cursor, n, sizeof(float[2])) : NULL;
    soup->colors = head->has_colors ? take(cursor, n, sizeof(float[3])) : NULL;
    soup->triangles_count = head->triangles_count;
    soup->triangles = take(cursor, head->triangles_count, sizeof(uint32_t[3]));
    soup->triangle_material = take(cursor, head->triangles_count, sizeof(uint32_t));
    soup->materials_count = head->materials_count;
    if (cursor->torn || head->materials_count > cursor->size)
        return NULL;
    soup->materials = ARENA_ARRAY(cursor->arena, struct import_material, head->materials_count);
    for (size_t i = 0; i < soup->materials_count; i++)
        take_material(cursor, &soup->materials[i]);
    bool whole = !cursor->torn && cursor->at == cursor->size && triangles_are_whole(soup);
    return whole ? soup : NULL;
}

struct import_soup *soup_read(struct arena *arena, int file)
{
    struct stat info;
    if (fstat(file, &info) != 0 || info.st_size <= 0)
        return NULL;
    size_t size = (size_t)info.st_size;
    void *bytes = mmap(NULL, size, PROT_READ, MAP_PRIVATE, file, 0);
    if (bytes == MAP_FAILED)
        return NULL;
    struct cursor cursor = {.arena = arena, .bytes = bytes, .size = size};
    struct import_soup *soup = take_soup(&cursor);
    munmap(bytes, size);
    return soup;
}
