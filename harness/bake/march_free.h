/* How far rays may go through empty voxels, by the way that they go. */
#ifndef TREELINE_BAKE_MARCH_FREE_H
#define TREELINE_BAKE_MARCH_FREE_H

#include "bake/voxels.h"

/* A cell as the march reads it. With MARCH_FULL: the index of its voxel. Else four bits for each of
 * the eight ways, from bit 4 x way on: from wherever a ray of that way is in the cell, it meets
 * nothing before it has gone so many voxels along one of the axes, 0..15; of way 7 three bits,
 * 0..7. Bit i of a way: the ray goes down along axis i. A distance to the nearest voxel all around
 * would also count those that lie behind. Beyond the level's box all is empty. */
#define MARCH_FULL 0x80000000u
enum { MARCH_WAY_BITS = 4, MARCH_WAY_MASK = 15 };

/* size z, y, x (x fastest). */
uint32_t *march_free_cells(struct arena *arena, const struct voxels_level *level);

#endif
