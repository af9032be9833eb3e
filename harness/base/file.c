/* Whole files and folders; where treeline's data is. */
#include "base/file.h"

#include <errno.h>
#include <fcntl.h>
#include <libgen.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

enum status file_read(struct arena *arena, const char *path, size_t limit_bytes, char **text,
                      size_t *size, struct error *error)
{
    int file = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK); /* a pipe is refused, not awaited */
    if (file < 0)
        return error_errno(error, errno == ENOENT ? STATUS_NOT_FOUND : STATUS_IO, "%s", path);
    struct stat info;
    if (fstat(file, &info) != 0 || !S_ISREG(info.st_mode)) {
        close(file);
        return error_set(error, STATUS_INVALID, "%s: is not a regular file", path);
    }
    size_t limit = limit_bytes ? limit_bytes : (size_t)1 << 30;
    size_t length = (size_t)info.st_size, done = 0;
    if (length > limit) {
        close(file);
        return error_set(error, STATUS_INVALID, "%s: has %zu bytes; at most %zu are allowed", path,
                         length, limit);
    }
    *text = arena_alloc(arena, length + 1, 1);
    while (done < length) {
        ssize_t got = read(file, *text + done, length - done);
        if (got < 0 && errno == EINTR)
            continue;
        if (got <= 0)
            break;
        done += (size_t)got;
    }
    close(file);
    if (done != length)
        return error_set(error, STATUS_IO, "%s: only %zu of %zu bytes could be read", path, done,
                         length);
    *size = length;
    return STATUS_OK;
}

/* Writes everything and syncs; false with errno set. */
static bool write_all(int file, const void *data, size_t size)
{
    const char *at = data;
    while (size) {
        ssize_t put = write(file, at, size);
        if (put < 0 && errno == EINTR)
            continue;
        if (put < 0)
            return false;
        at += put;
        size -= (size_t)put;
    }
    return fsync(file) == 0 || errno == EINVAL || errno == EROFS;
}

enum status file_write(const char *path, const void *data, size_t size, struct error *error)
{
    char temporary[PATH_MAX];
    if (snprintf(temporary, sizeof temporary, "%s.tmp.%ld", path, (long)getpid()) >=
        (int)sizeof temporary)
        return error_set(error, STATUS_IO, "%s: the path is too long", path);
    int file = open(temporary, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    if (file < 0)
        return error_errno(error, STATUS_IO, "%s: cannot be written", path);
    bool good = write_all(file, data, size);
    int number = errno;
    close(file);
    if (good && rename(temporary, path) == 0)
        return STATUS_OK;
    if (good)
        number = errno;
    unlink(temporary);
    errno = number;
    return error_errno(error, STATUS_IO, "%s: cannot be written", path);
}

enum status file_append(const char *path, const void *data, size_t size, struct error *error)
{
    int file = open(path, O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
    if (file < 0)
        return error_errno(error, STATUS_IO, "%s: cannot be written", path);
    struct stat info;
    bool regular = fstat(file, &info) == 0 && S_ISREG(info.st_mode);
    bool good = write_all(file, data, size);
    int number = errno;
    /* A half-written record (full disk) is taken back, so that the file stays whole. */
    bool torn = !good && regular && ftruncate(file, info.st_size) != 0;
    close(file);
    errno = number;
    if (good)
        return STATUS_OK;
    return error_errno(error, STATUS_IO, "%s: cannot be written%s", path,
                       torn ? " and may end in half a record" : "");
}

enum status file_make_folder(const char *path, struct error *error)
{
    char part[PATH_MAX];
    if (snprintf(part, sizeof part, "%s", path) >= (int)sizeof part)
        return error_set(error, STATUS_IO, "%s: the path is too long", path);
    for (char *c = part + 1;; c++) {
        if (*c && *c != '/')
            continue;
        char end = *c;
        *c = 0;
        if (mkdir(part, 0777) != 0 && errno != EEXIST)
            return error_errno(error, STATUS_IO, "%s: cannot be made a folder", path);
        *c = end;
        if (!end)
            break;
    }
    struct stat info;
    if (stat(path, &info) != 0 || !S_ISDIR(info.st_mode))
        return error_set(error, STATUS_IO, "%s: is not a folder", path);
    return STATUS_OK;
}

bool file_exists(const char *path)
{
    return access(path, F_OK) == 0;
}

bool path_ends_with(const char *path, const char *ending)
{
    size_t length = strlen(path), tail = strlen(ending);
    return length > tail && path[length - tail - 1] != '/' &&
           strcasecmp(path + length - tail, ending) == 0;
}

char *path_stem(struct arena *arena, const char *path)
{
    const char *slash = strrchr(path, '/');
    char *stem = arena_strdup(arena, slash ? slash + 1 : path);
    char *dot = strrchr(stem, '.');
    if (dot && dot > stem)
        *dot = 0;
    return stem;
}

/* Fills folder when BASE/UP/scenes exists. */
static bool data_at(const char *base, const char *up, char *folder)
{
    char scenes[PATH_MAX];
    if (snprintf(folder, PATH_MAX, "%s%s", base, up) >= PATH_MAX)
        return false;
    return snprintf(scenes, sizeof scenes, "%s/scenes", folder) < (int)sizeof scenes &&
           file_exists(scenes);
}

const char *data_folder(void)
{
    static _Thread_local char folder[PATH_MAX];
    const char *given = getenv("TREELINE_DATA");
    if (given && *given)
        return given;
    char program[PATH_MAX];
    ssize_t length = readlink("/proc/self/exe", program, sizeof program - 1);
    program[length > 0 ? length : 0] = 0;
    const char *base = dirname(program);
    /* Beside the program; installed; above build/CONFIG/, above build/CONFIG/tests/. */
    static const char *const ups[] = {"", "/../share/treeline", "/../..", "/../../.."};
    size_t i = 0;
    while (i < sizeof ups / sizeof ups[0] && !data_at(base, ups[i], folder))
        i++;
    if (i == sizeof ups / sizeof ups[0])
        data_at(base, ups[1], folder); /* for the error that names it */
    char *real = realpath(folder, NULL);
    if (real)
        snprintf(folder, sizeof folder, "%s", real);
    free(real);
    return folder;
}
