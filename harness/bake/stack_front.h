/* Trees drawn front to back into a picture of their own, in groups; after each group pixels that
 * let nothing more through are closed, so that what is behind them fails the depth test (Porter and
 * Duff 1984, doi:10.1145/800031.808606: under). The picture has 16 bits a channel or more: in 8
 * bits what is nearly transparent rounds to nothing, again and again. */
#ifndef TREELINE_BAKE_STACK_FRONT_H
#define TREELINE_BAKE_STACK_FRONT_H

#include "method/method.h"

struct stack_front;

enum status stack_front_prepare(struct workspace *workspace, struct stack_front **front);

/* Binds the empty picture, which shares the target's depth. */
void stack_front_begin(struct workspace *workspace, struct stack_front *front,
                       const struct target *target);
/* Blends what follows under what is there, depth tested. */
void stack_front_under(struct workspace *workspace);
/* Closes saturated pixels for what follows, in the target's depth, too. */
void stack_front_close(struct workspace *workspace, const struct stack_front *front);
/* Binds the target and blends the picture over it. */
void stack_front_end(struct workspace *workspace, const struct stack_front *front,
                     const struct target *target);

#endif
