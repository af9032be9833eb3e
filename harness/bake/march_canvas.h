/* A tile of the march's picture while it is drawn: rays opened, marched, turned into pixels. */
#ifndef TREELINE_BAKE_MARCH_CANVAS_H
#define TREELINE_BAKE_MARCH_CANVAS_H

#include "bake/march_job.h"

enum { TILE_MAX = 64 };

/* The first two are given. */
struct canvas {
    struct backdrop_cpu *backdrop;
    march_kernel *kernel;
    struct march_rays rays;
    /* Of pixels; columns and rows outside of the picture are never opened. */
    float left[TILE_MAX * TILE_MAX + MARCH_ROOM], depths_m[TILE_MAX * TILE_MAX + MARCH_ROOM];
    float gathered[TILE_MAX * TILE_MAX][4]; /* radiance */
    float rgb[TILE_MAX * TILE_MAX][3];      /* of what is behind the trees */
    float suns[TILE_MAX * TILE_MAX];        /* where the sun has shadows */
    struct backdrop_tile tile;
    uint64_t lookups; /* of far pictures */
    int open_count;   /* pixels through which more can be seen */
    float stop;       /* a pixel is closed at this transmittance */
};

/* What is behind the trees, of the tile whose upper left pixel is (x, y), of side_px. */
void canvas_begin(struct canvas *canvas, const struct march_view *picture, int x, int y,
                  int side_px);
/* Opens its pixels, before anything is drawn. */
void canvas_open(struct canvas *canvas, const struct march_view *picture);
void canvas_splat(struct canvas *canvas, const struct march_splat *splat,
                  const struct backdrop_rays *picture_rays);
/* A tree of a few pixels: a far picture of it, with what that hides and shines altogether (its)
 * made to be what it ought to (far). share: of its optical depth. */
void canvas_sprite(struct canvas *canvas, const struct march_view *picture,
                   const struct march_tree *tree, const struct march_sprite *sprite,
                   const struct march_far *its, const struct march_far *far, float share);
/* Whether what is behind hides a splat from a pixel. */
bool canvas_hides(const struct march_splat *splat, const struct backdrop_rays *picture_rays,
                  float x_px, float y_px, float behind_m);
/* Takes a share of the light from a pixel, its number in the tile. */
void canvas_over(struct canvas *canvas, int at, float share);
/* What lies between two depths along the view, m. */
void canvas_march(struct canvas *canvas, const struct march_view *picture,
                  const struct march_tree *tree, const struct march_seen *seen, float from_m,
                  float to_m);
/* Shadows on the terrain, where it is still seen. */
void canvas_shade(struct canvas *canvas, const struct march_view *picture);
/* pixels: of the picture, height x width x 4. */
void canvas_end(const struct canvas *canvas, const struct view *view, float *pixels);
/* The same of a tile without trees, not opened. */
void canvas_end_clear(const struct canvas *canvas, const struct view *view, float *pixels);

#endif
