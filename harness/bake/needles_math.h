/* The precision that the shaders of needles are compiled in: `real` and MATH are set by needles.h
 * (float) and needles_double.h. */
#ifndef TREELINE_BAKE_NEEDLES_MATH_H
#define TREELINE_BAKE_NEEDLES_MATH_H

#include <math.h>
#include <stdbool.h>

#define REAL(constant) ((real)(constant))
#define REAL_PI REAL(3.14159265358979324)

#define real_abs MATH(fabs)
#define real_atan2 MATH(atan2)
#define real_ceil MATH(ceil)
#define real_cos MATH(cos)
#define real_erf MATH(erf)
#define real_exp MATH(exp)
#define real_expm1 MATH(expm1)
#define real_log MATH(log)
#define real_log1p MATH(log1p)
#define real_max MATH(fmax)
#define real_min MATH(fmin)
#define real_sin MATH(sin)
#define real_sqrt MATH(sqrt)

#endif
