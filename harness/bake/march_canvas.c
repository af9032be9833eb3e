/* A tile of the march's picture while it is drawn. */
#include "bake/march_canvas.h"
#include "bake/march_shadow.h"
#include "bake/shadow_ground.h"
#include "bake/share.h"

#include <math.h>
#include <string.h>

void canvas_begin(struct canvas *canvas, const struct march_view *picture, int x, int y, int side)
{
    const struct view *view = picture->view;
    canvas->tile = (struct backdrop_tile){
        .x_px = x,
        .y_px = y,
        .width_px = x + side < view->width_px ? side : view->width_px - x,
        .height_px = y + side < view->height_px ? side : view->height_px - y,
        .stride = side,
        .depths_m = canvas->depths_m,
        .rgb = canvas->rgb,
        .suns = picture->shadows ? canvas->suns : NULL,
    };
    if (picture->shadows)
        memset(canvas->suns, 0, (size_t)(side * side) * sizeof *canvas->suns);
    backdrop_cpu_tile(canvas->backdrop, &canvas->tile);
}

void canvas_open(struct canvas *canvas, const struct march_view *picture)
{
    const int side = canvas->tile.stride;
    canvas->lookups = 0;
    canvas->rays = (struct march_rays){side, canvas->left, canvas->gathered, canvas->depths_m, 0};
    canvas->stop = picture->options.stop;
    canvas->open_count = canvas->tile.width_px * canvas->tile.height_px;
    memset(canvas->gathered, 0, (size_t)(side * side) * sizeof *canvas->gathered);
    for (int row = 0; row < side; row++)
        for (int column = 0; column < side; column++) {
            bool within = row < canvas->tile.height_px && column < canvas->tile.width_px;
            canvas->left[row * side + column] = within ? 1 : 0;
        }
}

void canvas_shade(struct canvas *canvas, const struct march_view *picture)
{
    const struct backdrop_tile *tile = &canvas->tile;
    for (int row = 0; row < tile->height_px; row++)
        for (int column = 0; column < tile->width_px; column++) {
            const int at = row * tile->stride + column;
            if (!(canvas->suns[at] > 0) || canvas->left[at] <= picture->options.stop)
                continue;
            const struct shadow_pixel pixel =
                shadow_pixel_of(picture->view->eye_m, &picture->rays, (float)(tile->x_px + column),
                                (float)(tile->y_px + row), canvas->depths_m[at]);
            march_shadows_shade_ground(picture->shadows, &pixel, canvas->suns[at], canvas->rgb[at]);
        }
}

typedef float four __attribute__((vector_size(4 * sizeof(float))));

void canvas_end_clear(const struct canvas *canvas, const struct view *view, float *pixels)
{
    const struct backdrop_tile *tile = &canvas->tile;
    for (int row = 0; row < tile->height_px; row++) {
        float *to =
            pixels + 4 * ((size_t)(tile->y_px + row) * (size_t)view->width_px + (size_t)tile->x_px);
        for (int at = row * tile->stride, end = at + tile->width_px; at < end; at++, to += 4) {
            const float *behind = canvas->rgb[at];
            const four pixel = {behind[0], behind[1], behind[2], 0};
            memcpy(to, &pixel, sizeof pixel);
        }
    }
}

void canvas_end(const struct canvas *canvas, const struct view *view, float *pixels)
{
    const struct backdrop_tile *tile = &canvas->tile;
    for (int row = 0; row < tile->height_px; row++) {
        float *to =
            pixels + 4 * ((size_t)(tile->y_px + row) * (size_t)view->width_px + (size_t)tile->x_px);
        for (int at = row * tile->stride, end = at + tile->width_px; at < end; at++, to += 4) {
            const float left = canvas->left[at], *behind = canvas->rgb[at];
            /* what is left of a closed one would have been more of the same */
            const bool closed = left <= canvas->stop;
            const float gain = closed ? 1 / (1 - left) : 1, rest = closed ? 0 : left;
            four pixel;
            memcpy(&pixel, canvas->gathered[at], sizeof pixel);
            pixel = gain * pixel + rest * (four){behind[0], behind[1], behind[2], 0};
            pixel[3] = 1 - rest;
            memcpy(to, &pixel, sizeof pixel);
        }
    }
}

/* A pixel's centre may see the ground before the tree that stands on it, since the tree is
 * elsewhere in the pixel: what hides the tree is nearer than the plane of its foot. */
