/* The parts of mesh_import: reading with assimp, and carrying the soup from the child that did. */
#ifndef TREELINE_WALL_MESH_IMPORT_PARTS_H
#define TREELINE_WALL_MESH_IMPORT_PARTS_H

#include "wall/mesh_import.h"

/* mesh_import in this very process; a damaged file may crash it or never return. */
enum status mesh_import_assimp(struct arena *arena, const char *path, size_t triangles_limit,
                               struct import_soup **soup, struct error *error);

/* Writes the soup to an open file; false when that fails. */
bool soup_write(int file, const struct import_soup *soup);
/* Reads it back into the arena; NULL when the file is not whole. */
struct import_soup *soup_read(struct arena *arena, int file);

#endif
