/* Horizon maps of a terrain: for each height sample and azimuth how high the terrain hides the sky
 * (Max 1988, doi:10.1007/BF01905562). A sun that moves needs nothing new. */
#ifndef TREELINE_BAKE_SKYLINE_H
#define TREELINE_BAKE_SKYLINE_H

#include "base/arena.h"
#include "scene/scene.h"

#define SKYLINE_AZIMUTHS_MOST 256
/* Where nothing of the terrain is ahead. */
#define SKYLINE_OPEN (-1e4f)

struct skyline {
    uint32_t samples_x, samples_z;
    int azimuths; /* k of them: k * 2 pi / azimuths, as the sun's: 0 toward +z, grows toward +x */
    float *tangents; /* azimuths x samples_z x samples_x: of the horizon's elevation */
};

/* The same surface with more samples: every quad becomes parts x parts, with the same diagonals.
 * Between samples a map is mixed, while the horizon falls as 1 / distance and jumps where a facet
 * ends: more samples are nearer to both. */
void skyline_refine(struct arena *arena, const struct terrain *terrain, int parts,
                    struct terrain *fine);

/* Each azimuth by one sweep along lines of the grid: the upper hull of what is ahead is kept, and a
 * line's next point looks along its tangent (as Timonen and Westerholm 2010, doi:10.1111/
 * j.1467-8659.2009.01642.x): time and memory are linear in the samples. Stewart 1998
 * (doi:10.1109/2945.675656) keeps such hulls in sectors. A line passes between two samples of each
 * column or row; the sample takes its far horizon from the two lines beside it, by their distances,
 * and looks at the next triangles itself. threads: more than one azimuth at once. */
void skyline_bake(struct arena *arena, const struct terrain *terrain, int azimuths, int threads,
                  struct skyline *skyline);

/* The same of one sample toward any azimuth, from every edge of the triangles that the ray passes:
 * slow and exact. */
float skyline_exact(const struct terrain *terrain, uint32_t x, uint32_t z, double azimuth_rad);

#endif
