/* A plant: a name, parameters or a file, and a mesh that is built when first asked for. */
#ifndef TREELINE_PLANT_PLANT_H
#define TREELINE_PLANT_PLANT_H

#include "base/arena.h"
#include "base/error.h"
#include "plant/mesh.h"

struct plant; /* opaque; belongs to an arena */
struct conifer;

/* The plants that can be generated, ends with NULL: "poplar", "oak", "hypertexture". */
extern const char *const plant_generators[];

/* A generated plant: generator's name, its options as text ("height=20,seed=3", NULL: defaults).
 * STATUS_NOT_FOUND with the list of names, STATUS_INVALID from the option table. Nothing is built
 * yet. */
enum status plant_generated(struct arena *arena, const char *generator, const char *options,
                            struct plant **plant, struct error *error);

/* A plant of a grammar (plant/lsystem.h, scenes/plants/): the file, and its parameters as text
 * ("boughs=6,seed=3", NULL: the file's own). The file is read and checked here; nothing is grown.
 */
enum status plant_lsystem(struct arena *arena, const char *path, const char *options,
                          struct plant **plant, struct error *error);

struct plant_import {
    double height_m;  /* 0: keep the file's units as metres; else scale to this height */
    bool z_up;        /* the file's up axis is +z */
    const char *leaf; /* comma-separated name parts of materials that are leaves; "": none; NULL:
                         guess by name (leaf, leaves, foliage, needle, feuille), by a texture with
                         alpha, or, where neither finds any, by shape: connected pieces that are
                         flat and open (|vector area| > area / 2) */
    const float *leaf_albedo,
        *bark_albedo; /* 3 floats; NULL: the file's material or vertex colour */
};

/* A user's mesh (OBJ, PLY, glTF, GLB through assimp). The file is opened only by plant_mesh. */
enum status plant_file(struct arena *arena, const char *path, const struct plant_import *import,
                       struct plant **plant, struct error *error);

struct coloring_request;
/* Pictures with depth of a folder (plant/images.h), coloured into voxels of the folder's box and
 * drawn as a rectangle a voxel. The folder is read only by plant_mesh and plant_hash. */
struct plant *plant_images(struct arena *arena, const char *folder,
                           const struct coloring_request *request);

/* A mesh made by the caller (tests, other rooms); it is used as it is and must outlive the plant.
 */
struct plant *plant_from_mesh(struct arena *arena, const char *name, const struct mesh *mesh);

/* A conifer made by the caller, already finished (plant/conifer.h); it must outlive the plant. */
struct plant *plant_from_conifer(struct arena *arena, const char *name,
                                 const struct conifer *conifer);

const char *plant_name(const struct plant *plant);
/* The generator's option table for documentation; NULL when the generator is unknown. */
const struct option *plant_options(const char *generator);

/* The mesh; built at the first call, the same pointer afterwards. The mesh lives in the plant's
 * arena. */
enum status plant_mesh(struct plant *plant, const struct mesh **mesh, struct error *error);

/* The hierarchy of a conifer, of a grammar or given; grown at the first call. NULL for a plant that
 * is none. */
enum status plant_conifer(struct plant *plant, const struct conifer **conifer, struct error *error);

/* Changes when the mesh would change: generator's version and parameters, or the file's bytes. For
 * a file this reads the file (and its textures) once. */
enum status plant_hash(struct plant *plant, uint64_t *hash, struct error *error);

struct plant_cost {
    bool built;
    double build_seconds;
    size_t build_bytes;
    size_t triangles_count;
};
struct plant_cost plant_cost(const struct plant *plant);

/* Checks what the rest relies on: finite positions, unit normals, indices in range, parts that tile
 * the triangles, bark before leaves, elements that tile their part; STATUS_INVALID names the first
 * violation. */
enum status mesh_check(const struct mesh *mesh, struct error *error);
/* Recomputes minimum_m, maximum_m and radius_m. */
void mesh_bounds(struct mesh *mesh);
/* m^2 */
double mesh_triangle_area(const struct mesh *mesh, size_t triangle);

#endif
