/* A look at a PLY file before assimp reads it: is it whole, and how are its colours stored? */
#include "wall/mesh_import_check.h"

#include "base/file.h"

#include <stdio.h>
#include <string.h>

struct ply {
    bool ascii, encoded;
    unsigned long long elements; /* of all kinds together: lines of an ASCII file */
    unsigned long long bytes; /* at least these of a binary one; a list counts as an empty list */
    unsigned long long count; /* of the element whose properties are being read */
};

static const size_t file_limit_bytes = (size_t)8 << 30;

/* Bytes of a scalar type; 0 for an unknown one. */
static unsigned size_of(const char *type)
{
    static const struct {
        const char *name;
        unsigned size;
    } types[] = {{"char", 1},  {"uchar", 1},   {"int8", 1},   {"uint8", 1},
                 {"short", 2}, {"ushort", 2},  {"int16", 2},  {"uint16", 2},
                 {"int", 4},   {"uint", 4},    {"int32", 4},  {"uint32", 4},
                 {"float", 4}, {"float32", 4}, {"double", 8}, {"float64", 8}};
    for (size_t i = 0; i < sizeof types / sizeof *types; i++)
        if (strcmp(types[i].name, type) == 0)
            return types[i].size;
    return 0;
}

static void read_line(struct ply *ply, const char *line)
{
    char word[64], name[64];
    unsigned long long count;
    if (sscanf(line, "format %63s", word) == 1)
        ply->ascii = strcmp(word, "ascii") == 0;
    if (sscanf(line, "element %63s %llu", word, &count) == 2) {
        ply->count = count < 1ull << 40 ? count : 1ull << 40;
        ply->elements += ply->count;
    }
    if (sscanf(line, "property list %63s", word) == 1) {
        ply->bytes += ply->count * size_of(word);
    } else if (sscanf(line, "property %63s %63s", word, name) == 2) {
        ply->bytes += ply->count * size_of(word);
        if (strcmp(name, "red") == 0)
            ply->encoded = strncmp(word, "float", 5) != 0 && strcmp(word, "double") != 0;
    }
}

/* Reads the header; NULL when it has no end, else where the elements start. */
static const char *read_header(struct ply *ply, const char *text, const char *end)
{
    while (text < end) {
        const char *stop = text + strcspn(text, "\r\n");
        char line[256];
        snprintf(line, sizeof line, "%.*s", stop - text < 255 ? (int)(stop - text) : 255, text);
        text = stop;
        text += text < end && *text == '\r';
        text += text < end && *text == '\n';
        if (strncmp(line, "end_header", 10) == 0)
            return text;
        if (text == stop)
            return NULL; /* a NUL or the end of the file */
        read_line(ply, line);
    }
    return NULL;
}

static unsigned long long lines_of(const char *text, const char *end)
{
    unsigned long long lines = 0;
    bool blank = true;
    for (; text < end; text++) {
        bool line_end = *text == '\n' || *text == '\r';
        lines += line_end && !blank;
        blank = line_end || (blank && (*text == ' ' || *text == '\t'));
    }
    return lines + !blank;
}

enum status ply_check(const char *path, bool *colors_encoded, struct error *error)
{
    struct arena *scratch = arena_create(0);
    char *text = NULL;
    size_t size = 0;
    enum status status = file_read(scratch, path, file_limit_bytes, &text, &size, error);
    if (status == STATUS_OK) {
        struct ply ply = {0};
        const char *end = text + size, *data = read_header(&ply, text, end);
        if (!data)
            status =
                error_set(error, STATUS_INVALID, "%s: its header has no end_header line", path);
        else if (ply.ascii && lines_of(data, end) < ply.elements)
            status = error_set(error, STATUS_INVALID, "%s: ends after %llu of %llu elements", path,
                               lines_of(data, end), ply.elements);
        else if (!ply.ascii && (unsigned long long)(end - data) < ply.bytes)
            status = error_set(error, STATUS_INVALID, "%s: ends after %zu of at least %llu bytes",
                               path, size, (unsigned long long)(data - text) + ply.bytes);
        *colors_encoded = ply.encoded;
    }
    arena_destroy(scratch);
    return status;
}
