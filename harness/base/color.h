/* Display encoding: sRGB (IEC 61966-2-1), the one curve between linear values and stored pictures.
 */
#ifndef TREELINE_BASE_COLOR_H
#define TREELINE_BASE_COLOR_H

/* Linear to display and back. Inputs are clamped to [0, 1]; NaN gives 0. */
float srgb_encode(float linear);
float srgb_decode(float display);

#endif
