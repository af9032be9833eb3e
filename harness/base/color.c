/* The sRGB curve, IEC 61966-2-1:1999, 5.2, and bytes of linear values. */
#include "base/color.h"

#include <math.h>

static float unit_clamp(float value)
{
    return value > 0 ? (value < 1 ? value : 1.0f) : 0.0f; /* NaN compares false: 0 */
}

float srgb_encode(float linear)
{
    float x = unit_clamp(linear);
    return x <= 0.0031308f ? 12.92f * x : 1.055f * powf(x, 1 / 2.4f) - 0.055f;
}

float srgb_decode(float display)
{
    float x = unit_clamp(display);
    return x <= 0.04045f ? x / 12.92f : powf((x + 0.055f) / 1.055f, 2.4f);
}

uint8_t color_byte(float value)
{
    return (uint8_t)(unit_clamp(value) * 255 + 0.5f);
}
