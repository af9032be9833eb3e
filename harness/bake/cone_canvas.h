/* A picture while cones of pixels are composed front to back: C = sum of w C prod (1 - w), with the
 * relief in the same cone. What is behind a pixel's trees is one layer, or, where the relief's edge
 * crosses the pixel, up to four, each with its share of 16 samples and its depth: a strip is seen
 * through the share of the pixel whose relief is behind it. */
#ifndef TREELINE_BAKE_CONE_CANVAS_H
#define TREELINE_BAKE_CONE_CANVAS_H

#include "bake/backdrop_cpu.h"
#include "bake/cone_light.h"
#include "bake/cone_strip.h"

enum { CONE_TILE = 32, CONE_LAYERS = 4 };

/* Relief or sky behind a part of a pixel. Relief without an edge there slants through it: a tree
 * smaller than a pixel may stand on any of its ground, before which it is. */
struct cone_layer {
    float depth_m, share;
    float left; /* of it is seen, once something behind it has been met */
    float rgb[3], sun;
};

struct cone_canvas {
    struct arena *arena;
    const struct scene *scene;
    struct backdrop_cpu *backdrop, *fine;  /* fine: of four times the pixels; NULL: flat */
    const struct cone_lights *lights;      /* NULL: none */
    int width_px, height_px, across, down; /* tiles */
    size_t pixels_capacity, tiles_capacity, edges_capacity;
    float *left, *share, *front_m, *rgb[3]; /* a pixel */
    float *limit_m; /* a pixel: what is nearer is before all that is seen of the relief */
    float *suns, (*behind)[3];
    int32_t *edges; /* of a pixel: -1, or which of the layers' fours */
    struct cone_layer *layers;
    uint8_t *open; /* a tile */
    float *far_m;  /* of a tile's relief; INFINITY: sky, or an edge */
    struct backdrop_rays rays;
    float eye_m[3];
};

struct cone_canvas *cone_canvas_create(struct workspace *workspace, const struct scene *scene,
                                       const struct cone_lights *lights, bool edges,
                                       enum status *status);
/* Sky and relief of a view, nothing before them. */
void cone_canvas_begin(struct workspace *workspace, struct cone_canvas *canvas,
                       const struct view *view);
/* Whether what is within so many pixels of a place on the screen, and no nearer than a depth, may
 * be seen. */
bool cone_canvas_sees(const struct cone_canvas *canvas, const float place_px[2], float reach_px,
                      float nearest_m);
/* Puts a strip's share w > 0 of a pixel over what is behind all that came before. */
void cone_canvas_put(struct cone_canvas *canvas, size_t pixel, const struct cone_strip *strip,
                     const struct cone_place *place, float w);
/* Writes pixels: height x width x 4. What lets through no more than stop is closed. */
void cone_canvas_end(struct workspace *workspace, struct cone_canvas *canvas, float stop,
                     float *pixels);

#endif
