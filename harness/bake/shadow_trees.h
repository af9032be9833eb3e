/* Trees as all their triangles in the world, for methods that need the very triangles that cast
 * shadows: nothing is pruned, the light is that of method polygons (bake/shade.glsl). */
#ifndef TREELINE_BAKE_SHADOW_TREES_H
#define TREELINE_BAKE_SHADOW_TREES_H

#include "method/method.h"

struct shadow_trees;
struct shadow_map;

/* STATUS_UNSUPPORTED where the trees have more triangles together than triangles_most. */
enum status shadow_trees_check(struct workspace *workspace, const struct scene *scene,
                               int triangles_most);
/* map: whose shadows the trees receive; NULL: none. Checked as above. */
enum status shadow_trees_prepare(struct workspace *workspace, const struct scene *scene,
                                 int triangles_most, const struct shadow_map *map,
                                 struct shadow_trees **trees);
/* A vertex of the instance's plant in the world: the same floats that are drawn. */
void shadow_trees_place(const struct instance *instance, const float point[3], float world_m[3]);
/* Triangles of the bound vertex array by 32-bit indices, to which base is added, in calls of
 * bounded size with a flush after each: llvmpipe holds all triangles that it has not rasterised
 * yet. */
void shadow_trees_indices(struct gl *gl, size_t first, size_t count, uint32_t base);
void shadow_trees_draw(struct workspace *workspace, const struct shadow_trees *trees,
                       const struct view *view);

#endif
