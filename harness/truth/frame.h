/* A picture: linear RGB and plant coverage, with its variance where it was sampled. */
#ifndef TREELINE_TRUTH_FRAME_H
#define TREELINE_TRUTH_FRAME_H

#include "base/arena.h"
#include "base/error.h"

#include <stdbool.h>

struct frame {
    int width_px, height_px;
    float *rgba; /* height x width x 4: linear RGB (background included), plant coverage; row 0 on
                    top */
    float *variance; /* height x width x 4: variance of the mean of each value; NULL: exact (no
                        sampling) */
};

/* What frame_check lets alpha overshoot [0, 1] by: blending in 16-bit floats rounds. */
#define FRAME_ALPHA_TOLERANCE 0.01f
/* Largest picture: 2^26 pixels (8192 x 8192), no side above 2^15. */
#define FRAME_PIXELS_MAX (1 << 26)
#define FRAME_SIDE_MAX_PX (1 << 15)

/* Zeroed. A size outside the limits above is the caller's mistake: it is cut to them. */
struct frame *frame_create(struct arena *arena, int width_px, int height_px, bool with_variance);

/* treeline's own raw format, little endian, read and written without OpenImageIO, so that timed
 * processes need none: the magic, int32 width, height, flags (1: variance follows), float32 rgba,
 * float32 variance, and the XXH3-64 (hash_bytes from 0) of all that stands before it. Refused with
 * the file's name: another magic, unknown flags, a size outside the limits, a length that the size
 * does not give, a wrong hash. */
#define FRAME_FILE_MAGIC "TLFRAME1"
enum status frame_save(const struct frame *frame, const char *path, struct error *error);
enum status frame_load(struct arena *arena, const char *path, struct frame **frame,
                       struct error *error);
/* The same bytes in memory, for the cache. */
void *frame_pack(struct arena *arena, const struct frame *frame, size_t *size);
enum status frame_unpack(struct arena *arena, const void *data, size_t size, const char *name,
                         struct frame **frame, struct error *error);

/* Hash of size and values (not of variance). */
uint64_t frame_hash(const struct frame *frame);
/* STATUS_BAD_PICTURE, with the first pixel and value, when a value is NaN, infinite, or alpha is
 * outside
 * [-FRAME_ALPHA_TOLERANCE, 1 + FRAME_ALPHA_TOLERANCE], or a variance is negative or not finite. */
enum status frame_check(const struct frame *frame, struct error *error);

#endif
