/* Mip-maps of the atlas that keep coverage and radiance. */
#include "bake/atlas_bake.h"

#include <math.h>
#include <stdlib.h>
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

static int compare_down(const void *a, const void *b)
{
    float x = *(const float *)a, y = *(const float *)b;
    return (x < y) - (x > y);
}

float atlas_test_scale(const float *texels, size_t count, float *scratch)
{
    double sum = 0;
    for (size_t i = 0; i < count; i++) {
        scratch[i] = texels[i * TEXEL_FLOATS + 3];
        sum += scratch[i];
    }
    size_t covered = (size_t)(sum + 0.5);
    if (covered == 0)
        return 0;
    qsort(scratch, count, sizeof *scratch, compare_down);
    /* Between the last texel that shall pass and the first that shall not. */
    float passes = scratch[covered - 1], fails = covered < count ? scratch[covered] : 0;
    return 1 / (passes + fails);
}
