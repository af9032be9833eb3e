/* Pictures with depth: the ray of a pixel, the point and the normal that it shows. */
#include "plant/coloring_view.h"

#include <math.h>

struct ray depth_view_ray(const struct depth_view *view, int column, int row)
{
    float x = (2 * ((float)column + 0.5f) / (float)view->width_px - 1) * view->half[0];
    float y = (1 - 2 * ((float)row + 0.5f) / (float)view->height_px) * view->half[1];
    struct ray ray;
    for (int i = 0; i < 3; i++) {
        float aside = x * view->right[i] + y * view->up[i];
        ray.origin_m[i] = view->position_m[i] + (view->pinhole ? 0 : aside);
        ray.direction[i] = view->forward[i] + (view->pinhole ? aside : 0);
    }
    return ray;
}

void depth_view_point(const struct depth_view *view, int column, int row, float depth_m,
                      float point_m[3])
{
    struct ray ray = depth_view_ray(view, column, row);
    for (int i = 0; i < 3; i++)
        point_m[i] = ray.origin_m[i] + depth_m * ray.direction[i];
}

/* The surface's tangent along the picture's columns (step 1, 0) or rows (0, 1): to the neighbour
 * whose depth is nearer, or across the view where both are far. */
static void tangent(const struct depth_view *view, int column, int row, const int step[2],
                    float along[3])
{
    float depth = view->depth_m[(size_t)row * (size_t)view->width_px + (size_t)column];
    float scale = view->pinhole ? depth : 1;
    float pixel_m = 2 * scale * (step[0] ? view->half[0] : view->half[1]) /
                    (float)(step[0] ? view->width_px : view->height_px);
    float nearest = 8 * pixel_m;
    int chosen = 0;
    for (int sign = -1; sign <= 1; sign += 2) {
        int x = column + sign * step[0], y = row + sign * step[1];
        if (x < 0 || y < 0 || x >= view->width_px || y >= view->height_px)
            continue;
        float jump = fabsf(view->depth_m[(size_t)y * (size_t)view->width_px + (size_t)x] - depth);
        if (jump < nearest) /* not where it is infinite */
            nearest = jump, chosen = sign;
    }
    int sign = chosen ? chosen : 1, x = column + sign * step[0], y = row + sign * step[1];
    float here[3], there[3];
    float beside = chosen ? view->depth_m[(size_t)y * (size_t)view->width_px + (size_t)x] : depth;
    depth_view_point(view, column, row, depth, here);
    depth_view_point(view, x, y, beside, there);
    for (int i = 0; i < 3; i++)
        along[i] = (float)sign * (there[i] - here[i]);
}

void depth_view_normal(const struct depth_view *view, int column, int row, float normal[3])
{
    float a[3], b[3];
    tangent(view, column, row, (const int[2]){1, 0}, a);
    tangent(view, column, row, (const int[2]){0, 1}, b);
    /* Columns go right, rows go down: down x right points to the camera. */
    float n[3] = {b[1] * a[2] - b[2] * a[1], b[2] * a[0] - b[0] * a[2], b[0] * a[1] - b[1] * a[0]};
    float length = sqrtf(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    for (int i = 0; i < 3; i++)
        normal[i] = length > 0 ? n[i] / length : -view->forward[i];
}