bool canvas_hides(const struct march_splat *splat, const struct backdrop_rays *rays, float x_px,
                  float y_px, float behind_m)
{
    if (behind_m > splat->depth_m)
        return false;
    float rise = rays->first[1] + x_px * rays->right[1] + y_px * rays->down[1];
    float plane_m = splat->lift_m / rise;
    bool meets = plane_m > 0 && plane_m < splat->depth_m;
    return !(behind_m > (meets ? 0.98f * plane_m : splat->depth_m));
}

/* The share of what is seen through a pixel that is hidden. 1 / e^x by its series: within 1 % of
 * what it ought to be where less than 2 is hidden. */
static float splat_share(const struct march_splat *splat, float area)
{
    if (!splat->is_many) {
        float hides = area < 1 ? area : 1;
        return splat->share < 1 ? share_hides(hides, splat->share) : hides;
    }
    area *= splat->share;
    float grown = 1 + area * (1 + area * (0.5f + area * (1.0f / 6 + area * (1.0f / 24))));
    return 1 - 1 / grown;
}

void canvas_over(struct canvas *canvas, int at, float share)
{
    const float before = canvas->left[at], after = before - share;
    canvas->left[at] = after;
    canvas->open_count -= before > canvas->stop && !(after > canvas->stop);
}

static void splat_pixel(struct canvas *canvas, const struct march_splat *splat,
                        const struct backdrop_rays *picture_rays, int column, int row)
{
    int x = splat->x_px + column - canvas->tile.x_px, y = splat->y_px + row - canvas->tile.y_px;
    if (x < 0 || y < 0 || x >= canvas->tile.width_px || y >= canvas->tile.height_px)
        return;
    const int at = y * canvas->tile.stride + x;
    if (canvas_hides(splat, picture_rays, (float)(splat->x_px + column), (float)(splat->y_px + row),
                     canvas->depths_m[at]))
        return;
    float area = splat->area_px2 * splat->across[column] * splat->along[row];
    float share = canvas->left[at] * splat_share(splat, area);
    canvas_over(canvas, at, share);
    for (int c = 0; c < 3; c++)
        canvas->gathered[at][c] += share * splat->rgb[c];
}

void canvas_splat(struct canvas *canvas, const struct march_splat *splat,
                  const struct backdrop_rays *picture_rays)
{
    for (int row = 0; row < splat->rows; row++)
        for (int column = 0; column < splat->columns; column++)
            splat_pixel(canvas, splat, picture_rays, column, row);
}

/* What of a tree is drawn. */
struct march_part {
    float from_m, to_m;
    uint32_t level;
    float thinned;
};

static int pixel_clamp(int at, int count)
{
    return at < 0 ? 0 : at >= count ? count - 1 : at;
}

/* At a level, but for a share of its density. */
static void march_level(struct canvas *canvas, const struct march_view *picture,
                        const struct march_tree *tree, const struct march_seen *seen,
                        const struct march_part *part)
{
    const float voxel_m = picture->species[tree->species].voxels->levels[part->level].voxel_m;
    const struct backdrop_tile *tile = &canvas->tile;
    const float half = 0.5f * (float)(tile->stride - 1);
    const float x_px = (float)tile->x_px, y_px = (float)tile->y_px;
    const int from[2] = {tile->x_px, tile->y_px}, sizes[2] = {tile->width_px, tile->height_px};
    struct march_rect rect;
    struct march_job job;
    march_job_fill(picture, tree, part->level, x_px + half, y_px + half, &job);
    march_job_aim(picture, tree, x_px, y_px, voxel_m, &job);
    job.near_m = fmaxf(job.near_m, part->from_m);
    job.far_m = part->to_m;
    job.thinned = seen->within ? 1 - march_solid : part->thinned;
    for (int i = 0; i < 2; i++) {
        rect.low[i] = pixel_clamp(seen->low[i] - from[i], sizes[i]);
        rect.high[i] = pixel_clamp(seen->high[i] - from[i], sizes[i]);
    }
    canvas->open_count -= canvas->kernel(&job, &rect, &canvas->rays);
}

/* The levels' transmittances multiply, so that the share of one in the exponent grows evenly. */
void canvas_march(struct canvas *canvas, const struct march_view *picture,
                  const struct march_tree *tree, const struct march_seen *seen, float from_m,
                  float to_m)
{
    const float next = (float)seen->next / 255;
    const float kept = (1 - (float)seen->far / 255) * (1 - (float)seen->gone / 255);
    struct march_part part = {from_m, to_m, seen->level, 1 - (1 - next) * kept};
    march_level(canvas, picture, tree, seen, &part);
    if (seen->next == 0)
        return;
    part.level++;
    part.thinned = 1 - next * kept;
    march_level(canvas, picture, tree, seen, &part);
}
