/* A tile of the march's picture while it is drawn. */
#include "bake/march_canvas.h"
#include "bake/march_shadow.h"
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
    canvas->lookups = 0;
    canvas->across = side / MARCH_BLOCK;
    canvas->blocks_count = canvas->open_count = canvas->across * canvas->across;
    memset(canvas->blocks, 0, (size_t)canvas->blocks_count * sizeof *canvas->blocks);
    for (int row = 0; row < canvas->tile.height_px; row++)
        for (int column = 0; column < canvas->tile.width_px; column++) {
            struct march_rays *rays =
                &canvas->blocks[row / MARCH_BLOCK * canvas->across + column / MARCH_BLOCK];
            int lane = row % MARCH_BLOCK * MARCH_BLOCK + column % MARCH_BLOCK;
            rays->left[lane] = 1;
            rays->depths_m[lane] = canvas->depths_m[row * side + column];
        }
    for (int block = 0; block < canvas->blocks_count; block++)
        canvas->open[block] = true;
}

void canvas_shade(struct canvas *canvas, const struct march_view *picture)
{
    const struct backdrop_tile *tile = &canvas->tile;
    const struct scene *scene = picture->scene;
    for (int row = 0; row < tile->height_px; row++)
        for (int column = 0; column < tile->width_px; column++) {
            const int at = row * tile->stride + column;
            const struct march_rays *rays =
                &canvas->blocks[row / MARCH_BLOCK * canvas->across + column / MARCH_BLOCK];
            float left = rays->left[row % MARCH_BLOCK * MARCH_BLOCK + column % MARCH_BLOCK];
            if (!(canvas->suns[at] > 0) || left <= picture->options.stop)
                continue;
            float place_m[3];
            for (int i = 0; i < 3; i++)
                place_m[i] =
                    picture->view->eye_m[i] +
                    canvas->depths_m[at] * (picture->rays.first[i] +
                                            (float)(tile->x_px + column) * picture->rays.right[i] +
                                            (float)(tile->y_px + row) * picture->rays.down[i]);
            float dark = (1 - march_shadows_at(picture->shadows, place_m)) * canvas->suns[at];
            float albedo[3];
            terrain_albedo(&scene->terrain, place_m[0], place_m[2], albedo);
            for (int c = 0; c < 3; c++)
                canvas->rgb[at][c] -= dark * albedo[c] * scene->sun.radiance[c];
        }
}

/* A row of a block, count pixels of it. behind: what the backdrop shows there. */
static void row_end(const struct march_rays *rays, int first, int count, float stop,
                    const float (*behind)[3], float *pixels)
{
    for (int k = 0; k < count; k++, pixels += 4) {
        const float *rgb = rays->rgb[first + k], left = rays->left[first + k];
        float gain = 1, rest = left;
        if (left <= stop) { /* what was left would have been more of the same */
            gain = 1 / (1 - left);
            rest = 0;
        }
        for (int c = 0; c < 3; c++)
            pixels[c] = gain * rgb[c] + rest * behind[k][c];
        pixels[3] = 1 - rest;
    }
}

/* Pixels outside the picture were never opened. */
void canvas_end(const struct canvas *canvas, float stop, const struct view *view, float *pixels)
{
    const struct backdrop_tile *tile = &canvas->tile;
    for (int row = 0; row < tile->height_px; row++) {
        const struct march_rays *rays = &canvas->blocks[row / MARCH_BLOCK * canvas->across];
        const float(*behind)[3] = (const float(*)[3])canvas->rgb + row * tile->stride;
        float *to =
            pixels + 4 * ((size_t)(tile->y_px + row) * (size_t)view->width_px + (size_t)tile->x_px);
        for (int column = 0; column < tile->width_px; column += MARCH_BLOCK) {
            int rest = tile->width_px - column, first = row % MARCH_BLOCK * MARCH_BLOCK;
            row_end(rays++, first, rest < MARCH_BLOCK ? rest : MARCH_BLOCK, stop, behind + column,
                    to + 4 * column);
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

static void splat_pixel(struct canvas *canvas, const struct march_splat *splat,
                        const struct backdrop_rays *picture_rays, int column, int row)
{
    int x = splat->x_px + column - canvas->tile.x_px, y = splat->y_px + row - canvas->tile.y_px;
    if (x < 0 || y < 0 || x >= canvas->tile.width_px || y >= canvas->tile.height_px)
        return;
    struct march_rays *rays = &canvas->blocks[y / MARCH_BLOCK * canvas->across + x / MARCH_BLOCK];
    int lane = y % MARCH_BLOCK * MARCH_BLOCK + x % MARCH_BLOCK;
    if (canvas_hides(splat, picture_rays, (float)(splat->x_px + column), (float)(splat->y_px + row),
                     rays->depths_m[lane]))
        return;
    float area = splat->area_px2 * splat->across[column] * splat->along[row];
    float share = rays->left[lane] * splat_share(splat, area);
    rays->left[lane] -= share;
    for (int c = 0; c < 3; c++)
        rays->rgb[lane][c] += share * splat->rgb[c];
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

static int block_clamp(int at, int across)
{
    return at < 0 ? 0 : at >= across ? across - 1 : at;
}

/* At a level, but for a share of its density. */
static void march_level(struct canvas *canvas, const struct march_view *picture,
                        const struct march_tree *tree, const struct march_seen *seen,
                        const struct march_part *part)
{
    const float voxel_m = picture->species[tree->species].voxels->levels[part->level].voxel_m;
    const float half = 0.5f * (float)(canvas->tile.stride - 1);
    const int from[2] = {canvas->tile.x_px, canvas->tile.y_px};
    int low[2], high[2];
    struct march_job job;
    march_job_fill(picture, tree, part->level, (float)from[0] + half, (float)from[1] + half, &job);
    job.near_m = fmaxf(job.near_m, part->from_m);
    job.far_m = part->to_m;
    job.thinned = seen->within ? 1 - march_solid : part->thinned;
    for (int i = 0; i < 2; i++) {
        low[i] = block_clamp((seen->low[i] - from[i]) / MARCH_BLOCK, canvas->across);
        high[i] = block_clamp((seen->high[i] - from[i]) / MARCH_BLOCK, canvas->across);
    }
    for (int y = low[1]; y <= high[1]; y++)
        for (int x = low[0]; x <= high[0]; x++) {
            int block = y * canvas->across + x;
            if (!canvas->open[block])
                continue;
            march_job_aim(picture, tree, (float)(from[0] + x * MARCH_BLOCK),
                          (float)(from[1] + y * MARCH_BLOCK), voxel_m, &job);
            canvas->open[block] = canvas->block(&job, &canvas->blocks[block]);
            canvas->open_count -= !canvas->open[block];
        }
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
