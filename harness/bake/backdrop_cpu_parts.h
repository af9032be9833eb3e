/* What the two halves of the CPU's backdrop share: a picture's constants and the bent terrain. */
#ifndef TREELINE_BAKE_BACKDROP_CPU_PARTS_H
#define TREELINE_BAKE_BACKDROP_CPU_PARTS_H

#include "bake/backdrop_cpu.h"

struct hills;

/* Light and fog of a picture, as shade_bark and shade_fog of shade.glsl have them. */
struct backdrop_light {
    float sun_direction[3];
    float in_sun[3], in_shade[3]; /* the terrain's albedo times the sun's and the sky's light */
    float fog_color[3], fog_density_per_m; /* density 0: none */
};

/* by_rays: a ray a pixel through a quadtree (bake/terrain_rays.h), not triangle by triangle: the
 * same picture. */
struct hills *hills_prepare(struct arena *arena, const struct terrain *terrain, bool by_rays);
/* Projects vertices and chunks. */
void hills_begin(struct hills *hills, const struct view *view, int threads);
/* Nearer surfaces over what the tile holds: depths_m and rgb. */
void hills_tile(const struct hills *hills, const struct backdrop_rays *rays, const float eye_m[3],
                const struct backdrop_light *light, const struct backdrop_tile *tile);

/* The share that fog leaves; distance_m: to the eye. */
static inline float backdrop_clear(const struct backdrop_light *light, float distance_m)
{
    return light->fog_density_per_m > 0 ? expf(-light->fog_density_per_m * distance_m) : 1;
}

/* Fog over a radiance. */
static inline void backdrop_fog(const struct backdrop_light *light, float distance_m, float rgb[3])
{
    if (light->fog_density_per_m <= 0)
        return;
    float clear = backdrop_clear(light, distance_m);
    for (int c = 0; c < 3; c++)
        rgb[c] = light->fog_color[c] + clear * (rgb[c] - light->fog_color[c]);
}

#endif
