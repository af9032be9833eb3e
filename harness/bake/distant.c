/* Distant trees: cells in view, their picture, its way to OpenGL. */
#include "bake/distant_parts.h"

#include "bake/backdrop_cpu.h"
#include "bake/horizon.h"
#include "distant.glsl.h"

#include <math.h>
#include <string.h>

enum { TILE_PX = 4 * DISTANT_BLOCK };

struct distant {
    const struct scene *scene;
    float limit_m;                /* largest tree's height over limit_px */
    float octaves;                /* in which trees become distant */
    struct distant_plant *plants; /* species */
    struct distant_cells *cells;
    struct distant_light light;
    bool baked, lit;
    struct backdrop_cpu *backdrop;
    uint32_t *near; /* instances of cells that are not distant */
    float *shares;  /* one an instance: that is drawn as distant; NULL: at once */
    size_t seen_count;
    struct distant_seen *seen; /* cells; front to back by order */
    float *keys[2];
    uint32_t *order[2];
    struct distant_canvas canvas;
    int width_px, height_px; /* that the canvas and the texture have */
    GLuint program, vertices, texture;
};

static void cells_prepare(struct arena *arena, struct distant *distant, float limit_px)
{
    const struct scene *scene = distant->scene;
    float reach_m = 0, extent_m = 0;
    for (size_t i = 0; i < scene->instances_count; i++) {
        const struct instance *instance = &scene->instances[i];
        const struct distant_plant *plant = &distant->plants[instance->species];
        reach_m = fmaxf(reach_m, instance->scale * plant->foot_reach_m);
        extent_m = fmaxf(extent_m, instance->scale * fmaxf(plant->height_m, plant->width_m));
    }
    distant->limit_m = extent_m / limit_px;
    distant->cells = distant_cells_create(arena, scene, reach_m);
    size_t count = distant->cells->cells_count;
    distant->near = ARENA_ARRAY(arena, uint32_t, scene->instances_count);
    if (distant->octaves > 0)
        distant->shares = ARENA_ARRAY(arena, float, scene->instances_count);
    distant->seen = ARENA_ARRAY(arena, struct distant_seen, count);
    for (int i = 0; i < 2; i++) {
        distant->keys[i] = ARENA_ARRAY(arena, float, count);
        distant->order[i] = ARENA_ARRAY(arena, uint32_t, count);
    }
}

static bool any_stretched(const struct scene *scene)
{
    for (size_t i = 0; i < scene->instances_count; i++)
        if (scene->instances[i].stretch != 1)
            return true;
    return false;
}

enum status distant_prepare(struct workspace *workspace, const struct scene *scene, float limit_px,
                            float octaves, struct distant **result)
{
    struct arena *arena = workspace->arena;
    if (any_stretched(scene)) {
        *result = NULL;
        return STATUS_OK;
    }
    struct distant *distant = *result = ARENA_NEW(arena, struct distant);
    enum status status = backdrop_cpu_prepare(workspace, scene, &distant->backdrop);
    distant->scene = scene;
    distant->octaves = octaves;
    distant->plants = ARENA_ARRAY(arena, struct distant_plant, scene->species_count);
    for (size_t i = 0; i < scene->species_count && status == STATUS_OK; i++)
        status = distant_plant_measure(workspace, scene->species[i].plant, &distant->plants[i]);
    if (status == STATUS_OK)
        status = gl_program(workspace->gl, "distant", distant_glsl, NULL, &distant->program,
                            workspace->error);
    if (status != STATUS_OK)
        return status;
    cells_prepare(arena, distant, limit_px);
    distant->vertices = gl_vertex_array(workspace->gl);
    return STATUS_OK;
}

