/* A user's mesh file as a plant: between plant.c and the importer. */
#ifndef TREELINE_PLANT_IMPORT_H
#define TREELINE_PLANT_IMPORT_H

#include "plant/plant.h"

struct import_request; /* a path and how to read it; belongs to an arena */

/* Keeps copies of path and import (NULL: zeros). STATUS_INVALID for an unknown ending, a height or
 * an albedo out of range; the file is not opened. */
enum status import_request(struct arena *arena, const char *path, const struct plant_import *import,
                           struct import_request **request, struct error *error);

/* Reads, converts and checks the mesh, or takes it from the disk cache, where it stands under
 * import_hash. */
enum status import_mesh(struct arena *arena, const struct import_request *request,
                        struct mesh **mesh, struct error *error);

/* Of the request, the file and every file that it names. */
enum status import_hash(const struct import_request *request, uint64_t *hash, struct error *error);

#endif
