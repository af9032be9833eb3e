/* A look at a PLY file before assimp reads it. */
#ifndef TREELINE_WALL_MESH_IMPORT_PLY_H
#define TREELINE_WALL_MESH_IMPORT_PLY_H

#include "base/error.h"

#include <stdbool.h>

/* STATUS_INVALID when the header has no end or the file is too short for the elements that it
 * promises: assimp 5.2 waits for ever for the rest of such a file. colors_encoded: vertex colours
 * are integers, so sRGB. */
enum status ply_check(const char *path, bool *colors_encoded, struct error *error);

#endif
