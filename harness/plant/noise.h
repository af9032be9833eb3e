/* Perlin's gradient noise: a smooth random function of space, the same on every machine. */
#ifndef TREELINE_PLANT_NOISE_H
#define TREELINE_PLANT_NOISE_H

#include "plant/grow.h"

/* In (-1, 1), 0 at whole coordinates, features about 1 apart, continuous to the second derivative.
 * Perlin 2002, "Improving Noise", doi:10.1145/566654.566636: his twelve gradients and his fade;
 * a hash of seed and lattice point stands for his table, so the noise does not repeat. */
double noise_gradient(uint64_t seed, struct vec p);

/* Octaves summed: each has twice the frequency of the one before and gain of its amplitude; divided
 * by the sum of the amplitudes, so in (-1, 1). octaves >= 1. Perlin 1985,
 * doi:10.1145/325165.325247.
 */
double noise_octaves(uint64_t seed, struct vec p, int octaves, double gain);

#endif
