/* Inside of the slices: which triangles each line of sight meets, and how far in front. */
#ifndef TREELINE_BAKE_SLICES_RASTER_H
#define TREELINE_BAKE_SLICES_RASTER_H

#include "base/arena.h"

#include <stddef.h>
#include <stdint.h>

/* A mesh as seen along one direction. Lines of sight stand on a grid of width x height; line (i, j)
 * passes through (i + 1/2, j + 1/2). Positions are snapped to 1/1024 of a line's distance, so that
 * what two triangles share is decided exactly: a closed mesh is entered as often as left. */
struct raster_plane {
    int width, height;
    int32_t (*points)[2]; /* vertices x 2, 1/1024 */
    const float *depths;  /* vertices; grows toward the eye */
    const uint32_t (*triangles)[3];
};

struct raster_hit {
    float depth;
    uint32_t triangle;
};

/* The hits of the lines of rows [row, row + rows): line (i, j)'s are [first[n], first[n + 1]), n =
 * (j - row) x width + i, foremost first, those of one depth by triangle. */
struct raster_band {
    int row, rows;
    size_t *first;
    struct raster_hit *hits;
};

/* Casts the lines of rows [row, row + rows) through the triangles numbered in list. */
void raster_cast(struct arena *arena, const struct raster_plane *plane, const uint32_t *list,
                 size_t count, int row, int rows, struct raster_band *band);

/* Twice the area in (1/1024)^2: positive where the triangle is seen counter-clockwise. */
int64_t raster_area(const struct raster_plane *plane, uint32_t triangle);

/* First and last row that the triangle can meet; first > last: none. */
void raster_rows(const struct raster_plane *plane, uint32_t triangle, int *first, int *last);

/* Weights of the three corners where line (i, j) meets the triangle; their sum is 1. The area must
 * not be 0. */
void raster_weights(const struct raster_plane *plane, uint32_t triangle, int i, int j,
                    float weights[3]);

#endif
