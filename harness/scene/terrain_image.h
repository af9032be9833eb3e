/* Heights and colours of a terrain from image files, decoded once and kept in the cache. */
#ifndef TREELINE_SCENE_TERRAIN_IMAGE_H
#define TREELINE_SCENE_TERRAIN_IMAGE_H

#include "scene/description.h"

/* Row 0 at the smallest z. */
struct terrain_image {
    uint32_t width, height;
    float *values; /* height x width x channels */
};

/* One channel, 2..TERRAIN_SAMPLES_MAX px a side, finite. Unsigned integers are in [0, 1]; floats
 * and signed integers (EXR, GeoTIFF) as they stand in the file. Both functions keep what they
 * decode in the cache, by the hash of the file's bytes, up to 2^25 values, so that OpenImageIO is
 * loaded only on a miss. Memory: the file, and 4 bytes a value three times while decoding, once
 * after. */
enum status terrain_image_heights(struct arena *arena, const char *path,
                                  struct terrain_image *heights, struct error *error);
/* Three channels, linear (integers are decoded from sRGB), each 0..1; a fourth is not looked at. */
enum status terrain_image_colors(struct arena *arena, const char *path,
                                 struct terrain_image *colors, struct error *error);

/* The colour at samples_x x samples_z vertices, whose outermost are the image's outermost pixels:
 * by a tent as wide as the coarser one's spacing, so that an image of the terrain's own size is
 * taken as it is, a coarser one is interpolated and a finer one averaged. */
float (*terrain_image_resample(struct arena *arena, const struct terrain_image *colors,
                               uint32_t samples_x, uint32_t samples_z))[3];

#endif
