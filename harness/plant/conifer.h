/* A conifer as a hierarchy: branches, the twigs on them, whorls ("cones") of needles on the twigs.
 *
 * One structure, two readings. The geometry (conifer_mesh, and the reference's curves) draws every
 * branch as a frustum of a cone and every needle as a cylinder with flat ends; the shaders of
 * Hattab, Babahenini and Djedi (analytic hierarchical illumination of conifers) integrate over
 * needles, cones and twigs instead. Both take a needle from conifer_needle.
 *
 * The paper's counts: needles = branches x cones a branch x needles a cone, where its "branch" is a
 * twig here. A cone is N needles from one point of the twig's axis, each at the angle phi to it:
 * needle i of cone j stands at the azimuth azimuth_rad + j azimuth_step_rad + 2 pi i / N and leans
 * toward the twig's tip. */
#ifndef TREELINE_PLANT_CONIFER_H
#define TREELINE_PLANT_CONIFER_H

#include "base/arena.h"
#include "base/error.h"
#include "plant/mesh.h"

/* Above these a conifer is refused. */
enum {
    CONIFER_NEEDLES_MAX = 16 << 20,
    CONIFER_BRANCHES_MAX = 4 << 20,
    CONIFER_TWIGS_MAX = 4 << 20
};

/* A straight twig and its needles. All cones of a twig are alike but for their azimuth. */
struct conifer_twig {
    float base_m[3], axis[3]; /* axis: unit, from the base to the tip */
    float length_m, axis_radius_m;
    uint32_t cones_count;   /* whorls; 0: a bare twig */
    float spacing_m;        /* dh, from cone to cone; cone j stands at (j + 1/2) dh from the base */
    uint32_t needles_count; /* N, of a cone */
    float needle_length_m, needle_radius_m;
    float needle_angle_rad;              /* phi, between needle and axis, in [0, pi] */
    float azimuth_rad, azimuth_step_rad; /* of the first needle, and from cone to cone */
};

/* A piece of a branch or of the trunk (then without twigs), and the twigs that stand on it. */
struct conifer_branch {
    float from_m[3], to_m[3];
    float radius_from_m, radius_to_m; /* both above 0 */
    uint32_t first_twig, twigs_count;
};

struct conifer {
    size_t branches_count;
    struct conifer_branch *branches; /* their twigs tile [0, twigs_count) in order */
    size_t twigs_count;
    struct conifer_twig *twigs;
    float needle_albedo[3], bark_albedo[3]; /* linear RGB in [0, 1] */
    /* Blinn's lobe of a needle: the sun adds needle_specular (N.H)^needle_exponent to the radiance,
     * where N.L > 0, in units of scene.sun.radiance. 0: none. */
    float needle_specular, needle_exponent;
    uint32_t needle_sides, branch_sides; /* of the prisms of the mesh, 3..64; 0: 3 and 6 */
    /* Filled by conifer_finish. */
    float minimum_m[3], maximum_m[3]; /* holds all needles and branches */
    uint64_t needles_count;
};

/* Checks numbers and counts, fills the last fields. STATUS_INVALID names the first violation. */
enum status conifer_finish(struct conifer *conifer, struct error *error);

/* Two unit vectors across the unit axis and each other: across is azimuth 0, along azimuth 90
 * degrees; across x along = axis. */
void conifer_frame(const float axis[3], float across[3], float along[3]);

/* Needle `needle` of cone `cone` of a twig, in [0, needles_count) and [0, cones_count): its middle
 * line from base_m to tip_m, in the plant's space. The only definition of where a needle is. */
void conifer_needle(const struct conifer_twig *twig, uint32_t cone, uint32_t needle,
                    float base_m[3], float tip_m[3]);

/* A capped frustum about the line from a_m to b_m. */
struct conifer_piece {
    float a_m[3], b_m[3], radius_a_m, radius_b_m;
};

/* All pieces of bark: branches first, then the axes of the twigs. pieces: branches_count +
 * twigs_count. */
void conifer_bark(const struct conifer *conifer, struct conifer_piece *pieces);
/* All needles, twig by twig, cone by cone. pieces: needles_count. */
void conifer_needles(const struct conifer *conifer, struct conifer_piece *pieces);

/* The polygons: capped prisms whose mean silhouette over all directions is that of the round pieces
 * (Cauchy: a convex section of the same perimeter). Bark has the round pieces' normals; needles,
 * which are narrower than pixels, are flat: over many azimuths a prism's sides, each lit as a
 * plane, shine as the round needle does, where round normals on three sides would show what faces
 * away. One part of bark, then one of leaves (left out where there is no needle) in which an
 * element is a needle, solid. It passes mesh_check. */
struct mesh *conifer_mesh(struct arena *arena, const struct conifer *conifer);

#endif
