/* Sky and terrain for methods that draw on the CPU: what backdrop.h draws, tile by tile. */
#ifndef TREELINE_BAKE_BACKDROP_CPU_H
#define TREELINE_BAKE_BACKDROP_CPU_H

#include "method/method.h"

struct backdrop_cpu;

enum status backdrop_cpu_prepare(struct workspace *workspace, const struct scene *scene,
                                 struct backdrop_cpu **backdrop);
/* Once a picture, before its tiles: the terrain's depth and light. */
void backdrop_cpu_begin(struct workspace *workspace, struct backdrop_cpu *backdrop,
                        const struct view *view);

struct backdrop_tile {
    int x_px, y_px, width_px, height_px; /* within the picture; row 0 on top */
    int stride;                          /* pixels from row to row in what follows */
    float *depths_m;                     /* along the view; INFINITY where the sky is */
    float (*rgb)[3];
    float *suns; /* of the terrain, times its albedo and the sun's radiance: how much of rgb is the
                    sun's; left alone where the sky is. NULL: not wanted */
};
/* Both may run in several threads at once. Depths first, then colours where share > 0. */
void backdrop_cpu_tile(const struct backdrop_cpu *backdrop, const struct backdrop_tile *tile);

/* The ray of pixel (x, y), (0, 0) the centre of the upper left one: first + x right + y down, as
 * long as 1 along the view. */
struct backdrop_rays {
    float first[3], right[3], down[3];
};
struct backdrop_rays backdrop_rays_of(const struct view *view);

#endif
