/* What a shadow map of a directional sun sees: splits, slices, maps that stand still, biases. */
#ifndef TREELINE_BAKE_SHADOW_MATH_H
#define TREELINE_BAKE_SHADOW_MATH_H

#include "scene/scene.h"

enum { SHADOW_CASCADES_MAX = 4 };

/* Where cascades end: count + 1 depths along the view from near to far. Zhang, Sun, Xu, Lun 2006
 * (parallel-split shadow maps), doi:10.1145/1128923.1128975: lambda 1 is logarithmic, 0 uniform,
 * between them a blend. 0 < near < far, count 1..SHADOW_CASCADES_MAX. */
void shadow_splits(double near_m, double far_m, double lambda, int count, double *depths_m);

/* The smallest sphere that is centred on the view's axis and holds a slice of its frustum: the
 * centre's depth and the radius. spread2: tan^2 of half the horizontal angle plus that of half the
 * vertical. */
struct shadow_sphere {
    double depth_m, radius_m;
};
struct shadow_sphere shadow_sphere_of(double near_m, double far_m, double spread2);
double shadow_spread2(const struct view *view);

/* Right, up, toward the sun: orthonormal, right-handed, for any unit direction. */
void shadow_axes(const float sun[3], double axes[3][3]);

/* Bounds in light space, along the three axes. */
struct shadow_box {
    double low[3], high[3];
};
/* Of all that casts: trees by their reach, and the ground where it is bent. */
struct shadow_box shadow_casters_box(const struct scene *scene, const double axes[3][3]);

struct shadow_request {
    const struct view *view;
    double near_m, far_m; /* the slice */
    int size_px;          /* texels a side */
    bool stable;          /* the texels stand still in the world while the eye moves and turns */
    bool perspective;     /* light-space perspective: Wimmer, Scherzer, Purgathofer 2004 */
    struct shadow_box casters;
};

/* One map: world to clip space, z from -1 at the sun's side to 1. */
struct shadow_fit {
    double matrix[4][4]; /* column-major */
    double texel_m[2];   /* across and along, of a map without perspective */
    double range_m;      /* of depth */
    bool perspective;
};
/* Where the map would be wider than all that casts it is as wide as that. A view along the sun's
 * direction has no perspective to give and gets none. */
void shadow_fit(const struct shadow_request *request, const double axes[3][3],
                struct shadow_fit *fit);

/* Whether a sphere reaches into the map across the light, m; true of any where the map has
 * perspective, which would need more than this. */
bool shadow_fit_meets(const struct shadow_fit *fit, const double center_m[3], double radius_m);

/* The depth in metres that a plane of slope (gradient_x, gradient_y), metres a metre in light
 * space, needs as bias under a filter that reaches reach texels from the point: (k + 1/2) for (2k +
 * 1)^2 nearest taps, k + 1 for bilinear ones; at most sqrt(2) reach w tan(b), b the angle of normal
 * and sun. A departure from glPolygonOffset: exact. Of planes: where two meet in a
 * valley, the steeper one's is needed on both sides of the fold; without it thin lines of dots stay
 * there (plan shadows-stability: .6 to 1 % of a relief under a sun at the zenith). */
static inline double shadow_bias_m(double reach, const double texel_m[2], double gradient_x,
                                   double gradient_y)
{
    return reach * (texel_m[0] * fabs(gradient_x) + texel_m[1] * fabs(gradient_y));
}

#endif
