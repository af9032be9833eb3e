/* Directions on the circle, the octahedron and the crossed planes. */
#include "bake/views.h"

#include <math.h>
#include <stdbool.h>

size_t views_side(enum views_layout layout, size_t views)
{
    if (layout == VIEWS_CIRCLE || layout == VIEWS_PLANES)
        return views > 0 ? views : 1;
    size_t side = 2;
    while ((side + 1) * (side + 1) <= views)
        side++;
    return side;
}

size_t views_count(enum views_layout layout, size_t side)
{
    switch (layout) {
    case VIEWS_CIRCLE:
        return side;
    case VIEWS_PLANES:
        return 2 * side;
    case VIEWS_HEMISPHERE:
    case VIEWS_OCTAHEDRON:
        break;
    }
    return side * side;
}

static void direction_of_azimuth(double azimuth_rad, float direction[3])
{
    direction[0] = (float)sin(azimuth_rad);
    direction[1] = 0;
    direction[2] = (float)cos(azimuth_rad);
}

/* Point (u, v) of the square [-1, 1]^2 on the sphere; the upper half alone when the layout is the
 * hemisphere. */
static void direction_of_square(enum views_layout layout, double u, double v, float direction[3])
{
    double x = u, z = v;
    if (layout == VIEWS_HEMISPHERE) {
        x = 0.5 * (u + v);
        z = 0.5 * (u - v);
    }
    double y = 1 - fabs(x) - fabs(z);
    if (y < 0) {
        double folded_x = copysign(1 - fabs(z), x);
        z = copysign(1 - fabs(x), z);
        x = folded_x;
    }
    double length = sqrt(x * x + y * y + z * z);
    direction[0] = (float)(x / length);
    direction[1] = (float)(y / length);
    direction[2] = (float)(z / length);
}

void views_direction(enum views_layout layout, size_t side, size_t index, float direction[3])
{
    if (layout == VIEWS_CIRCLE || layout == VIEWS_PLANES) {
        double turn = layout == VIEWS_CIRCLE ? 2 * M_PI : M_PI;
        direction_of_azimuth(turn * (double)index / (double)side, direction);
        return;
    }
    double step = 2 / (double)(side - 1);
    double u = step * (double)(index % side) - 1, v = step * (double)(index / side) - 1;
    direction_of_square(layout, u, v, direction);
}

void views_plane(const float direction[3], float right[3], float up[3])
{
    float length = hypotf(direction[0], direction[2]);
    bool level = length > 1e-6f;
    right[0] = level ? direction[2] / length : 1;
    right[1] = 0;
    right[2] = level ? -direction[0] / length : 0;
    up[0] = direction[1] * right[2] - direction[2] * right[1];
    up[1] = direction[2] * right[0] - direction[0] * right[2];
    up[2] = direction[0] * right[1] - direction[1] * right[0];
}
