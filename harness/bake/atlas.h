/* Pictures of the scene's plants from many directions, as texture arrays that shade under any sun:
 * the raw material of billboards, crossed quads and other impostors.
 *
 * A picture is orthographic: plane coordinates (s, t) in metres along the view's right and up,
 * origin at the plant's centre (on its +y axis, at middle height), depth along the view's direction
 * toward the eye. All pictures of all species are layers of the same arrays. Plants are baked once
 * and kept in the disk cache. */
#ifndef TREELINE_BAKE_ATLAS_H
#define TREELINE_BAKE_ATLAS_H

#include "bake/atlas_light.h"
#include "bake/views.h"
#include "method/method.h"

#include <stdint.h>

enum { ATLAS_HULL = 8 };

/* What the mip-maps keep and the colour means.
 * blend:    colour premultiplied by coverage; box filter, so every level has the mean of the
 * finest. test:     straight colour; coverage of each picture and level is scaled so that the share
 * of texels at or above 1/2 is the picture's mean coverage (Castano 2010, "Computing Alpha
 * Mipmaps", with the true mean as the goal); levels end where the shorter side has 4 texels.
 * coverage: straight colour, box-filtered coverage. */
enum atlas_alpha { ATLAS_BLEND, ATLAS_TEST, ATLAS_COVERAGE };

struct atlas_request {
    enum views_layout layout;
    size_t side;       /* of views.h */
    int resolution_px; /* texels along the longest extent of a plant over all its pictures, 8..2048
                        */
    int samples;       /* samples along a texel's side, 1..8 */
    enum atlas_alpha alpha;
    bool nearest; /* where texels are not larger than pixels take the nearest, not a mean of four */
    bool depth;   /* make the depth array too */
};

/* One picture, as impostor.glsl reads it (std430). */
struct atlas_view {
    float right[3], origin_s; /* plane coordinates of the layer's lower left corner, m */
    float up[3], origin_t;
    float toward[3], covered_m2; /* silhouette area */
    float low[2], high[2];       /* rectangle of the covered texels, m */
    float depth_plane[4];        /* depth of what is seen, m: [0] + [1] s + [2] t (least squares) */
    float hull[ATLAS_HULL][2];   /* convex outline of the covered texels, counter-clockwise; may
                                    repeat its last point */
    float triangle[3][4]; /* smallest found about the hull: corner (s, t), and how it moves when all
                             sides move out by a metre */
};

/* One species, as impostor.glsl reads it (std430). */
struct atlas_species {
    float center_y_m, radius_m; /* sphere about the centre that holds the plant */
    float texel_m;
    float first_view;   /* of its pictures and layers; -1: no tree of this species in the scene */
    float albedo_scale; /* colour of a full texel */
    float unused[3];
    float light[1 + LIGHT_CHANNELS][12]; /* struct light_basis, row */
};

struct atlas {
    int width_px, height_px, levels, layers; /* powers of two */
    size_t views_count;                      /* a species */
    size_t species_count;
    struct atlas_species *species;
    struct atlas_view *views; /* layers */
    GLuint albedo;            /* RGBA8 array: colour / albedo_scale, coverage */
    GLuint light;             /* RGBA8 array: light channels, straight */
    GLuint depth; /* R16 array: (depth / radius + 1) / 2, straight; 0 unless requested */
    GLuint views_buffer, species_buffer;
};

/* Bakes the plants of those species that have a tree. STATUS_INVALID when the arrays would pass 4
 * GiB or the layers the device's limit; plant errors pass through. Leaves the GL state as
 * backdrop_draw does, framebuffer 0 bound. */
enum status atlas_build(struct workspace *workspace, const struct scene *scene,
                        const struct atlas_request *request, struct atlas **atlas);

#endif
