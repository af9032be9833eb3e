/* Sky, flat terrain and its horizon on the CPU; bent terrain is backdrop_cpu_hills.c. */
#include "bake/backdrop_cpu.h"
#include "bake/backdrop_cpu_parts.h"
#include "bake/horizon.h"

#include <math.h>
#include <stdint.h>

/* Above, a ray a pixel is faster than a look at every chunk and triangle: at 800 x 600 pixels
 * (tests/bench_terrain.c). */
enum { TRIANGLES_DRAWN_MAX = 1 << 22 };

struct backdrop_cpu {
    const struct scene *scene;
    bool flat;
    struct hills *hills; /* NULL: flat, or no terrain */
    struct view view;
    struct backdrop_rays rays;
    struct backdrop_light light;
    int borders_count;
    float ends[4][2][3]; /* on the screen, row 0 on top: x, y, 1 / depth */
    float inward[4][2];
};

struct backdrop_rays backdrop_rays_of(const struct view *view)
{
    struct backdrop_rays rays;
    float pixel = 2 * tanf(0.5f * view->fov_y_rad) / (float)view->height_px;
    for (int i = 0; i < 3; i++) {
        rays.right[i] = pixel * view->right[i];
        rays.down[i] = -pixel * view->up[i];
        rays.first[i] = view->forward[i] - 0.5f * (float)(view->width_px - 1) * rays.right[i] -
                        0.5f * (float)(view->height_px - 1) * rays.down[i];
    }
    return rays;
}

enum status backdrop_cpu_prepare(struct workspace *workspace, const struct scene *scene,
                                 struct backdrop_cpu **backdrop)
{
    struct backdrop_cpu *made = *backdrop = ARENA_NEW(workspace->arena, struct backdrop_cpu);
    made->scene = scene;
    made->flat = scene->terrain.samples_x > 0 && horizon_is_flat(&scene->terrain);
    if (scene->terrain.samples_x > 0 && !made->flat) {
        const struct terrain *terrain = &scene->terrain;
        uint64_t triangles = (uint64_t)(terrain->samples_x - 1) * (terrain->samples_z - 1) * 2;
        made->hills = hills_prepare(workspace->arena, terrain, triangles > TRIANGLES_DRAWN_MAX);
    }
    return STATUS_OK;
}

static void borders_begin(struct backdrop_cpu *backdrop, const struct view *view)
{
    float ends[8][3];
    backdrop->borders_count =
        horizon_borders(&backdrop->scene->terrain, view, ends, backdrop->inward);
    for (int border = 0; border < backdrop->borders_count; border++) {
        backdrop->inward[border][1] *= -1;
        for (int end = 0; end < 2; end++) {
            float *screen = backdrop->ends[border][end];
            horizon_screen(view, ends[2 * border + end], screen);
            screen[1] = (float)view->height_px - screen[1];
            screen[2] = 1 / screen[2];
        }
    }
}

void backdrop_cpu_begin(struct workspace *workspace, struct backdrop_cpu *backdrop,
                        const struct view *view)
{
    const struct scene *scene = backdrop->scene;
    struct backdrop_light *light = &backdrop->light;
    backdrop->view = *view;
    backdrop->rays = backdrop_rays_of(view);
    light->fog_density_per_m = workspace->effects & EFFECT_FOG ? scene->fog.density_per_m : 0;
    for (int i = 0; i < 3; i++) {
        light->sun_direction[i] = view->sun_direction[i];
        light->in_sun[i] = scene->terrain.albedo[i] * scene->sun.radiance[i];
        light->in_shade[i] =
            workspace->effects & EFFECT_AMBIENT ? scene->terrain.albedo[i] * scene->ambient[i] : 0;
        light->fog_color[i] = scene->fog.color[i];
    }
    backdrop->borders_count = 0;
    if (backdrop->flat)
        borders_begin(backdrop, view);
    if (backdrop->hills)
        hills_begin(backdrop->hills, view, workspace->threads);
}

static void ray_of(const struct backdrop_rays *rays, float x_px, float y_px, float ray[3])
{
    for (int i = 0; i < 3; i++)
        ray[i] = rays->first[i] + x_px * rays->right[i] + y_px * rays->down[i];
}

