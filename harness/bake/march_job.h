/* Trees as the march has them, and what one of them is to a block of pixels. */
#ifndef TREELINE_BAKE_MARCH_JOB_H
#define TREELINE_BAKE_MARCH_JOB_H

#include "bake/backdrop_cpu.h"
#include "bake/march.h"
#include "bake/march_parts.h"
#include "bake/march_tree.h"

/* A species as the march has it. */
struct march_species {
    const struct voxels *voxels;
    const uint32_t *cells[VOXELS_LEVELS_MAX]; /* of its levels, as march_free.h has them */
    const struct mesh *mesh;
    float center_m[3]; /* of the finest level's box, in the plant's axes */
    float half_m[3];   /* its half extents */
    float radius_m;    /* of a sphere around it that holds the plant */
    bool is_solid;     /* its leaves are needles, lit on the outside alone */
};

/* voxels: of the plant, or made of them; mesh: the plant's. */
void march_species_fill(struct arena *arena, const struct voxels *voxels, const struct mesh *mesh,
                        struct march_species *species);

struct march_shadows;

/* Constants of a picture. */
struct march_view {
    const struct view *view;
    const struct scene *scene;
    struct backdrop_rays rays;
    float focal_px;
    unsigned effects;
    struct march_options options;
    const struct march_species *species;
    const struct march_shadows *shadows; /* NULL: the sun has none */
};

enum { MARCH_SPLAT = 255, MARCH_SPRITE = 253 };
/* A tree's sphere of this radius is seen as a splat. */
#define MARCH_SMALL_PX 0.8f

/* Where a tree is on the screen: pixels whose centres its box may cover, at a level; low above
 * high: none. Smaller than a pixel: level MARCH_SPLAT, the four pixels around its middle; not much
 * larger: MARCH_SPRITE, those that its sphere may touch. */
struct march_seen {
    int16_t low[2], high[2];
    uint8_t level;
    uint8_t next; /* share of 255 that is drawn at the next coarser level */
    uint8_t far;  /* share of 255 that is drawn from a far picture: of a sprite, as a splat */
    uint8_t gone; /* share of 255 that a cell, or what is in this one, shows instead */
    bool within;  /* the eye is in its bark */
};
struct march_seen march_see(const struct march_view *picture, const struct march_tree *tree,
                            float depth_m);

/* Depths along the view that a tree's box at a level takes (m), the side of its voxels there; of a
 * splat, its box at the finest. */
struct march_span {
    float near_m, far_m, voxel_m;
    float rest_m; /* the least near_m from here to the list's end */
};
struct march_span march_span_of(const struct march_view *picture, const struct march_tree *tree,
                                uint32_t level);

/* x' S y of a packed matrix as a model has it. */
struct march_form march_form_of(enum march_model model, const float x[3], const float y[3]);

/* Everything but the block's own first ray, for pixels around (x, y). */
void march_job_fill(const struct march_view *picture, const struct march_tree *tree, uint32_t level,
                    float x_px, float y_px, struct march_job *job);
/* The first ray for the block whose upper left pixel is (x, y). */
void march_job_aim(const struct march_view *picture, const struct march_tree *tree, float x_px,
                   float y_px, float voxel_m, struct march_job *job);

/* A tree's middle: x and y in pixels from the first pixel's centre, and its depth. */
void march_middle(const struct march_view *picture, const struct march_tree *tree, float middle[3]);
/* The pixels first..last, cut to the picture, along an axis. */
void march_seen_between(struct march_seen *seen, int axis, float first, float last, int size_px);

/* How a species, turned by a step, looks from far away in a direction. */
struct march_far {
    float cover_m2, rgb[3]; /* hidden of the screen's plane at its depth, for scale 1; radiance */
    float sun_rgb[3];       /* of that by the sun, where it has shadows */
};
/* The same as a small picture: what a rectangle of the screen's plane around its middle shows, as
 * sums over all texels above and to the left (Crow 1984, doi:10.1145/800031.808600), row 0 on top:
 * radiance times cover, cover. */
enum { SPRITE_SIDE = 8 };
struct march_sprite {
    float sums[SPRITE_SIDE + 1][SPRITE_SIDE + 1][4];
    float sides_m[2]; /* right, down; for scale 1 */
} __attribute__((aligned(16)));
/* Of what is seen of the sun's light on a plant, the share that is left by the plant's own shadow;
 * shadows is not NULL. */
float march_far_lit(const struct march_view *picture, uint32_t species, uint32_t turn, float x_px,
                    float y_px, march_kernel *kernel);
void march_far_fill(const struct march_view *picture, uint32_t species, uint32_t turn, float x_px,
                    float y_px, march_kernel *kernel, struct march_far *far,
                    struct march_sprite *sprite);

/* What is hardly larger than a pixel: spread evenly over a rectangle of the picture. */
enum { SPLAT_SIDE = 6 };
struct march_splat {
    int x_px, y_px, columns, rows; /* pixels that it touches, SPLAT_SIDE each way at most */
    float across[SPLAT_SIDE], along[SPLAT_SIDE]; /* the share in a pixel: across x along */
    float depth_m, lift_m;                       /* of its middle; of its foot above the eye */
    float rgb[3];
    float area_px2; /* what it hides altogether */
    float share;    /* of its optical depth that is drawn */
    bool is_many;   /* trees, which may hide each other */
};
/* The share that fog leaves of what is at a march_middle. */
float march_clear(const struct march_view *picture, const float middle[3]);
/* All but its area. middle: as march_middle; sides: 1..SPLAT_SIDE - 1. */
void march_splat_place(const struct march_view *picture, const float middle[3],
                       const float sides_px[2], float foot_y_m, const struct march_far *far,
                       struct march_splat *splat);
void march_splat_of(const struct march_view *picture, const struct march_tree *tree,
                    const struct march_far *far, struct march_splat *splat);

#endif
