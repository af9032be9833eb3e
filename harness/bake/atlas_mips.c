/* Mip-maps of the atlas that keep coverage and radiance. */
#include "bake/atlas_bake.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

void atlas_halve(const float *from, int width_px, int height_px, float *to)
{
    int step_x = width_px > 1 ? 2 : 1, step_y = height_px > 1 ? 2 : 1;
    float share = 1 / (float)(step_x * step_y);
    for (int y = 0; y < height_px / step_y; y++)
        for (int x = 0; x < width_px / step_x; x++, to += TEXEL_FLOATS) {
            float weights = 0;
            memset(to, 0, TEXEL_FLOATS * sizeof *to);
            for (int k = 0; k < step_x * step_y; k++) {
                int row = y * step_y + k / step_x, column = x * step_x + k % step_x;
                const float *texel =
                    from + TEXEL_FLOATS * ((size_t)row * (size_t)width_px + (size_t)column);
                float weight = texel[0] + texel[1] + texel[2] + 1e-4f * texel[3];
                for (int i = 0; i < 4; i++)
                    to[i] += share * texel[i];
                for (int i = 4; i < TEXEL_FLOATS; i++)
                    to[i] += weight * texel[i];
                weights += weight;
            }
            for (int i = 4; i < TEXEL_FLOATS; i++)
                to[i] = weights > 0 ? to[i] / weights : 0.5f;
        }
}

void atlas_fill(float *texels, int width_px, int height_px, const float *coarser)
{
    int step_x = width_px > 1 ? 2 : 1, step_y = height_px > 1 ? 2 : 1;
    int coarser_width = width_px / step_x;
    for (int y = 0; y < height_px; y++)
        for (int x = 0; x < width_px; x++) {
            float *texel = texels + TEXEL_FLOATS * ((size_t)y * (size_t)width_px + (size_t)x);
            const float *above = coarser + TEXEL_FLOATS * ((size_t)(y / step_y * coarser_width) +
                                                           (size_t)(x / step_x));
            if (texel[3] > 0)
                continue;
            memcpy(texel + 4, above + 4, (TEXEL_FLOATS - 4) * sizeof *texel);
        }
}

/* Coverage, scaled and clamped as a byte holds it, at a point between texels; nothing lies outside.
 */
static float coverage_at(const float *texels, int width_px, int height_px, float x, float y,
                         float scale)
{
    int column = (int)floorf(x), row = (int)floorf(y);
    float sum = 0;
    for (int k = 0; k < 4; k++) {
        int i = column + (k & 1), j = row + (k >> 1);
        float weight = (k & 1 ? x - (float)column : 1 - x + (float)column) *
                       (k >> 1 ? y - (float)row : 1 - y + (float)row);
        if (i < 0 || j < 0 || i >= width_px || j >= height_px)
            continue;
        float alpha = texels[TEXEL_FLOATS * ((size_t)j * (size_t)width_px + (size_t)i) + 3];
        sum += weight * fminf(scale * alpha, 1);
    }
    return sum;
}

/* Share of the texels that pass the test. */
static double passing_share(const float *texels, int width_px, int height_px, float scale)
{
    size_t count = (size_t)width_px * (size_t)height_px, passed = 0;
    for (size_t i = 0; i < count; i++)
        passed += scale * texels[TEXEL_FLOATS * i + 3] >= 0.5f;
    return (double)passed / (double)count;
}

/* Share of the level that passes the test: at four points a texel, at one in large levels. */
static double tested_share(const float *texels, int width_px, int height_px, float scale)
{
    int points = width_px * height_px > 4096 ? 1 : 4;
    size_t passed = 0;
    for (int y = 0; y < height_px; y++)
        for (int x = 0; x < width_px; x++)
            for (int k = 0; k < points; k++) {
                int corner = points == 4 ? k : (x + 2 * y) & 3;
                float dx = corner & 1 ? 0.25f : -0.25f, dy = corner & 2 ? 0.25f : -0.25f;
                passed += coverage_at(texels, width_px, height_px, (float)x + dx, (float)y + dy,
                                      scale) >= 0.5f;
            }
    return (double)passed / ((double)points * width_px * height_px);
}

float atlas_test_scale(const float *texels, int width_px, int height_px, bool nearest)
{
    enum { STEPS = 12 };
    size_t count = (size_t)width_px * (size_t)height_px;
    double wanted = 0;
    for (size_t i = 0; i < count; i++)
        wanted += texels[i * TEXEL_FLOATS + 3] / (double)count;
    if (wanted <= 0)
        return 1;
    double low = 0.125, high = 8; /* the share grows with the scale */
    for (int step = 0; step < STEPS; step++) {
        double middle = sqrt(low * high);
        double share = nearest ? passing_share(texels, width_px, height_px, (float)middle)
                               : tested_share(texels, width_px, height_px, (float)middle);
        if (share < wanted)
            low = middle;
        else
            high = middle;
    }
    return (float)sqrt(low * high);
}
