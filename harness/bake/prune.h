/* Far trees by stochastic pruning: a plant as a shuffled list of small triangles of which any run
 * stands for all.
 *
 * Cook, Halstead, Planck, Ryu 2007, Stochastic simplification of aggregate detail,
 * doi:10.1145/1276377.1276476: a random fraction f of the elements is kept and scaled to 1/f of its
 * area, so that the total area stays (eq. 2). Departures: a leaf is one triangle from the start,
 * a solid one (a needle) two of its sides, of half its surface together, and bark, which is no
 * aggregate, is cut into samples of the leaves' mean area, so that one list and one draw make
 * a whole far tree. */
#ifndef TREELINE_BAKE_PRUNE_H
#define TREELINE_BAKE_PRUNE_H

#include "base/arena.h"
#include "plant/mesh.h"
#include "scene/scene.h"

/* 40 bytes. */
struct prune_vertex {
    float position_m[3];
    float center_m[3];  /* of the element: position = center + grow * (position - center) */
    int16_t normal[4];  /* snorm; w: 32767 leaf, -32767 needle, 0 bark */
    uint16_t albedo[4]; /* unorm, texture included; w: of bark, its width, see stout.h */
};

struct prune {
    size_t count;                  /* elements */
    struct prune_vertex *vertices; /* 3 x count, in random order of elements */
    /* What a run's number of elements goes by: leaves' opaque area, one side; half of the bark's;
     * all of the needles', of which the elements are half as large: their grain shows more. */
    double area_m2;
};

/* The arena is best a passing one: it also holds what was needed on the way. */
struct prune *prune_create(struct arena *arena, const struct mesh *mesh, uint64_t seed);

struct prune_light {
    const struct scene *scene;
    const struct view *view;
    unsigned effects; /* as in effects.h */
    float stretch;    /* of the tree */
};
/* Radiance of bark (0) and leaves (1) over all turns about the plant's axis, weighted by the area
 * that the view's direction sees. probes: one vertex of each of count elements, a random choice. */
void prune_mean_radiance(const struct prune_vertex *probes, size_t count,
                         const struct prune_light *light, float mean[2][3]);

#endif
