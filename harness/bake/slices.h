/* Plants as stacks of slices, made on the CPU and kept on disk: the raw material of texels.
 *
 * A stack looks along one direction: `toward` points to the eye in front of it, right x up =
 * toward. Its box is cut along toward into count slabs of one thickness; slice 0 is the hindmost.
 * The picture of a slab is orthographic: texel (column, row) spans [column, column + 1] x [row, row
 * + 1] texels from the box's low corner along right and up (row 0 is at the bottom), its value
 * stands for its middle. From 8 texels a side on the outermost ring of texels is empty.
 *
 * What a texel holds is seen from straight in front: of each sample's hits in the slab the foremost
 * wins. Seen from behind the foremost is another; in thin slabs the difference is small and no
 * second picture is kept. Normals face the front (normal . toward >= 0): a leaf's is negated where
 * it points away, bark's is mirrored in the slice's plane, so that its sides keep theirs. Seen from
 * behind, undo the same: negate a leaf's, mirror bark's. */
#ifndef TREELINE_BAKE_SLICES_H
#define TREELINE_BAKE_SLICES_H

#include "base/arena.h"
#include "base/error.h"
#include "plant/plant.h"

#include <stdbool.h>
#include <stdint.h>

/* Where a hit goes.
 * clip:     into the slab of its depth; what lies inside closed bark is filled (Meyer and Neyret
 *           1998, section 4.1: contours), with what is nearer, the bark before or behind it. Leaves
 *           may be cut in two.
 * centroid: a leaf goes whole into the slab of its centroid (Senegas 2001, 5.7.2); bark as above.
 */
enum slices_cut { SLICES_CLIP, SLICES_CENTROID };
enum { SLICES_BARK = 1, SLICES_LEAVES = 2 }; /* parts, bits */
enum { SLICES_MOST = 512 };                  /* slices of a stack, texels of a side */
enum { SLICES_LIGHTS = 64 };

/* Light that colours are baked under. Bark's light is max(0, N.L), a leaf's |N.L| or, one-sided,
 * max(0, N.L) with N toward the eye. */
struct slices_light {
    float sun_direction[3]; /* unit, plant's space, toward the sun */
    float sun_radiance[3], ambient[3];
    bool two_sided;
    bool from_behind; /* as seen from there */
    /* Of the tree, whose normals are diag(1, 1 / stretch, 1) N over their length; 0 is 1. Else
     * directions are axes. */
    float stretch;
};

struct slices_request {
    size_t directions_count;      /* 1..64 */
    const float (*directions)[3]; /* directions_count x 3: unit, plant's space, toward the eye */
    int width_px, height_px;      /* of a picture along right and up, 1..SLICES_MOST */
    int count;                    /* slices of a stack, 1..SLICES_MOST */
    int samples;                  /* along a texel's side, 1..8 */
    enum slices_cut cut;
    unsigned parts; /* SLICES_BARK | SLICES_LEAVES */
    /* 0: from the mesh. 1..64: from so many pictures around the plant, by voxel colouring; then
     * width_px and height_px are count, directions are axes, parts are both and cut and samples do
     * not matter. */
    size_t views;
    bool binary; /* with views: a coloured voxel is opaque */
    /* 0..SLICES_LIGHTS; what is lit is not kept on disk: baking is as fast. */
    size_t lights_count;
    const struct slices_light *lights;
};

/* One slice: the smallest rectangle that holds its covered texels. The bilinear footprint of the
 * rectangle ends half a texel outside of it: draw [left - 1/2, left + width + 1/2] and likewise
 * upward. width and height are 0 where nothing is covered. */
struct slice {
    int left, bottom, width, height; /* texels of the picture */
    size_t first;                    /* its texels are [first, first + width x height), by rows */
};

struct slices_stack {
    float right[3], up[3], toward[3]; /* unit, plant's space; views_plane() of toward */
    float low_m[3], high_m[3];        /* box along right, up, toward; from the plant's foot */
};

struct slices {
    size_t stacks_count; /* as the request's directions */
    int width_px, height_px, count;
    float albedo_scale; /* colour of a full texel */
    struct slices_stack *stacks;
    struct slice *slices; /* stacks_count x count */
    size_t texels_count;
    uint8_t (*color)[4];  /* texels: albedo x coverage / albedo_scale, coverage; n / 255 */
    uint8_t (*normal)[4]; /* texels: mean normal in the plant's space, not unit: (n - 128) / 127, so
                             that 128 is 0; share of leaf in the coverage, n / 255; where covered */
    uint16_t *depth;      /* texels: mean depth, 0 at the slab's back, 65535 at its front (clamped:
                             a leaf of SLICES_CENTROID may reach out); where covered */
    size_t lights_count;
    float lit_scale;   /* radiance of a full texel */
    uint8_t (*lit)[4]; /* lights x texels: the mean radiance of what color holds, in its form: in
                          color's place, with lit_scale in albedo_scale's, it is a stack too */
};

/* Slices of a plant, from the cache or baked by at most `threads` threads (the same bytes for any
 * number). Empty parts give empty slices. STATUS_INVALID names a value of the request that is out
 * of range; the plant's errors pass through. */
enum status slices_create(struct arena *arena, struct plant *plant,
                          const struct slices_request *request, int threads,
                          const struct slices **slices, struct error *error);

/* +z, +x, +y: the three directions of Meyer and Neyret. */
extern const float slices_axes[3][3];

/* ---- Filtering: a picture is width x height x SLICES_FLOATS, row 0 at the bottom: colour x
 * coverage, coverage, normal x coverage, share of leaf x coverage, so that means and composites are
 * sums. ---- */
enum { SLICES_FLOATS = 8 };

/* Texels [first, first + count) of the arrays. */
void slices_decode(const struct slices *slices, size_t first, size_t count, float *texels);
/* The whole picture of one slice, width_px x height_px; zeros outside of its rectangle. */
void slices_expand(const struct slices *slices, size_t stack, int slice, float *texels);
/* The mean of 2 x 2 texels (a side of 1 stays, the last of an odd side is dropped into its
 * neighbour's texel: every texel counts once): max(1, side / 2) texels a side; keeps the mean. */
void slices_halve(const float *from, int width_px, int height_px, float *to);
/* to = near over far (003, 4.3.3, corrected): C = C_near + (1 - a_near) C_far, likewise coverage
 * and normals. Associative. The order matters for colour, not for coverage. to may be either. */
void slices_fuse(const float *near, const float *far, size_t texels, float *to);
/* Half as many slices, each two composited as seen from the front or, from_behind, from the back.
 * The box grows by a slab behind the front where count is odd. */
const struct slices *slices_fused(struct arena *arena, const struct slices *slices,
                                  bool from_behind);

/* Bytes for a texture, in struct slices' form. straight: colour divided by coverage. unit: normals
 * get length 1 (a zero mean stays 0). normal may be NULL. */
void slices_encode(const float *texels, size_t count, bool straight, bool unit, uint8_t (*color)[4],
                   uint8_t (*normal)[4]);
/* Gives empty texels (coverage 0) within `rings` texels of covered ones straight colour and normal:
 * ring by ring the mean of those of the 8 neighbours that have one, normals with the neighbours'
 * mean length (a zero sum gives 0); coverage stays 0. Where coverage is 1/255 or more nothing
 * changes. normal may be NULL. */
void slices_dilate(uint8_t (*color)[4], uint8_t (*normal)[4], int width_px, int height_px,
                   int rings);

#endif
