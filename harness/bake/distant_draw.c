/* The trees of one cell into a picture, each its plant's picture seen from the cell's direction. */
#include "bake/distant_parts.h"
#include "bake/share.h"
#include "bake/views.h"

#include <math.h>

/* A pixel that lets through less holds all that is seen of it. */
static const float saturated = 1.0f / 256;

static float dot(const float a[3], const float b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* How trees of one step of rotation show their picture: in the plane that it was made in. */
struct pose {
    uint16_t view;
    float turn[2];      /* cosine and sine of the rotation */
    float screen[2][2]; /* pixels, y down, a metre along the picture's right and up at depth 1 */
    float inverse[2][2];
};

/* What a cell's trees have in common: seen from so far away their directions differ little. */
struct facing {
    struct pose poses[DISTANT_STEPS];
    float focal_px;
};

/* The view of the hemisphere that is nearest to a direction; from below the horizon, on it. */
static uint16_t view_nearest(const float direction[3])
{
    float y = fmaxf(direction[1], 0);
    float size = fmaxf(fabsf(direction[0]) + y + fabsf(direction[2]), 1e-12f);
    float x = direction[0] / size, z = direction[2] / size, half = 0.5f * (DISTANT_SIDE - 1);
    int column = (int)((x + z + 1) * half + 0.5f), row = (int)((x - z + 1) * half + 0.5f);
    return (uint16_t)(row * DISTANT_SIDE + column);
}

/* own: toward the eye, in the plant's axes; away: from the eye, in the world's. */
static void pose_place(const struct view *view, const float own[3], const float away[3],
                       float focal_px, struct pose *pose)
{
    float direction[3], planes[2][3], depth = dot(away, view->forward);
    const float c = pose->turn[0], s = pose->turn[1];
    pose->view = view_nearest(own);
    views_direction(VIEWS_HEMISPHERE, DISTANT_SIDE, pose->view, direction);
    views_plane(direction, planes[0], planes[1]);
    for (int k = 0; k < 2; k++) {
        const float *plane = planes[k];
        const float world[3] = {plane[0] * c + plane[2] * s, plane[1],
                                -plane[0] * s + plane[2] * c};
        float deep = dot(world, view->forward) / depth;
        pose->screen[0][k] = focal_px * (dot(world, view->right) - deep * dot(away, view->right));
        pose->screen[1][k] = -focal_px * (dot(world, view->up) - deep * dot(away, view->up));
    }
    float determinant =
        pose->screen[0][0] * pose->screen[1][1] - pose->screen[0][1] * pose->screen[1][0];
    pose->inverse[0][0] = pose->screen[1][1] / determinant;
    pose->inverse[0][1] = -pose->screen[0][1] / determinant;
    pose->inverse[1][0] = -pose->screen[1][0] / determinant;
    pose->inverse[1][1] = pose->screen[0][0] / determinant;
}

static void facing_fill(const struct view *view, const struct distant_cell *cell,
                        struct facing *facing)
{
    float away[3], to_eye[3];
    for (int i = 0; i < 3; i++)
        away[i] = cell->middle_m[i] - view->eye_m[i];
    float distance = sqrtf(dot(away, away));
    for (int i = 0; i < 3; i++)
        to_eye[i] = -away[i] / distance;
    facing->focal_px = cull_focal_px(view);
    for (int step = 0; step < DISTANT_STEPS; step++) {
        struct pose *pose = &facing->poses[step];
        float angle = (float)step * 2 * (float)M_PI / DISTANT_STEPS;
        float c = pose->turn[0] = cosf(angle), s = pose->turn[1] = sinf(angle);
        const float own[3] = {to_eye[0] * c - to_eye[2] * s, to_eye[1],
                              to_eye[0] * s + to_eye[2] * c};
        pose_place(view, own, away, facing->focal_px, pose);
    }
}

/* A tree's picture on the screen. */
struct sprite {
    const uint8_t (*texels)[4]; /* with their ring */
    int width, height, stride;  /* texels: width + 2 a row */
    float from[2];              /* texel at pixel (0, 0), the ring's middle is 0 */
    float step[2][2];           /* texels a pixel to the right and down */
    int low[2], high[2];        /* pixels that it may touch */
    float rgb_scale, alpha_scale, fog[3];
    float depth_m; /* of its nearest part */
    float share;   /* of its optical depth */
};

/* The level whose texels are about as large as pixels, and how much larger than they are they must
 * be drawn for no pixel to fall between them. */
static const struct distant_level *level_for(const struct distant_plant *plant, float texel_px[2],
                                             float grown[2])
{
    const struct distant_level *level = plant->levels, *last = level + plant->levels_count - 1;
    while (level < last && texel_px[0] * texel_px[1] < 0.3f) {
        texel_px[0] *= (float)level[0].width / (float)level[1].width;
        texel_px[1] *= (float)level[0].height / (float)level[1].height;
        level++;
    }
    for (int k = 0; k < 2; k++)
        grown[k] = texel_px[k] < 0.7f ? 0.7f / texel_px[k] : 1;
    return level;
}

static bool sprite_place(const struct distant_canvas *canvas, const struct facing *facing,
                         const struct distant_plant *plant, const struct distant_tree *tree,
                         struct sprite *sprite)
{
    const struct view *view = canvas->view;
    const float *forward = view->forward;
    const struct pose *pose = &facing->poses[tree->step];
    const size_t number = pose->view;
    const float *middle_m = plant->middle_m[number], *turn = pose->turn;
    float away[3] = {middle_m[0] * turn[0] + middle_m[2] * turn[1], middle_m[1],
                     -middle_m[0] * turn[1] + middle_m[2] * turn[0]};
    for (int i = 0; i < 3; i++)
        away[i] = tree->scale * away[i] + tree->position_m[i] - view->eye_m[i];
    float depth = dot(away, forward), per = facing->focal_px / depth,
          px_per_m = tree->scale / depth;
    const float *low_m = plant->low_m[number], *texel_m = plant->texel_m[number];
    float texel_px[2] = {texel_m[0] * tree->scale * per, texel_m[1] * tree->scale * per}, grown[2];
    const struct distant_level *level = level_for(plant, texel_px, grown);
    const int size[2] = {level->width, level->height};
    float middle[2] = {0.5f * (float)view->width_px - 0.5f + per * dot(away, view->right),
                       0.5f * (float)view->height_px - 0.5f - per * dot(away, view->up)};
    float half_m[2], at_m[2];
    for (int k = 0; k < 2; k++) {
        float whole_m = (float)plant->levels[0].width * texel_m[k];
        if (k == 1)
            whole_m = (float)plant->levels[0].height * texel_m[k];
        float own_m = whole_m / (float)size[k] * grown[k];
        at_m[k] = low_m[k] + 0.5f * whole_m;
        half_m[k] = 0.5f * (float)(size[k] + 1) * own_m;
        for (int axis = 0; axis < 2; axis++)
            sprite->step[k][axis] = pose->inverse[k][axis] / (px_per_m * own_m);
    }
    for (int axis = 0; axis < 2; axis++) {
        const float *screen = pose->screen[axis];
        middle[axis] += px_per_m * (screen[0] * at_m[0] + screen[1] * at_m[1]);
        float reach = px_per_m * (fabsf(screen[0]) * half_m[0] + fabsf(screen[1]) * half_m[1]);
        const float most = (float)((axis ? view->height_px : view->width_px) - 1);
        if (!(middle[axis] + reach >= 0) || !(middle[axis] - reach <= most))
            return false;
        sprite->low[axis] = (int)ceilf(fmaxf(middle[axis] - reach, 0));
        sprite->high[axis] = (int)floorf(fminf(middle[axis] + reach, most));
    }
    for (int k = 0; k < 2; k++)
        sprite->from[k] = 0.5f * (float)(size[k] + 1) - sprite->step[k][0] * middle[0] -
                          sprite->step[k][1] * middle[1];
    sprite->width = size[0];
    sprite->height = size[1];
    sprite->stride = size[0] + 2;
    size_t lit = (size_t)(tree->step * DISTANT_TURNS + DISTANT_STEPS / 2) / DISTANT_STEPS;
    sprite->texels = (const uint8_t(*)[4])plant->texels +
                     (number * DISTANT_TURNS + lit % DISTANT_TURNS) * plant->texels_count +
                     level->first;
    float clear = 1;
    if (canvas->fog_density_per_m > 0)
        clear = expf(-canvas->fog_density_per_m * sqrtf(dot(away, away)));
    sprite->alpha_scale = 1 / (255 * grown[0] * grown[1]);
    sprite->rgb_scale = clear * plant->scale * sprite->alpha_scale;
    for (int i = 0; i < 3; i++)
        sprite->fog[i] = (1 - clear) * canvas->scene->fog.color[i];
    sprite->depth_m = depth - 0.5f * tree->scale * plant->width_m;
    return true;
}

/* The four texels around a place, mixed. */
static inline void sample(const struct sprite *sprite, float u, float v, float texel[4])
{
    int column = (int)u, row = (int)v;
    float x = u - (float)column, y = v - (float)row;
    const uint8_t(*low)[4] = sprite->texels + row * sprite->stride + column;
    const uint8_t(*high)[4] = low + sprite->stride;
    float weights[4] = {(1 - x) * (1 - y), x * (1 - y), (1 - x) * y, x * y};
    for (int c = 0; c < 4; c++)
        texel[c] = weights[0] * low[0][c] + weights[1] * low[1][c] + weights[2] * high[0][c] +
                   weights[3] * high[1][c];
}

/* Returns how many pixels are mixed from texels. */
static uint64_t sprite_row(const struct distant_canvas *canvas, const struct sprite *sprite, int y,
                           int low_px, int high_px)
{
    const size_t row = (size_t)y * (size_t)canvas->view->width_px;
    struct distant_block *blocks = canvas->blocks + y / DISTANT_BLOCK * canvas->columns;
    const float most[2] = {(float)(sprite->width + 1), (float)(sprite->height + 1)};
    uint64_t mixed = 0;
    for (int x = low_px; x <= high_px; x++) {
        float *pixel = canvas->pixels[row + (size_t)x], texel[4];
        float u = sprite->from[0] + (float)x * sprite->step[0][0] + (float)y * sprite->step[0][1];
        float v = sprite->from[1] + (float)x * sprite->step[1][0] + (float)y * sprite->step[1][1];
        if (!(u >= 0 && u < most[0] && v >= 0 && v < most[1]) || pixel[3] < saturated ||
            canvas->depths_m[row + (size_t)x] < sprite->depth_m)
            continue;
        sample(sprite, u, v, texel);
        float alpha = texel[3] * sprite->alpha_scale, through = pixel[3], gain = through;
        float hides = alpha;
        if (sprite->share < 1 && alpha > 0) {
            hides = share_hides(alpha, sprite->share);
            gain = through * hides / alpha;
        }
        for (int c = 0; c < 3; c++)
            pixel[c] += gain * (texel[c] * sprite->rgb_scale + alpha * sprite->fog[c]);
        pixel[3] = through * (1 - hides);
        blocks[x / DISTANT_BLOCK].open -= pixel[3] < saturated;
        mixed++;
    }
    return mixed;
}

uint64_t distant_cell_draw(const struct distant_canvas *canvas, const struct distant_cells *cells,
                           const struct distant_plant *plants, const struct distant_seen *seen,
                           int low_px, int high_px)
{
    const struct distant_cell *cell = &cells->cells[seen->cell];
    struct facing facing;
    uint64_t mixed = 0;
    facing_fill(canvas->view, cell, &facing);
    for (uint32_t i = cell->first; i < cell->first + cell->count; i++) {
        const struct distant_tree *tree = &cells->trees[i];
        struct sprite sprite = {.share = seen->share};
        if (!sprite_place(canvas, &facing, &plants[tree->species], tree, &sprite))
            continue;
        int low = sprite.low[0] > low_px ? sprite.low[0] : low_px;
        int high = sprite.high[0] < high_px ? sprite.high[0] : high_px;
        for (int y = sprite.low[1]; y <= sprite.high[1] && low <= high; y++)
            mixed += sprite_row(canvas, &sprite, y, low, high);
    }
    return mixed;
}
