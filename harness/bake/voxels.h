/* A plant as a sparse pyramid of voxels that remember how much they hide in each direction and how
 * their surfaces are turned: the raw material of every ray march.
 *
 * Hiding: rays along the three axes, 64 a voxel's face, are tested against the plant's triangles;
 * the optical depth -ln(1 - covered share) of each axis, with the correlations of the normals'
 * second moments, gives a matrix S of extinction(w) = sqrt(w' S w) per metre (the form of SGGX,
 * Heitz, Dupuy, Crassin and Dachsbacher 2015, doi:10.1145/2766988). A coarser voxel's rays pass
 * through the finer ones' triangles, so that what hides the same ray twice counts once.
 *
 * Light: M = the area-weighted mean of n n'. For unit directions w to the eye and l to the sun,
 * with a = w' M w, b = l' M l, c = w' M l, the closures below are exact for isotropic and for
 * parallel normals:
 *
 *     E |n.w|        = evenness * sqrt(a)
 *     E |n.w| |n.l|  = G = (2 / pi) (sqrt(a b - c c) + |c| asin(|c| / sqrt(a b)))
 *     two-sided leaf, mean |N.L| of what is seen:       G / E |n.w|
 *     one-sided leaf or bark, mean max(0, N.L), N toward the eye:  (G + c) / (2 E |n.w|) */
#ifndef TREELINE_BAKE_VOXELS_H
#define TREELINE_BAKE_VOXELS_H

#include "base/arena.h"
#include "plant/plant.h"

enum { VOXELS_RESOLUTION_MAX = 512, VOXELS_LEVELS_MAX = 10, VOXELS_FIRST = 256 };

/* 16 bytes. shape and normals hold a symmetric matrix of trace 1 in 30 bits, from bit 0 on: xx, yy,
 * xy, xz, yz; a diagonal entry is bits / 63, one beside it (bits - 31) / 62. */
struct voxel {
    float extinction; /* sqrt(trace S), per voxel's side at its level */
    uint32_t shape;   /* S / trace S */
    uint32_t normals; /* M */
    uint32_t color;   /* bytes from bit 0 on: red, green, blue as shares of voxels.albedo; 4 bits of
                         evenness, .75 + bits / 60; 4 bits of the bark's share of area, / 15 */
};

struct voxels_level {
    uint32_t size[3]; /* voxels along x, y, z */
    float voxel_m;    /* side */
    /* size z, y, x (x fastest). Below VOXELS_FIRST an empty voxel: the Chebyshev distance, 1..255
     * voxels, to the nearest that is not; else VOXELS_FIRST + index into voxels.voxels. */
    uint32_t *cells;
};

struct voxels {
    float origin_m[3]; /* lowest corner of every level, in the plant's axes */
    float albedo[3];   /* the greatest of each colour */
    uint32_t levels_count, voxels_count;
    struct voxels_level levels[VOXELS_LEVELS_MAX]; /* each twice as coarse; the last is one voxel */
    struct voxel *voxels;
};

/* resolution: voxels along the plant's longest extent, 1..VOXELS_RESOLUTION_MAX. Cached on disk. An
 * empty mesh gives one empty voxel. */
enum status voxels_of_plant(struct arena *arena, struct plant *plant, int resolution,
                            const struct voxels **voxels, struct error *error);

/* The same plant with Noma's directional opacities (1995): each voxel hides by its opacity along
 * the three axes alone, and a coarser one's is 1 - the mean, over the four pairs of its cells along
 * the axis, of (1 - r)(1 - r'), as if what is in one cell knew nothing of the next. Between the
 * axes: the optical depths' root mean square, by the squared cosines. Light and cells stay as they
 * are; cells are shared. */
const struct voxels *voxels_noma(struct arena *arena, const struct voxels *voxels);

/* The same plant with the mean of each voxel's normals in their place (voxels_visible.h), in the
 * word `normals`, and shapes to go with it: as large as hide along the three axes together what
 * they hid. Cells are shared. */
const struct voxels *voxels_visible(struct arena *arena, const struct voxels *voxels);

/* A voxel unpacked, as the march does it. Matrices: xx, yy, zz, xy, xz, yz. */
struct voxel_optics {
    float extinction, shape[6], normals[6], albedo[3], evenness, bark;
};
struct voxel_optics voxel_unpack(const struct voxels *voxels, uint32_t index);
struct voxel voxel_pack(const struct voxel_optics *optics, const float albedo[3]);

#endif
