/* Levels of detail of a plant: near, all leaves with the coarsest bark whose surface has moved by
 * little; far, a run of the plant's pruned elements (prune.h), as many as its area has tolerances
 * squared, over bark that is still drawn whole while it is wide. */
#ifndef TREELINE_BAKE_LEVELS_H
#define TREELINE_BAKE_LEVELS_H

#include "bake/cull.h"
#include "bake/detail.h"
#include "bake/prune.h"

enum { LEVELS_STEPS_MAX = 64, LEVELS_RUNS = 16, LEVELS_RISES = 5 };

struct levels {
    struct cull_bound bound;
    float low_m, high_m, radius_m; /* of the cylinder about its axis that holds the plant */
    size_t levels_count;
    float errors_m[DETAIL_LEVELS_MAX];
    size_t level_triangles[DETAIL_LEVELS_MAX];
    float area_m2;
    uint32_t elements; /* of pruning; 0: none */
    uint32_t steps_count;
    uint32_t step_bark[LEVELS_STEPS_MAX];     /* the level of bark drawn with a step, */
    uint16_t step_stout[LEVELS_STEPS_MAX];    /* where at least so wide; else its elements are */
    uint32_t step_elements[LEVELS_STEPS_MAX]; /* descending, each 1/sqrt(2) of the one before */
    /* size of an element, beside what keeps the plant's area, to the fourth; at evenly spaced rises
     */
    float step_size4[LEVELS_STEPS_MAX][LEVELS_RISES];
};

/* Where one of the LEVELS_RUNS runs of pruned elements begins. */
uint32_t levels_begin(const struct levels *levels, uint32_t run);

/* prune: NULL for every triangle at any distance. taper: the share of a run that shrinks away. */
void levels_fill(struct levels *levels, const struct mesh *mesh, const struct detail *detail,
                 const struct prune *prune, float taper);

/* How a tree is seen. */
struct levels_seen {
    float per_m; /* tolerances a metre of the plant, at most, at the nearest point of the cylinder
                    that holds the tree */
    float rise;  /* squared sine of the elevation it is seen from, in the plant's space: 0 level, 1
                    straight down or up */
};
/* depth_m: of its middle along the view. */
struct levels_seen levels_seen(const struct levels *levels, const struct view *view, float focal_px,
                               float tolerance_px, const struct instance *instance, float depth_m);

/* step < 0: the detail level, else that step of pruning. */
struct levels_choice {
    uint32_t level;
    int step;
};
/* The choice with fewer triangles that keeps the tolerance; per_m 0: far enough for the last. */
struct levels_choice levels_choose(const struct levels *levels, float per_m);

/* The elements of a step that are kept, and their growth. taper as in levels_fill: 0 keeps the
 * step's elements, else as many as are asked for. */
struct levels_run {
    float kept, growth;
};
struct levels_run levels_run_of(const struct levels *levels, int step,
                                const struct levels_seen *seen, float taper);

#endif
