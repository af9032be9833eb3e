/* Light and opacity of needles, of cones of needles and of twigs, in closed and nearly closed
 * forms.
 *
 * Hattab, Babahenini and Djedi, "Un modele pour l'illumination analytique et hierarchique des
 * coniferes" (after Meyer and Neyret 2000); (n) names its equations. Each level stands twice: the
 * exact form is a few nodes of quadrature where the paper's closed form fails, the paper's own form
 * (needles_paper.h) is as printed and clamped to what is physical.
 *
 * Frame: the twig's, z along it; a needle is a cylinder whose axis is (sin phi cos t, sin phi sin
 * t, cos phi). Directions are unit and point away from the place: to the light, to the eye. Lengths
 * are in metres, areas in square metres, all other numbers are pure. Reflectances are those of an
 * albedo (diffuse: N.L without 1/pi) and of a weight of (N.H)^exponent of 1.
 *
 * Everything is inline and depends on the C library alone. Numbers that are finite and in range
 * give numbers that are finite, at least 0, and diffuse and specular at most the opacity they stand
 * with.
 *
 *   needles_needle.h    one needle                              (1) to (5)
 *   needles_opacity.h   opacity of discs by their optical depth (19)
 *   needles_cone.h      N needles around the axis               (6) to (11)
 *   needles_twig.h      cones one after the other               (12) to (21)
 *   needles_paper.h     the same as printed
 *
 * Here all is in float; needles_double.h is the same code in double, its names end in _double. */
#ifndef TREELINE_BAKE_NEEDLES_H
#define TREELINE_BAKE_NEEDLES_H

#include "bake/needles_math.h"

#define real float
#define MATH(function) function##f
#include "bake/needles_needle.h"

#include "bake/needles_opacity.h"

#include "bake/needles_cone.h"

#include "bake/needles_twig.h"

#include "bake/needles_paper.h"

#undef real
#undef MATH

#endif
