/* What the levels of a twig share: projection and light of a strip. */
#ifndef TREELINE_BAKE_CONE_EMIT_PARTS_H
#define TREELINE_BAKE_CONE_EMIT_PARTS_H

#include "bake/cone_emit.h"

/* A cylinder or frustum between two places in the plant's axes, m. */
struct cone_rod {
    float ends_m[2][3], radius_m[2];
};

void cone_to_camera(const struct cone_tree *tree, const float place_m[3], float camera_m[3]);

/* Fills place, widths and depths; the ends are cut to what is before the near plane. False: nothing
 * is. */
bool cone_strip_place(const struct cone_picture *picture, const struct cone_tree *tree,
                      const struct cone_rod *rod, struct cone_strip *strip);
/* Light of a material through fog at the strip's depth: the sun's part as if it were lit fully, and
 * all else. */
struct cone_material {
    const float *albedo;
    float specular;
};
void cone_strip_color(const struct cone_picture *picture, const struct cone_material *material,
                      const struct needles_shade *shade, struct cone_strip *strip);
/* Light that changes across a cylinder wide enough to see it. mean: the diffuse part of what the
 * strip was coloured by. */
void cone_strip_round(const struct cone_tree *tree, const struct cone_rod *rod, float mean,
                      struct cone_strip *strip);
/* Of two that share a place: what is left of an opacity. */
float cone_opacity_part(float opacity, float share);

/* A twig in a view, whatever it is drawn as. */
struct cone_twig_view {
    const struct cone_twig *twig;
    struct needles_sight sight; /* in the twig's axes; by lanes: light, eye and exponent alone */
    float eye[3];               /* in the plant's */
    struct cone_halves halves;
    struct needles_disc disc;
    struct needles_lit lit;
    float part;       /* of its opacity (cone_outline_part, the tree's fill) */
    float grown;      /* how much more area it is drawn with */
    float gain;       /* of the sun, of what falls on the tree */
    float needles_m2; /* a cone's, as seen, nothing hidden */
    float axis_shine; /* of its bark */
    struct cone_mix mix;
};

size_t cone_needles_emit(const struct cone_picture *picture, const struct cone_tree *tree,
                         const struct cone_twig_view *seen, const struct cone_beam *beam,
                         struct cone_strip *strips);
size_t cone_cones_emit(const struct cone_picture *picture, const struct cone_tree *tree,
                       const struct cone_twig_view *seen, const struct cone_beam *beam,
                       struct cone_strip *strips);
/* The light that reaches a cone, before the twig itself shades it. */
float cone_light_of(const struct cone_tree *tree, const struct cone_twig_view *seen, uint32_t cone);
/* Where a cone stands; a sphere that holds its needles. */
float cone_sphere_of(const struct cone_twig *twig, uint32_t cone, float apex_m[3],
                     float center_m[3]);

#endif
