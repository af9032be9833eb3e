/* A user's mesh file as a plant: the request, the hash of all its files, and the way through the
 * disk cache. */
#include "plant/import.h"

#include "base/file.h"
#include "base/hash.h"
#include "plant/import_steps.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

enum {
    IMPORT_VERSION = 2, /* raised whenever the same files give another mesh */
    TRIANGLES_LIMIT = 50000000,
};
static const size_t file_limit_bytes = (size_t)8 << 30;

static enum status check_albedo(const char *path, const char *name, const float *albedo,
                                struct error *error)
{
    for (int k = 0; albedo && k < 3; k++)
        if (!(albedo[k] >= 0 && albedo[k] <= 1))
            return error_set(error, STATUS_INVALID, "%s: %s: %g is outside 0..1", path, name,
                             (double)albedo[k]);
    return STATUS_OK;
}

static const float *kept_albedo(struct arena *arena, const float *albedo)
{
    return albedo ? memcpy(ARENA_ARRAY(arena, float, 3), albedo, 3 * sizeof *albedo) : NULL;
}

enum status import_request(struct arena *arena, const char *path, const struct plant_import *import,
                           struct import_request **request, struct error *error)
{
    const struct plant_import none = {0};
    import = import ? import : &none;
    if (!path_ends_with(path, ".obj") && !path_ends_with(path, ".ply") &&
        !path_ends_with(path, ".gltf") && !path_ends_with(path, ".glb"))
        return error_set(
            error, STATUS_INVALID,
            "%s: is not a mesh format that can be read; allowed: .obj, .ply, .gltf, .glb", path);
    if (!(import->height_m >= 0 && import->height_m <= 1000))
        return error_set(error, STATUS_INVALID, "%s: height_m: %g is outside 0..1000", path,
                         import->height_m);
    if (check_albedo(path, "leaf_albedo", import->leaf_albedo, error) != STATUS_OK ||
        check_albedo(path, "bark_albedo", import->bark_albedo, error) != STATUS_OK)
        return STATUS_INVALID;
    *request = ARENA_NEW(arena, struct import_request);
    **request = (struct import_request){
        .path = arena_strdup(arena, path),
        .height_m = import->height_m,
        .z_up = import->z_up,
        .leaf = import->leaf ? arena_strdup(arena, import->leaf) : NULL,
        .leaf_albedo = kept_albedo(arena, import->leaf_albedo),
        .bark_albedo = kept_albedo(arena, import->bark_albedo),
    };
    return STATUS_OK;
}

const char *import_resolve(struct arena *arena, const char *path, const char *name)
{
    char *clean = arena_strdup(arena, name);
    for (char *c = clean; *c; c++)
        if (*c == '\\')
            *c = '/';
    const char *slash = strrchr(path, '/');
    int folder = slash ? (int)(slash - path) + 1 : 0;
    const char *whole =
        clean[0] == '/' ? clean : arena_printf(arena, "%.*s%s", folder, path, clean);
    if (file_exists(whole))
        return whole;
    const char *last = strrchr(clean, '/');
    const char *beside = arena_printf(arena, "%.*s%s", folder, path, last ? last + 1 : clean);
    return file_exists(beside) ? beside : NULL;
}

/* Chains the bytes of a file named in another one; a missing one only by its name. What is there
 * but is no file that can be read is refused: assimp waits for the end of a pipe. */
static enum status hash_named(struct arena *arena, const char *path, const char *name,
                              uint64_t *hash, struct error *error)
{
    char *bytes;
    size_t size;
    const char *at = import_resolve(arena, path, name);
    *hash = hash_text(*hash, name);
    if (!at)
        return STATUS_OK;
    if (file_read(arena, at, file_limit_bytes, &bytes, &size, error) != STATUS_OK)
        return error_context(error, "%s", path);
    *hash = hash_bytes(*hash, bytes, size);
    return STATUS_OK;
}

/* The rest of a line behind its keyword, trimmed, or NULL when the line starts with another word.
 */
static char *after_word(struct arena *arena, const char *line, size_t length, const char *word)
{
    size_t n = strlen(word);
    while (length && isspace((unsigned char)*line))
        line++, length--;
    if (length <= n || strncasecmp(line, word, n) != 0 || !isspace((unsigned char)line[n]))
        return NULL;
    const char *end = line + length;
    for (line += n; line < end && isspace((unsigned char)*line);)
        line++;
    while (end > line && isspace((unsigned char)end[-1]))
        end--;
    return end > line ? arena_printf(arena, "%.*s", (int)(end - line), line) : NULL;
}

/* Calls for each line of a text that starts with the word. */
static enum status
each_line(struct arena *arena, const char *path, const char *text, size_t size, const char *word,
          enum status (*take)(struct arena *, const char *, char *, uint64_t *, struct error *),
          uint64_t *hash, struct error *error)
{
    const char *end = text + size;
    while (text < end) {
        const char *newline = memchr(text, '\n', (size_t)(end - text));
        const char *stop = newline ? newline : end;
        char *rest =
            stop - text < 4096 ? after_word(arena, text, (size_t)(stop - text), word) : NULL;
        if (rest) {
            enum status status = take(arena, path, rest, hash, error);
            if (status != STATUS_OK)
                return status;
        }
        text = stop + 1;
    }
    return STATUS_OK;
}

