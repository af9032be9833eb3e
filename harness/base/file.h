/* Whole files, atomic writes, folders, and the disk cache of built things by content hash. */
#ifndef TREELINE_BASE_FILE_H
#define TREELINE_BASE_FILE_H

#include "base/arena.h"
#include "base/error.h"

#include <stdbool.h>

/* Reads a whole file; text gets a NUL behind its end (not counted in size). Folders, missing files
 * and files above limit_bytes (0: 1 GiB) are refused by name. */
enum status file_read(struct arena *arena, const char *path, size_t limit_bytes, char **text,
                      size_t *size, struct error *error);
/* Writes to PATH.tmp.PID, fsyncs, renames: the file is whole or absent, and two writers do not mix.
 */
enum status file_write(const char *path, const void *data, size_t size, struct error *error);
/* Appends one whole record with a single write and fsync. */
enum status file_append(const char *path, const void *data, size_t size, struct error *error);
/* mkdir -p */
enum status file_make_folder(const char *path, struct error *error);
bool file_exists(const char *path);

/* "trees/Oak.OBJ" ends with ".obj": the case of letters does not count, and a name must stand
 * before the ending. */
bool path_ends_with(const char *path, const char *ending);
/* A file's name without folder and ending: "Oak". */
char *path_stem(struct arena *arena, const char *path);

/* The cache: $TREELINE_CACHE, else $XDG_CACHE_HOME/treeline, else ~/.cache/treeline. Entries are
 * KIND-HASH; an entry that is torn or of another size does not exist. TREELINE_CACHE=off disables.
 */
/* The cache's folder, into PATH_MAX bytes; false when it is off or has no place. */
bool cache_folder(char *folder);
bool cache_get(struct arena *arena, const char *kind, uint64_t hash, void **data, size_t *size);
/* A cache that cannot be written is no error: the thing is built again next time. */
void cache_put(const char *kind, uint64_t hash, const void *data, size_t size);
/* Removes the oldest entries until the cache holds at most limit_bytes; 0 empties it. */
enum status cache_trim(size_t limit_bytes, size_t *removed_bytes, struct error *error);

/* The folder of scenes/, reports/ and methods' data: $TREELINE_DATA, else beside the executable
 * when it holds scenes/, else PREFIX/share/treeline of a program in PREFIX/bin, else the checkout
 * whose build/ holds the program. An installation may be moved. */
const char *data_folder(void);

#endif
