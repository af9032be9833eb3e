/* Perlin's gradient noise and its octaves. */
#include "plant/noise.h"

/* The largest sum of eight gradients' ramps is 1.0364, beside a cube's middle. */
static const double noise_bound = 1.04;

static double ramp(uint64_t seed, const int64_t cell[3], int corner, const double in[3])
{
    static const signed char gradients[12][3] = {
        {1, 1, 0},  {-1, 1, 0},  {1, -1, 0}, {-1, -1, 0}, {1, 0, 1},  {-1, 0, 1},
        {1, 0, -1}, {-1, 0, -1}, {0, 1, 1},  {0, -1, 1},  {0, 1, -1}, {0, -1, -1},
    };
    uint64_t hash = random_mix(seed);
    double sum = 0, offset[3];
    for (int i = 0; i < 3; i++) {
        int step = corner >> i & 1;
        hash = random_mix(hash ^ (uint64_t)(cell[i] + step));
        offset[i] = in[i] - step;
    }
    /* The upper half scaled to 12: unbiased to 3e-9. */
    const signed char *gradient = gradients[(hash >> 32) * 12 >> 32];
    for (int i = 0; i < 3; i++)
        sum += gradient[i] * offset[i];
    return sum;
}

double noise_gradient(uint64_t seed, struct vec p)
{
    const double at[3] = {p.x, p.y, p.z};
    int64_t cell[3];
    double in[3], fade[3], sum = 0;
    for (int i = 0; i < 3; i++) {
        double low = floor(at[i]);
        cell[i] = (int64_t)low;
        in[i] = at[i] - low;
        fade[i] = in[i] * in[i] * in[i] * (in[i] * (in[i] * 6 - 15) + 10);
    }
    for (int corner = 0; corner < 8; corner++) {
        double weight = 1;
        for (int i = 0; i < 3; i++)
            weight *= corner >> i & 1 ? fade[i] : 1 - fade[i];
        sum += weight * ramp(seed, cell, corner, in);
    }
    return sum / noise_bound;
}

double noise_octaves(uint64_t seed, struct vec p, int octaves, double gain)
{
    double sum = 0, total = 0, amplitude = 1;
    for (int k = 0; k < octaves; k++) {
        sum += amplitude * noise_gradient(seed + (uint64_t)k, p);
        total += amplitude;
        amplitude *= gain;
        p = vec_scale(p, 2);
    }
    return sum / total;
}
