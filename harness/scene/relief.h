/* Fractal relief by midpoint displacement, of the triangle counts of Hattab, Babahenini and Djedi;
 * and Perlin's noise as a relief, of which Babahenini and Djedi made their 10,000 patches. */
#ifndef TREELINE_SCENE_RELIEF_H
#define TREELINE_SCENE_RELIEF_H

#include "base/arena.h"

#include <stdint.h>

enum { RELIEF_LEVEL_MAX = 26 };

/* Heights of a rectangle that is cut in two along x, then along z, and so on, `level` times: a mesh
 * of 2^(level + 1) triangles, the paper's law (5: 64, 7: 256, 9: 1024; it prints 4 and 6 for the
 * first two). Each new vertex stands at the middle of its edge's ends, moved by (2 r - 1) spike
 * n / level, r uniform in [0, 1), n = level at the first cut and 1 at the last. The paper's r spike
 * n / count only ever raises, so that the relief drifts upward. The corners stand at 0.
 * samples: along x and z, 2^ceil(level / 2) + 1 and 2^floor(level / 2) + 1. Returns samples[1] x
 * samples[0] heights, in the unit of spike. */
float *relief_heights(struct arena *arena, int level, double spike, uint64_t seed,
                      uint32_t samples[2]);

/* Perlin's noise as a terrain. */
struct relief_noise {
    uint32_t samples[2]; /* along x and z */
    double height_m;     /* heights are within -height_m..height_m */
    double period_m;     /* between the lattice's points in the first octave */
    int octaves;         /* each of twice the frequency, gain of the amplitude */
    double gain;
    uint64_t seed;
};

/* Heights of a rectangle of size_m[0] x size_m[1] m about the origin, samples[1] x samples[0], m:
 * noise_octaves() at (x / period, 1 / 2, z / period), halfway between two layers of the lattice,
 * where the noise is 0 at no point by design. Perlin 1985, doi:10.1145/325165.325247. */
float *relief_perlin(struct arena *arena, const struct relief_noise *noise, const double size_m[2]);

#endif
