/* Voxel colouring: pictures with depth, taken around a plant, become a volume of coloured voxels.
 *
 * Babahenini and Djedi 2006 (volumetric textures from voxel colouring): each pixel is projected
 * back to where its depth says, and its colour goes to the voxel there. Seitz and Dyer 1997,
 * doi:10.1109/CVPR.1997.609462: a voxel is kept when the views that see it agree on its colour.
 * Which views see it, they find by sweeping the voxels in order of depth; here each view's depths
 * say it exactly, ray by ray. Departures: opacity is the share of the rays arriving in a voxel that
 * end in it (the paper gives every coloured voxel 255; `binary` does), and the colour is the mean
 * of all pixels (the paper's is the last one's). */
#ifndef TREELINE_PLANT_COLORING_H
#define TREELINE_PLANT_COLORING_H

#include "base/arena.h"
#include "plant/mesh.h"

enum { COLORING_GRID_MAX = 256, COLORING_VIEWS_MAX = 64 };

/* A picture with depth. Its camera is orthonormal: right x up = -forward. The middle of pixel
 * (column, row), row 0 on top, is x = 2 (column + 1/2) / width - 1, y = 1 - 2 (row + 1/2) / height;
 * its ray is, with half[0] x right + half[1] y up = s:
 *   orthographic: position + s + t forward;   pinhole: position + t (forward + s).
 * depth is t: it is measured along forward. */
struct depth_view {
    bool pinhole;
    float position_m[3], right[3], up[3], forward[3];
    float half[2]; /* orthographic: half the picture's width and height, m; pinhole: tangents of
                      half the angles */
    int width_px, height_px;
    const float (*color)[3]; /* height x width, linear RGB; only looked at where depth is finite */
    const float *depth_m;    /* height x width; INFINITY: nothing there */
    const float *leaf;       /* height x width: 1 thin as a leaf, 0 the skin of something solid;
                                NULL: all 1 */
};

struct coloring_request {
    int grid; /* voxels along each side of the box, 2..COLORING_GRID_MAX */
    float minimum_m[3], maximum_m[3];
    bool binary;       /* coloured voxels are opaque */
    float agreement;   /* a voxel is carved where the views' mean colours deviate by more (sample
                          standard deviation of the worst of R, G, B); INFINITY: never */
    float see_through; /* a voxel is carved where more than this share of the rays of a view (of 4
                          rays or more) pass it; 1: never */
};

/* What a cell of the grid holds. */
enum { COLORING_UNSEEN, COLORING_CLEAR, COLORING_CARVED, COLORING_FIRST };

struct colored_voxel {
    uint32_t cell;
    float color[3], opacity, leaf;
    float normal[3];     /* mean, of length at most 1; either sign where both sides were seen */
    float position_m[3]; /* mean of the points that were seen */
    float area_m2;       /* of the surface inside, as far as it is seen */
    float chord_m;       /* mean length of the rays' way through the voxel, were none to end: what
                            hides opacity on that way hides 1 - (1 - opacity)^(w / chord_m) on
                            another of w metres */
};

struct coloring {
    int grid;
    float minimum_m[3], voxel_m[3];
    /* grid z, y, x (x fastest): no ray came here; rays pass and none ends; coloured but carved; or
     * COLORING_FIRST + index into voxels. */
    uint32_t *cells;
    size_t voxels_count; /* coloured */
    struct colored_voxel *voxels;
    size_t unseen_count, clear_count, carved_count;
};

/* Colours a volume. The same for any number of threads. Cells that no view sees stay UNSEEN: inside
 * of something opaque, or behind it in too few views. */
void coloring_build(struct arena *arena, const struct depth_view *views, size_t views_count,
                    const struct coloring_request *request, struct coloring *coloring);

/* The normal of the surface at a pixel whose depth is finite, toward the camera, from the depths
 * beside it; where they jump by more than 8 pixels' size it faces the camera. */
void depth_view_normal(const struct depth_view *view, int column, int row, float normal[3]);
/* The point at a depth on a pixel's ray. */
void depth_view_point(const struct depth_view *view, int column, int row, float depth_m,
                      float point_m[3]);

/* One rectangle a voxel (two triangles, one leaf element), at the mean of the points that were
 * seen, across the mean normal, of the area that they tell: what any method can draw. NULL without
 * a coloured voxel. It is a cloud of flat pieces: what is solid has no inside, and hardly any
 * holes.
 */
struct mesh *coloring_mesh(struct arena *arena, const struct coloring *coloring);

#endif
