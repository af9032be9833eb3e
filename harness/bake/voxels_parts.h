/* The steps from triangles to voxels: a sparse grid of what rays meet, its pyramid. */
#ifndef TREELINE_BAKE_VOXELS_PARTS_H
#define TREELINE_BAKE_VOXELS_PARTS_H

#include "bake/voxels.h"

enum { VOXEL_RAYS = 8 }; /* along a voxel's side */

/* What a voxel holds. Areas in units of the finest voxels' faces. */
struct voxel_mass {
    float area, bark; /* of all, of bark; back faces of bark and needles hide nothing and count
                         half */
    float moments[6]; /* sum of area n n': xx, yy, zz, xy, xz, yz */
    float facing[3];  /* sum of area |n_i| */
    float albedo[3];  /* sum of area x albedo */
    float cover[3];   /* share of the rays along each axis that meet something */
    uint64_t rays[3]; /* which: bit b + 8 c, b and c the other two axes in cyclic order */
};

struct voxel_grid {
    uint32_t size[3];
    uint32_t *cells; /* 0: empty; else 1 + index into masses */
    size_t count, capacity;
    struct voxel_mass *masses;
};

/* The finest grid: size given, its cells of side voxel_m from origin_m on. */
enum status voxel_grid_fill(struct arena *arena, const struct mesh *mesh, const float origin_m[3],
                            float voxel_m, struct voxel_grid *grid, struct error *error);
/* Half as fine. */
void voxel_grid_halve(struct arena *arena, const struct voxel_grid *fine,
                      struct voxel_grid *coarse);
/* Optical depth of a voxel of which rays meet a share; where all of 64 rays meet something, no more
 * is known than that less than one passes. Times the cover to a power: below. */
float voxel_depth(float cover, float power);
/* The area that a plant hides along each axis, in its finest voxels' faces: of all rays through it.
 */
void voxel_grid_hidden(struct arena *arena, const struct voxel_grid *finest, double areas[3]);
/* The powers of their covers that optical depths have to be multiplied with so that the grid hides
 * such areas (in its own faces). Voxels behind each other share their outlines, so that those that
 * hide a part of their faces hide too much together; what is full stays opaque. */
void voxel_grid_temper(struct arena *arena, const struct voxel_grid *grid, const double areas[3],
                       float powers[3]);
/* Noma's opacity of eight cells, 0..1; 2 k and 2 k + 1 are a pair along the axis. */
float voxel_noma(const float opacities[8]);
/* Empty cells (0) become their Chebyshev distance to the nearest full one, at most 255; full ones
 * stay and must be VOXELS_FIRST or more. */
void voxel_distances(const uint32_t size[3], uint32_t *cells);

#endif
