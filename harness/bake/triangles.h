/* Trees by their triangles: all leaves near, an error-controlled level of detail far away.
 *
 * A tree's level (bake/levels.h) follows from how large a metre appears at its nearest point. Near:
 * all leaves. Far: a run of the plant's pruned elements (bake/prune.h), as many as its area has
 * pixels of tolerance_px squared, so that no element grows past that size; a tree below a pixel is
 * two of them. Each tree takes its own of 16 runs, so that far trees are not all the same two
 * leaves.
 *
 * Where GL is software, triangles that meet no sample or are hidden are dropped before it sees them
 * (bake/sift.h): most of a forest's are smaller than a pixel. */
#ifndef TREELINE_BAKE_TRIANGLES_H
#define TREELINE_BAKE_TRIANGLES_H

#include "bake/cull.h"
#include "bake/sampling.h"
#include "bake/shadow_map.h"
#include "method/method.h"

struct triangles_request {
    size_t trees_room;  /* trees drawn at a time, at most */
    float tolerance_px; /* how large a pruned leaf may grow; 0: every triangle at any distance */
    bool smooth;        /* pruned leaves shrink away one by one instead of in steps */
    bool contrast;      /* pruned leaves are drawn nearer to their mean radiance */
    bool sift;          /* where GL is software and no plant has a texture */
    const struct shadow_map *shadows; /* received; NULL: none. Then nothing is sifted */
};

struct triangles;

/* tolerance_px by a method's option: that at lod=auto, twice as much at intermediate, four times at
 * low, 0 at high. */
float triangles_tolerance_px(float error_px, enum lod lod);

/* Uploads the plants of all species that have trees. */
enum status triangles_prepare(struct workspace *workspace, const struct scene *scene,
                              const struct triangles_request *request,
                              struct triangles **triangles);

/* One a species, for cull_create. */
const struct cull_bound *triangles_bounds(const struct triangles *triangles);

/* The order that triangles_draw wants a list in. */
enum cull_order triangles_order(const struct triangles *triangles);

struct triangles_frame {
    const struct view *view;              /* the picture's */
    const struct view *drawn;             /* with the size of what is bound */
    const struct sampling_places *places; /* of each texel of what is bound */
    struct cull *cull;                    /* that the list is of */
};
/* Draws all trees that may shade a shadow map's pass, with its programs, into what is bound. */
void triangles_cast(struct workspace *workspace, struct triangles *triangles,
                    const struct shadow_pass *pass);

/* Draws the trees of a list into what is bound, depth tested. Reorders the list. Leaves a program
 * and a vertex array bound. */
void triangles_draw(struct workspace *workspace, struct triangles *triangles,
                    const struct triangles_frame *frame, struct cull_list *list);

#endif
