/* Maps of the errors of the shaders of needles, exact and as printed, over angles and densities. */
#ifndef TREELINE_REPORT_SHADERS_H
#define TREELINE_REPORT_SHADERS_H

#include "base/error.h"

/* Writes FOLDER/shaders.{dat,gp,png}. shaders.dat has a block for each density: angles of eye and
 * needles to the twig in degrees, opacity, brightness and shine by converged quadrature, and all
 * three by the exact form and by the paper's. STATUS_UNAVAILABLE without gnuplot, after the other
 * two. */
enum status shaders_draw(const char *folder, struct error *error);

#endif
