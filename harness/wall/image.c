/* Images on disk: finds and loads the shim, turns its answers into images and clear errors. */
#include "wall/image.h"

#include "base/color.h"
#include "base/file.h"
#include "wall/oiio.h"

#include <dlfcn.h>
#include <errno.h>
#include <libgen.h>
#include <limits.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define SHIM "treeline_image.so"
#define HALF_MAX 65504.0f

static const char *const names_y[] = {"Y"};
static const char *const names_ya[] = {"Y", "A"};
static const char *const names_rgba[] = {"R", "G", "B", "A"};

/* From beside the executable (a build), the folder above (its tests), or PREFIX/lib/treeline of a
 * program in PREFIX/bin. */
static const struct oiio_calls *load_shim(struct error *error)
{
    char self[PATH_MAX] = "";
    ssize_t length = readlink("/proc/self/exe", self, sizeof self - 1);
    self[length > 0 ? length : 0] = 0;
    const char *folder = dirname(self);
    const char *formats[] = {"%s/" SHIM, "%s/../" SHIM, "%s/../lib/treeline/" SHIM};
    for (size_t i = 0; i < sizeof formats / sizeof *formats; i++) {
        char path[PATH_MAX + 64];
        snprintf(path, sizeof path, formats[i], folder);
        if (!file_exists(path))
            continue;
        void *library = dlopen(path, RTLD_NOW | RTLD_LOCAL);
        if (!library) {
            error_set(error, STATUS_UNAVAILABLE, "no images can be read or written here: %s",
                      dlerror());
            return NULL;
        }
        const struct oiio_calls *calls = dlsym(library, OIIO_CALLS_SYMBOL);
        if (calls && calls->abi == OIIO_ABI)
            return calls;
        error_set(error, STATUS_UNAVAILABLE, "%s: belongs to another version of treeline", path);
        return NULL;
    }
    error_set(error, STATUS_UNAVAILABLE,
              "no images can be read or written here: " SHIM " is neither in %s, nor in the folder "
              "above it, nor in lib/treeline there",
              folder);
    return NULL;
}

static void *allocate(void *user, size_t bytes)
{
    return arena_alloc(user, bytes, 1);
}

/* Reading */

static enum status check_readable(const char *path, struct error *error)
{
    struct stat about;
    if (stat(path, &about) != 0) {
        enum status status = errno == ENOENT || errno == ENOTDIR ? STATUS_NOT_FOUND : STATUS_IO;
        return error_errno(error, status, "%s", path);
    }
    if (S_ISDIR(about.st_mode))
        return error_set(error, STATUS_INVALID, "%s: is a folder, not a picture", path);
    if (!S_ISREG(about.st_mode))
        return error_set(error, STATUS_INVALID, "%s: is not a regular file", path);
    if (access(path, R_OK) != 0)
        return error_errno(error, STATUS_IO, "%s", path);
    return STATUS_OK;
}

/* A PNG must reach its last chunk: OpenImageIO leaks where libpng finds the end too early (2.4).
 * Files of other formats pass. */
static bool is_cut_off_png(const char *path)
{
    unsigned char bytes[8];
    FILE *file = fopen(path, "rb");
    if (!file)
        return false;
    bool is_png = fread(bytes, 1, 8, file) == 8 && memcmp(bytes, "\x89PNG\r\n\x1a\n", 8) == 0;
    bool whole = false;
    while (is_png && !whole && fread(bytes, 1, 8, file) == 8) { /* length, type, data, CRC */
        uint32_t length = (uint32_t)bytes[0] << 24 | (uint32_t)bytes[1] << 16 |
                          (uint32_t)bytes[2] << 8 | bytes[3];
        if (fseek(file, (long)length + 3, SEEK_CUR) != 0 || fgetc(file) == EOF)
            break;
        whole = memcmp(bytes + 4, "IEND", 4) == 0;
    }
    fclose(file);
    return is_png && !whole;
}

static void decode_srgb(struct image *image, int alpha)
{
    size_t count = (size_t)image->width_px * (size_t)image->height_px;
    for (size_t i = 0; i < count; i++)
        for (int c = 0; c < image->channels_count; c++)
            if (c != alpha) {
                float *value = &image->values[i * (size_t)image->channels_count + (size_t)c];
                *value = srgb_decode(*value);
            }
}

static enum status read_picture(struct arena *arena, const char *path, bool linear,
                                struct image **image, double *unit, struct error *error)
{
    enum status status = check_readable(path, error);
    if (status)
        return status;
    if (is_cut_off_png(path))
        return error_set(error, STATUS_INVALID,
                         "%s: no picture can be read from it: the PNG is cut off", path);
    struct error shim_error;
    const struct oiio_calls *calls = load_shim(&shim_error);
    if (!calls)
        return error_set(error, STATUS_UNAVAILABLE, "%s: %s", path, shim_error.text);
    char message[512] = "";
    struct oiio_context context = {allocate, arena, message, sizeof message};
    struct oiio_picture picture = {0};
    if (calls->read(&context, path, IMAGE_VALUES_MAX, IMAGE_CHANNELS_MAX, &picture))
        return error_set(error, STATUS_INVALID, "%s: no picture can be read from it: %s", path,
                         message);
    const char **names = ARENA_ARRAY(arena, const char *, (size_t)picture.channels_count);
    for (int c = 0; c < picture.channels_count; c++)
        names[c] = picture.names[c];
    *image = ARENA_NEW(arena, struct image);
    **image = (struct image){picture.width_px, picture.height_px, picture.channels_count,
                             picture.values, names};
    *unit = picture.unit;
    if (linear && picture.srgb)
        decode_srgb(*image, picture.alpha);
    return STATUS_OK;
}