/* The pixels that a sphere before the eye may touch. */
static void sphere_pixels(const struct view *view, const float away[3], float depth_m,
                          float radius_m, struct distant_seen *seen)
{
    const float *axes[2] = {view->right, view->up};
    const int size[2] = {view->width_px, view->height_px};
    float focal = cull_focal_px(view), nearest = depth_m - radius_m;
    for (int k = 0; k < 2; k++) {
        float along = away[0] * axes[k][0] + away[1] * axes[k][1] + away[2] * axes[k][2];
        float middle = 0.5f * (float)(size[k] - 1) + (k ? -1 : 1) * focal * along / depth_m;
        float reach = 2 + focal * radius_m / nearest * (1 + fabsf(along) / depth_m);
        seen->low_px[k] = (int)fminf(fmaxf(middle - reach, 0), (float)size[k]);
        seen->high_px[k] = (int)fminf(fmaxf(middle + reach, -1), (float)(size[k] - 1));
    }
}

/* The share of a cell that is distant: from a distance on, over some octaves. */
static float share_at(const struct distant *distant, float nearest_m, float least_m)
{
    if (nearest_m < least_m || !(distant->octaves > 0))
        return nearest_m < least_m ? 0 : 1;
    return fminf(log2f(nearest_m / least_m) / distant->octaves, 1);
}

/* Its trees are drawn as they are near, too. */
static void cell_near(struct distant *distant, const struct distant_cell *cell, float share,
                      size_t *near)
{
    const uint32_t *instances = distant->cells->instances + cell->first;
    memcpy(distant->near + *near, instances, cell->count * sizeof *distant->near);
    *near += cell->count;
    for (uint32_t k = 0; k < cell->count && distant->shares; k++)
        distant->shares[instances[k]] = share;
}

float distant_share(const struct distant *distant, size_t instance)
{
    return distant->shares ? distant->shares[instance] : 0;
}

struct cull_list distant_cull(struct distant *distant, struct cull *cull, const struct view *view,
                              enum cull_order order)
{
    const struct distant_cells *cells = distant->cells;
    const float least_m = fmaxf(distant->limit_m * cull_focal_px(view), view->near_m);
    size_t near = 0;
    distant->seen_count = 0;
    for (size_t i = 0; i < cells->cells_count; i++) {
        const struct distant_cell *cell = &cells->cells[i];
        if (!view_sees_sphere(view, cell->middle_m, cell->radius_m))
            continue;
        float away[3], depth = 0;
        for (int k = 0; k < 3; k++) {
            away[k] = cell->middle_m[k] - view->eye_m[k];
            depth += away[k] * view->forward[k];
        }
        float share = share_at(distant, depth - cell->radius_m, least_m);
        if (share < 1)
            cell_near(distant, cell, share, &near);
        if (!(share > 0))
            continue;
        struct distant_seen *seen = &distant->seen[distant->seen_count];
        *seen = (struct distant_seen){
            .cell = (uint32_t)i, .nearest_m = depth - cell->radius_m, .share = share};
        sphere_pixels(view, away, depth, cell->radius_m, seen);
        distant->keys[0][distant->seen_count] = depth;
        distant->order[0][distant->seen_count] = (uint32_t)distant->seen_count;
        distant->seen_count++;
    }
    cull_sort(distant->keys[0], distant->order[0], distant->keys[1], distant->order[1],
              distant->seen_count, false);
    return cull_view_of(cull, view, order, distant->near, near);
}

static void canvas_size(struct workspace *workspace, struct distant *distant,
                        const struct view *view)
{
    struct distant_canvas *canvas = &distant->canvas;
    if (view->width_px == distant->width_px && view->height_px == distant->height_px)
        return;
    struct gl *gl = workspace->gl;
    size_t pixels = (size_t)view->width_px * (size_t)view->height_px;
    int rows = (view->height_px + DISTANT_BLOCK - 1) / DISTANT_BLOCK;
    canvas->columns = (view->width_px + DISTANT_BLOCK - 1) / DISTANT_BLOCK;
    canvas->pixels = arena_alloc(workspace->arena, pixels, sizeof *canvas->pixels);
    canvas->depths_m = ARENA_ARRAY(workspace->arena, float, pixels);
    canvas->blocks =
        ARENA_ARRAY(workspace->arena, struct distant_block, (size_t)(rows * canvas->columns));
    if (distant->texture)
        gl_delete_texture(gl, distant->texture);
    distant->texture =
        gl_texture(gl, GL_TEXTURE_2D, 1, GL_RGBA32F, view->width_px, view->height_px, 1);
    distant->width_px = view->width_px;
    distant->height_px = view->height_px;
}

