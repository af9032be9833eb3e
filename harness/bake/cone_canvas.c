/* The pixels of conifers: relief cut into layers where its edges are, strips put over it. */
#include "bake/cone_canvas.h"
#include "bake/horizon.h"
#include "bake/march_shadow_parts.h"

#include <math.h>
#include <string.h>

enum {
    FINE = 4,
    SAMPLES = FINE * FINE,
    BLOCK = 8
}; /* samples along a pixel; pixels a fine block */

struct cone_canvas *cone_canvas_create(struct workspace *workspace, const struct scene *scene,
                                       const struct cone_lights *lights, bool edges,
                                       enum status *status)
{
    struct cone_canvas *canvas = ARENA_NEW(workspace->arena, struct cone_canvas);
    canvas->arena = workspace->arena;
    canvas->scene = scene;
    canvas->lights = lights;
    *status = backdrop_cpu_prepare(workspace, scene, &canvas->backdrop);
    if (!*status && edges && scene->terrain.samples_x > 0 && !horizon_is_flat(&scene->terrain))
        *status = backdrop_cpu_prepare(workspace, scene, &canvas->fine);
    return canvas;
}

static void room_for(struct cone_canvas *canvas, const struct view *view)
{
    const size_t pixels = (size_t)view->width_px * (size_t)view->height_px;
    canvas->width_px = view->width_px;
    canvas->height_px = view->height_px;
    canvas->across = (view->width_px + CONE_TILE - 1) / CONE_TILE;
    canvas->down = (view->height_px + CONE_TILE - 1) / CONE_TILE;
    const size_t tiles = (size_t)canvas->across * (size_t)canvas->down;
    if (tiles > canvas->tiles_capacity) {
        canvas->tiles_capacity = tiles;
        canvas->open = ARENA_ARRAY(canvas->arena, uint8_t, tiles);
        canvas->far_m = ARENA_ARRAY(canvas->arena, float, tiles);
    }
    memset(canvas->open, 1, tiles);
    if (pixels <= canvas->pixels_capacity)
        return;
    canvas->pixels_capacity = pixels;
    canvas->left = ARENA_ARRAY(canvas->arena, float, pixels);
    canvas->share = ARENA_ARRAY(canvas->arena, float, pixels);
    canvas->front_m = ARENA_ARRAY(canvas->arena, float, pixels);
    canvas->limit_m = ARENA_ARRAY(canvas->arena, float, pixels);
    for (int c = 0; c < 3; c++)
        canvas->rgb[c] = ARENA_ARRAY(canvas->arena, float, pixels);
    canvas->suns = ARENA_ARRAY(canvas->arena, float, pixels);
    canvas->behind = arena_alloc(canvas->arena, pixels, sizeof *canvas->behind);
    canvas->edges = ARENA_ARRAY(canvas->arena, int32_t, pixels);
}

/* Whether 1 / depth, which is even along a plane, bends at a pixel. */
static bool is_edge(const struct cone_canvas *canvas, int x, int y)
{
    static const float bend = 0.02f;
    const size_t at = (size_t)y * (size_t)canvas->width_px + (size_t)x;
    const float *depths = canvas->front_m;
    const size_t steps[2] = {1, (size_t)canvas->width_px};
    const int places[2] = {x, y}, sizes[2] = {canvas->width_px, canvas->height_px};
    for (int axis = 0; axis < 2; axis++) {
        if (places[axis] == 0 || places[axis] == sizes[axis] - 1)
            continue;
        float middle = 1 / depths[at];
        float around = 1 / depths[at - steps[axis]] + 1 / depths[at + steps[axis]];
        if (fabsf(around - 2 * middle) > bend * fmaxf(middle, 0.5f * around))
            return true;
    }
    return false;
}

static void tile_begin(struct cone_canvas *canvas, size_t tile)
{
    const int x = (int)(tile % (size_t)canvas->across) * CONE_TILE;
    const int y = (int)(tile / (size_t)canvas->across) * CONE_TILE;
    const size_t at = (size_t)y * (size_t)canvas->width_px + (size_t)x;
    const struct backdrop_tile part = {
        .x_px = x,
        .y_px = y,
        .width_px = x + CONE_TILE < canvas->width_px ? CONE_TILE : canvas->width_px - x,
        .height_px = y + CONE_TILE < canvas->height_px ? CONE_TILE : canvas->height_px - y,
        .stride = canvas->width_px,
        .depths_m = canvas->front_m + at,
        .rgb = canvas->behind + at,
        .suns = canvas->suns + at,
    };
    for (int row = 0; row < part.height_px; row++)
        for (int column = 0; column < part.width_px; column++) {
            size_t pixel = at + (size_t)row * (size_t)canvas->width_px + (size_t)column;
            canvas->left[pixel] = canvas->share[pixel] = 1;
            canvas->rgb[0][pixel] = canvas->rgb[1][pixel] = canvas->rgb[2][pixel] = 0;
            canvas->suns[pixel] = 0;
            canvas->edges[pixel] = -1;
        }
    backdrop_cpu_tile(canvas->backdrop, &part);
}

