/* Textures of an imported mesh: decoded, turned upright, colour and opacity put together. */
#include "base/color.h"
#include "plant/import_steps.h"
#include "wall/image.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Bytes that stand inside a mesh file go through a file of their own, because image_read takes
 * paths. */
static enum status read_embedded(struct arena *arena, const struct import_texture *from,
                                 struct image **image, struct error *error)
{
    const char *folder = getenv("TMPDIR");
    const char *ending = from->format[0] ? from->format : "png";
    char *path = arena_printf(arena, "%s/treeline-XXXXXX.%s", folder ? folder : "/tmp", ending);
    int file = mkstemps(path, (int)strlen(ending) + 1);
    if (file < 0)
        return error_errno(error, STATUS_IO, "%s: cannot be written", path);
    const char *bytes = from->bytes;
    size_t done = 0;
    while (done < from->bytes_size) {
        ssize_t put = write(file, bytes + done, from->bytes_size - done);
        if (put <= 0)
            break;
        done += (size_t)put;
    }
    close(file);
    enum status status = done < from->bytes_size
                             ? error_errno(error, STATUS_IO, "%s: cannot be written", path)
                             : image_read(arena, path, true, image, error);
    unlink(path);
    return status;
}

/* Uncompressed texels: blue, green, red, alpha of 8 bits, sRGB. */
static struct image *read_texels(struct arena *arena, const struct import_texture *from)
{
    struct image *image = ARENA_NEW(arena, struct image);
    size_t count = (size_t)from->width_px * (size_t)from->height_px;
    image->width_px = from->width_px;
    image->height_px = from->height_px;
    image->channels_count = 4;
    image->values = arena_alloc(arena, count, sizeof(float[4]));
    const unsigned char *bytes = from->bytes;
    for (size_t i = 0; i < count; i++) {
        for (int k = 0; k < 3; k++)
            image->values[4 * i + (size_t)k] =
                srgb_decode((float)bytes[4 * i + 2 - (size_t)k] / 255);
        image->values[4 * i + 3] = (float)bytes[4 * i + 3] / 255;
    }
    return image;
}

static enum status read_image(struct arena *arena, const char *path, const char *material,
                              const struct import_texture *from, struct image **image,
                              struct error *error)
{
    enum status status = STATUS_OK;
    if (!from->path && from->format[0] == '\0' && from->width_px > 0) {
        *image = read_texels(arena, from);
    } else if (!from->path) {
        status = read_embedded(arena, from, image, error);
    } else {
        const char *file = import_resolve(arena, path, from->path);
        if (!file)
            return error_set(error, STATUS_NOT_FOUND,
                             "%s: material '%s': its texture '%s' does not exist", path, material,
                             from->path);
        status = image_read(arena, file, true, image, error);
    }
    if (status != STATUS_OK)
        error_context(error, "%s: material '%s'", path, material);
    return status;
}

static float clamp01(float x)
{
    return fminf(1, fmaxf(0, x)); /* NaN becomes 0 */
}

/* A channel of the texel at (x, y) of a picture of width x height texels, nearest; row 0 on top. */
static float sample(const struct image *image, int x, int y, int width, int height, int channel)
{
    size_t column = (size_t)x * (size_t)image->width_px / (size_t)width;
    size_t row = (size_t)y * (size_t)image->height_px / (size_t)height;
    size_t texel = row * (size_t)image->width_px + column;
    return clamp01(image->values[texel * (size_t)image->channels_count + (size_t)channel]);
}

static int alpha_channel(const struct image *image)
{
    int channels = image->channels_count;
    return channels == 2 || channels == 4 ? channels - 1 : -1;
}

/* The channel that tells how opaque a picture is: its alpha where it has some, else, of an opacity
 * map, its grey; -1: none. */
static int veil_channel(const struct image *image, bool is_opacity_map)
{
    int alpha = alpha_channel(image);
    size_t texels = (size_t)image->width_px * (size_t)image->height_px;
    for (size_t i = 0; alpha >= 0 && i < texels; i++)
        if (image->values[i * (size_t)image->channels_count + (size_t)alpha] < 1)
            return alpha;
    return is_opacity_map ? 0 : -1;
}

/* color or opacity may be NULL, not both; the picture is turned upside down. */
static void fill(struct texture *texture, const struct image *color, const struct image *opacity,
                 float cutoff)
{
    int width = texture->width_px, height = texture->height_px;
    const struct image *veil = opacity ? opacity : color;
    int channel = veil_channel(veil, opacity != NULL);
    int step = color && color->channels_count >= 3 ? 1 : 0;
    for (int y = 0; y < height; y++)
        for (int x = 0; x < width; x++) {
            size_t row = (size_t)(height - 1 - y);
            float *to = texture->rgba + 4 * (row * (size_t)width + (size_t)x);
            for (int k = 0; k < 3; k++)
                to[k] = color ? sample(color, x, y, width, height, k * step) : 1;
            to[3] = 1;
            if (channel >= 0)
                to[3] = clamp01(sample(veil, x, y, width, height, channel) * 0.5f / cutoff);
        }
}

enum status import_texture(struct arena *arena, const char *path,
                           const struct import_material *material, const struct texture **texture,
                           bool *has_holes, struct error *error)
{
    struct image *color = NULL, *opacity = NULL;
    enum status status = STATUS_OK;
    *texture = NULL;
    *has_holes = false;
    if (!material->color && !material->opacity)
        return STATUS_OK;
    struct arena *scratch = arena_create(0);
    if (material->color)
        status = read_image(scratch, path, material->name, material->color, &color, error);
    if (status == STATUS_OK && material->opacity)
        status = read_image(scratch, path, material->name, material->opacity, &opacity, error);
    const struct image *size = color ? color : opacity;
    if (status == STATUS_OK && size) {
        struct texture *made = ARENA_NEW(arena, struct texture);
        made->width_px = size->width_px;
        made->height_px = size->height_px;
        size_t count = (size_t)made->width_px * (size_t)made->height_px;
        made->rgba = arena_alloc(arena, count, sizeof(float[4]));
        fill(made, color, opacity, material->alpha_cutoff);
        for (size_t i = 0; i < count; i++) {
            float *alpha = &made->rgba[4 * i + 3];
            *alpha = material->alpha_ignored ? 1 : *alpha;
            *has_holes |= *alpha < 0.5f;
        }
        *texture = made;
    }
    arena_destroy(scratch);
    return status;
}