/* When the first distant tree is seen: most scenes have none. */
static enum status pictures_bake(struct workspace *workspace, struct distant *distant)
{
    const struct scene *scene = distant->scene;
    enum status status = STATUS_OK;
    for (size_t i = 0; i < scene->species_count && status == STATUS_OK && !distant->baked; i++)
        status = distant_plant_bake(workspace, scene->species[i].plant, &distant->plants[i]);
    distant->baked = status == STATUS_OK;
    return status;
}

static void light(struct workspace *workspace, struct distant *distant, const struct view *view)
{
    const struct scene *scene = distant->scene;
    struct distant_light now = {.two_sided = workspace->effects & EFFECT_TWO_SIDED};
    memcpy(now.sun_direction, view->sun_direction, sizeof now.sun_direction);
    memcpy(now.sun_radiance, scene->sun.radiance, sizeof now.sun_radiance);
    if (workspace->effects & EFFECT_AMBIENT)
        memcpy(now.ambient, scene->ambient, sizeof now.ambient);
    if (distant->lit && !memcmp(&now, &distant->light, sizeof now))
        return;
    distant->light = now;
    distant->lit = true;
    for (size_t i = 0; i < scene->species_count; i++)
        distant_plant_light(workspace, &distant->plants[i], &now);
}

/* Whether terrain may stand before trees; a flat one does not hide what stands on it. */
static bool terrain_hides(const struct distant *distant, const struct view *view)
{
    const struct terrain *terrain = &distant->scene->terrain;
    return terrain->samples_x > 0 &&
           !(horizon_is_flat(terrain) && view->eye_m[1] >= terrain->heights_m[0]);
}

/* Depths of the terrain in a square of pixels. */
static void tile_depths(const struct distant *distant, int x_px, int y_px, int width_px,
                        int height_px)
{
    float depths_m[TILE_PX * TILE_PX], rgb[TILE_PX * TILE_PX][3];
    struct backdrop_tile tile = {x_px, y_px, width_px, height_px, TILE_PX, depths_m, rgb, NULL};
    backdrop_cpu_tile(distant->backdrop, &tile);
    for (int y = 0; y < height_px; y++)
        memcpy(distant->canvas.depths_m + (y_px + y) * distant->width_px + x_px,
               depths_m + TILE_PX * y, (size_t)width_px * sizeof *depths_m);
}

/* Empty pixels of columns [low, high] and the terrain behind them. */
static void strip_clear(const struct distant *distant, bool hides, int low, int high)
{
    const struct distant_canvas *canvas = &distant->canvas;
    const int width = distant->width_px, height = distant->height_px;
    for (int y = 0; y < height; y++)
        for (int x = low; x <= high; x++) {
            float *pixel = canvas->pixels[y * width + x];
            pixel[0] = pixel[1] = pixel[2] = 0;
            pixel[3] = 1;
            canvas->depths_m[y * width + x] = INFINITY;
        }
    for (int y = 0; y < height && hides; y += TILE_PX)
        for (int x = low; x <= high; x += TILE_PX)
            tile_depths(distant, x, y, high + 1 - x < TILE_PX ? high + 1 - x : TILE_PX,
                        height - y < TILE_PX ? height - y : TILE_PX);
}

static void strip_blocks(const struct distant_canvas *canvas, int low, int high)
{
    const int width = canvas->view->width_px, height = canvas->view->height_px;
    for (int y = 0; y < height; y++)
        for (int x = low; x <= high; x++) {
            struct distant_block *block =
                &canvas->blocks[y / DISTANT_BLOCK * canvas->columns + x / DISTANT_BLOCK];
            if (y % DISTANT_BLOCK == 0 && x % DISTANT_BLOCK == 0)
                *block = (struct distant_block){0, 0};
            block->open++;
            block->farthest_m = fmaxf(block->farthest_m, canvas->depths_m[y * width + x]);
        }
}

