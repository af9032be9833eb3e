/* Frames as pictures on disk, and error maps as colours. Loads OpenImageIO when called; not for
 * timed processes. */
#ifndef TREELINE_TRUTH_FRAME_IMAGE_H
#define TREELINE_TRUTH_FRAME_IMAGE_H

#include "truth/frame.h"
#include "wall/image.h"

/* By the path's ending. .exr: 32-bit float channels R, G, B, A, and variance.R, .G, .B, .A where
 * the frame has variance; A is the plants' coverage, RGB holds the background and is not multiplied
 * by A. .png: 8-bit sRGB of R, G, B alone (coverage is no opacity). Any other ending is
 * STATUS_INVALID. Equal frames are equal files. */
enum status frame_write_image(const char *path, const struct frame *frame, struct error *error);

/* Any picture: a raw frame file (by its first bytes), or what OpenImageIO reads. Integer files are
 * decoded from sRGB to linear. Channels R, G, B by name, else the first three; one or two channels
 * are grey (and alpha). A (or the file's alpha) is the coverage; without one the coverage is 1 and
 * has_coverage false. variance.R ... are read back when all four are there. STATUS_INVALID above
 * the limits of truth/frame.h. */
enum status frame_read_image(struct arena *arena, const char *path, struct frame **frame,
                             bool *has_coverage, struct error *error);

/* A map of errors as colours from black through violet and orange to pale yellow (matplotlib's
 * magma, CC0, S. van der Walt and N. Smith; 17 of its colours, linear between). map: height x
 * width; 0 to full; values outside are clamped, NaN is 0. The image is R, G, B and already
 * sRGB-encoded: write it with encode false. */
struct image *map_to_image(struct arena *arena, const float *map, int width_px, int height_px,
                           float full);

#endif