/* The farthest that a pixel's relief is within a pixel of it along each axis; at an edge, as it
 * is. */
static float limit_of(const struct cone_canvas *canvas, int x, int y)
{
    const size_t width = (size_t)canvas->width_px;
    const float *at = canvas->front_m + (size_t)y * width + (size_t)x;
    if (is_edge(canvas, x, y))
        return *at;
    float far_m = *at;
    if (x > 0 && x + 1 < canvas->width_px)
        far_m = fmaxf(far_m, fmaxf(at[-1], at[1]));
    if (y > 0 && y + 1 < canvas->height_px)
        far_m = fmaxf(far_m, fmaxf(at[-(ptrdiff_t)width], at[width]));
    return far_m;
}

static void tile_limit(struct cone_canvas *canvas, size_t tile)
{
    const int x = (int)(tile % (size_t)canvas->across) * CONE_TILE;
    const int y = (int)(tile / (size_t)canvas->across) * CONE_TILE;
    const int right = x + CONE_TILE < canvas->width_px ? x + CONE_TILE : canvas->width_px;
    const int bottom = y + CONE_TILE < canvas->height_px ? y + CONE_TILE : canvas->height_px;
    float far_m = 0;
    for (int row = y; row < bottom; row++)
        for (int column = x; column < right; column++) {
            const float limit_m = limit_of(canvas, column, row);
            canvas->limit_m[(size_t)row * (size_t)canvas->width_px + (size_t)column] = limit_m;
            far_m = fmaxf(far_m, limit_m);
        }
    canvas->far_m[tile] = far_m;
}

/* Samples of a fine block that belong to one pixel. */
struct samples {
    float depths_m[SAMPLES], suns[SAMPLES], rgb[SAMPLES][3];
};

/* Sorted by depth, cut where it leaps. */
static void layers_of(struct samples *samples, struct cone_layer layers[CONE_LAYERS])
{
    static const float leap = 1.05f;
    int order[SAMPLES], count = 0;
    for (int k = 0; k < SAMPLES; k++) {
        int at = k;
        for (; at > 0 && samples->depths_m[order[at - 1]] > samples->depths_m[k]; at--)
            order[at] = order[at - 1];
        order[at] = k;
    }
    memset(layers, 0, CONE_LAYERS * sizeof *layers);
    for (int k = 0; k < SAMPLES; k++) {
        const int sample = order[k];
        bool leaps = k > 0 && samples->depths_m[sample] > leap * samples->depths_m[order[k - 1]];
        count += leaps && count < CONE_LAYERS - 1;
        struct cone_layer *layer = &layers[count];
        layer->share += 1.0f / SAMPLES;
        layer->depth_m = samples->depths_m[sample];
        layer->sun += samples->suns[sample] / SAMPLES;
        for (int c = 0; c < 3; c++)
            layer->rgb[c] += samples->rgb[sample][c] / SAMPLES;
    }
}

