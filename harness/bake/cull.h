/* Which trees are seen, how near, in which order and group: the CPU's part of every instanced
 * method. */
#ifndef TREELINE_BAKE_CULL_H
#define TREELINE_BAKE_CULL_H

#include "base/arena.h"
#include "scene/scene.h"

/* A sphere that holds a plant of scale and stretch 1: its centre is on the plant's +y axis, so
 * turning does not move it. */
struct cull_bound {
    float center_y_m, radius_m;
};
struct cull_bound cull_bound_of(const struct mesh *mesh);

/* The cylinder about its axis that holds a plant of scale and stretch 1. */
struct cull_cylinder {
    float low_m, high_m, radius_m;
    float beyond_m; /* longer at both ends, by the tree's scale alone */
};
/* Whether a tree's cylinder, margin_m wider and longer at both ends, holds the eye. */
bool cull_cylinder_holds(const struct cull_cylinder *cylinder, const struct instance *instance,
                         const float eye_m[3], float margin_m);

enum cull_order { CULL_AS_PLACED, CULL_FRONT_TO_BACK, CULL_BACK_TO_FRONT };

/* The spheres of a scene's instances, laid out for fast tests, and room for the lists. */
struct cull;

/* bounds: one for each species of the scene. */
struct cull *cull_create(struct arena *arena, const struct scene *scene,
                         const struct cull_bound *bounds);

/* The trees in a view. The arrays belong to the cull and last until its next call. */
struct cull_list {
    size_t count;
    uint32_t *instances; /* count: indices into scene->instances */
    float *depths_m;     /* count: of the spheres' centres along view->forward; may be negative */
};

/* Trees whose spheres touch the frustum, sorted by depth (stable: ties stay as placed). */
struct cull_list cull_view(struct cull *cull, const struct view *view, enum cull_order order);

/* The same of some instances alone. */
struct cull_list cull_view_of(struct cull *cull, const struct view *view, enum cull_order order,
                              const uint32_t *instances, size_t count);

/* Regroups a list: groups[k] < groups_count is the group of list->instances[k] (say species and
 * level). Within a group the order stays. first: groups_count + 1 values, where each group begins.
 */
void cull_group(struct cull *cull, struct cull_list *list, const uint32_t *groups,
                size_t groups_count, uint32_t *first);

/* Planes of a view's frustum: unit normals inward, distance. */
void cull_planes(const struct view *view, float planes[6][4]);

/* Pixels that one metre covers at a depth of one metre: px = metres * cull_focal_px / depth. */
float cull_focal_px(const struct view *view);

/* Stable radix sort by key, ascending (descending when down): keys and values, count each; the
 * scratch arrays hold count as well. NaN sorts behind everything. */
void cull_sort(float *keys, uint32_t *values, float *scratch_keys, uint32_t *scratch_values,
               size_t count, bool down);

#endif
