/* One picture's camera: matrices, rays, what the frustum holds. */
#include "scene/camera.h"

#include <string.h>

static const double DEGREE = 0.017453292519943295;

static void cross3(const double a[3], const double b[3], double to[3])
{
    to[0] = a[1] * b[2] - a[2] * b[1];
    to[1] = a[2] * b[0] - a[0] * b[2];
    to[2] = a[0] * b[1] - a[1] * b[0];
}

static double length3(const double a[3])
{
    return sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
}

/* Right, up, forward: orthonormal, right-handed with backward. Straight down and up, +y is no
 * guide: the picture's top is then -z and +z, the limits of tilting a camera that looks along -z.
 */
static void basis_of(const float eye_m[3], const float target_m[3], double basis[3][3])
{
    double *right = basis[0], *up = basis[1], *forward = basis[2];
    for (int i = 0; i < 3; i++)
        forward[i] = (double)target_m[i] - eye_m[i];
    double length = length3(forward);
    if (!(length > 0) || !isfinite(length)) {
        memcpy(forward, (double[3]){0, 0, -1}, sizeof basis[2]);
        length = 1;
    }
    for (int i = 0; i < 3; i++)
        forward[i] /= length;
    double guide[3] = {0, 1, 0};
    if (sqrt(forward[0] * forward[0] + forward[2] * forward[2]) < 1e-5) {
        guide[1] = 0;
        guide[2] = forward[1] > 0 ? 1 : -1;
    }
    cross3(forward, guide, right);
    double right_length = length3(right);
    for (int i = 0; i < 3; i++)
        right[i] /= right_length;
    cross3(right, forward, up);
}

/* Column-major; the eye looks along -z of its own frame. */
static void matrix_view(const double basis[3][3], const float eye_m[3], mat4 matrix)
{
    for (int row = 0; row < 3; row++) {
        double sign = row == 2 ? -1 : 1, shift = 0;
        for (int i = 0; i < 3; i++) {
            matrix[i][row] = (float)(sign * basis[row][i]);
            shift += sign * basis[row][i] * eye_m[i];
        }
        matrix[3][row] = (float)-shift;
        matrix[row][3] = 0;
    }
    matrix[3][3] = 1;
}

/* OpenGL clip space, z in [-1, 1]. */
static void matrix_projection(const struct view *view, mat4 matrix)
{
    double scale = 1.0 / tan(0.5 * view->fov_y_rad);
    double near = view->near_m, far = view->far_m;
    memset(matrix, 0, sizeof(mat4));
    matrix[0][0] = (float)(scale * view->height_px / view->width_px);
    matrix[1][1] = (float)scale;
    matrix[2][2] = (float)((near + far) / (near - far));
    matrix[2][3] = -1;
    matrix[3][2] = (float)(2 * near * far / (near - far));
}

/* Fills everything from eye, target, time and the depths already in view. */
static void view_fill(const struct scene *scene, const float eye_m[3], const float target_m[3],
                      struct view *view)
{
    double basis[3][3];
    basis_of(eye_m, target_m, basis);
    for (int i = 0; i < 3; i++) {
        view->eye_m[i] = eye_m[i];
        view->right[i] = (float)basis[0][i];
        view->up[i] = (float)basis[1][i];
        view->forward[i] = (float)basis[2][i];
    }
    view->fov_y_rad = scene->camera.fov_y_rad;
    view->width_px = scene->width_px;
    view->height_px = scene->height_px;
    matrix_view((const double(*)[3])basis, eye_m, view->view);
    matrix_projection(view, view->projection);
    glm_mat4_mul(view->projection, view->view, view->view_projection);

    const struct sun *sun = &scene->sun;
    double t = view->time;
    double azimuth = sun->azimuth_rad + t * ((double)sun->end_azimuth_rad - sun->azimuth_rad);
    double elevation =
        sun->elevation_rad + t * ((double)sun->end_elevation_rad - sun->elevation_rad);
    view->sun_direction[0] = (float)(cos(elevation) * sin(azimuth));
    view->sun_direction[1] = (float)sin(elevation);
    view->sun_direction[2] = (float)(cos(elevation) * cos(azimuth));
}

