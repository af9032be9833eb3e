/* Colours as they are stored: sRGB (IEC 61966-2-1), the one curve between linear values and stored
 * pictures; bytes of textures. */
#ifndef TREELINE_BASE_COLOR_H
#define TREELINE_BASE_COLOR_H

#include <stdint.h>

/* Linear to display and back. Inputs are clamped to [0, 1]; NaN gives 0. */
float srgb_encode(float linear);
float srgb_decode(float display);

/* The nearest of 0..255 to 255 times a value; values are clamped to [0, 1], NaN gives 0. */
uint8_t color_byte(float value);

#endif
