/* A tree turned into numbers for a kernel: place on the screen, rays in its axes, light. */
#include "bake/march_job.h"
#include "bake/march_shadow.h"

#include <math.h>

static float dot3(const float a[3], const float b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static int16_t pixel_of(float at_px, int size_px)
{
    return (int16_t)(at_px > -2 ? at_px < (float)size_px ? at_px : (float)size_px + 1 : -2);
}

void march_seen_between(struct march_seen *seen, int axis, float first, float last, int size_px)
{
    seen->low[axis] = pixel_of(first > 0 ? first : 0, size_px);
    seen->high[axis] = pixel_of(last < (float)(size_px - 1) ? last : (float)(size_px - 1), size_px);
}

void march_middle(const struct march_view *picture, const struct march_tree *tree, float middle[3])
{
    const struct view *view = picture->view;
    const float *center = picture->species[tree->species].center_m;
    float offset[3] = {center[0] * tree->cosine + center[2] * tree->sine, tree->stretch * center[1],
                       center[2] * tree->cosine - center[0] * tree->sine};
    for (int i = 0; i < 3; i++)
        offset[i] = tree->position_m[i] + tree->scale * offset[i] - view->eye_m[i];
    middle[2] = dot3(offset, view->forward);
    float scale = picture->focal_px / middle[2];
    middle[0] = 0.5f * (float)(view->width_px - 1) + scale * dot3(offset, view->right);
    middle[1] = 0.5f * (float)(view->height_px - 1) - scale * dot3(offset, view->up);
}

/* Of a far picture: all of it at a radius, nothing from smooth octaves above on. */
static uint8_t far_share(float radius_px, float limit_px, float smooth)
{
    if (radius_px < limit_px || !(smooth > 0))
        return radius_px < limit_px ? 255 : 0;
    float part = 1 - log2f(radius_px / limit_px) / smooth;
    return part > 0 ? (uint8_t)(255 * part) : 0;
}

static struct march_seen see_small(const struct march_view *picture, const struct march_tree *tree)
{
    struct march_seen seen = {.level = MARCH_SPLAT};
    float middle[3];
    march_middle(picture, tree, middle);
    float x = floorf(middle[0]), y = floorf(middle[1]);
    march_seen_between(&seen, 0, x, x + 1, picture->view->width_px);
    march_seen_between(&seen, 1, y, y + 1, picture->view->height_px);
    return seen;
}

static struct march_seen see_sprite(const struct march_view *picture, const struct march_tree *tree,
                                    float radius_m)
{
    struct march_seen seen = {.level = MARCH_SPRITE};
    float middle[3];
    march_middle(picture, tree, middle);
    float reach_px = 0.5f + radius_m * picture->focal_px / middle[2];
    for (int i = 0; i < 2; i++)
        march_seen_between(&seen, i, ceilf(middle[i] - reach_px), floorf(middle[i] + reach_px),
                           i ? picture->view->height_px : picture->view->width_px);
    return seen;
}

/* Nothing of the coarser level up to 1 - smooth, all of it at 1. */
static uint8_t next_share(float part, float smooth)
{
    float from = 1 - smooth;
    return part > from ? (uint8_t)(255 * (part - from) / smooth) : 0;
}

/* Also the pixels that another one holds. */
static void seen_join(struct march_seen *seen, const struct march_seen *other)
{
    for (int i = 0; i < 2; i++) {
        bool none = seen->low[i] > seen->high[i];
        seen->low[i] = none || other->low[i] < seen->low[i] ? other->low[i] : seen->low[i];
        seen->high[i] = none || other->high[i] > seen->high[i] ? other->high[i] : seen->high[i];
    }
}

static struct march_seen see_voxels(const struct march_view *picture, const struct march_tree *tree,
                                    float depth_m)
{
    const struct march_species *species = &picture->species[tree->species];
    const struct view *view = picture->view;
    struct march_seen seen = {.high = {-1, -1}};
    float detail = march_detail_of(view, tree, species->voxels, picture->focal_px,
                                   picture->options.bias, depth_m);
    seen.level = (uint8_t)detail;
    seen.next = next_share(detail - floorf(detail), picture->options.smooth);
    struct march_box box = march_box_of(view, tree, species->voxels, seen.level + (seen.next > 0));
    struct march_outline outline = march_outline_of(view, &box, picture->focal_px);
    seen.within = !outline.before && march_within_bark(view, tree, species->mesh);
    for (int i = 0; i < 2 && outline.any; i++)
        march_seen_between(&seen, i, ceilf(outline.low[i]), floorf(outline.high[i]),
                           i ? view->height_px : view->width_px);
    return seen;
}

/* Sprites turn into splats below a splat's size, since that holds no more; else the finer turns
 * into the coarser above its limit: rays between voxels smaller than a pixel would miss them. */
struct march_seen march_see(const struct march_view *picture, const struct march_tree *tree,
                            float depth_m)
{
    const float radius_m = tree->scale * picture->species[tree->species].radius_m;
    if (tree->stretch != 1 || depth_m - radius_m <= picture->view->near_m)
        return see_voxels(picture, tree, depth_m);
    const float smooth = picture->options.smooth, far_px = picture->options.far_px;
    const float radius_px = radius_m * picture->focal_px / depth_m;
    const bool sprites = far_px > MARCH_SMALL_PX;
    const float small_px = sprites && smooth > 0 ? MARCH_SMALL_PX * exp2f(-smooth) : MARCH_SMALL_PX;
    if (radius_px < small_px)
        return see_small(picture, tree);
    struct march_seen seen = radius_px < far_px ? see_sprite(picture, tree, radius_m)
                                                : see_voxels(picture, tree, depth_m);
    const bool far_sprite = sprites && seen.level != MARCH_SPRITE;
    seen.far = far_share(radius_px, far_sprite ? far_px : small_px, smooth);
    if (seen.far > 0) {
        struct march_seen other =
            far_sprite ? see_sprite(picture, tree, radius_m) : see_small(picture, tree);
        seen_join(&seen, &other);
    }
    return seen;
}

struct march_span march_span_of(const struct march_view *picture, const struct march_tree *tree,
                                uint32_t level)
{
    const struct voxels *voxels = picture->species[tree->species].voxels;
    uint32_t kept = level < voxels->levels_count ? level : 0;
    struct march_box box = march_box_of(picture->view, tree, voxels, kept);
    float middle_m = dot3(box.middle_m, picture->view->forward);
    float reach_m = march_box_reach(&box, picture->view->forward);
    return (struct march_span){.near_m = middle_m - reach_m,
                               .far_m = middle_m + reach_m,
                               .voxel_m = tree->scale * voxels->levels[kept].voxel_m};
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

struct march_form march_form_of(enum march_model model, const float x[3], const float y[3])
{
    return model == MARCH_ISOTROPIC ? form_isotropic(x, y) : form_of(x, y);
}

static void light_fill(const struct march_view *picture, const struct march_tree *tree,
                       const struct voxels *voxels, struct march_job *job)
{
    const struct scene *scene = picture->scene;
    const float *toward_eye = job->toward_eye, *toward_sun = job->toward_sun;
    march_to_plant(tree, picture->view->sun_direction, 1, job->toward_sun);
    job->by_mean = picture->options.model == MARCH_VISIBLE;
    job->cosine = dot3(toward_eye, toward_sun);
    job->sun_square = tree->stretch == 1 ? 1 : dot3(toward_sun, toward_sun);
    job->raise = 1 / (tree->stretch * tree->stretch) - 1;
    const enum march_model model = picture->options.model;
    job->hidden = march_form_of(model, toward_eye, toward_eye);
    job->upright = march_form_of(model, (float[3]){0, 1, 0}, (float[3]){0, 1, 0});
    job->seen = job->hidden;
    job->lit = march_form_of(model, toward_sun, toward_sun);
    job->both = march_form_of(model, toward_eye, toward_sun);
    const bool thin = !picture->species[tree->species].is_solid;
    job->one_sided = picture->effects & EFFECT_TWO_SIDED && thin ? 0 : 1;
    for (int c = 0; c < 3; c++) {
        float white = voxels->albedo[c] / 255;
        job->sun[c] = white * scene->sun.radiance[c];
        job->shade[c] = picture->effects & EFFECT_AMBIENT ? white * scene->ambient[c] : 0;
    }
}

static void fog_fill(const struct march_view *picture, const struct march_box *box,
                     struct march_job *job)
{
    float density = picture->effects & EFFECT_FOG ? picture->scene->fog.density_per_m : 0;
    job->clear = march_box_clear(box, density);
    for (int c = 0; c < 3; c++)
        job->fog[c] = (1 - job->clear) * picture->scene->fog.color[c];
}

void march_species_fill(struct arena *arena, const struct voxels *voxels, const struct mesh *mesh,
                        struct march_species *species)
{
    float square = 0;
    species->voxels = voxels;
    species->mesh = mesh;
    species->is_solid = mesh_is_solid(mesh);
    for (uint32_t level = 0; level < voxels->levels_count; level++)
        species->cells[level] = march_free_cells(arena, &voxels->levels[level]);
    for (int i = 0; i < 3; i++) {
        float half = 0.5f * (mesh->maximum_m[i] - mesh->minimum_m[i]);
        species->center_m[i] = mesh->minimum_m[i] + half;
        species->half_m[i] = half;
        square += half * half;
    }
    species->radius_m = sqrtf(square);
}

void march_job_aim(const struct march_view *picture, const struct march_tree *tree, float x_px,
                   float y_px, float voxel_m, struct march_job *job)
{
    const struct backdrop_rays *rays = &picture->rays;
    float world[3];
    for (int i = 0; i < 3; i++)
        world[i] = rays->first[i] + x_px * rays->right[i] + y_px * rays->down[i];
    march_to_plant(tree, world, 1 / (tree->scale * voxel_m), job->first);
}

void march_job_fill(const struct march_view *picture, const struct march_tree *tree, uint32_t level,
                    float x_px, float y_px, struct march_job *job)
{
    const struct voxels *voxels = picture->species[tree->species].voxels;
    const struct voxels_level *grid = &voxels->levels[level];
    const float per_m = 1 / (tree->scale * grid->voxel_m);
    struct march_box box = march_box_of(picture->view, tree, voxels, level);
    job->cells = picture->species[tree->species].cells[level];
    job->voxels = (const uint32_t *)(const void *)voxels->voxels;
    for (int i = 0; i < 3; i++)
        job->size[i] = (int32_t)grid->size[i];
    march_eye_of(picture->view, tree, voxels, level, per_m, job->eye);
    march_to_plant(tree, picture->rays.right, per_m, job->right);
    march_to_plant(tree, picture->rays.down, per_m, job->down);
    march_job_aim(picture, tree, x_px, y_px, grid->voxel_m, job);
    job->speed = sqrtf(dot3(job->first, job->first));
    for (int i = 0; i < 3; i++)
        job->toward_eye[i] = -job->first[i] / job->speed;
    job->near_m = picture->view->near_m;
    job->far_m = INFINITY;
    job->step = picture->options.step;
    job->stop = picture->options.stop;
    job->thinned = 0;
    light_fill(picture, tree, voxels, job);
    job->light.passes = NULL;
    if (picture->shadows)
        march_shadows_fill(picture->shadows, tree, level, job);
    fog_fill(picture, &box, job);
}

/* A rectangle's even spread cut to the pixels along an axis; returns the first. */
static int splat_cut(float middle_px, float side_px, int *count, float shares[SPLAT_SIDE])
{
    float low = middle_px - 0.5f * side_px, high = middle_px + 0.5f * side_px;
    float first = floorf(low + 0.5f);
    *count = 0;
    for (float at = first; at - 0.5f < high && *count < SPLAT_SIDE; at++) {
        float length_px = fminf(high, at + 0.5f) - fmaxf(low, at - 0.5f);
        shares[(*count)++] = length_px > 0 ? length_px / side_px : 0;
    }
    return (int)first;
}

float march_clear(const struct march_view *picture, const float middle[3])
{
    if (!(picture->effects & EFFECT_FOG) || !(picture->scene->fog.density_per_m > 0))
        return 1;
    float x = (middle[0] - 0.5f * (float)picture->view->width_px) / picture->focal_px;
    float y = (middle[1] - 0.5f * (float)picture->view->height_px) / picture->focal_px;
    return expf(-picture->scene->fog.density_per_m * middle[2] * sqrtf(1 + x * x + y * y));
}

void march_splat_place(const struct march_view *picture, const float middle[3],
                       const float sides_px[2], float foot_y_m, const struct march_far *far,
                       struct march_splat *splat)
{
    const float clear = march_clear(picture, middle);
    splat->x_px = splat_cut(middle[0], sides_px[0], &splat->columns, splat->across);
    splat->y_px = splat_cut(middle[1], sides_px[1], &splat->rows, splat->along);
    splat->share = 1;
    splat->depth_m = middle[2];
    splat->lift_m = foot_y_m - picture->view->eye_m[1];
    for (int c = 0; c < 3; c++)
        splat->rgb[c] =
            picture->scene->fog.color[c] + clear * (far->rgb[c] - picture->scene->fog.color[c]);
}

void march_splat_of(const struct march_view *picture, const struct march_tree *tree,
                    const struct march_far *far, struct march_splat *splat)
{
    static const float pixel[2] = {1, 1};
    float middle[3];
    march_middle(picture, tree, middle);
    float per_m = tree->scale * picture->focal_px / middle[2];
    march_splat_place(picture, middle, pixel, tree->position_m[1], far, splat);
    splat->area_px2 = far->cover_m2 * per_m * per_m;
    splat->is_many = false;
}
