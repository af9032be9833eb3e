/* Splits, slices, fits of shadow maps; in double, since maps that stand still are compared exactly.
 */
#include "bake/shadow_math.h"

#include <string.h>

void shadow_splits(double near_m, double far_m, double lambda, int count, double *depths_m)
{
    for (int i = 0; i <= count; i++) {
        double t = (double)i / count;
        depths_m[i] = lambda * near_m * pow(far_m / near_m, t) +
                      (1 - lambda) * (near_m + (far_m - near_m) * t);
    }
    depths_m[0] = near_m;
    depths_m[count] = far_m;
}

struct shadow_sphere shadow_sphere_of(double near_m, double far_m, double spread2)
{
    double n = near_m, f = far_m;
    if (spread2 >= (f - n) / (f + n))
        return (struct shadow_sphere){f, f * sqrt(spread2)};
    return (struct shadow_sphere){0.5 * (f + n) * (1 + spread2),
                                  0.5 * sqrt((f - n) * (f - n) + 2 * (f * f + n * n) * spread2 +
                                             (f + n) * (f + n) * spread2 * spread2)};
}

double shadow_spread2(const struct view *view)
{
    double up = tan(0.5 * (double)view->fov_y_rad);
    double right = up * view->width_px / view->height_px;
    return up * up + right * right;
}

