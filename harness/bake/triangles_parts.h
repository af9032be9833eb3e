/* What the files of trees by their triangles share. */
#ifndef TREELINE_BAKE_TRIANGLES_PARTS_H
#define TREELINE_BAKE_TRIANGLES_PARTS_H

#include "bake/levels.h"
#include "bake/plant_draws.h"
#include "bake/sift_gl.h"
#include "bake/sift_plant.h"
#include "bake/triangles.h"

enum {
    VARIANT_BARK,
    VARIANT_LEAF,
    VARIANT_LEAF_LIT,
    VARIANT_BARK_TEXTURED,
    VARIANT_LEAF_TEXTURED,
    VARIANT_PRUNED,
    VARIANT_SIFTED, /* and, in the order of the streams, the next two */
    VARIANTS = VARIANT_SIFTED + SIFT_STREAMS
};

/* A species. */
struct kind {
    bool drawn; /* some tree is of it */
    struct levels levels;
    struct plant_gl gpu;     /* instanced drawing, */
    struct sift_plant *sift; /* or sifted */
    uint32_t probes_count;
    struct prune_vertex *probes; /* some elements, for the plant's mean radiance */
    float stretch[2];            /* of its trees, least and most; between them in equal ratios */
    int first_mean, means_count; /* are the stretches of its means */
    uint32_t first_group, groups_count;
};

/* One call's worth of commands: which program, which mesh. */
struct call {
    const struct kind *kind;
    const struct plant_gl_batch *batch; /* NULL: pruning */
    size_t first, count;
    uint64_t triangles;
};

struct triangles {
    const struct scene *scene;
    struct triangles_request request;
    size_t kinds_count;
    struct kind *kinds;
    struct cull_bound *bounds; /* kinds_count */
    int means_count;           /* that the shaders hold: a bark's and a leaf's each */
    GLuint programs[VARIANTS]; /* those in use */
    uint8_t *runs;             /* instances_count: which run of elements; NULL: none is pruned */
    /* instanced drawing */
    GLuint placed_buffer, command_buffer;
    size_t commands_room;
    struct plant_command *commands;
    struct call *calls; /* of a frame: one a batch and one a kind's pruning at most */
    uint32_t *groups;   /* trees_room */
    uint32_t *first;    /* groups_count + 1 */
    size_t groups_count;
    /* sifted drawing, if any */
    struct sift_gl sifted;
    struct sift_tree *sift_trees; /* trees_room */
    struct sift_run *sift_runs;
};

/* The share of an element's run over which it shrinks away. */
float triangles_taper(const struct triangles *triangles);
/* VARIANT_... of the program that draws a batch. */
int triangles_variant(const struct triangles *triangles, const struct plant_gl_batch *batch);

/* Where the shaders have the mean of the bark of a tree, of the nearest step of its stretch; its
 * leaves' follows. */
int triangles_mean_of(const struct kind *kind, float stretch);
float triangles_mean_stretch(const struct kind *kind, int step);

#endif
