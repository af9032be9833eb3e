/* Trees in the world and on the screen, for marches of rays. */
#include "bake/march_tree.h"

#include <math.h>
#include <string.h>

void march_trees_fill(const struct scene *scene, struct march_tree *trees)
{
    for (size_t i = 0; i < scene->instances_count; i++) {
        const struct instance *instance = &scene->instances[i];
        struct march_tree *tree = &trees[i];
        memcpy(tree->position_m, instance->position_m, sizeof tree->position_m);
        tree->cosine = cosf(instance->rotation_rad);
        tree->sine = sinf(instance->rotation_rad);
        tree->scale = instance->scale;
        tree->stretch = instance->stretch;
        tree->species = instance->species;
        float turns = instance->rotation_rad / 6.2831853f;
        tree->turn =
            (uint16_t)((uint32_t)((turns - floorf(turns)) * MARCH_TURNS + 0.5f) % MARCH_TURNS);
    }
}

/* The inverse of instance_matrix's rotation and stretch. */
void march_to_plant(const struct march_tree *tree, const float world[3], float scale,
                    float plant[3])
{
    plant[0] = scale * (world[0] * tree->cosine - world[2] * tree->sine);
    plant[1] = scale * world[1] / tree->stretch;
    plant[2] = scale * (world[0] * tree->sine + world[2] * tree->cosine);
}

void march_eye_of(const struct view *view, const struct march_tree *tree,
                  const struct voxels *voxels, uint32_t level, float per_m, float eye[3])
{
    float offset[3];
    for (int i = 0; i < 3; i++)
        offset[i] = view->eye_m[i] - tree->position_m[i];
    march_to_plant(tree, offset, per_m, eye);
    for (int i = 0; i < 3; i++)
        eye[i] -= voxels->origin_m[i] / voxels->levels[level].voxel_m;
}

float march_detail_of(const struct view *view, const struct march_tree *tree,
                      const struct voxels *voxels, float focal_px, float bias, float depth_m)
{
    float pixel_m = fmaxf(depth_m, view->near_m) / focal_px;
    float voxel_m = tree->scale * sqrtf(tree->stretch) * voxels->levels[0].voxel_m;
    float level = log2f(pixel_m / voxel_m) + bias;
    return fminf(fmaxf(level, 0), (float)(voxels->levels_count - 1));
}

static float dot3(const float a[3], const float b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

struct march_box march_box_of(const struct view *view, const struct march_tree *tree,
                              const struct voxels *voxels, uint32_t level)
{
    const struct voxels_level *grid = &voxels->levels[level];
    const float c = tree->cosine, s = tree->sine;
    const float axes[3][3] = {{c, 0, -s}, {0, tree->stretch, 0}, {s, 0, c}};
    struct march_box box;
    for (int i = 0; i < 3; i++)
        box.middle_m[i] = tree->position_m[i] - view->eye_m[i];
    for (int k = 0; k < 3; k++) {
        float half = 0.5f * (float)grid->size[k] * grid->voxel_m;
        float place = tree->scale * (voxels->origin_m[k] + half);
        for (int i = 0; i < 3; i++) {
            box.middle_m[i] += place * axes[k][i];
            box.half_m[k][i] = tree->scale * half * axes[k][i];
        }
    }
    return box;
}

float march_box_reach(const struct march_box *box, const float direction[3])
{
    float reach = 0;
    for (int k = 0; k < 3; k++)
        reach += fabsf(dot3(box->half_m[k], direction));
    return reach;
}

float march_box_spread(const struct march_box *box, const float axis[3], const float forward[3],
                       float slope)
{
    float spread = 0;
    for (int k = 0; k < 3; k++)
        spread += fabsf(dot3(box->half_m[k], axis) - slope * dot3(box->half_m[k], forward));
    return spread;
}

float march_box_clear(const struct march_box *box, float fog_density_per_m)
{
    if (!(fog_density_per_m > 0))
        return 1;
    return expf(-fog_density_per_m * sqrtf(dot3(box->middle_m, box->middle_m)));
}

struct march_outline march_outline_of(const struct view *view, const struct march_box *box,
                                      float focal_px)
{
    const int size_px[2] = {view->width_px, view->height_px};
    const float down[3] = {-view->up[0], -view->up[1], -view->up[2]};
    const float *axes[2] = {view->right, down};
    float middle = dot3(box->middle_m, view->forward);
    float reach = march_box_reach(box, view->forward);
    struct march_outline outline = {.high = {(float)size_px[0], (float)size_px[1]},
                                    .before = middle - reach > view->near_m,
                                    .any = middle + reach > view->near_m};
    for (int i = 0; i < 2 && outline.before; i++) {
        float slope = dot3(box->middle_m, axes[i]) / middle;
        float spread =
            march_box_spread(box, axes[i], view->forward, slope) * focal_px / (middle - reach);
        outline.middle[i] = 0.5f * (float)(size_px[i] - 1) + focal_px * slope;
        outline.low[i] = outline.middle[i] - spread;
        outline.high[i] = outline.middle[i] + spread;
    }
    return outline;
}
