/* A folder of pictures with depth as a plant: cameras.json beside them says how they were taken.
 * scenes/README.md documents every key. */
#ifndef TREELINE_PLANT_IMAGES_H
#define TREELINE_PLANT_IMAGES_H

#include "base/error.h"
#include "plant/coloring.h"

/* How a depth is stored. */
struct images_depth {
    bool along_ray; /* distance from the eye; else along the camera's direction */
    float unit_m;   /* of a stored 1 (white of an integer file) */
    float far_m;    /* nothing is there from here on; 0: 1e9, but unit_m in an integer file */
};

struct images {
    float minimum_m[3], maximum_m[3]; /* box */
    struct images_depth depth;
    size_t views_count;
    struct depth_view *views;      /* cameras; the pictures are empty until images_load */
    const char **colors, **depths; /* paths of the pictures */
};

/* Reads cameras.json of a folder. STATUS_NOT_FOUND without one, STATUS_INVALID names file, key,
 * value and what is allowed. */
enum status images_describe(struct arena *arena, const char *folder, struct images *images,
                            struct error *error);
/* Reads the pictures that are described (starts OpenImageIO). STATUS_INVALID where color and depth
 * differ in size, a depth channel is missing, or all together are above 2^26 pixels. */
enum status images_load(struct arena *arena, struct images *images, struct error *error);
/* Of cameras.json, every picture, and how they are to be coloured. */
enum status images_hash(const char *folder, const struct coloring_request *request, uint64_t *hash,
                        struct error *error);

/* Writes such a folder: for each view color-NN.exr (R, G, B, A) and depth-NN.exr (Z), 32-bit, and
 * cameras.json. */
enum status images_write(const char *folder, const struct images *images, struct error *error);

/* The plant: described, read, coloured and made a mesh, or taken from the disk cache. request's box
 * is the folder's. STATUS_INVALID when no voxel is coloured. */
enum status images_mesh(struct arena *arena, const char *folder,
                        const struct coloring_request *request, struct mesh **mesh,
                        struct error *error);

#endif
