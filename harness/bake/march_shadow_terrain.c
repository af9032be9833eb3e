/* Where bent terrain takes the sun: swept away from the sun, each sample from two of the row before
 * it. A place is dark below max(ground, height) there, lowered along the ray. */
#include "bake/march_shadow_parts.h"

#include <math.h>

/* Samples across the sweep. */
struct row {
    size_t count, stride;
    float shift;           /* along the row, in samples, to where the light comes from */
    float drop_m, least_m; /* of light to the next row; of all the terrain */
};

static void row_sweep(const struct row *row, const float *ground_m, const float *before_m,
                      float *heights_m)
{
    for (size_t k = 0; k < row->count; k++) {
        float at = (float)k + row->shift, low = floorf(at), top_m[2];
        for (int side = 0; side < 2; side++) {
            float sample = low + (float)side;
            bool inside = sample >= 0 && sample <= (float)(row->count - 1);
            size_t from = inside ? (size_t)sample * row->stride : 0;
            top_m[side] = inside ? fmaxf(before_m[from], ground_m[from]) : row->least_m;
        }
        heights_m[k * row->stride] = top_m[0] + (at - low) * (top_m[1] - top_m[0]) - row->drop_m;
    }
}

void shadow_terrain_sweep(const struct terrain *terrain, const float toward_sun[3],
                          float *heights_m)
{
    const size_t counts[2] = {terrain->samples_x, terrain->samples_z}, strides[2] = {1, counts[0]};
    const float steps[2] = {toward_sun[0] / terrain->size_x_m * (float)(counts[0] - 1),
                            toward_sun[2] / terrain->size_z_m * (float)(counts[1] - 1)};
    const int along = fabsf(steps[0]) > fabsf(steps[1]) ? 0 : 1, beside = 1 - along;
    const float pace = fabsf(steps[along]);
    float least_m = INFINITY;
    for (size_t i = 0; i < counts[0] * counts[1]; i++)
        least_m = fminf(least_m, terrain->heights_m[i]);
    for (size_t i = 0; i < counts[0] * counts[1]; i++)
        heights_m[i] = least_m - 1;
    if (!(pace * 1e6f * terrain->size_x_m > toward_sun[1]))
        return; /* straight down */
    struct row row = {.count = counts[beside],
                      .stride = strides[beside],
                      .shift = steps[beside] / pace,
                      .drop_m = toward_sun[1] / pace,
                      .least_m = least_m - 1};
    for (size_t k = 1; k < counts[along]; k++) {
        bool onward = steps[along] < 0; /* the sun is where the samples' numbers begin */
        size_t at = onward ? k : counts[along] - 1 - k, before = onward ? at - 1 : at + 1;
        row_sweep(&row, terrain->heights_m + before * strides[along],
                  heights_m + before * strides[along], heights_m + at * strides[along]);
    }
}

float shadow_terrain_at(const struct terrain *terrain, const float *heights_m,
                        const float place_m[3])
{
    const uint32_t counts[2] = {terrain->samples_x, terrain->samples_z};
    const float at_m[2] = {place_m[0] + 0.5f * terrain->size_x_m,
                           place_m[2] + 0.5f * terrain->size_z_m};
    const float sizes_m[2] = {terrain->size_x_m, terrain->size_z_m};
    float share[2];
    uint32_t low[2];
    for (int k = 0; k < 2; k++) {
        float at = at_m[k] / sizes_m[k] * (float)(counts[k] - 1);
        at = at > 0 ? at < (float)(counts[k] - 1) ? at : (float)(counts[k] - 1) : 0;
        low[k] = (uint32_t)at < counts[k] - 2 ? (uint32_t)at : counts[k] - 2;
        share[k] = at - (float)low[k];
    }
    const float *row = heights_m + (size_t)low[1] * counts[0] + low[0], *next = row + counts[0];
    float near_m = row[0] + share[0] * (row[1] - row[0]);
    float far_m = next[0] + share[0] * (next[1] - next[0]);
    return place_m[1] < near_m + share[1] * (far_m - near_m) ? 0 : 1;
}
