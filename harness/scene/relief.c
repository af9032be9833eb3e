/* Midpoint displacement on a height field: what is shared by two triangles is one height, so that
 * no crack can open. */
#include "scene/relief.h"

#include "base/random.h"
#include "plant/noise.h"

#include <stddef.h>

/* Displaces the middles of all edges along one axis; stride: between the vertices on either axis.
 */
static void cut(float *heights, const uint32_t samples[2], int axis, const uint32_t stride[2],
                double amplitude, struct random *random)
{
    size_t step = axis == 0 ? 1 : samples[0];
    size_t half = stride[axis] / 2;
    uint32_t begin[2] = {0, 0};
    begin[axis] = (uint32_t)half;
    for (uint32_t z = begin[1]; z < samples[1]; z += stride[1])
        for (uint32_t x = begin[0]; x < samples[0]; x += stride[0]) {
            float *middle = heights + (size_t)z * samples[0] + x;
            double mean = 0.5 * ((double)*(middle - half * step) + (double)middle[half * step]);
            *middle = (float)(mean + (2 * random_double(random) - 1) * amplitude);
        }
}

float *relief_heights(struct arena *arena, int level, double spike, uint64_t seed,
                      uint32_t samples[2])
{
    uint32_t stride[2] = {1u << ((level + 1) / 2), 1u << (level / 2)};
    samples[0] = stride[0] + 1;
    samples[1] = stride[1] + 1;
    float *heights = ARENA_ARRAY(arena, float, (size_t)samples[0] * samples[1]);
    struct random random = random_seed(seed, 0x72656c69);
    for (int k = 0; k < level; k++) {
        int axis = k % 2;
        cut(heights, samples, axis, stride, spike * (level - k) / level, &random);
        stride[axis] /= 2;
    }
    return heights;
}

float *relief_perlin(struct arena *arena, const struct relief_noise *noise, const double size_m[2])
{
    const uint32_t *samples = noise->samples;
    float *heights = ARENA_ARRAY(arena, float, (size_t)samples[0] * samples[1]);
    for (uint32_t z = 0; z < samples[1]; z++)
        for (uint32_t x = 0; x < samples[0]; x++) {
            double at[2] = {(double)x / (samples[0] - 1) - 0.5, (double)z / (samples[1] - 1) - 0.5};
            struct vec place = {at[0] * size_m[0] / noise->period_m, 0.5,
                                at[1] * size_m[1] / noise->period_m};
            double value = noise_octaves(noise->seed, place, noise->octaves, noise->gain);
            heights[(size_t)z * samples[0] + x] = (float)(noise->height_m * value);
        }
    return heights;
}
