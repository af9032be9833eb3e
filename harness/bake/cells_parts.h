/* What the two halves of cells.h share: the hierarchy. */
#ifndef TREELINE_BAKE_CELLS_PARTS_H
#define TREELINE_BAKE_CELLS_PARTS_H

#include "bake/cells.h"

/* A cell of so many trees at most is not cut again. */
enum { CELLS_LEAF = 8 };

struct cells_node {
    float center_m[3], radius_m; /* a sphere that holds its trees' spheres */
    uint32_t begin, end;         /* in the order of the cells' trees */
    uint32_t far;                /* its second half; the first is the next node; 0: a leaf */
    uint32_t species;
};

/* A part of the hierarchy that one thread looks through, and what it found there. */
struct cells_run {
    uint32_t node;
    size_t count; /* listed, from the node's place on */
};
enum { CELLS_RUNS = 128 };

struct cells {
    const struct scene *scene;
    const struct cull_bound *bounds;
    size_t trees_count, nodes_count, roots_count;
    struct cells_run *runs;
    uint32_t *roots; /* one a species that has trees */
    struct cells_node *nodes;
    struct cells_sums *sums; /* one a node */
    float (*spheres)[4];     /* of each tree, in the cells' order: centre, radius, m */
    uint32_t *instances;     /* their indices in the scene */
    uint32_t *entries[2];    /* the list and its scratch, one a tree and one a node */
    float *depths_m[2];
    uint8_t *shares[2];
    uint32_t *order[2]; /* while the list is sorted */
};

/* In the unsorted list, of what is listed of a node: a place for each tree and each cell. */
static inline size_t cells_place(const struct cells *cells, uint32_t number)
{
    return (size_t)cells->nodes[number].begin + number;
}

#endif
