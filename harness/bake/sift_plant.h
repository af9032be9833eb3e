/* A plant's batches and pruned elements as sets for sift.h. */
#ifndef TREELINE_BAKE_SIFT_PLANT_H
#define TREELINE_BAKE_SIFT_PLANT_H

#include "bake/detail.h"
#include "bake/levels.h"
#include "bake/prune.h"
#include "bake/sift.h"

/* What shades a stream: bark in each pixel, leaves in each pixel, flat triangles at their corners.
 */
enum { SIFT_BARK, SIFT_LEAF, SIFT_LIT };

struct sift_plant {
    size_t batches_count;
    bool *bark;                                  /* batches_count */
    struct sift_set *(*sets)[DETAIL_LEVELS_MAX]; /* batches_count; leaves: the first alone */
    uint32_t (*stout)[LEVELS_STEPS_MAX];         /* batches_count: of bark, elements at a step */
    struct sift_set *pruned;                     /* NULL: none */
};

/* Textures cannot be sifted: false when a batch has one. */
bool sift_plant_possible(const struct mesh *mesh);

/* In normal.w, beside its mean: lit as bark is, not as a thin leaf. Even, and above every mean. */
enum { SIFT_SOLID = 8192 };

/* prune: NULL for none. normal.w is 1 for leaves, 0 for bark, and SIFT_SOLID what is not thin. */
struct sift_plant *sift_plant_create(struct arena *arena, const struct detail *detail,
                                     const struct prune *prune, const struct levels *levels);

/* What one tree draws: its batches at a level, or a run of pruned elements over whole bark. At most
 * batches_count + 1 runs; returns how many. */
struct sift_part {
    struct levels_choice choice;
    uint32_t run; /* of pruned elements, the tree's own */
    struct levels_seen seen;
    float taper; /* as in levels_run_of */
};
size_t sift_plant_runs(const struct sift_plant *plant, const struct levels *levels,
                       const struct sift_part *part, struct sift_run *runs);

#endif
