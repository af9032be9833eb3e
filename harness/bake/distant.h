/* Trees of a few pixels: single pictures of the plants, drawn by the CPU into one picture of all of
 * them, which OpenGL blends over the backdrop, under the trees that are nearer.
 *
 * A software OpenGL sets up two to five million small triangles a second; a tree of 2 x 4 pixels
 * drawn here takes a tenth of that. Trees are kept in cells of many: a cell outside of the view, or
 * behind what lets nothing through any more, is passed over as a whole. Cells are drawn front to
 * back and each pixel under what it holds already (Porter and Duff 1984,
 * doi:10.1145/800031.808606). */
#ifndef TREELINE_BAKE_DISTANT_H
#define TREELINE_BAKE_DISTANT_H

#include "bake/cull.h"
#include "method/method.h"

struct distant;

/* limit_px: a tree is distant where the largest tree would be shorter than so many pixels; over so
 * many octaves of distance from there on it becomes so gradually, 0: at once. *distant is NULL
 * where trees are stretched: their pictures would be others. */
enum status distant_prepare(struct workspace *workspace, const struct scene *scene, float limit_px,
                            float octaves, struct distant **distant);

/* Culls the scene: returns the trees in view that are not distant, or not yet altogether, sorted,
 * and remembers the cells of those that are. The list is the cull's, as cull_view's. */
struct cull_list distant_cull(struct distant *distant, struct cull *cull, const struct view *view,
                              enum cull_order order);

/* The share of an instance's optical depth that is drawn as distant, of distant_cull's view; 0..1.
 */
float distant_share(const struct distant *distant, size_t instance);

/* Draws what distant_cull found into what is bound, on top of the backdrop; the pictures are baked
 * when it first found any. Leaves the blend function (1, 1 - alpha) and blending and depth test on,
 * depth writing off. */
enum status distant_draw(struct workspace *workspace, struct distant *distant,
                         const struct view *view);

#endif
