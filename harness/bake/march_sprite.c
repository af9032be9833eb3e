/* Trees of a few pixels on a tile: each pixel shows the mean of the far picture's texels that lie
 * in its square, whole or in part, from the sums at its corners. */
#include "bake/march_canvas.h"
#include "bake/share.h"

#include <math.h>
#include <string.h>

typedef float four __attribute__((vector_size(4 * sizeof(float))));

/* Pixels of a tile that a side of the picture may touch, and the places of their edges among the
 * texels: a whole number and what is beyond it. */
struct cut {
    int first, count;
    int texels[TILE_MAX + 1];
    float beyond[TILE_MAX + 1];
};

static void cut_of(float middle_px, float side_px, int tile_px, int tile_size_px, struct cut *cut)
{
    float low = middle_px - 0.5f * side_px, per_px = SPRITE_SIDE / side_px;
    int first = (int)floorf(low + 0.5f) - tile_px, end = (int)ceilf(low + side_px + 0.5f) - tile_px;
    first = first > 0 ? first : 0;
    end = end < tile_size_px ? end : tile_size_px;
    cut->first = first;
    cut->count = end > first ? end - first : 0;
    float from = ((float)(tile_px + first) - 0.5f - low) * per_px;
    int k = 0;
    do {
        float at = from + (float)k * per_px;
        at = at > 0 ? at < SPRITE_SIDE ? at : SPRITE_SIDE : 0;
        cut->texels[k] = at < SPRITE_SIDE ? (int)at : SPRITE_SIDE - 1;
        cut->beyond[k] = at - (float)cut->texels[k];
    } while (++k <= cut->count);
}

/* The sums at the edges of a row of pixels, down to a place among the texels. */
static void edge_sums(const struct march_sprite *sprite, const struct cut *across, int texel,
                      float beyond, four *sums)
{
    for (int k = 0; k <= across->count; k++) {
        const float *at = sprite->sums[texel][across->texels[k]];
        four corners[4];
        memcpy(&corners[0], at, sizeof corners[0]);
        memcpy(&corners[1], at + 4, sizeof corners[1]);
        memcpy(&corners[2], at + 4 * (SPRITE_SIDE + 1), sizeof corners[2]);
        memcpy(&corners[3], at + 4 * (SPRITE_SIDE + 2), sizeof corners[3]);
        four above = corners[0] + across->beyond[k] * (corners[1] - corners[0]);
        four below = corners[2] + across->beyond[k] * (corners[3] - corners[2]);
        sums[k] = above + beyond * (below - above);
    }
}

/* Over what is seen through a pixel, its number in the tile. color: radiance times cover, cover; of
 * it, a share. */
static void pixel_over(struct canvas *canvas, int at, four color, float share)
{
    float left = canvas->left[at], scale = color[3] > 1 ? left / color[3] : left;
    if (share < 1)
        scale = left * share_hides(color[3], share) / color[3];
    canvas_over(canvas, at, scale * color[3]);
    for (int c = 0; c < 3; c++)
        canvas->gathered[at][c] += scale * color[c];
}

/* What turns a texel into radiance and cover: own factors, and the fog's by its cover. */
struct shine {
    four own, fog;
};

static struct shine shine_of(const struct march_view *picture, float clear,
                             const struct march_far *its, const struct march_far *far, float share)
{
    share *= its->cover_m2 > 0 ? far->cover_m2 / its->cover_m2 : 0;
    struct shine shine = {.own = {0, 0, 0, share}, .fog = {0, 0, 0, 0}};
    for (int c = 0; c < 3; c++) {
        shine.own[c] = its->rgb[c] > 0 ? clear * share * far->rgb[c] / its->rgb[c] : 0;
        shine.fog[c] = (1 - clear) * share * picture->scene->fog.color[c];
    }
    return shine;
}

void canvas_sprite(struct canvas *canvas, const struct march_view *picture,
                   const struct march_tree *tree, const struct march_sprite *sprite,
                   const struct march_far *its, const struct march_far *far, float share)
{
    const struct backdrop_tile *tile = &canvas->tile;
    float middle[3];
    march_middle(picture, tree, middle);
    const float per_m = tree->scale * picture->focal_px / middle[2];
    const float sides_px[2] = {sprite->sides_m[0] * per_m, sprite->sides_m[1] * per_m};
    struct cut across, down;
    cut_of(middle[0], sides_px[0], tile->x_px, tile->width_px, &across);
    cut_of(middle[1], sides_px[1], tile->y_px, tile->height_px, &down);
    const struct shine shine = shine_of(picture, march_clear(picture, middle), its, far,
                                        sides_px[0] * sides_px[1] / (SPRITE_SIDE * SPRITE_SIDE));
    const struct march_splat splat = {.depth_m = middle[2],
                                      .lift_m = tree->position_m[1] - picture->view->eye_m[1]};
    four sums[2][TILE_MAX + 1];
    /* four corners at each edge, of 16 bytes */
    canvas->lookups += (uint64_t)((across.count + 1) * (down.count + 1)) * 4 * 2;
    edge_sums(sprite, &across, down.texels[0], down.beyond[0], sums[0]);
    for (int row = 0; row < down.count; row++) {
        const four *above = sums[row & 1], *below = sums[~row & 1];
        edge_sums(sprite, &across, down.texels[row + 1], down.beyond[row + 1], sums[~row & 1]);
        for (int column = 0; column < across.count; column++) {
            four texels = below[column + 1] - below[column] - above[column + 1] + above[column];
            int x = across.first + column, y = down.first + row, at = y * tile->stride + x;
            if (texels[3] > 0 && !canvas_hides(&splat, &picture->rays, (float)(tile->x_px + x),
                                               (float)(tile->y_px + y), canvas->depths_m[at]))
                pixel_over(canvas, at, shine.own * texels + shine.fog * texels[3], share);
        }
    }
}
