/* The random streams of placement, one a purpose and index, so that no draw depends on another's
 * number. */
#ifndef TREELINE_SCENE_PLACE_RANDOM_H
#define TREELINE_SCENE_PLACE_RANDOM_H

#include "base/random.h"

enum place_salt { SALT_QUAD = 1, SALT_CHOICE, SALT_TREE, SALT_DART };

struct random place_random(uint64_t seed, enum place_salt salt, uint64_t index);

#endif
