/* How wide the stems of a plant are, so that trunks and boughs stay whole while twigs are sampled.
 */
#ifndef TREELINE_BAKE_STOUT_H
#define TREELINE_BAKE_STOUT_H

#include "base/arena.h"
#include "plant/mesh.h"

/* Widths are in steps of 1/16384 m, up to 4 m: they travel in vertices. */
uint16_t stout_pack(float width_m);

/* The mean width of the connected piece of bark that each vertex of the mesh belongs to, as that of
 * a tube of its area and of its extent's length; 0 on leaves. vertices_count values. */
uint16_t *stout_widths(struct arena *arena, const struct mesh *mesh);

/* Reorders triangles from wide to thin, else as they were. widths: of the vertices that the indices
 * name. */
void stout_order(uint32_t *indices, size_t indices_count, const uint16_t *widths);
/* Leading indices of triangles at least as wide. */
size_t stout_count(const uint32_t *indices, size_t indices_count, const uint16_t *widths,
                   uint16_t least);

#endif