static float length_of(const float ray[3])
{
    return sqrtf(ray[0] * ray[0] + ray[1] * ray[1] + ray[2] * ray[2]);
}

static void sky_row(const struct sky *sky, const struct backdrop_rays *rays, float x_px, float y_px,
                    int count, float *depths_m, float (*rgb)[3])
{
    for (int k = 0; k < count; k++) {
        float ray[3];
        ray_of(rays, x_px + (float)k, y_px, ray);
        float rise = ray[1] / length_of(ray);
        float up = sqrtf(rise > 0 ? rise : 0), low = -8 * rise;
        low = low < 1 ? low : 1;
        low = low > 0 ? low : 0;
        depths_m[k] = INFINITY;
        for (int i = 0; i < 3; i++)
            rgb[k][i] = sky->horizon[i] + up * (sky->zenith[i] - sky->horizon[i]) +
                        low * (sky->ground[i] - sky->horizon[i]);
    }
}

static void plane_light(const struct backdrop_light *light, float side, float rgb[3])
{
    float cosine = fmaxf(0, side * light->sun_direction[1]);
    for (int i = 0; i < 3; i++)
        rgb[i] = light->in_sun[i] * cosine + light->in_shade[i];
}

static void plane_row(const struct backdrop_cpu *backdrop, float x_px, float y_px, int count,
                      float *depths_m, float (*rgb)[3], float *suns)
{
    const struct terrain *terrain = &backdrop->scene->terrain;
    const float *eye = backdrop->view.eye_m;
    float lift = terrain->heights_m[0] - eye[1], lit[3];
    float half_x = 0.5f * terrain->size_x_m, half_z = 0.5f * terrain->size_z_m;
    bool fog = backdrop->light.fog_density_per_m > 0;
    plane_light(&backdrop->light, lift <= 0 ? 1 : -1, lit);
    for (int k = 0; k < count; k++) {
        float ray[3];
        ray_of(&backdrop->rays, x_px + (float)k, y_px, ray);
        float depth = lift / ray[1];
        float x = eye[0] + depth * ray[0], z = eye[2] + depth * ray[2];
        bool hit = depth > 0 && fabsf(x) <= half_x && fabsf(z) <= half_z;
        depths_m[k] = hit ? depth : depths_m[k];
        for (int i = 0; i < 3; i++)
            rgb[k][i] = hit ? lit[i] : rgb[k][i];
        if (suns && hit)
            suns[k] = fmaxf(0, (lift <= 0 ? 1 : -1) * backdrop->light.sun_direction[1]) *
                      backdrop_clear(&backdrop->light, depth * length_of(ray));
        if (fog && hit)
            backdrop_fog(&backdrop->light, depth * length_of(ray), rgb[k]);
    }
}

/* The same where all of the row sees it, without fog and suns. */
static void plane_fill(const struct backdrop_cpu *backdrop, float x_px, float y_px, int count,
                       float *depths_m, float (*rgb)[3])
{
    const struct backdrop_rays *rays = &backdrop->rays;
    const float lift = backdrop->scene->terrain.heights_m[0] - backdrop->view.eye_m[1];
    float lit[3];
    plane_light(&backdrop->light, lift <= 0 ? 1 : -1, lit);
    for (int k = 0; k < count; k++)
        depths_m[k] =
            lift / (rays->first[1] + (x_px + (float)k) * rays->right[1] + y_px * rays->down[1]);
    for (int k = 0; k < count; k++)
        for (int i = 0; i < 3; i++)
            rgb[k][i] = lit[i];
}

/* The flat terrain is convex, and so is what a row sees of it: its ends decide. */
static bool plane_fills_row(const struct backdrop_cpu *backdrop, float x_px, float y_px, int count)
{
    float depths_m[2] = {INFINITY, INFINITY}, unused[2][3] = {{0, 0, 0}, {0, 0, 0}};
    plane_row(backdrop, x_px, y_px, 1, &depths_m[0], &unused[0], NULL);
    plane_row(backdrop, x_px + (float)(count - 1), y_px, 1, &depths_m[1], &unused[1], NULL);
    return isfinite(depths_m[0]) && isfinite(depths_m[1]);
}

