/* A tree turned into numbers for a kernel: place on the screen, rays in its axes, light. */
#include "bake/march_job.h"

#include <math.h>

/* World to plant: the inverse of instance_matrix's rotation. */
static void to_plant(const struct march_tree *tree, const float world[3], float scale,
                     float plant[3])
{
    plant[0] = scale * (world[0] * tree->cosine - world[2] * tree->sine);
    plant[1] = scale * world[1];
    plant[2] = scale * (world[0] * tree->sine + world[2] * tree->cosine);
}

static float dot3(const float a[3], const float b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* The middle of a level's box from the eye, and its half extents' vectors. */
struct box {
    float middle_m[3], half_m[3][3];
};

static struct box box_of(const struct march_view *picture, const struct march_tree *tree,
                         const struct voxels *voxels, uint32_t level)
{
    const struct voxels_level *grid = &voxels->levels[level];
    const float c = tree->cosine, s = tree->sine;
    const float axes[3][3] = {{c, 0, -s}, {0, 1, 0}, {s, 0, c}};
    struct box box;
    for (int i = 0; i < 3; i++)
        box.middle_m[i] = tree->position_m[i] - picture->view->eye_m[i];
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

/* The level whose voxels are about as large as pixels. */
static uint32_t level_of(const struct march_view *picture, const struct march_tree *tree,
                         const struct voxels *voxels, float depth_m)
{
    float pixel_m = fmaxf(depth_m, picture->view->near_m) / picture->focal_px;
    float level =
        floorf(log2f(pixel_m / (tree->scale * voxels->levels[0].voxel_m)) + picture->options.bias);
    float last = (float)(voxels->levels_count - 1);
    return (uint32_t)fminf(fmaxf(level, 0), last);
}

static int16_t pixel_of(float at_px, int size_px)
{
    return (int16_t)fminf(fmaxf(at_px, -2), (float)size_px + 1);
}

struct march_seen march_see(const struct march_view *picture, const struct march_tree *tree,
                            const struct voxels *voxels, float depth_m)
{
    const struct view *view = picture->view;
    const int size_px[2] = {view->width_px, view->height_px};
    const float down[3] = {-view->up[0], -view->up[1], -view->up[2]};
    const float *axes[2] = {view->right, down};
    struct march_seen seen = {{0, 0}, {-1, -1}, 0};
    seen.level = (uint8_t)level_of(picture, tree, voxels, depth_m);
    struct box box = box_of(picture, tree, voxels, seen.level);
    float middle = dot3(box.middle_m, view->forward), reach = 0, low[2], high[2];
    for (int k = 0; k < 3; k++)
        reach += fabsf(dot3(box.half_m[k], view->forward));
    if (middle + reach < view->near_m)
        return seen;
    bool small = true;
    for (int i = 0; i < 2; i++) {
        low[i] = 0;
        high[i] = (float)size_px[i];
        small &= middle - reach > view->near_m;
        if (middle - reach <= view->near_m)
            continue;
        float slope = dot3(box.middle_m, axes[i]) / middle, spread = 0;
        for (int k = 0; k < 3; k++)
            spread +=
                fabsf(dot3(box.half_m[k], axes[i]) - slope * dot3(box.half_m[k], view->forward));
        spread *= picture->focal_px / (middle - reach);
        float at = 0.5f * (float)size_px[i] + picture->focal_px * slope;
        low[i] = at - spread;
        high[i] = at + spread;
        small &= spread < 0.75f;
    }
    if (small)
        seen.level = MARCH_SPLAT;
    for (int i = 0; i < 2; i++) {
        float at = 0.5f * (low[i] + high[i]);
        float first = small ? floorf(at - 0.5f) : ceilf(low[i] - 0.5f);
        float last = small ? first + 1 : floorf(high[i] - 0.5f);
        seen.low[i] = pixel_of(fmaxf(first, 0), size_px[i]);
        seen.high[i] = pixel_of(fminf(last, (float)(size_px[i] - 1)), size_px[i]);
    }
    return seen;
}

/* x' M y of a packed matrix. */
static struct march_form form_of(const float x[3], const float y[3])
{
    struct march_form form;
    float *f = form.factors, zz = x[2] * y[2];
    f[1] = (x[0] * y[0] - zz) / 63;
    f[2] = (x[1] * y[1] - zz) / 63;
    f[3] = (x[0] * y[1] + x[1] * y[0]) / 62;
    f[4] = (x[0] * y[2] + x[2] * y[0]) / 62;
    f[5] = (x[1] * y[2] + x[2] * y[1]) / 62;
    f[0] = zz - 31 * (f[3] + f[4] + f[5]);
    return form;
}

/* The same for the matrix 1/3. */
static struct march_form form_isotropic(const float x[3], const float y[3])
{
    return (struct march_form){{dot3(x, y) / 3}};
}

static void light_fill(const struct march_view *picture, const struct march_tree *tree,
                       const struct voxels *voxels, const float toward_eye[3],
                       struct march_job *job)
{
    const struct scene *scene = picture->scene;
    float toward_sun[3];
    to_plant(tree, picture->view->sun_direction, 1, toward_sun);
    struct march_form (*form)(const float[3], const float[3]) =
        picture->options.model == MARCH_SGGX ? form_of : form_isotropic;
    job->hidden = form(toward_eye, toward_eye);
    job->seen = job->hidden;
    job->lit = form(toward_sun, toward_sun);
    job->both = form(toward_eye, toward_sun);
    job->one_sided = picture->effects & EFFECT_TWO_SIDED ? 0 : 1;
    for (int c = 0; c < 3; c++) {
        float white = voxels->albedo[c] / 255;
        job->sun[c] = white * scene->sun.radiance[c];
        job->shade[c] = picture->effects & EFFECT_AMBIENT ? white * scene->ambient[c] : 0;
    }
}

static void fog_fill(const struct march_view *picture, const struct box *box, struct march_job *job)
{
    float density = picture->effects & EFFECT_FOG ? picture->scene->fog.density_per_m : 0;
    job->clear = density > 0 ? expf(-density * sqrtf(dot3(box->middle_m, box->middle_m))) : 1;
    for (int c = 0; c < 3; c++)
        job->fog[c] = (1 - job->clear) * picture->scene->fog.color[c];
}

void march_job_aim(const struct march_view *picture, const struct march_tree *tree, float x_px,
                   float y_px, float voxel_m, struct march_job *job)
{
    const struct backdrop_rays *rays = &picture->rays;
    float world[3];
    for (int i = 0; i < 3; i++)
        world[i] = rays->first[i] + x_px * rays->right[i] + y_px * rays->down[i];
    to_plant(tree, world, 1 / (tree->scale * voxel_m), job->first);
}

void march_job_fill(const struct march_view *picture, const struct march_tree *tree,
                    const struct voxels *voxels, uint32_t level, float x_px, float y_px,
                    struct march_job *job)
{
    const struct voxels_level *grid = &voxels->levels[level];
    float per_m = 1 / (tree->scale * grid->voxel_m), offset[3], toward_eye[3];
    struct box box = box_of(picture, tree, voxels, level);
    job->cells = grid->cells;
    job->voxels = (const uint32_t *)(const void *)voxels->voxels;
    for (int i = 0; i < 3; i++) {
        job->size[i] = (int32_t)grid->size[i];
        offset[i] = picture->view->eye_m[i] - tree->position_m[i];
    }
    to_plant(tree, offset, per_m, job->eye);
    for (int i = 0; i < 3; i++)
        job->eye[i] -= voxels->origin_m[i] / grid->voxel_m;
    to_plant(tree, picture->rays.right, per_m, job->right);
    to_plant(tree, picture->rays.down, per_m, job->down);
    march_job_aim(picture, tree, x_px, y_px, grid->voxel_m, job);
    job->speed = sqrtf(dot3(job->first, job->first));
    for (int i = 0; i < 3; i++)
        toward_eye[i] = -job->first[i] / job->speed;
    job->near_m = picture->view->near_m;
    job->step = picture->options.step;
    job->stop = picture->options.stop;
    light_fill(picture, tree, voxels, toward_eye, job);
    fog_fill(picture, &box, job);
}

/* The coarsest level is one voxel; a ray along an axis through its middle is covered by the share
 * that rays along this axis are, and its face is as large as a voxel's: so this much of the screen
 * is covered, and between the axes what the voxel's shape says. */
void march_splat_of(const struct march_view *picture, const struct march_tree *tree,
                    const struct voxels *voxels, march_block *block, struct march_splat *splat)
{
    const struct view *view = picture->view;
    const uint32_t last = voxels->levels_count - 1;
    struct box box = box_of(picture, tree, voxels, last);
    struct march_job job;
    struct march_rays rays = {.left = {0}};
    float depth = dot3(box.middle_m, view->forward);
    float x = 0.5f * (float)view->width_px +
              picture->focal_px * dot3(box.middle_m, view->right) / depth - 0.5f;
    float y = 0.5f * (float)view->height_px -
              picture->focal_px * dot3(box.middle_m, view->up) / depth - 0.5f;
    march_job_fill(picture, tree, voxels, last, x, y, &job);
    job.near_m = depth - 0.5f / job.speed;
    job.step = 1;
    rays.left[0] = 1;
    rays.depths_m[0] = depth + 0.5f / job.speed;
    block(&job, &rays);
    float covered = 1 - rays.left[0];
    float side_px = tree->scale * voxels->levels[last].voxel_m * picture->focal_px / depth;
    float right = x - floorf(x), low = y - floorf(y);
    splat->x_px = (int)floorf(x);
    splat->y_px = (int)floorf(y);
    splat->depth_m = depth;
    for (int c = 0; c < 3; c++)
        splat->rgb[c] = covered > 0 ? rays.rgb[c][0] / covered : 0;
    for (int k = 0; k < 4; k++)
        splat->shares[k] = fminf(1, covered * side_px * side_px * (k & 1 ? right : 1 - right) *
                                        (k >> 1 ? low : 1 - low));
}
