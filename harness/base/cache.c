/* The disk cache: one file an entry, KIND-HASH, with size and checksum in front; torn entries do
 * not exist. */
#include "base/file.h"
#include "base/hash.h"

#include <dirent.h>
#include <fcntl.h>
#include <inttypes.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* Entries above this total are removed, oldest first, when one is put. */
#define CACHE_LIMIT_BYTES ((size_t)8 << 30)

struct entry_header {
    char magic[8];
    uint64_t size, checksum;
};
static const char magic[8] = "TLCACHE1";

bool cache_folder(char *folder)
{
    const char *given = getenv("TREELINE_CACHE"), *xdg = getenv("XDG_CACHE_HOME"),
               *home = getenv("HOME");
    if (given && strcmp(given, "off") == 0)
        return false;
    int length;
    if (given && *given)
        length = snprintf(folder, PATH_MAX, "%s", given);
    else if (xdg && *xdg)
        length = snprintf(folder, PATH_MAX, "%s/treeline", xdg);
    else if (home && *home)
        length = snprintf(folder, PATH_MAX, "%s/.cache/treeline", home);
    else
        return false;
    return length < PATH_MAX;
}

static bool entry_path(const char *kind, uint64_t hash, char *path)
{
    char folder[PATH_MAX];
    return cache_folder(folder) &&
           snprintf(path, PATH_MAX, "%.3900s/%.64s-%016" PRIx64, folder, kind, hash) < PATH_MAX;
}

bool cache_get(struct arena *arena, const char *kind, uint64_t hash, void **data, size_t *size)
{
    char path[PATH_MAX], *bytes;
    size_t total;
    struct entry_header header;
    if (!entry_path(kind, hash, path) || !file_exists(path) ||
        file_read(arena, path, (size_t)4 << 30, &bytes, &total, NULL) != STATUS_OK ||
        total < sizeof header)
        return false;
    memcpy(&header, bytes, sizeof header);
    char *payload = bytes + sizeof header;
    if (memcmp(header.magic, magic, sizeof magic) != 0 || header.size != total - sizeof header ||
        header.checksum != hash_bytes(0, payload, header.size))
        return false;
    utimensat(AT_FDCWD, path, NULL, 0); /* used just now: the last to be trimmed */
    /* The payload is moved to the front, where the arena's alignment holds. */
    memmove(bytes, payload, header.size);
    *data = bytes;
    *size = header.size;
    return true;
}

void cache_put(const char *kind, uint64_t hash, const void *data, size_t size)
{
    char folder[PATH_MAX], path[PATH_MAX];
    if (!entry_path(kind, hash, path) || !cache_folder(folder) ||
        file_make_folder(folder, NULL) != STATUS_OK)
        return;
    struct entry_header header = {.size = size, .checksum = hash_bytes(0, data, size)};
    memcpy(header.magic, magic, sizeof magic);
    char *entry = malloc(sizeof header + size);
    if (!entry)
        return;
    memcpy(entry, &header, sizeof header);
    memcpy(entry + sizeof header, data, size);
    file_write(path, entry, sizeof header + size, NULL);
    free(entry);
    cache_trim(CACHE_LIMIT_BYTES, NULL, NULL);
}

struct entry {
    char name[NAME_MAX + 1];
    struct timespec used;
    size_t bytes;
};

static int entry_older(const void *a, const void *b)
{
    const struct timespec *x = &((const struct entry *)a)->used,
                          *y = &((const struct entry *)b)->used;
    if (x->tv_sec != y->tv_sec)
        return x->tv_sec < y->tv_sec ? -1 : 1;
    return (x->tv_nsec > y->tv_nsec) - (x->tv_nsec < y->tv_nsec);
}

/* All regular files of the cache's folder, malloced; -1 when the folder cannot be read. */
static long entries_list(DIR *folder, struct entry **entries, size_t *bytes)
{
    long count = 0, capacity = 0;
    for (struct dirent *item; (item = readdir(folder));) {
        struct stat info;
        if (fstatat(dirfd(folder), item->d_name, &info, AT_SYMLINK_NOFOLLOW) != 0 ||
            !S_ISREG(info.st_mode))
            continue;
        if (count == capacity) {
            capacity = capacity ? 2 * capacity : 64;
            struct entry *more = realloc(*entries, (size_t)capacity * sizeof **entries);
            if (!more)
                return count;
            *entries = more;
        }
        struct entry *entry = &(*entries)[count++];
        snprintf(entry->name, sizeof entry->name, "%s", item->d_name);
        entry->used = info.st_mtim;
        entry->bytes = (size_t)info.st_size;
        *bytes += entry->bytes;
    }
    return count;
}

enum status cache_trim(size_t limit_bytes, size_t *removed_bytes, struct error *error)
{
    char path[PATH_MAX];
    if (removed_bytes)
        *removed_bytes = 0;
    if (!cache_folder(path))
        return STATUS_OK;
    DIR *folder = opendir(path);
    if (!folder)
        return STATUS_OK; /* nothing was ever cached */
    struct entry *entries = NULL;
    size_t total = 0;
    long count = entries_list(folder, &entries, &total);
    if (total > limit_bytes)
        qsort(entries, (size_t)count, sizeof *entries, entry_older);
    enum status status = STATUS_OK;
    for (long i = 0; i < count && total > limit_bytes; i++) {
        if (unlinkat(dirfd(folder), entries[i].name, 0) != 0) {
            status =
                error_errno(error, STATUS_IO, "%s/%s: cannot be removed", path, entries[i].name);
            continue;
        }
        total -= entries[i].bytes;
        if (removed_bytes)
            *removed_bytes += entries[i].bytes;
    }
    free(entries);
    closedir(folder);
    return status;
}
