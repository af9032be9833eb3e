/* Shadow volumes in the stencil buffer (Crow 1977, Heidmann 1991; Everitt and Kilgard 2002 for caps
 * at infinity, z-fail and wrapping): how many volumes each visible sample is within.
 *
 * What holds: counts are the true ones modulo 128 of two halves of what casts, in whatever order
 * volumes come, since they wrap both ways (shadow_volume_count.c): a sample that is taken for lit
 * is in a multiple of 128 volumes of either half. Alpha-tested triangles cast as if they were
 * opaque. The edge of a shadow lies where the rasteriser puts the wall: exact to the depth buffer's
 * resolution, z^2 / (near 2^24) at depth z. The time is fill: a tree of leaves has thousands of
 * walls behind each pixel. So volumes end in the ground (bake/shadow_floor.h), which no eye above
 * it can tell; before a sample they may be open there. */
#ifndef TREELINE_BAKE_SHADOW_VOLUME_H
#define TREELINE_BAKE_SHADOW_VOLUME_H

#include "method/method.h"

/* z-pass counts what is before a sample: right where the eye is in no volume. z-fail counts what is
 * behind: right everywhere, and caps are drawn too. AUTO: z-pass for trees in whose volume the eye
 * cannot be, z-fail for the others and for the terrain. */
enum shadow_test { SHADOW_AUTO, SHADOW_Z_FAIL, SHADOW_Z_PASS };

struct shadow_volume_request {
    enum shadow_test test;
    bool trees_alone; /* the terrain casts none */
    bool triangles;   /* each triangle has its own volume, without silhouettes */
    /* Where what is drawn is not the very triangles that cast, volumes begin behind them, away from
     * the sun, so that no surface shades itself: as far as the larger of both, and what floats and
     * depths do not resolve. 0 both: at them. */
    float behind_px;    /* pixels, at a caster's depth */
    float behind_radii; /* of the largest tree's */
};

struct shadow_volume;

/* Neighbours of all casters, trees and terrain; no volume yet. */
enum status shadow_volume_prepare(struct workspace *workspace, const struct scene *scene,
                                  const struct shadow_volume_request *request,
                                  struct shadow_volume **volume);
/* The boundaries for the view's sun, of all whose shadows may be seen to a depth of deep_m;
 * INFINITY: of all. Nothing to do when the sun stands where it stood and the eye has not left what
 * they were made for. Made anew in draws that are counted, and tallied; counting them into the
 * stencil is part of every frame. */
void shadow_volume_extrude(struct workspace *workspace, struct shadow_volume *volume,
                           const struct view *view, float deep_m);
/* The far plane is moved to infinity: what must be drawn with volumes, surfaces too. */
void shadow_volume_view(struct view *view);
/* Clears the stencil of the bound framebuffer and counts into it. Surfaces must be drawn, with the
 * same view and, where volumes begin at what casts, as its very triangles; depth is not changed.
 * Leaves the stencil test on, passing where the count is 0 and the sample is no deeper than deep_m,
 * until shadow_volume_end. */
void shadow_volume_count(struct workspace *workspace, const struct shadow_volume *volume,
                         const struct view *view, float deep_m);
void shadow_volume_end(struct workspace *workspace);

#endif