/* Layers of the edges' pixels in a block of the picture. */
static void block_cut(struct cone_canvas *canvas, int x, int y)
{
    enum { SIDE = BLOCK * FINE };
    float depths_m[SIDE * SIDE], suns[SIDE * SIDE], rgb[SIDE * SIDE][3];
    const int right = x + BLOCK < canvas->width_px ? x + BLOCK : canvas->width_px;
    const int bottom = y + BLOCK < canvas->height_px ? y + BLOCK : canvas->height_px;
    memset(suns, 0, sizeof suns);
    const struct backdrop_tile part = {.x_px = FINE * x,
                                       .y_px = FINE * y,
                                       .width_px = FINE * (right - x),
                                       .height_px = FINE * (bottom - y),
                                       .stride = SIDE,
                                       .depths_m = depths_m,
                                       .rgb = rgb,
                                       .suns = suns};
    backdrop_cpu_tile(canvas->fine, &part);
    for (int row = y; row < bottom; row++)
        for (int column = x; column < right; column++) {
            const size_t pixel = (size_t)row * (size_t)canvas->width_px + (size_t)column;
            struct samples samples;
            if (canvas->edges[pixel] < 0)
                continue;
            for (int k = 0; k < SAMPLES; k++) {
                int at = (FINE * (row - y) + k / FINE) * SIDE + FINE * (column - x) + k % FINE;
                samples.depths_m[k] = depths_m[at];
                samples.suns[k] = suns[at];
                memcpy(samples.rgb[k], rgb[at], sizeof samples.rgb[k]);
            }
            struct cone_layer *layers = canvas->layers + CONE_LAYERS * canvas->edges[pixel];
            layers_of(&samples, layers);
            canvas->limit_m[pixel] = layers[0].depth_m;
        }
}

static void edges_cut(struct workspace *workspace, struct cone_canvas *canvas,
                      const struct view *view)
{
    struct view fine = *view;
    size_t count = 0;
    for (int y = 0; y < canvas->height_px; y++)
        for (int x = 0; x < canvas->width_px; x++)
            if (is_edge(canvas, x, y)) {
                canvas->edges[(size_t)y * (size_t)canvas->width_px + (size_t)x] = (int32_t)count++;
                canvas->far_m[y / CONE_TILE * canvas->across + x / CONE_TILE] = INFINITY;
            }
    if (count == 0)
        return;
    canvas->layers = shadow_room(canvas->arena, canvas->layers, CONE_LAYERS * count,
                                 &canvas->edges_capacity, sizeof *canvas->layers);
    fine.width_px *= FINE;
    fine.height_px *= FINE;
    backdrop_cpu_begin(workspace, canvas->fine, &fine);
#pragma omp parallel for num_threads(workspace->threads) schedule(dynamic, 1)
    for (int y = 0; y < canvas->height_px; y += BLOCK)
        for (int x = 0; x < canvas->width_px; x += BLOCK) {
            bool any = false;
            for (int k = 0; k < BLOCK * BLOCK && !any; k++) {
                int column = x + k % BLOCK, row = y + k / BLOCK;
                any = column < canvas->width_px && row < canvas->height_px &&
                      canvas->edges[(size_t)row * (size_t)canvas->width_px + (size_t)column] >= 0;
            }
            if (any)
                block_cut(canvas, x, y);
        }
}

void cone_canvas_begin(struct workspace *workspace, struct cone_canvas *canvas,
                       const struct view *view)
{
    room_for(canvas, view);
    canvas->rays = backdrop_rays_of(view);
    memcpy(canvas->eye_m, view->eye_m, sizeof canvas->eye_m);
    backdrop_cpu_begin(workspace, canvas->backdrop, view);
    const size_t tiles = (size_t)canvas->across * (size_t)canvas->down;
#pragma omp parallel for num_threads(workspace->threads) schedule(dynamic, 1)
    for (size_t tile = 0; tile < tiles; tile++)
        tile_begin(canvas, tile);
#pragma omp parallel for num_threads(workspace->threads) schedule(dynamic, 1)
    for (size_t tile = 0; tile < tiles; tile++)
        tile_limit(canvas, tile);
    if (canvas->fine)
        edges_cut(workspace, canvas, view);
}

bool cone_canvas_sees(const struct cone_canvas *canvas, const float place_px[2], float reach_px,
                      float nearest_m)
{
    const float per_tile = 1.0f / CONE_TILE;
    const float left = (place_px[0] - reach_px) * per_tile,
                top = (place_px[1] - reach_px) * per_tile;
    const float right = (place_px[0] + reach_px) * per_tile;
    const float bottom = (place_px[1] + reach_px) * per_tile;
    if (!(right >= 0 && bottom >= 0 && left < (float)canvas->across && top < (float)canvas->down))
        return false;
    const int first = left > 0 ? (int)left : 0, low = top > 0 ? (int)top : 0;
    const int last = right < (float)canvas->across ? (int)right : canvas->across - 1;
    const int high = bottom < (float)canvas->down ? (int)bottom : canvas->down - 1;
    for (int row = low; row <= high; row++)
        for (int column = first; column <= last; column++) {
            const int tile = row * canvas->across + column;
            if (canvas->open[tile] && nearest_m < canvas->far_m[tile])
                return true;
        }
    return false;
}

