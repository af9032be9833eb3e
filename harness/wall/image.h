/* Images on disk through OpenImageIO. The C++ shim is a shared object loaded when first used, so
 * that a process which reads and writes no image never starts OpenImageIO. */
#ifndef TREELINE_WALL_IMAGE_H
#define TREELINE_WALL_IMAGE_H

#include "base/arena.h"
#include "base/error.h"

#include <stdbool.h>
#include <stdint.h>

struct image {
    int width_px, height_px, channels_count;
    float *values;            /* height x width x channels; row 0 on top */
    const char *const *names; /* channels_count names, or NULL: Y | Y, A | R, G, B | R, G, B, A */
};

/* Largest picture that is read or written: height x width x channels. */
#define IMAGE_VALUES_MAX (1 << 28)
#define IMAGE_CHANNELS_MAX 64

/* Reads the first picture of a file of any format OpenImageIO knows, with all its channels and
 * their names. linear: files of 8- and 16-bit integers (PNG, JPEG) are taken as sRGB and decoded,
 * except alpha and files that say they are linear; false keeps the stored values, integers scaled
 * to [0, 1]. Floats (EXR) are kept as they are. RGB is never multiplied or divided by alpha. A
 * missing file is STATUS_NOT_FOUND, what is no picture (a folder, text, a cut-off file) or is above
 * IMAGE_VALUES_MAX is STATUS_INVALID, no shim or OpenImageIO STATUS_UNAVAILABLE. */
enum status image_read(struct arena *arena, const char *path, bool linear, struct image **image,
                       struct error *error);
/* The same, as stored. unit: of floats and signed integers (EXR, GeoTIFF) the number in the file
 * that a value of 1 stands for; 0 of unsigned integers, which are shares of their most. */
enum status image_read_units(struct arena *arena, const char *path, struct image **image,
                             double *unit, struct error *error);
/* STATUS_INVALID unless the path ends in .exr or .png: to be asked before hours of work. */
enum status image_path_check(const char *path, struct error *error);
/* By the path's ending, whole or not at all (file_write). .exr: half or float by bits (16, 32),
 * linear, zip, no date, so equal images are equal files; half is clamped to +-65504. .png: 8 or 16
 * bits, 1 to 4 channels; encode applies the sRGB curve to the colour channels (not to alpha) and
 * says so in the file; without it values are stored as they are; both clamp to [0, 1]. Other
 * endings, bits and channel counts are STATUS_INVALID. */
enum status image_write(const char *path, const struct image *image, int bits, bool encode,
                        struct error *error);
/* The bytes that image_write would write to a .png of 8 bits, for pages. */
enum status image_png(struct arena *arena, const struct image *image, bool encode, uint8_t **bytes,
                      size_t *size, struct error *error);

#endif
