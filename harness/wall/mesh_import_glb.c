/* A look at a GLB file before assimp reads it: is it as long as its head says? */
#include "wall/mesh_import_check.h"

#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

enum { HEAD_BYTES = 20 }; /* magic, version, length; length and type of the first chunk */

static uint32_t u32_at(const unsigned char *bytes)
{
    return bytes[0] | (uint32_t)bytes[1] << 8 | (uint32_t)bytes[2] << 16 | (uint32_t)bytes[3] << 24;
}

enum status glb_check(const char *path, struct error *error)
{
    unsigned char head[HEAD_BYTES];
    struct stat info = {0};
    FILE *file = fopen(path, "rbe");
    if (!file || fstat(fileno(file), &info) != 0) {
        error_errno(error, STATUS_IO, "%s", path);
        if (file)
            fclose(file);
        return STATUS_IO;
    }
    size_t got = fread(head, 1, sizeof head, file);
    fclose(file);
    if (got < 4 || memcmp(head, "glTF", 4) != 0)
        return STATUS_OK;
    uint64_t size = (uint64_t)info.st_size;
    uint64_t wanted = got < sizeof head ? sizeof head : u32_at(head + 8);
    if (got == sizeof head && (uint64_t)HEAD_BYTES + u32_at(head + 12) > wanted)
        wanted = (uint64_t)HEAD_BYTES + u32_at(head + 12);
    if (size < wanted)
        return error_set(error, STATUS_INVALID, "%s: ends after %llu of %llu bytes", path,
                         (unsigned long long)size, (unsigned long long)wanted);
    return STATUS_OK;
}
