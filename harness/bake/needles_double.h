/* needles.h in double precision; every name ends in _double. For tests, maps and bakes. */
#ifndef TREELINE_BAKE_NEEDLES_DOUBLE_H
#define TREELINE_BAKE_NEEDLES_DOUBLE_H

#include "bake/needles_math.h"

#undef TREELINE_BAKE_NEEDLES_NEEDLE_H
#undef TREELINE_BAKE_NEEDLES_OPACITY_H
#undef TREELINE_BAKE_NEEDLES_CONE_H
#undef TREELINE_BAKE_NEEDLES_TWIG_H
#undef TREELINE_BAKE_NEEDLES_PAPER_H

#define real double
#define MATH(function) function
#define needles_axis needles_axis_double
#define needles_clamp needles_clamp_double
#define needles_cone_cover needles_cone_cover_double
#define needles_cone_panel needles_cone_panel_double
#define needles_cone_seen needles_cone_seen_double
#define needles_cone_shade needles_cone_shade_double
#define needles_cone_sheets needles_cone_sheets_double
#define needles_cone_sums needles_cone_sums_double
#define needles_cover needles_cover_double
#define needles_cross needles_cross_double
#define needles_diffuse needles_diffuse_double
#define needles_disc needles_disc_double
#define needles_disc_lit needles_disc_lit_double
#define needles_disc_of needles_disc_of_double
#define needles_disc_opacity needles_disc_opacity_double
#define needles_disc_shadow needles_disc_shadow_double
#define needles_dot needles_dot_double
#define needles_e1_log needles_e1_log_double
#define needles_half_shade needles_half_shade_double
#define needles_line_lit needles_line_lit_double
#define needles_lit needles_lit_double
#define needles_lune needles_lune_double
#define needles_mean_sine needles_mean_sine_double
#define needles_needle_shade needles_needle_shade_double
#define needles_nodes needles_nodes_double
#define needles_nodes_of needles_nodes_of_double
#define needles_paper_cone_shade needles_paper_cone_shade_double
#define needles_paper_diffuse needles_paper_diffuse_double
#define needles_paper_lines needles_paper_lines_double
#define needles_paper_lit needles_paper_lit_double
#define needles_paper_opacities needles_paper_opacities_double
#define needles_paper_reflect needles_paper_reflect_double
#define needles_paper_sums needles_paper_sums_double
#define needles_paper_twig_shade needles_paper_twig_shade_double
#define needles_radial_opacity needles_radial_opacity_double
#define needles_reflect needles_reflect_double
#define needles_shade needles_shade_double
#define needles_sheet_opacity needles_sheet_opacity_double
#define needles_shine needles_shine_double
#define needles_sight needles_sight_double
#define needles_sight_of needles_sight_of_double
#define needles_sine_power needles_sine_power_double
#define needles_specular needles_specular_double
#define needles_sums needles_sums_double
#define needles_twig needles_twig_double
#define needles_twig_depths needles_twig_depths_double
#define needles_twig_of needles_twig_of_double
#define needles_twig_opacity needles_twig_opacity_double
#define needles_twig_shade needles_twig_shade_double

#include "bake/needles_needle.h"

#include "bake/needles_opacity.h"

#include "bake/needles_cone.h"

#include "bake/needles_twig.h"

#include "bake/needles_paper.h"

#undef real
#undef MATH
#undef needles_axis
#undef needles_clamp
#undef needles_cone_cover
#undef needles_cone_panel
#undef needles_cone_seen
#undef needles_cone_shade
#undef needles_cone_sheets
#undef needles_cone_sums
#undef needles_cover
#undef needles_cross
#undef needles_diffuse
#undef needles_disc
#undef needles_disc_lit
#undef needles_disc_of
#undef needles_disc_opacity
#undef needles_disc_shadow
#undef needles_dot
#undef needles_e1_log
#undef needles_half_shade
#undef needles_line_lit
#undef needles_lit
#undef needles_lune
#undef needles_mean_sine
#undef needles_needle_shade
#undef needles_nodes
#undef needles_nodes_of
#undef needles_paper_cone_shade
#undef needles_paper_diffuse
#undef needles_paper_lines
#undef needles_paper_lit
#undef needles_paper_opacities
#undef needles_paper_reflect
#undef needles_paper_sums
#undef needles_paper_twig_shade
#undef needles_radial_opacity
#undef needles_reflect
#undef needles_shade
#undef needles_sheet_opacity
#undef needles_shine
#undef needles_sight
#undef needles_sight_of
#undef needles_sine_power
#undef needles_specular
#undef needles_sums
#undef needles_twig
#undef needles_twig_depths
#undef needles_twig_of
#undef needles_twig_opacity
#undef needles_twig_shade

/* F, D and S of a twig's cone, (10), (6) and (8), by 64 nodes on each quarter of it. */
static inline struct needles_sums_double
needles_converged_sums_double(const struct needles_twig_double *twig,
                              const struct needles_sight_double *sight)
{
    enum { PANELS = 8 };
    struct needles_sums_double sums = {{0, 0}, {0, 0}, {0, 0}};
    for (int i = 0; i < PANELS; i++)
        needles_cone_panel_double(twig->sine, twig->cosine, sight, 8, (double)i / PANELS,
                                  (double)(i + 1) / PANELS, &sums);
    return sums;
}

/* needles.h may come before or after. */
#undef TREELINE_BAKE_NEEDLES_NEEDLE_H
#undef TREELINE_BAKE_NEEDLES_OPACITY_H
#undef TREELINE_BAKE_NEEDLES_CONE_H
#undef TREELINE_BAKE_NEEDLES_TWIG_H
#undef TREELINE_BAKE_NEEDLES_PAPER_H

#endif