static bool cell_hidden(const struct distant_canvas *canvas, const struct distant_seen *seen,
                        int low, int high)
{
    for (int y = seen->low_px[1] / DISTANT_BLOCK; y <= seen->high_px[1] / DISTANT_BLOCK; y++)
        for (int x = low / DISTANT_BLOCK; x <= high / DISTANT_BLOCK; x++) {
            const struct distant_block *block = &canvas->blocks[y * canvas->columns + x];
            if (block->open > 0 && block->farthest_m > seen->nearest_m)
                return false;
        }
    return true;
}

/* Returns how many pixels are mixed. */
static uint64_t strip_draw(const struct distant *distant, bool hides, int low_px, int high_px)
{
    const struct distant_canvas *canvas = &distant->canvas;
    const int width = canvas->view->width_px, height = canvas->view->height_px;
    uint64_t mixed = 0;
    strip_clear(distant, hides, low_px, high_px);
    strip_blocks(canvas, low_px, high_px);
    for (size_t i = 0; i < distant->seen_count; i++) {
        const struct distant_seen *seen = &distant->seen[distant->order[0][i]];
        int low = seen->low_px[0] > low_px ? seen->low_px[0] : low_px;
        int high = seen->high_px[0] < high_px ? seen->high_px[0] : high_px;
        if (low <= high && !cell_hidden(canvas, seen, low, high))
            mixed += distant_cell_draw(canvas, distant->cells, distant->plants, seen, low, high);
    }
    for (int y = 0; y < height; y++)
        for (int x = low_px; x <= high_px; x++)
            canvas->pixels[y * width + x][3] = 1 - canvas->pixels[y * width + x][3];
    return mixed;
}

static void blend(struct workspace *workspace, const struct distant *distant)
{
    struct gl *gl = workspace->gl;
    gl->TextureSubImage2D(distant->texture, 0, 0, 0, distant->width_px, distant->height_px, GL_RGBA,
                          GL_FLOAT, distant->canvas.pixels);
    gl->UseProgram(distant->program);
    gl->BindVertexArray(distant->vertices);
    gl->BindTextureUnit(0, distant->texture);
    gl->Uniform1i(gl_uniform(gl, distant->program, "height_px"), distant->height_px);
    gl->Disable(GL_DEPTH_TEST);
    gl->Enable(GL_BLEND);
    gl->BlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
    gl->DepthMask(GL_FALSE);
    gl_draw_arrays(gl, GL_TRIANGLES, 0, 3, 1);
    gl->Enable(GL_DEPTH_TEST);
}

enum status distant_draw(struct workspace *workspace, struct distant *distant,
                         const struct view *view)
{
    if (distant->seen_count == 0)
        return STATUS_OK;
    enum status status = pictures_bake(workspace, distant);
    if (status != STATUS_OK)
        return status;
    canvas_size(workspace, distant, view);
    light(workspace, distant, view);
    bool hides = terrain_hides(distant, view);
    if (hides)
        backdrop_cpu_begin(workspace, distant->backdrop, view);
    struct distant_canvas *canvas = &distant->canvas;
    canvas->view = view;
    canvas->scene = distant->scene;
    canvas->fog_density_per_m =
        workspace->effects & EFFECT_FOG ? distant->scene->fog.density_per_m : 0;
    int threads = workspace->threads > 0 ? workspace->threads : 1;
    int strips = threads > 1 ? 4 * threads : 1;
    uint64_t mixed = 0;
#pragma omp parallel for num_threads(threads) schedule(dynamic) reduction(+ : mixed)
    for (int i = 0; i < strips; i++) {
        int low = canvas->columns * i / strips, high = canvas->columns * (i + 1) / strips;
        int end = high * DISTANT_BLOCK;
        mixed += strip_draw(distant, hides, low * DISTANT_BLOCK,
                            (end < view->width_px ? end : view->width_px) - 1);
    }
    if (workspace->counted)
        workspace->tally.lookups += 4 * mixed;
    blend(workspace, distant);
    return STATUS_OK;
}
