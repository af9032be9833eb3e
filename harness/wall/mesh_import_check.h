/* A look at a mesh file before assimp reads it. */
#ifndef TREELINE_WALL_MESH_IMPORT_CHECK_H
#define TREELINE_WALL_MESH_IMPORT_CHECK_H

#include "base/error.h"

#include <stdbool.h>

/* STATUS_INVALID when the header has no end or the file is too short for the elements that it
 * promises: assimp 5.2 waits for ever for the rest of such a file. colors_encoded: vertex colours
 * are integers, so sRGB. */
enum status ply_check(const char *path, bool *colors_encoded, struct error *error);

/* STATUS_INVALID when a GLB is shorter than its head says: assimp 5.2 makes room for all of it
 * first. What does not begin as a GLB passes. */
enum status glb_check(const char *path, struct error *error);

/* STATUS_INVALID for a byte order mark before anything but a comment: the line would be lost. */
enum status obj_check(const char *path, struct error *error);

#endif
