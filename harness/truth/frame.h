/* A picture: linear RGB and plant coverage, with its variance where it was sampled. */
#ifndef TREELINE_TRUTH_FRAME_H
#define TREELINE_TRUTH_FRAME_H

#include "base/arena.h"
#include "base/error.h"

#include <stdbool.h>

struct frame {
    int width_px, height_px;
    float *rgba;     /* height x width x 4: linear RGB (background included), plant coverage; row 0 on top */
    float *variance; /* height x width x 4: variance of the mean of each value; NULL: exact (no sampling) */
};

struct frame *frame_create(struct arena *arena, int width_px, int height_px, bool with_variance);

/* treeline's own raw format: "TLFRAME1", int32 width, height, flags, then the float planes, little endian, XXH3
 * at the end. Read and written without OpenImageIO, so that timed processes need none. */
enum status frame_save(const struct frame *frame, const char *path, struct error *error);
enum status frame_load(struct arena *arena, const char *path, struct frame **frame,
                       struct error *error);
/* The same bytes in memory, for the cache. */
void *frame_pack(struct arena *arena, const struct frame *frame, size_t *size);
enum status frame_unpack(struct arena *arena, const void *data, size_t size, const char *name,
                         struct frame **frame, struct error *error);

/* Hash of size and values (not of variance). */
uint64_t frame_hash(const struct frame *frame);
/* STATUS_BAD_PICTURE, with the first pixel and value, when a value is NaN, infinite, or alpha is outside
 * [-tolerance, 1 + tolerance]. */
enum status frame_check(const struct frame *frame, struct error *error);

#endif
