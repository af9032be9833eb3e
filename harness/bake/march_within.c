/* Is the eye within a trunk? Voxels let through what passes beside the part of a wall that each of
 * them holds: from outside a ray meets two walls and most of it is hidden, from within only one. */
#include "bake/cull.h"
#include "bake/march_tree.h"

#include <math.h>

enum { WAYS = 4 };

/* How often the four horizontal ways from a place leave closed bark more than they enter it. */
static void ways_leave(const struct mesh *mesh, uint32_t triangle, const float place_m[3],
                       int left[WAYS])
{
    const float *p[3];
    for (int k = 0; k < 3; k++)
        p[k] = mesh->positions[mesh->triangles[triangle][k]];
    if (fminf(p[0][1], fminf(p[1][1], p[2][1])) > place_m[1] ||
        fmaxf(p[0][1], fmaxf(p[1][1], p[2][1])) < place_m[1])
        return;
    for (int axis = 0; axis < 3; axis += 2) {
        int b = (axis + 1) % 3, c = (axis + 2) % 3;
        double sides[3], sum = 0, along = 0;
        for (int k = 0; k < 3; k++) {
            const float *from = p[(k + 1) % 3], *to = p[(k + 2) % 3];
            sides[k] = ((double)to[b] - from[b]) * ((double)place_m[c] - from[c]) -
                       ((double)to[c] - from[c]) * ((double)place_m[b] - from[b]);
            sum += sides[k];
            along += sides[k] * p[k][axis];
        }
        if (sum == 0 || (sides[0] > 0) != (sides[1] > 0) || (sides[1] > 0) != (sides[2] > 0))
            continue;
        bool beyond = along / sum > place_m[axis], outward = sum > 0; /* along the axis */
        left[axis + beyond] += beyond == outward ? 1 : -1;
    }
}

static bool place_within(const struct mesh *mesh, const float place_m[3])
{
    int left[WAYS] = {0};
    for (size_t i = 0; i < mesh->parts_count; i++) {
        const struct mesh_part *part = &mesh->parts[i];
        if (mesh->materials[part->material].kind != MATERIAL_BARK)
            continue;
        for (uint32_t t = 0; t < part->triangles_count; t++)
            ways_leave(mesh, part->first_triangle + t, place_m, left);
    }
    return left[0] > 0 && left[1] > 0 && left[2] > 0 && left[3] > 0;
}

bool march_within_bark(const struct view *view, const struct march_tree *tree,
                       const struct mesh *mesh)
{
    const float half = view->near_m / cull_focal_px(view);
    const float right_m = 0.5f * (float)view->width_px * half;
    const float up_m = 0.5f * (float)view->height_px * half;
    for (int corner = 0; corner < 5; corner++) { /* the near plane's middle, and its corners */
        float x_m = corner ? (corner & 1 ? right_m : -right_m) : 0;
        float y_m = corner ? ((corner - 1) & 2 ? up_m : -up_m) : 0;
        float offset[3], place_m[3];
        for (int i = 0; i < 3; i++)
            offset[i] = view->eye_m[i] - tree->position_m[i] + view->near_m * view->forward[i] +
                        x_m * view->right[i] + y_m * view->up[i];
        march_to_plant(tree, offset, 1 / tree->scale, place_m);
        for (int i = 0; i < 3; i++)
            if (!(place_m[i] > mesh->minimum_m[i] && place_m[i] < mesh->maximum_m[i]))
                return false;
        if (!place_within(mesh, place_m))
            return false;
    }
    return true;
}
