/* For tests of the shaders of needles: directions. */
#ifndef TREELINE_TESTS_NEEDLES_WAYS_H
#define TREELINE_TESTS_NEEDLES_WAYS_H

#include "base/random.h"

#include <math.h>

#define PI 3.14159265358979324
#define COUNT(array) (sizeof(array) / sizeof *(array))

static inline void unit(const double v[3], double out[3])
{
    double length = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    for (int i = 0; i < 3; i++)
        out[i] = v[i] / length;
}

static inline void random_direction(struct random *random, double out[3])
{
    double z = 2 * random_double(random) - 1, turn = 2 * PI * random_double(random);
    double flat = sqrt(1 - z * z);
    out[0] = flat * cos(turn), out[1] = flat * sin(turn), out[2] = z;
}

#endif
