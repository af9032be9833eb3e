/* The steps of an import: files named, textures decoded, soup into mesh, mesh to and from bytes. */
#ifndef TREELINE_PLANT_IMPORT_STEPS_H
#define TREELINE_PLANT_IMPORT_STEPS_H

#include "plant/import.h"
#include "wall/mesh_import.h"

struct import_request {
    const char *path;
    double height_m;
    bool z_up;
    const char *leaf; /* NULL: guess */
    const float *leaf_albedo, *bark_albedo;
};

/* Where a file named inside the mesh file at path is: beside the mesh file, by its whole name or
 * its last part. NULL when neither exists. */
const char *import_resolve(struct arena *arena, const char *path, const char *name);

/* Decodes a material's textures into one: linear RGB, alpha scaled so that 0.5 is the cut-off, row
 * 0 at v = 0. NULL when the material has none. has_holes: some texel is transparent. */
enum status import_texture(struct arena *arena, const char *path,
                           const struct import_material *material, const struct texture **texture,
                           bool *has_holes, struct error *error);

/* Places, scales, classifies, orders. textures, has_holes: one for each of the soup's materials. */
enum status import_convert(struct arena *arena, const struct import_request *request,
                           struct import_soup *soup, const struct texture *const *textures,
                           const bool *has_holes, struct mesh **mesh, struct error *error);

/* Of each point, the number of its connected piece: triangles of which take is true connect the
 * points of their vertices. Union by size, path halving: Tarjan 1975, doi:10.1145/321879.321884. */
uint32_t *import_connect(struct arena *arena, const struct import_soup *soup, const uint32_t *point,
                         const bool *take);

/* Of each triangle: does it belong to a connected piece that is flat and open, as a leaf is? */
bool *import_flat(struct arena *arena, const struct import_soup *soup, const uint32_t *point,
                  const bool *keep);

/* A mesh as bytes for the disk cache; decoding uses the bytes in place and returns NULL when they
 * are not whole. */
void *import_encode(struct arena *arena, const struct mesh *mesh, size_t *size);
struct mesh *import_decode(struct arena *arena, void *bytes, size_t size);

#endif
