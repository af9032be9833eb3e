/* Trees so near to the eye that no picture of them from afar is right, drawn by their triangles.
 *
 * A picture is orthographic. On a plane through a tree's axis, d from the eye, it spans
 * atan(r / d) to each side, the tree of radius r itself asin(r / d): the picture is 22 % narrower
 * at 1.2 radii, 11 % at 2, 5 % at 3; and within the tree the plane may lie behind the eye. Coverage
 * measured against the ray tracer, tree of the conformance world: billboards .80 of it at 1.25
 * radii, .90 at 2, .94 at 3. */
#ifndef TREELINE_BAKE_NEARBY_H
#define TREELINE_BAKE_NEARBY_H

#include "bake/cull.h"
#include "bake/sampling.h"
#include "method/method.h"

/* At most so many trees are drawn in a picture; the others stay with the method. */
enum { NEARBY_MOST = 64 };

struct nearby;
struct shadow_map;

/* radii: a tree is near when the eye is closer to its axis than so many of its radii, and no
 * farther above or below it than what that is more than one; 0: none ever is. octaves: of that
 * distance, over which it becomes near gradually; 0: at once. The triangles are uploaded here when
 * the camera's path comes so near, else by the first picture that needs them. shadows: received;
 * NULL: none. */
enum status nearby_prepare(struct workspace *workspace, const struct scene *scene, float radii,
                           float octaves, const struct shadow_map *shadows, struct nearby **nearby);

/* Takes the near trees out of a list that is sorted by depth; those that are not near altogether
 * stay in it, too. */
void nearby_take(struct nearby *nearby, const struct view *view, enum cull_order order,
                 struct cull_list *list);

/* Of nearby_take's view, the share of a tree that is to be shown by its triangles; 0 of one that is
 * near altogether or not at all. */
float nearby_share(const struct nearby *nearby, uint32_t instance);

/* Draws the trees that are near altogether, without blending, depth tested, into what is bound, of
 * so many samples a texel. Nothing where there is none. */
enum status nearby_draw(struct workspace *workspace, struct nearby *nearby, const struct view *view,
                        int samples, struct cull *cull);

/* The same of one tree that becomes near, all of it. */
enum status nearby_draw_one(struct workspace *workspace, struct nearby *nearby,
                            const struct view *view, uint32_t instance, int samples,
                            struct cull *cull);

#endif
