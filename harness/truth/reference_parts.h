/* What the files of the reference share: the traced scene, the tile and the plan of samples. */
#ifndef TREELINE_TRUTH_REFERENCE_PARTS_H
#define TREELINE_TRUTH_REFERENCE_PARTS_H

#include "truth/reference.h"
#include "wall/embree.h"

/* The samples of a pixel are this many independently scrambled sets. More sets estimate the
 * variance better (one degree of freedom less than sets), fewer sets make better use of the low
 * discrepancy: at equal samples the variance grows as sets^0.14 on sub-pixel leaves, sets^0.5 on
 * clean edges. */
#define REFERENCE_REPLICATES 4
#define REFERENCE_SAMPLES_LIMIT 65536
#define REFERENCE_SIDE_LIMIT 16384

/* How one part of a mesh, or the bark or the needles of a conifer, is shaded. */
struct surface {
    const struct mesh *mesh; /* NULL: of a conifer, flat and not varied */
    uint32_t first_triangle;
    bool leaf;
    bool plant;  /* counts as coverage */
    bool flat;   /* the vertices' normals are the triangles' own */
    bool varied; /* the albedo changes within a triangle */
    float albedo[3];
    float specular, exponent; /* of a needle's lobe; 0: none */
    float (*tints)[3]; /* albedo of each triangle of the part, with the vertices' colour; NULL:
                          albedo */
    const struct texture *texture;
};

/* What a hit needs to know of its instance. */
struct placement {
    float turn_cos, turn_sin;
    float rise; /* of normals, against their width: 1 / stretch */
    uint32_t first_surface;
};

struct traced_scene {
    const struct scene *scene;
    struct embree *embree;
    struct surface *surfaces;
    struct placement *placements; /* instances_count, then the terrain */
};

/* Builds plants that have an instance, terrain, and their Embree scene. The caller ends it with
 * embree_destroy on *traced's embree, also after an error (it may be NULL). */
enum status traced_scene_build(struct arena *arena, const struct scene *scene, int threads,
                               struct traced_scene *traced, struct error *error);

/* Albedo of the point that a packet's lane has hit on a surface. */
void surface_albedo(const struct surface *surface, const struct embree_packet *packet, int lane,
                    float albedo[3]);

/* What one picture is made of; read by all threads. */
struct picture {
    struct traced_scene traced;
    const struct view *view;
    unsigned effects;
    uint64_t seed;
    int width_px, height_px;
    float sun[3], ambient[3]; /* radiance of a white surface; 0 where the effect is off */
    bool sun_shines, sky_shines;
    bool masked; /* the shadow mask in place of light */
    /* Not unit direction through (x, y) px, 1 along the view's forward: corner + x step_x + y
     * step_y. */
    float corner[3], step_x[3], step_y[3];
};

struct ray_counts {
    double primary, shadow, occlusion;
};

/* Means of each replicate so far: pixels x REFERENCE_REPLICATES x RGBA, as sums; and the samples of
 * each pixel. */
struct samples {
    float (*sums)[REFERENCE_REPLICATES][4];
    uint32_t *counts; /* taken */
    uint32_t *wanted; /* to be taken; a multiple of REFERENCE_REPLICATES */
};

#define TILE_SIDE 16

struct tile_work; /* what one thread needs; lives in the arena */
struct tile_work *tile_work_create(struct arena *arena);

/* Takes the missing samples of the tile's pixels. tile: number, row by row. */
void tile_trace(const struct picture *picture, struct tile_work *work, int tile,
                struct samples *samples, struct ray_counts *counts);

/* Variance of each pixel's mean: pixels x RGBA, from the replicates. */
void samples_variance(const struct samples *samples, size_t pixels, float (*variance)[4]);

/* log2 of the share of samples, in steps of 1 / PLAN_STEPS, from -PLAN_LEVELS / 2 on. */
#define PLAN_STEPS_BITS 4
#define PLAN_STEPS (1 << PLAN_STEPS_BITS)
#define PLAN_LEVELS 2048

/* Where samples are worth most: each pixel's share from the variances of its neighbours alone, so
 * that how often a pixel is sampled does not depend on what its own samples were. variance: height
 * x width x RGBA, of the pilot. */
void plan_levels(const float (*variance)[4], int width_px, int height_px, int16_t *levels);

struct plan_limits {
    uint32_t samples_min, samples_max; /* powers of two */
    double target;                     /* standard error, RMS over pixels and RGB */
};

#define PLAN_SCALE_LEAST (-2 * PLAN_LEVELS)

struct plan {
    struct plan_limits limits;
    int width_px;
    int16_t *levels; /* a pixel */
    int scale[2];    /* of the two halves of the picture; at first PLAN_SCALE_LEAST */
};
/* Sets wanted so that the target is likely to be met. variance: of the means now. False when
 * nothing more can or need be done. */
bool plan_next(struct plan *plan, const float (*variance)[4], size_t pixels,
               struct samples *samples);
/* RMS over pixels and RGB of the standard error. */
double plan_standard_error(const float (*variance)[4], size_t pixels);

#endif
