/* A plant's triangles and pruned elements in vertex arrays, for instanced drawing. */
#ifndef TREELINE_BAKE_PLANT_GL_H
#define TREELINE_BAKE_PLANT_GL_H

#include "bake/detail.h"
#include "bake/levels.h"
#include "bake/prune.h"
#include "method/method.h"

/* The instanced attributes: place, turn (of the run of pruned elements: how many, their growth),
 * run (the first element; the width from which on bark is left out, as stout.h packs it, unorm) and
 * shape (stretch; the first of the mean radiances that are the tree's). */
struct plant_gl_placed {
    float foot_m[3], scale;
    float turn[2], kept, growth; /* cosine, sine */
    float begin, stout;
    float stretch, mean;
};

struct plant_gl_batch {
    enum material_kind kind;
    GLuint texture; /* 0: none */
    bool thin, flat, closed;
    struct detail_range levels[DETAIL_LEVELS_MAX];
    struct detail_range stout[LEVELS_STEPS_MAX]; /* of bark, what is drawn with a step of pruning */
};

/* Attributes 0 position, 1 normal, 2 albedo, 3 texture coordinates, 4 an element's centre, 5 place,
 * 6 turn, 7 run, 8 shape. */
struct plant_gl {
    GLuint detail, pruned; /* vertex arrays; pruned 0: none */
    size_t batches_count;
    struct plant_gl_batch *batches;
};

/* placed: a buffer of struct plant_gl_placed. */
void plant_gl_detail(struct workspace *workspace, const struct detail *detail,
                     const struct levels *levels, GLuint placed, struct plant_gl *plant);
/* The index list is 0, 1, 2, ... twice: a run that starts late goes on at the beginning. */
void plant_gl_pruned(struct workspace *workspace, const struct prune *prune, GLuint placed,
                     struct plant_gl *plant);

#endif