enum status image_read(struct arena *arena, const char *path, bool linear, struct image **image,
                       struct error *error)
{
    double unit;
    return read_picture(arena, path, linear, image, &unit, error);
}

enum status image_read_units(struct arena *arena, const char *path, struct image **image,
                             double *unit, struct error *error)
{
    return read_picture(arena, path, false, image, unit, error);
}

/* Writing */

static const char *const *default_names(int channels_count)
{
    return channels_count == 1 ? names_y : channels_count == 2 ? names_ya : names_rgba;
}

static enum status check_image(const char *path, const struct image *image, bool exr, int bits,
                               struct error *error)
{
    if (exr ? bits != 16 && bits != 32 : bits != 8 && bits != 16)
        return error_set(error, STATUS_INVALID, "%s: %d bits; %s", path, bits,
                         exr ? "an EXR has 16 or 32" : "a PNG has 8 or 16");
    int channels_max = !exr || !image->names ? 4 : IMAGE_CHANNELS_MAX;
    if (image->channels_count < 1 || image->channels_count > channels_max)
        return error_set(error, STATUS_INVALID, "%s: %d channels are outside 1..%d%s", path,
                         image->channels_count, channels_max,
                         exr && !image->names ? " without names" : "");
    if (image->width_px < 1 || image->height_px < 1 ||
        image->width_px > IMAGE_VALUES_MAX / image->channels_count / image->height_px)
        return error_set(error, STATUS_INVALID, "%s: size %d x %d x %d is outside 1..%d values",
                         path, image->width_px, image->height_px, image->channels_count,
                         IMAGE_VALUES_MAX);
    return STATUS_OK;
}

static float clamp_float(float value, float low, float high)
{
    return value > low ? (value < high ? value : high) : low; /* NaN: low */
}

/* A copy of the values as they are to be stored. */
static float *stored_values(struct arena *arena, const struct image *image, bool exr, int bits,
                            bool encode, int alpha)
{
    size_t channels = (size_t)image->channels_count;
    size_t count = (size_t)image->width_px * (size_t)image->height_px * channels;
    float *values = ARENA_ARRAY(arena, float, count);
    for (size_t i = 0; i < count; i++) {
        float value = image->values[i];
        if (!exr)
            value = encode && (int)(i % channels) != alpha ? srgb_encode(value)
                                                           : clamp_float(value, 0, 1);
        else if (bits == 16 && value == value)
            value = clamp_float(value, -HALF_MAX, HALF_MAX);
        values[i] = value;
    }
    return values;
}

static enum status encode_image(struct arena *arena, const char *path, const struct image *image,
                                bool exr, int bits, bool encode, uint8_t **bytes, size_t *size,
                                struct error *error)
{
    enum status status = check_image(path, image, exr, bits, error);
    if (status)
        return status;
    struct error shim_error;
    const struct oiio_calls *calls = load_shim(&shim_error);
    if (!calls)
        return error_set(error, STATUS_UNAVAILABLE, "%s: %s", path, shim_error.text);
    const char *const *names = image->names ? image->names : default_names(image->channels_count);
    struct oiio_picture picture = {
        image->width_px, image->height_px, image->channels_count, NULL, NULL, -1, encode, 0};
    picture.names = arena_alloc(arena, (size_t)picture.channels_count, sizeof *picture.names);
    for (int c = 0; c < picture.channels_count; c++) {
        snprintf(picture.names[c], OIIO_NAME_BYTES, "%s", names[c]);
        if (strcmp(names[c], "A") == 0)
            picture.alpha = c;
    }
    picture.values = stored_values(arena, image, exr, bits, encode, picture.alpha);
    char message[512] = "";
    struct oiio_context context = {allocate, arena, message, sizeof message};
    if (calls->write(&context, exr ? "exr" : "png", &picture, bits, bytes, size))
        return error_set(error, STATUS_IO, "%s: the picture could not be encoded: %s", path,
                         message);
    return STATUS_OK;
}

enum status image_path_check(const char *path, struct error *error)
{
    if (path_ends_with(path, ".exr") || path_ends_with(path, ".png"))
        return STATUS_OK;
    return error_set(error, STATUS_INVALID, "%s: pictures are written as .exr or .png", path);
}

enum status image_write(const char *path, const struct image *image, int bits, bool encode,
                        struct error *error)
{
    enum status status = image_path_check(path, error);
    if (status != STATUS_OK)
        return status;
    bool exr = path_ends_with(path, ".exr");
    struct arena *scratch = arena_create(0);
    uint8_t *bytes;
    size_t size;
    status =
        encode_image(scratch, path, image, exr, bits, exr ? false : encode, &bytes, &size, error);
    if (status == STATUS_OK)
        status = file_write(path, bytes, size, error);
    arena_destroy(scratch);
    return status;
}

enum status image_png(struct arena *arena, const struct image *image, bool encode, uint8_t **bytes,
                      size_t *size, struct error *error)
{
    struct arena *scratch = arena_create(0);
    uint8_t *encoded;
    enum status status =
        encode_image(scratch, "PNG", image, false, 8, encode, &encoded, size, error);
    if (status == STATUS_OK) {
        *bytes = arena_alloc(arena, *size, 1);
        memcpy(*bytes, encoded, *size);
    }
    arena_destroy(scratch);
    return status;
}