/* What is nearer than a depth is seen as it is by now. */
static void layers_pass(struct cone_canvas *canvas, size_t pixel, float depth_m)
{
    if (canvas->edges[pixel] < 0) {
        canvas->share[pixel] = 0;
        return;
    }
    struct cone_layer *layers = canvas->layers + CONE_LAYERS * canvas->edges[pixel];
    float share = 0, limit_m = INFINITY;
    for (int k = 0; k < CONE_LAYERS; k++) {
        if (!(layers[k].share > 0) || layers[k].left > 0)
            continue;
        if (layers[k].depth_m < depth_m) {
            layers[k].left = fmaxf(canvas->left[pixel], 1e-9f);
        } else {
            share += layers[k].share;
            limit_m = fminf(limit_m, layers[k].depth_m);
        }
    }
    canvas->share[pixel] = share;
    canvas->limit_m[pixel] = limit_m;
}

void cone_canvas_put(struct cone_canvas *canvas, size_t pixel, const struct cone_strip *strip,
                     const struct cone_place *place, float w)
{
    float depth_m = strip->depths_m[0] + place->share * (strip->depths_m[1] - strip->depths_m[0]);
    if (depth_m > canvas->limit_m[pixel])
        layers_pass(canvas, pixel, depth_m);
    float part = w * canvas->left[pixel] * canvas->share[pixel];
    if (!(part > 0))
        return;
    float lit = cone_strip_lit(strip, place);
    for (int c = 0; c < 3; c++)
        canvas->rgb[c][pixel] += part * (strip->shade[c] + lit * strip->sun[c]);
    canvas->left[pixel] *= 1 - w;
}

/* Takes the sun from relief that trees or relief shade. */
static void layer_shade(const struct cone_canvas *canvas, size_t pixel, float depth_m, float sun,
                        float rgb[3])
{
    if (!canvas->lights || !(sun > 0) || !isfinite(depth_m))
        return;
    const size_t width = (size_t)canvas->width_px;
    const struct shadow_pixel seen = shadow_pixel_of(
        canvas->eye_m, &canvas->rays, (float)(pixel % width), (float)(pixel / width), depth_m);
    cone_lights_shade_ground(canvas->lights, &seen, sun, rgb);
}

/* Sums what is left of a pixel's layers; returns how much is. */
static float behind_of(struct cone_canvas *canvas, size_t pixel, float stop, float rgb[3])
{
    float sum = 0;
    memset(rgb, 0, 3 * sizeof *rgb);
    if (canvas->edges[pixel] < 0) {
        sum = canvas->left[pixel];
        memcpy(rgb, canvas->behind[pixel], 3 * sizeof *rgb);
        if (sum > stop)
            layer_shade(canvas, pixel, canvas->front_m[pixel], canvas->suns[pixel], rgb);
        for (int c = 0; c < 3; c++)
            rgb[c] *= sum;
        return sum;
    }
    struct cone_layer *layers = canvas->layers + CONE_LAYERS * canvas->edges[pixel];
    for (int k = 0; k < CONE_LAYERS; k++) {
        struct cone_layer *layer = &layers[k];
        if (!(layer->share > 0))
            continue;
        float part = layer->left > 0 ? layer->left : canvas->left[pixel], color[3];
        for (int c = 0; c < 3; c++)
            color[c] = layer->rgb[c] / layer->share;
        layer_shade(canvas, pixel, layer->depth_m, layer->sun / layer->share, color);
        sum += part * layer->share;
        for (int c = 0; c < 3; c++)
            rgb[c] += part * layer->share * color[c];
    }
    return sum;
}

void cone_canvas_end(struct workspace *workspace, struct cone_canvas *canvas, float stop,
                     float *pixels)
{
#pragma omp parallel for num_threads(workspace->threads) schedule(dynamic, 4)
    for (int y = 0; y < canvas->height_px; y++)
        for (int x = 0; x < canvas->width_px; x++) {
            const size_t pixel = (size_t)y * (size_t)canvas->width_px + (size_t)x;
            float behind[3], *to = pixels + 4 * pixel;
            float left = behind_of(canvas, pixel, stop, behind), gain = 1;
            if (left <= stop) { /* what was left would have been more of the same */
                gain = 1 / (1 - left);
                left = 0;
            }
            for (int c = 0; c < 3; c++)
                to[c] = gain * canvas->rgb[c][pixel] + (left > 0 ? behind[c] : 0);
            to[3] = 1 - left;
        }
}