void view_at(const struct scene *scene, double time, struct view *view)
{
    *view = (struct view){0};
    view->time = time > 0 ? (time < 1 ? time : 1) : 0;
    view->near_m = scene->camera.near_m;
    view->far_m = scene->camera.far_m;
    float eye_m[3], target_m[3];
    camera_at(scene, view->time, eye_m, target_m);
    view_fill(scene, eye_m, target_m, view);
}

void view_look_at(const struct scene *scene, const float eye_m[3], const float target_m[3],
                  struct view *view)
{
    *view = (struct view){0};
    float eyes_m[1][3] = {{eye_m[0], eye_m[1], eye_m[2]}};
    camera_depths(scene, eyes_m, 1, &view->near_m, &view->far_m);
    if (scene->camera.near_m > 0)
        view->near_m = fminf(view->near_m, scene->camera.near_m);
    view->far_m = fmaxf(view->far_m, scene->camera.far_m);
    view_fill(scene, eye_m, target_m, view);
}

/* The way that the camera looks, tilted back to the horizon, is cos(elevation) forward +
 * sin(elevation) up: known straight down, too, by where the picture's top is. */
void view_angles_deg(const struct view *view, double *elevation_deg, double *azimuth_deg)
{
    const float *forward = view->forward, *up = view->up;
    double level = hypot(forward[0], forward[2]), x = forward[0] * level - forward[1] * up[0],
           z = forward[2] * level - forward[1] * up[2];
    *elevation_deg = atan2(0.0 - forward[1], level) / DEGREE; /* never -0 */
    *azimuth_deg = fmod(atan2(-x, -z) / DEGREE + 360, 360);
}

void view_ray(const struct view *view, float x_px, float y_px, float direction[3])
{
    double tangent = tan(0.5 * view->fov_y_rad);
    double across = tangent * (2.0 * x_px - view->width_px) / view->height_px;
    double along = tangent * (view->height_px - 2.0 * y_px) / view->height_px;
    double ray[3];
    for (int i = 0; i < 3; i++)
        ray[i] = view->forward[i] + across * view->right[i] + along * view->up[i];
    double length = length3(ray);
    for (int i = 0; i < 3; i++)
        direction[i] = (float)(ray[i] / length);
}

/* Distances to the six planes; a sphere outside one of them touches nothing. A sphere near a corner
 * may pass. The margin covers rounding. */
bool view_sees_sphere(const struct view *view, const float center_m[3], float radius_m)
{
    float offset[3], x = 0, y = 0, depth = 0;
    for (int i = 0; i < 3; i++) {
        offset[i] = center_m[i] - view->eye_m[i];
        x += offset[i] * view->right[i];
        y += offset[i] * view->up[i];
        depth += offset[i] * view->forward[i];
    }
    float margin_m = 1e-5f * (fabsf(x) + fabsf(y) + fabsf(depth)) + 1e-5f;
    float reach_m = radius_m + margin_m;
    if (depth + reach_m < view->near_m || depth - reach_m > view->far_m)
        return false;
    float scale_x = view->projection[0][0], scale_y = view->projection[1][1];
    return !(fabsf(x) * scale_x - depth > reach_m * sqrtf(1 + scale_x * scale_x)) &&
           !(fabsf(y) * scale_y - depth > reach_m * sqrtf(1 + scale_y * scale_y));
}

void instance_matrix(const struct instance *instance, mat4 matrix)
{
    float c = cosf(instance->rotation_rad) * instance->scale;
    float s = sinf(instance->rotation_rad) * instance->scale;
    memset(matrix, 0, sizeof(mat4));
    matrix[0][0] = c;
    matrix[0][2] = -s;
    matrix[1][1] = instance->scale * instance->stretch;
    matrix[2][0] = s;
    matrix[2][2] = c;
    memcpy(matrix[3], instance->position_m, sizeof instance->position_m);
    matrix[3][3] = 1;
}