static double dot3(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross3(const double a[3], const double b[3], double to[3])
{
    for (int i = 0; i < 3; i++)
        to[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
}

/* Duff et al. 2017, JCGT 6(1): no direction is special. */
void shadow_axes(const float sun[3], double axes[3][3])
{
    double *z = axes[2], length = 0;
    for (int i = 0; i < 3; i++)
        length += (double)sun[i] * (double)sun[i];
    for (int i = 0; i < 3; i++)
        z[i] = (double)sun[i] / sqrt(length);
    double sign = copysign(1, z[2]), a = -1 / (sign + z[2]), b = z[0] * z[1] * a;
    memcpy(axes[0], (double[3]){1 + sign * z[0] * z[0] * a, sign * b, -sign * z[0]},
           sizeof axes[0]);
    memcpy(axes[1], (double[3]){b, sign + z[1] * z[1] * a, -z[1]}, sizeof axes[1]);
}

static void box_add(struct shadow_box *box, const double axes[3][3], const double point[3],
                    double margin)
{
    for (int i = 0; i < 3; i++) {
        double at = dot3(axes[i], point);
        box->low[i] = fmin(box->low[i], at - margin);
        box->high[i] = fmax(box->high[i], at + margin);
    }
}

static struct shadow_box box_empty(void)
{
    return (struct shadow_box){{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
}

static bool ground_is_bent(const struct terrain *terrain)
{
    size_t count = (size_t)terrain->samples_x * terrain->samples_z;
    for (size_t i = 1; i < count; i++)
        if (terrain->heights_m[i] != terrain->heights_m[0])
            return true;
    return false;
}

struct shadow_box shadow_casters_box(const struct scene *scene, const double axes[3][3])
{
    struct shadow_box box = box_empty();
    for (size_t i = 0; i < scene->instances_count; i++) {
        const float *foot = scene->instances[i].position_m;
        box_add(&box, axes, (double[3]){(double)foot[0], (double)foot[1], (double)foot[2]},
                (double)scene->tree_reach_m);
    }
    bool bent = ground_is_bent(&scene->terrain);
    for (int corner = 0; corner < 8 && bent; corner++) {
        double point[3];
        for (int i = 0; i < 3; i++)
            point[i] = (double)(corner >> i & 1 ? scene->maximum_m[i] : scene->minimum_m[i]);
        box_add(&box, axes, point, 0);
    }
    for (int i = 0; i < 3; i++)
        if (!(box.low[i] < box.high[i])) { /* nothing casts, or a point does */
            box.low[i] = -1;
            box.high[i] = 1;
        }
    return box;
}

/* The slice's eight corners. */
static void slice_corners(const struct shadow_request *request, double corners[8][3])
{
    const struct view *view = request->view;
    double up = tan(0.5 * (double)view->fov_y_rad);
    double right = up * view->width_px / view->height_px;
    for (int k = 0; k < 8; k++) {
        double depth = k & 4 ? request->far_m : request->near_m;
        double across = (k & 1 ? 1 : -1) * right * depth, along = (k & 2 ? 1 : -1) * up * depth;
        for (int i = 0; i < 3; i++)
            corners[k][i] = (double)view->eye_m[i] + depth * (double)view->forward[i] +
                            across * (double)view->right[i] + along * (double)view->up[i];
    }
}

/* An interval of a map's axis: the slice's, but no wider than what casts. */
static void axis_tight(const struct shadow_box *slice, const struct shadow_box *casters, int axis,
                       double *low, double *high)
{
    *low = fmax(slice->low[axis], casters->low[axis]);
    *high = fmin(slice->high[axis], casters->high[axis]);
    if (!(*low < *high)) { /* no shadow falls into the slice */
        *low = casters->low[axis];
        *high = casters->high[axis];
    }
}

/* The same width for every eye, its ends on whole texels. */
static void axis_stable(double center, double radius, int size_px, const struct shadow_box *casters,
                        int axis, double *low, double *high)
{
    double width = 2 * radius * size_px / (size_px > 2 ? size_px - 1 : 1);
    if (casters->high[axis] - casters->low[axis] <= width) {
        *low = casters->low[axis];
        *high = casters->high[axis];
        return;
    }
    double texel = width / size_px;
    *low = (floor((center - radius) / texel)) * texel;
    *high = *low + width;
}

/* Of the casters alone, so that it stands still: what lies behind them all is as good as at the far
 * end. */
static void depth_range(const struct shadow_request *request, double *low, double *high)
{
    *high = request->casters.high[2];
    *low = request->casters.low[2];
    if (!(*high - *low > 1e-3))
        *low = *high - 1;
}

static void fit_ortho(const double axes[3][3], const double low[3], const double high[3],
                      int size_px, struct shadow_fit *fit)
{
    memset(fit, 0, sizeof *fit);
    for (int row = 0; row < 3; row++) {
        double sign = row == 2 ? -1 : 1, scale = 2 / (high[row] - low[row]);
        for (int i = 0; i < 3; i++)
            fit->matrix[i][row] = sign * scale * axes[row][i];
        fit->matrix[3][row] = -sign * scale * 0.5 * (low[row] + high[row]);
    }
    fit->matrix[3][3] = 1;
    fit->texel_m[0] = (high[0] - low[0]) / size_px;
    fit->texel_m[1] = (high[1] - low[1]) / size_px;
    fit->range_m = high[2] - low[2];
}

/* Wimmer et al. 2004: a perspective across the light, along the eye's direction. axes: turned so
 * that the second is that direction. False: the eye looks along the light. */
static bool axes_turn(const struct shadow_request *request, const double axes[3][3],
                      double turned[3][3], double *sine)
{
    const float *forward = request->view->forward;
    double along[3], f[3] = {(double)forward[0], (double)forward[1], (double)forward[2]};
    double toward = dot3(f, axes[2]);
    for (int i = 0; i < 3; i++)
        along[i] = f[i] - toward * axes[2][i];
    *sine = sqrt(dot3(along, along));
    if (*sine < 0.1)
        return false;
    for (int i = 0; i < 3; i++) {
        turned[1][i] = along[i] / *sine;
        turned[2][i] = axes[2][i];
    }
    cross3(turned[1], turned[2], turned[0]);
    return true;
}

static void fit_perspective(const struct shadow_request *request, const double axes[3][3],
                            double sine, struct shadow_fit *fit)
{
    double corners[8][3], depth[2];
    struct shadow_box slice = box_empty();
    slice_corners(request, corners);
    for (int k = 0; k < 8; k++)
        box_add(&slice, axes, corners[k], 0);
    depth_range(request, &depth[0], &depth[1]);
    /* The nearest plane of least error, and its centre of projection behind the slice. */
    double near = (request->near_m + sqrt(request->near_m * request->far_m)) / sine;
    double length = slice.high[1] - slice.low[1], far = near + length;
    double behind = slice.low[1] - near, u0 = 0.5 * (slice.low[0] + slice.high[0]);
    double w0 = 0.5 * (depth[0] + depth[1]), across[2] = {INFINITY, -INFINITY};
    double deep[2] = {INFINITY, -INFINITY};
    for (int k = 0; k < 8; k++) {
        double v = dot3(axes[1], corners[k]) - behind, u = (dot3(axes[0], corners[k]) - u0) / v;
        across[0] = fmin(across[0], u);
        across[1] = fmax(across[1], u);
        for (int end = 0; end < 2; end++) {
            deep[0] = fmin(deep[0], (depth[end] - w0) / v);
            deep[1] = fmax(deep[1], (depth[end] - w0) / v);
        }
    }
    double rows[4][4] = {{0}}; /* of u, v, w, 1 */
    double su = 2 / (across[1] - across[0]), sw = 2 / (deep[1] - deep[0]);
    double cu = 0.5 * (across[0] + across[1]), cw = 0.5 * (deep[0] + deep[1]);
    memcpy(rows[0], (double[4]){su, -su * cu, 0, -su * u0 + su * cu * behind}, sizeof rows[0]);
    memcpy(rows[1],
           (double[4]){0, (far + near) / length, 0,
                       -(far + near) / length * behind - 2 * far * near / length},
           sizeof rows[1]);
    memcpy(rows[2], (double[4]){0, sw * cw, -sw, sw * w0 - sw * cw * behind}, sizeof rows[2]);
    memcpy(rows[3], (double[4]){0, 1, 0, -behind}, sizeof rows[3]);
    memset(fit, 0, sizeof *fit);
    for (int row = 0; row < 4; row++) {
        for (int i = 0; i < 3; i++)
            for (int axis = 0; axis < 3; axis++)
                fit->matrix[i][row] += rows[row][axis] * axes[axis][i];
        fit->matrix[3][row] = rows[row][3];
    }
    fit->texel_m[0] = (slice.high[0] - slice.low[0]) / request->size_px;
    fit->texel_m[1] = length / request->size_px;
    fit->range_m = depth[1] - depth[0];
    fit->perspective = true;
}

void shadow_fit(const struct shadow_request *request, const double axes[3][3],
                struct shadow_fit *fit)
{
    double low[3], high[3], corners[8][3], turned[3][3], sine;
    if (request->perspective && axes_turn(request, axes, turned, &sine)) {
        fit_perspective(request, (const double(*)[3])turned, sine, fit);
        return;
    }
    struct shadow_box slice = box_empty();
    struct shadow_sphere sphere =
        shadow_sphere_of(request->near_m, request->far_m, shadow_spread2(request->view));
    double center[3];
    for (int i = 0; i < 3; i++)
        center[i] =
            (double)request->view->eye_m[i] + sphere.depth_m * (double)request->view->forward[i];
    slice_corners(request, corners);
    for (int k = 0; k < 8; k++)
        box_add(&slice, axes, corners[k], 0);
    for (int axis = 0; axis < 2; axis++) {
        if (request->stable)
            axis_stable(dot3(axes[axis], center), sphere.radius_m, request->size_px,
                        &request->casters, axis, &low[axis], &high[axis]);
        else
            axis_tight(&slice, &request->casters, axis, &low[axis], &high[axis]);
    }
    depth_range(request, &low[2], &high[2]);
    fit_ortho(axes, low, high, request->size_px, fit);
}

bool shadow_fit_meets(const struct shadow_fit *fit, const double center_m[3], double radius_m)
{
    for (int row = 0; row < 2 && !fit->perspective; row++) {
        double at = fit->matrix[3][row], square = 0;
        for (int i = 0; i < 3; i++) {
            at += fit->matrix[i][row] * center_m[i];
            square += fit->matrix[i][row] * fit->matrix[i][row];
        }
        if (fabs(at) > 1 + radius_m * sqrt(square))
            return false;
    }
    return true;
}
