/* The sun on the ground under a pixel, whatever of it the pixel covers: the mean of what reaches
 * each place, not what reaches the mean place. A map of the ground from above holds shares of the
 * sun, each level half as fine; a pixel's footprint, longer than wide where the ground is seen at a
 * slant, is a row of places along it, each from the level that is as wide (Williams 1983, Pyramidal
 * parametrics; McCormack et al. 1999, Feline). */
#ifndef TREELINE_BAKE_SHADOW_GROUND_H
#define TREELINE_BAKE_SHADOW_GROUND_H

#include "bake/backdrop_cpu.h"
#include "bake/shadow_light.h"

enum { SHADOW_GROUND_LEVELS = 12 };

struct shadow_ground {
    float low_m[2], cell_m; /* along x and z; a cell's side at level 0 */
    int levels_count;       /* 0: no tree, no ground, or no sun above it */
    int32_t size[SHADOW_GROUND_LEVELS][2];
    uint8_t *levels[SHADOW_GROUND_LEVELS]; /* rows along z of columns along x, 0..255; what is not
                                              there is lit */
    size_t capacity;
};

/* The part of the ground that trees may shade, as the light is now; the arrays grow by the arena.
 */
void shadow_ground_fill(struct arena *arena, struct shadow_ground *ground,
                        const struct shadow_light *light, int threads);

/* A pixel that sees the ground at eye + depth ray; ray: as long as 1 along the view; right, down:
 * what is added to it one pixel on. */
struct shadow_pixel {
    float eye_m[3], depth_m, ray[3], right[3], down[3];
};
struct shadow_pixel shadow_pixel_of(const float eye_m[3], const struct backdrop_rays *rays,
                                    float x_px, float y_px, float depth_m);
/* Mean share of the sun over the pixel. Where the ground is bent, over the plane that touches it
 * there. */
float shadow_ground_at(const struct shadow_ground *ground, const struct shadow_light *light,
                       const struct shadow_pixel *pixel);
/* Takes from what a pixel shows of the ground the sun that does not reach it. sun: the share of the
 * sun's radiance times albedo that it has by its slope and through fog. */
void shadow_ground_shade(const struct shadow_ground *ground, const struct shadow_light *light,
                         const struct shadow_pixel *pixel, float sun, const float radiance[3],
                         float rgb[3]);

#endif
