/* Images on disk through OpenImageIO. The C++ shim is a shared object loaded when first used, so that a
 * process which reads and writes no image never starts OpenImageIO. */
#ifndef TREELINE_WALL_IMAGE_H
#define TREELINE_WALL_IMAGE_H

#include "base/arena.h"
#include "base/error.h"

#include <stdbool.h>
#include <stdint.h>

struct image {
    int width_px, height_px, channels_count;
    float *values;           /* height x width x channels; row 0 on top */
    const char *const *names; /* channels_count names, or NULL: R, G, B, A */
};

/* Reads any format OpenImageIO knows. linear: sRGB-encoded files (8-bit PNG, JPEG) are decoded to linear; false keeps
 * the stored values (heights, normals), scaled to [0, 1] for integers. Images above 2^28 values are refused. */
enum status image_read(struct arena *arena, const char *path, bool linear, struct image **image,
                       struct error *error);
/* .exr: half or float by bits (16, 32), linear, no date, so equal images are equal files. .png: 8 or 16
 * bits, encode applies the sRGB curve to the colour channels (not alpha), values clamped. Other endings refused. */
enum status image_write(const char *path, const struct image *image, int bits, bool encode,
                        struct error *error);
/* A PNG in memory (for pages), 8 bits. */
enum status image_png(struct arena *arena, const struct image *image, bool encode, uint8_t **bytes,
                      size_t *size, struct error *error);

#endif
