/* A tree that turns into its triangles: the mix of two pictures of it, one by its slices and one by
 * its triangles, each with its coverage (Porter and Duff 1984, doi:10.1145/800031.808606: plus of
 * two that are dissolved), laid over what is behind the tree. What it hides and its light are in
 * every pixel the mean of both, by their shares.
 *
 * Drawn over each other, each thinned to its share s, they would hide less than either: where both
 * are opaque and slices let A through, (1 - s) A^(1 - s) is left. Coverage less than traced, an oak
 * 14.4 m from the eye that becomes near from 16.3 m to 13.1 m: by slices .009, by triangles .002,
 * thinned .051, mixed .004. */
#ifndef TREELINE_BAKE_STACK_NEAR_H
#define TREELINE_BAKE_STACK_NEAR_H

#include "method/method.h"

struct stack_near;

enum status stack_near_prepare(struct workspace *workspace, struct stack_near **near);

/* Binds an empty picture for the slices; the depth is the target's. */
void stack_near_slices(struct workspace *workspace, struct stack_near *near,
                       const struct target *target);
/* Binds one for the triangles, with a copy of the target's depth. */
void stack_near_triangles(struct workspace *workspace, const struct stack_near *near,
                          const struct target *target);
/* Binds the target and blends the mix over it. share: 0..1 of the triangles. */
void stack_near_end(struct workspace *workspace, const struct stack_near *near,
                    const struct target *target, float share);

#endif
