/* Inside of the atlas: one plant's pictures at the finest level, before mip-maps. */
#ifndef TREELINE_BAKE_ATLAS_BAKE_H
#define TREELINE_BAKE_ATLAS_BAKE_H

#include "bake/atlas.h"

/* Pictures of one plant as bytes: what the cache keeps. */
struct atlas_plant {
    int width_px, height_px; /* a picture; multiples of 4 */
    size_t views_count;
    float center_y_m, radius_m, texel_m, albedo_scale;
    struct light_basis light;
    struct atlas_view *views; /* views_count */
    uint8_t (
        *albedo)[4]; /* views x height x width: premultiplied colour / albedo_scale, coverage */
    uint8_t (*channels)[4]; /* views x height x width: light channels where coverage > 0 */
    uint16_t *depth; /* views x height x width: (depth / radius + 1) / 2 where coverage > 0 */
};

/* Bakes a mesh. Memory that outlives the call is taken from arena. */
enum status atlas_bake(struct workspace *workspace, struct arena *arena, const struct mesh *mesh,
                       const struct atlas_request *request, bool two_sided,
                       struct atlas_plant *plant);

/* Largest colour that any sample can have, so that a byte's steps are not wasted; 1 where all is
 * black. */
float atlas_brightest(const struct mesh *mesh);

/* One level of one picture as floats: count texels of straight or premultiplied colour, coverage,
 * light channels and depth, 9 floats each. */
enum { TEXEL_FLOATS = 9 };

/* Halves a level (sides of 1 stay): coverage and premultiplied colour by box filter, light and
 * depth weighted by colour, so that the mean radiance stays. from: height x width x 9; colour
 * premultiplied. */
void atlas_halve(const float *from, int width_px, int height_px, float *to);
/* Light channels and depth of empty texels from the coarser level (which is filled already). */
void atlas_fill(float *texels, int width_px, int height_px, const float *coarser);
/* Factor on coverage, in [1/8, 8], such that the share of the level where the clamped coverage,
 * bilinear or of the nearest texel, reaches 1/2 is the level's mean coverage. */
float atlas_test_scale(const float *texels, int width_px, int height_px, bool nearest);

/* The outline of a picture: smallest rectangle and a convex polygon of at most 8 corners that hold
 * all covered texels, half a texel beyond their edge, the smallest triangle that prolongs three
 * sides of their hull, and the plane fitted to their depth. view's
 * origin must be set. */
void atlas_outline(struct arena *arena, const uint8_t (*albedo)[4], const uint16_t *depth,
                   int width_px, int height_px, float texel_m, float radius_m,
                   struct atlas_view *view);

#endif