/* The share of a pixel's square on the inner side of a line: a trapezoid, integrated. */
static float share_inside(const float across[2], float inside_px)
{
    float a = fmaxf(fabsf(across[0]), fabsf(across[1]));
    float b = fminf(fabsf(across[0]), fabsf(across[1]));
    float away = fabsf(inside_px), corner = fmaxf(0.5f * (a + b) - away, 0);
    if (away <= 0.5f * (a - b))
        return 0.5f + inside_px / a;
    float share = corner * corner / fmaxf(2 * a * b, 1e-6f);
    return inside_px > 0 ? 1 - share : share;
}

static void border_pixel(const struct backdrop_cpu *backdrop, int border, float x_px, float y_px,
                         float rgb[3])
{
    static const float reach_px = 1.5f;
    const float *from = backdrop->ends[border][0], *to = backdrop->ends[border][1];
    const float *across = backdrop->inward[border];
    float dx = to[0] - from[0], dy = to[1] - from[1];
    float x = x_px + 0.5f - from[0], y = y_px + 0.5f - from[1];
    float inside_px = x * across[0] + y * across[1];
    float along = (x * dx + y * dy) / (dx * dx + dy * dy);
    if (!(fabsf(inside_px) < reach_px) || !(along >= 0 && along <= 1))
        return;
    float ray[3], sky[3], ground[3], unused;
    ray_of(&backdrop->rays, x_px, y_px, ray);
    sky_row(&backdrop->scene->sky, &backdrop->rays, x_px, y_px, 1, &unused, &sky);
    plane_light(&backdrop->light, 1, ground);
    float depth = 1 / (from[2] + along * (to[2] - from[2]));
    backdrop_fog(&backdrop->light, depth * length_of(ray), ground);
    float share = share_inside(across, inside_px);
    for (int i = 0; i < 3; i++)
        rgb[i] = sky[i] + share * (ground[i] - sky[i]);
}

/* The pixels of a row within reach of a border: an interval. */
static void border_row(const struct backdrop_cpu *backdrop, int border,
                       const struct backdrop_tile *tile, int row)
{
    const float *from = backdrop->ends[border][0], *across = backdrop->inward[border];
    float y = (float)(tile->y_px + row) + 0.5f - from[1];
    int first = 0, end = tile->width_px;
    if (fabsf(across[0]) > 1e-6f) {
        float middle = from[0] - y * across[1] / across[0] - (float)tile->x_px - 0.5f;
        float reach = 1.5f / fabsf(across[0]);
        first = (int)fminf(fmaxf(floorf(middle - reach), 0), (float)end);
        end = (int)fminf(fmaxf(ceilf(middle + reach) + 1, 0), (float)end);
    } else if (!(fabsf(y * across[1]) < 1.5f)) {
        return;
    }
    for (int k = first; k < end; k++)
        border_pixel(backdrop, border, (float)(tile->x_px + k), (float)(tile->y_px + row),
                     tile->rgb[row * tile->stride + k]);
}

void backdrop_cpu_tile(const struct backdrop_cpu *backdrop, const struct backdrop_tile *tile)
{
    for (int row = 0; row < tile->height_px; row++) {
        float *depths_m = tile->depths_m + row * tile->stride;
        float(*rgb)[3] = tile->rgb + row * tile->stride;
        float x_px = (float)tile->x_px, y_px = (float)(tile->y_px + row);
        const bool filled = backdrop->flat && plane_fills_row(backdrop, x_px, y_px, tile->width_px);
        if (!filled)
            sky_row(&backdrop->scene->sky, &backdrop->rays, x_px, y_px, tile->width_px, depths_m,
                    rgb);
        if (filled && !tile->suns && !(backdrop->light.fog_density_per_m > 0))
            plane_fill(backdrop, x_px, y_px, tile->width_px, depths_m, rgb);
        else if (backdrop->flat)
            plane_row(backdrop, x_px, y_px, tile->width_px, depths_m, rgb,
                      tile->suns ? tile->suns + row * tile->stride : NULL);
        for (int border = 0; border < backdrop->borders_count; border++)
            border_row(backdrop, border, tile, row);
    }
    if (backdrop->hills)
        hills_tile(backdrop->hills, &backdrop->rays, backdrop->view.eye_m, &backdrop->light, tile);
}
