/* A plant's triangles packed for drawing: one vertex and index list, a batch for each kind and
 * texture, and levels of simplified bark. */
#ifndef TREELINE_BAKE_DETAIL_H
#define TREELINE_BAKE_DETAIL_H

#include "base/arena.h"
#include "plant/mesh.h"

enum { DETAIL_LEVELS_MAX = 8 };

/* 28 bytes. Shorts where 8 or 10 bits would show: linear albedo is dark, normals are lit. */
struct detail_vertex {
    float position_m[3];
    int16_t normal[4];  /* snorm, w unused */
    uint16_t albedo[4]; /* unorm, material and vertex colour multiplied, w unused */
};

struct detail_range {
    uint32_t first_index, indices_count;
};

struct detail_batch {
    enum material_kind kind;
    const struct texture *texture; /* NULL: none */
    bool thin;                     /* leaves that are not solid */
    bool flat;   /* every triangle has one colour, its normals are the geometric one: it may be lit
                    at any vertex */
    bool closed; /* a closed surface that faces outward: its back faces are never seen */
    struct detail_range levels[DETAIL_LEVELS_MAX]; /* bark: from wide to thin */
};

struct detail {
    size_t vertices_count;
    struct detail_vertex *vertices;
    uint16_t *widths; /* vertices_count: of the bark they belong to, see stout.h */
    float (*uvs)[2];  /* vertices_count; NULL when no material has a texture */
    size_t indices_count;
    uint32_t *indices;
    size_t batches_count;
    struct detail_batch *batches;
    size_t levels_count;               /* level 0: every triangle */
    float errors_m[DETAIL_LEVELS_MAX]; /* how far the bark's surface may have moved */
    size_t triangles_count[DETAIL_LEVELS_MAX];
};

/* simplify: false makes level 0 alone. The arena is best a passing one: it also holds what was
 * needed on the way. */
struct detail *detail_create(struct arena *arena, const struct mesh *mesh, bool simplify);

/* True when every edge of the surface is shared by two triangles that agree on the outside (after
 * welding equal positions) and the volume within is positive. indices: indices_count numbers of
 * vertices. */
bool detail_is_closed(struct arena *arena, const float (*positions)[3], size_t vertices_count,
                      const uint32_t *indices, size_t indices_count);

/* The triangles of a batch's level that are at least so wide (stout.h). */
struct detail_range detail_stout(const struct detail *detail, size_t batch, size_t level,
                                 uint16_t least);

/* Packing of a unit vector and of a colour in [0, 1]; values outside are clamped. */
void detail_pack_normal(const float normal[3], int16_t packed[4]);
void detail_pack_albedo(const float albedo[3], uint16_t packed[4]);

#endif
