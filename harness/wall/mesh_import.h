/* Mesh files (OBJ, PLY, glTF, GLB) through assimp, as one soup in the file's own axes and units.
 *
 * Node transforms are applied and instances copied out; polygons are cut into triangles; points and
 * lines are dropped. Colours are linear: glTF's are by definition; vertex colours of OBJ files and
 * of PLY files that store them as integers are sRGB and are decoded; material colours are taken as
 * linear. */
#ifndef TREELINE_WALL_MESH_IMPORT_H
#define TREELINE_WALL_MESH_IMPORT_H

#include "base/arena.h"
#include "base/error.h"

#include <stdbool.h>
#include <stdint.h>

/* A texture as the file names or holds it: one of path, bytes. */
struct import_texture {
    const char *path; /* as written in the file */
    const void *bytes;
    size_t bytes_size;
    char format[16]; /* of bytes: "png", "jpg"; "" when width_px x height_px x 4 BGRA bytes stand
                        there */
    int width_px, height_px;
};

struct import_material {
    const char *name;
    float albedo[3];                              /* linear, clamped to [0, 1] */
    const struct import_texture *color, *opacity; /* NULL: none */
    bool alpha_ignored; /* glTF alphaMode OPAQUE: the texture's alpha says nothing */
    float alpha_cutoff; /* opaque from this alpha on; 0.5 where the file says nothing */
};

struct import_soup {
    size_t vertices_count;
    float (*positions)[3]; /* finite */
    float (*normals)[3];   /* of any length; (0, 0, 0) where the file has none */
    float (*uvs)[2];       /* v = 0 is the texture's lowest row; NULL: no vertex has one */
    float (*colors)[3];    /* in [0, 1]; NULL: no vertex has one */
    size_t triangles_count;
    uint32_t (*triangles)[3];
    uint32_t *triangle_material;
    size_t materials_count;
    struct import_material *materials;
};

/* STATUS_INVALID "FILE: ..." for what assimp cannot read, an empty mesh, more than triangles_limit
 * triangles, a vertex that is not finite (named), or a textured material on faces without texture
 * coordinates. */
enum status mesh_import(struct arena *arena, const char *path, size_t triangles_limit,
                        struct import_soup **soup, struct error *error);

#endif
