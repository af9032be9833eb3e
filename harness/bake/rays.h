/* Rays for methods: the reference's tracer, at a number of samples a pixel that a method names. */
#ifndef TREELINE_BAKE_RAYS_H
#define TREELINE_BAKE_RAYS_H

#include "method/method.h"

/* Rays of a picture beyond which rays_draw refuses: pixels x samples. */
#define RAYS_PRIMARY_MAX ((size_t)1 << 27)

/* Belongs to the workspace's arena and ends with it. */
struct rays;
/* The plants' geometry and the terrain in the ray tracer's hierarchy. */
enum status rays_prepare(struct workspace *workspace, const struct scene *scene,
                         struct rays **rays);
/* Every pixel from samples rays, a power of two from 4 on, whose places are not the reference's,
 * with the workspace's effects. STATUS_UNSUPPORTED above RAYS_PRIMARY_MAX. Counts its rays. */
enum status rays_draw(struct workspace *workspace, const struct rays *rays, const struct view *view,
                      int samples, struct target *target);

#endif
