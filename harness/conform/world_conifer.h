/* The conifer of the conformance checks, for methods that draw nothing else. */
#ifndef TREELINE_CONFORM_WORLD_CONIFER_H
#define TREELINE_CONFORM_WORLD_CONIFER_H

#include "plant/plant.h"

/* Whorls x boughs x twigs with needles around a trunk that begins in the ground: as high as
 * WORLD_TREE_M, within trial_bounded's ball. */
struct plant *world_conifer(struct arena *arena);

#endif
