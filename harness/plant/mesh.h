/* The exact geometry of a plant: what the reference traces and what every representation is made
 * from. */
#ifndef TREELINE_PLANT_MESH_H
#define TREELINE_PLANT_MESH_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum material_kind { MATERIAL_BARK, MATERIAL_LEAF };

struct texture {
    int width_px, height_px;
    float *rgba; /* height x width x 4, linear RGB, straight alpha; row 0 is v = 0 */
};

struct material {
    char *name;
    enum material_kind kind;
    float albedo[3]; /* linear RGB in [0, 1]; multiplies vertex colours and texture */
    const struct texture
        *texture; /* NULL: none. Wraps; bilinear; a texel is opaque from alpha 0.5 on */
    bool solid;   /* of a leaf: closed pieces that face outward (needles), lit as bark is */
};

/* Whether both sides are lit alike where the scene wants that (EFFECT_TWO_SIDED). */
static inline bool material_is_thin(const struct material *material)
{
    return material->kind == MATERIAL_LEAF && !material->solid;
}

/* A run of triangles of one material. */
struct mesh_part {
    uint32_t first_triangle, triangles_count;
    uint32_t material;
    /* Leaves: where each leaf (or needle, or connected piece) begins, as triangle numbers;
     * elements_count + 1 values, the last is first_triangle + triangles_count. Bark: NULL, 0. */
    uint32_t *element_first;
    uint32_t elements_count;
};

/* Metres, +y up, the plant's foot at the origin. Bark parts come before leaf parts. */
struct mesh {
    size_t vertices_count;
    float (*positions)[3];
    float (*normals)[3]; /* unit; flat on leaves, smooth on bark */
    float (*uvs)[2];     /* NULL when no material has a texture */
    float (*colors)[3];  /* linear albedo a vertex; NULL: 1 */
    size_t triangles_count;
    uint32_t (*triangles)[3]; /* counter-clockwise seen from outside */
    size_t parts_count;
    struct mesh_part *parts;
    size_t materials_count;
    struct material *materials;
    float minimum_m[3], maximum_m[3]; /* bounding box */
    float radius_m; /* of the smallest cylinder about the +y axis that holds the mesh */
};

/* Whether it has no leaves that are lit on both sides. */
static inline bool mesh_is_solid(const struct mesh *mesh)
{
    for (size_t i = 0; i < mesh->materials_count; i++)
        if (material_is_thin(&mesh->materials[i]))
            return false;
    return true;
}

#endif
