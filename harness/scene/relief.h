/* Fractal relief by midpoint displacement, of the triangle counts of Hattab, Babahenini and Djedi.
 */
#ifndef TREELINE_SCENE_RELIEF_H
#define TREELINE_SCENE_RELIEF_H

#include "base/arena.h"

#include <stdint.h>

enum { RELIEF_LEVEL_MAX = 22 };

/* Heights of a rectangle that is cut in two along x, then along z, and so on, `level` times: a mesh
 * of 2^(level + 1) triangles, the paper's law (5: 64, 7: 256, 9: 1024; it prints 4 and 6 for the
 * first two). Each new vertex stands at the middle of its edge's ends, moved by (2 r - 1) spike
 * n / level, r uniform in [0, 1), n = level at the first cut and 1 at the last. The paper's r spike
 * n / count only ever raises, so that the relief drifts upward. The corners stand at 0.
 * samples: along x and z, 2^ceil(level / 2) + 1 and 2^floor(level / 2) + 1. Returns samples[1] x
 * samples[0] heights, in the unit of spike. */
float *relief_heights(struct arena *arena, int level, double spike, uint64_t seed,
                      uint32_t samples[2]);

#endif
