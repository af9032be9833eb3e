/* Triangles that meet a sample, found on the CPU: where triangles are smaller than pixels, nearly
 * all of them fall between the samples or behind others, and a software rasteriser spends its time
 * on setting them up in vain.
 *
 * Wihlidal 2016, Optimizing the graphics pipeline with compute, Game Developers Conference (small
 * primitives, depth); Hasselgren and Akenine-Moeller 2016, Masked software occlusion culling,
 * doi:10.2312/hpg.20161189 (a depth buffer of the CPU's own). Departure: both work on blocks of
 * pixels; here the depth of each sample is kept, as most triangles meet one at most.
 *
 * Whatever is dropped would not have changed the picture; what is left is drawn by the rasteriser
 * as ever. */
#ifndef TREELINE_BAKE_SIFT_H
#define TREELINE_BAKE_SIFT_H

#include "bake/sampling.h"
#include "base/arena.h"
#include "scene/scene.h"

/* 28 bytes; of a plant in its own metres, of what is left in the world's. */
struct sift_vertex {
    float position_m[3];
    int16_t normal[4];  /* snorm, at most 1 long; w: odd for leaves, the rest is the caller's */
    uint16_t albedo[4]; /* unorm; w: of bark, its width (stout.h); left, 1 / growth of the run */
};

/* Elements, each a few triangles about a centre (a leaf, a piece of bark). */
struct sift_set {
    size_t count;
    float *x, *y, *z, *radius_m;  /* count each: a sphere that holds the element */
    uint32_t *first;              /* count + 1: its triangles; at most SIFT_TRIANGLES */
    struct sift_vertex *vertices; /* 3 a triangle */
    bool closed;                  /* a closed surface: back faces are not seen from without */
    int stream;                   /* where what is left goes, below SIFT_STREAMS */
};
enum { SIFT_TRIANGLES = 4, SIFT_STREAMS = 3 };

/* first: count + 1 bounds of elements of at most SIFT_TRIANGLES triangles; NULL: one each. centers:
 * count, what an element is scaled about; NULL: the middle of its box. vertices is kept. */
struct sift_set *sift_set_create(struct arena *arena, struct sift_vertex *vertices, size_t count,
                                 const uint32_t *first, const float (*centers)[3]);

/* A run of a set's elements for one tree: those from `begin` on, around the end, as many as `kept`
 * rounded up. Element k of the run is scaled about its centre by growth * clamp((kept - k - 0.5) /
 * (taper * kept), 0, 1), taper 0: by growth. A plain run has kept = count, growth = 1, taper = 0.
 */
struct sift_run {
    const struct sift_set *set;
    uint32_t begin;
    float kept, growth, taper;
    uint16_t stout; /* bark at least as wide is left out; 0: none */
};

struct sift_tree {
    const struct instance *instance;
    size_t first_run, runs_count;
    float low_m, high_m,
        radius_m; /* the cylinder about its axis that holds it, at scale and stretch
                     1 */
    bool within;  /* the eye may be within it: back faces of closed surfaces are seen */
    int16_t mean; /* even; added to its normals' w */
};

struct sift;

/* triangles_room: of each stream of each thread that fit at a time, at least 4096. */
struct sift *sift_create(struct arena *arena, int threads, size_t triangles_room);

/* Begins a picture with the samples of `places` in each of its pixels. trees are best sorted from
 * near to far; trees and runs must last. */
void sift_begin(struct sift *sift, const struct view *view, const struct sampling_places *places,
                const struct sift_tree *trees, size_t trees_count, const struct sift_run *runs);

/* Fills `vertices` (room for sift_vertices_count) until it is full or all is done. Returns false
 * when nothing was left to do. Then stream s has spans[s][t] for each thread t. */
struct sift_span {
    size_t first, count; /* vertices */
};
size_t sift_vertices_count(const struct sift *sift);
int sift_threads(const struct sift *sift);
bool sift_fill(struct sift *sift, struct sift_vertex *vertices);
struct sift_span sift_left(const struct sift *sift, int stream, int thread);

#endif