/* A texture statement: options such as "-s 1 1 1" come before the name. */
static enum status take_map(struct arena *arena, const char *path, char *rest, uint64_t *hash,
                            struct error *error)
{
    char *last = strrchr(rest, ' ');
    return hash_named(arena, path, rest[0] == '-' && last ? last + 1 : rest, hash, error);
}

static enum status take_library(struct arena *arena, const char *path, char *rest, uint64_t *hash,
                                struct error *error)
{
    char *text;
    size_t size;
    const char *at = import_resolve(arena, path, rest);
    if (!at)
        return error_set(error, STATUS_NOT_FOUND, "%s: its material library '%s' does not exist",
                         path, rest);
    enum status status = file_read(arena, at, file_limit_bytes, &text, &size, error);
    if (status != STATUS_OK)
        return status;
    *hash = hash_bytes(*hash, text, size);
    status = each_line(arena, at, text, size, "map_Kd", take_map, hash, error);
    return status ? status : each_line(arena, at, text, size, "map_d", take_map, hash, error);
}

/* Every "uri": "..." of a glTF that names a file. */
static enum status hash_uris(struct arena *arena, const char *path, const char *text, size_t size,
                             uint64_t *hash, struct error *error)
{
    enum status status = STATUS_OK;
    const char *end = text + size;
    while (!status && (text = memmem(text, (size_t)(end - text), "\"uri\"", 5))) {
        for (text += 5; text < end && (isspace((unsigned char)*text) || *text == ':');)
            text++;
        if (text == end || *text != '"')
            continue;
        text++;
        const char *close = memchr(text, '"', (size_t)(end - text));
        if (close && close - text < 4096 && strncmp(text, "data:", 5) != 0)
            status = hash_named(arena, path, arena_printf(arena, "%.*s", (int)(close - text), text),
                                hash, error);
    }
    return status;
}

/* Chains the hash of a mesh file's bytes and of every file that it names: .mtl, .bin, textures. A
 * missing .mtl is STATUS_NOT_FOUND; missing textures are told when they are decoded. */
static enum status hash_files(const char *path, uint64_t *hash, struct error *error)
{
    struct arena *scratch = arena_create(0);
    char *text;
    size_t size = 0;
    enum status status = file_read(scratch, path, file_limit_bytes, &text, &size, error);
    if (status == STATUS_OK && size == 0)
        status = error_set(error, STATUS_INVALID, "%s: is empty", path);
    if (status == STATUS_OK) {
        *hash = hash_bytes(*hash, text, size);
        if (path_ends_with(path, ".obj"))
            status = each_line(scratch, path, text, size, "mtllib", take_library, hash, error);
        else if (path_ends_with(path, ".ply"))
            status = each_line(scratch, path, text, size < 65536 ? size : 65536,
                               "comment TextureFile", take_map, hash, error);
        else
            status = hash_uris(scratch, path, text, size, hash, error);
    }
    arena_destroy(scratch);
    return status;
}

enum status import_hash(const struct import_request *request, uint64_t *hash, struct error *error)
{
    uint64_t h = hash_u64(hash_text(0, "import"), IMPORT_VERSION);
    const char *ending = strrchr(request->path, '.');
    h = hash_text(h, ending);
    h = hash_u64(hash_double(h, request->height_m), request->z_up);
    h = hash_text(hash_u64(h, request->leaf != NULL), request->leaf);
    for (int k = 0; k < 3; k++) {
        h = hash_double(h, request->leaf_albedo ? (double)request->leaf_albedo[k] : -1);
        h = hash_double(h, request->bark_albedo ? (double)request->bark_albedo[k] : -1);
    }
    enum status status = hash_files(request->path, &h, error);
    *hash = h;
    return status;
}

static enum status read_file(struct arena *arena, const struct import_request *request,
                             struct mesh **mesh, struct error *error)
{
    struct arena *scratch = arena_create(0);
    struct import_soup *soup = NULL;
    enum status status = mesh_import(scratch, request->path, TRIANGLES_LIMIT, &soup, error);
    if (status == STATUS_OK) {
        const struct texture **textures =
            ARENA_ARRAY(scratch, const struct texture *, soup->materials_count);
        bool *has_holes = ARENA_ARRAY(scratch, bool, soup->materials_count);
        for (size_t i = 0; i < soup->materials_count && status == STATUS_OK; i++)
            status = import_texture(arena, request->path, &soup->materials[i], &textures[i],
                                    &has_holes[i], error);
        if (status == STATUS_OK)
            status = import_convert(arena, request, soup, textures, has_holes, mesh, error);
    }
    arena_destroy(scratch);
    return status;
}

enum status import_mesh(struct arena *arena, const struct import_request *request,
                        struct mesh **mesh, struct error *error)
{
    uint64_t hash;
    enum status status = import_hash(request, &hash, error);
    if (status != STATUS_OK)
        return status;
    void *bytes;
    size_t size;
    if (cache_get(arena, "plant", hash, &bytes, &size)) {
        *mesh = import_decode(arena, bytes, size);
        if (*mesh && mesh_check(*mesh, NULL) == STATUS_OK)
            return STATUS_OK;
    }
    status = read_file(arena, request, mesh, error);
    if (status != STATUS_OK)
        return status;
    if (mesh_check(*mesh, error) != STATUS_OK)
        return error_context(error, "%s", request->path);
    struct arena *scratch = arena_create(0);
    bytes = import_encode(scratch, *mesh, &size);
    cache_put("plant", hash, bytes, size);
    arena_destroy(scratch);
    return STATUS_OK;
}
