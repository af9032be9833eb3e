/* How a plant looks from far away: rays marched through it, summed. */
#include "bake/march_job.h"

#include <math.h>
#include <string.h>

static float dot3(const float a[3], const float b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

enum { FAR_SIDE = 2 * SPRITE_SIDE, FAR_RAYS = FAR_SIDE * FAR_SIDE };
struct far_rays {
    float left[FAR_RAYS + MARCH_ROOM], depths_m[FAR_RAYS + MARCH_ROOM], rgb[FAR_RAYS][4];
};

/* All of them. */
static void far_march(const struct march_job *job, march_kernel *kernel, float depth_m,
                      struct far_rays *far)
{
    const struct march_rect rect = {{0, 0}, {FAR_SIDE - 1, FAR_SIDE - 1}};
    struct march_rays rays = {FAR_SIDE, far->left, far->rgb, far->depths_m, 0};
    memset(far, 0, sizeof *far);
    for (int at = 0; at < FAR_RAYS; at++) {
        far->left[at] = 1;
        far->depths_m[at] = 2 * depth_m;
    }
    kernel(job, &rect, &rays);
}

/* Adds rays to the sums, and to the texels, of four rays each. */
static void far_gather(const struct far_rays *rays, struct march_far *far,
                       struct march_sprite *sprite)
{
    for (int at = 0; at < FAR_RAYS; at++) {
        float *texel = sprite->sums[at / FAR_SIDE / 2 + 1][at % FAR_SIDE / 2 + 1];
        float cover = 1 - rays->left[at];
        far->cover_m2 += cover;
        texel[3] += 0.25f * cover;
        for (int c = 0; c < 3; c++) {
            far->rgb[c] += rays->rgb[at][c];
            texel[c] += 0.25f * rays->rgb[at][c];
        }
    }
}

/* The box before the eye on the ray, far away, in FAR_SIDE x FAR_SIDE rays; what is covered in the
 * plane through its middle along the screen. Fog is left to each tree. */
static void sprite_sum(struct march_sprite *sprite)
{
    for (int y = 1; y <= SPRITE_SIDE; y++)
        for (int x = 1; x <= SPRITE_SIDE; x++)
            for (int c = 0; c < 4; c++)
                sprite->sums[y][x][c] += sprite->sums[y - 1][x][c] + sprite->sums[y][x - 1][c] -
                                         sprite->sums[y - 1][x - 1][c];
}

/* The sun's part of what rays see of a tree. */
static void far_sun_add(const struct march_job *job, march_kernel *kernel, float depth_m,
                        struct march_far *far)
{
    struct march_job sun = *job;
    struct far_rays rays;
    memset(sun.shade, 0, sizeof sun.shade);
    far_march(&sun, kernel, depth_m, &rays);
    for (int at = 0; at < FAR_RAYS; at++)
        for (int c = 0; c < 3; c++)
            far->sun_rgb[c] += rays.rgb[at][c];
}

float march_far_lit(const struct march_view *picture, uint32_t species, uint32_t turn, float x_px,
                    float y_px, march_kernel *kernel)
{
    struct march_view sun = *picture;
    struct march_far far[2];
    struct march_sprite sprite;
    float seen[2] = {0, 0};
    sun.effects &= ~(unsigned)EFFECT_AMBIENT;
    for (int shaded = 0; shaded < 2; shaded++) {
        sun.shadows = shaded ? picture->shadows : NULL;
        march_far_fill(&sun, species, turn, x_px, y_px, kernel, &far[shaded], &sprite);
        for (int c = 0; c < 3; c++)
            seen[shaded] += far[shaded].rgb[c];
    }
    return seen[0] > 0 ? seen[1] / seen[0] : 1;
}

void march_far_fill(const struct march_view *picture, uint32_t species, uint32_t turn, float x_px,
                    float y_px, march_kernel *kernel, struct march_far *far,
                    struct march_sprite *sprite)
{
    const float angle = 6.2831853f * (float)turn / MARCH_TURNS;
    const struct view *view = picture->view;
    const struct voxels *voxels = picture->species[species].voxels;
    const float depth_m = 2000 * picture->species[species].radius_m;
    struct march_view away = *picture;
    struct march_tree tree = {.cosine = cosf(angle),
                              .sine = sinf(angle),
                              .scale = 1,
                              .stretch = 1,
                              .species = species,
                              .turn = (uint16_t)turn,
                              .alone = true};
    struct march_box box = march_box_of(view, &tree, voxels, 0);
    float ray[3], sides_m[2];
    for (int i = 0; i < 3; i++)
        ray[i] =
            picture->rays.first[i] + x_px * picture->rays.right[i] + y_px * picture->rays.down[i];
    for (int i = 0; i < 3; i++) /* its middle stands on the ray */
        tree.position_m[i] = depth_m * ray[i] - box.middle_m[i];
    for (int k = 0; k < 2; k++) {
        const float *axis = k ? view->up : view->right;
        sides_m[k] = 2 * march_box_spread(&box, axis, view->forward, dot3(ray, axis)) / FAR_SIDE;
    }
    for (int i = 0; i < 3; i++) {
        away.rays.right[i] = sides_m[0] / depth_m * view->right[i];
        away.rays.down[i] = -sides_m[1] / depth_m * view->up[i];
        away.rays.first[i] =
            ray[i] - 0.5f * (FAR_SIDE - 1) * (away.rays.right[i] + away.rays.down[i]);
    }
    float level = floorf(log2f(sqrtf(sides_m[0] * sides_m[1]) / voxels->levels[0].voxel_m));
    level = fminf(fmaxf(level, 0), (float)(voxels->levels_count - 1));
    away.effects &= ~(unsigned)EFFECT_FOG;
    struct march_job job;
    struct far_rays rays;
    const float middle = 0.5f * (FAR_SIDE - 1), voxel_m = voxels->levels[(int)level].voxel_m;
    march_job_fill(&away, &tree, (uint32_t)level, middle, middle, &job);
    *far = (struct march_far){0};
    *sprite = (struct march_sprite){.sides_m = {FAR_SIDE * sides_m[0], FAR_SIDE * sides_m[1]}};
    march_job_aim(&away, &tree, 0, 0, voxel_m, &job);
    far_march(&job, kernel, depth_m, &rays);
    far_gather(&rays, far, sprite);
    if (picture->shadows)
        far_sun_add(&job, kernel, depth_m, far);
    sprite_sum(sprite);
    for (int c = 0; c < 3; c++) {
        far->rgb[c] = far->cover_m2 > 0 ? far->rgb[c] / far->cover_m2 : 0;
        far->sun_rgb[c] = far->cover_m2 > 0 ? far->sun_rgb[c] / far->cover_m2 : 0;
    }
    far->cover_m2 *= sides_m[0] * sides_m[1];
}
