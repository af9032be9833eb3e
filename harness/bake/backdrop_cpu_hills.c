/* A bent terrain on the CPU: its triangles, chunk by chunk, over a tile, or of a large one a ray a
 * pixel through its quadtree. A triangle is met where a
 * ray has the three planes through the eye and its edges on one side (Olano and Greer 1997,
 * "Triangle Scan Conversion using 2D Homogeneous Coordinates"): no clipping, and the same weights
 * give depth and normal. */
#include "bake/backdrop_cpu_parts.h"
#include "bake/terrain_rays.h"

#include <math.h>
#include <string.h>

enum { CHUNK_SIDE = 8 };

/* On the screen, px, row 0 on top. */
struct bounds {
    float low[2], high[2];
};

struct hills {
    const struct terrain *terrain;
    struct terrain_rays *rays; /* NULL: by what follows */
    const struct mesh *mesh;
    uint32_t quads_x, quads_z, chunks_x, chunks_z;
    float (*screen)[3]; /* of each vertex: x, y in px, depth along the view */
    struct bounds *chunks;
    float (*spheres)[4]; /* of each chunk: centre, radius, m */
};

static uint32_t end_of(uint32_t chunk, uint32_t quads)
{
    uint32_t end = (chunk + 1) * CHUNK_SIDE;
    return end < quads ? end : quads;
}

/* The vertices of a chunk; returns how many. */
enum { CHUNK_CORNERS = (CHUNK_SIDE + 1) * (CHUNK_SIDE + 1) };
static size_t chunk_corners(const struct hills *hills, size_t chunk,
                            uint32_t corners[CHUNK_CORNERS])
{
    uint32_t cx = (uint32_t)(chunk % hills->chunks_x), cz = (uint32_t)(chunk / hills->chunks_x);
    size_t count = 0;
    for (uint32_t z = cz * CHUNK_SIDE; z <= end_of(cz, hills->quads_z); z++)
        for (uint32_t x = cx * CHUNK_SIDE; x <= end_of(cx, hills->quads_x); x++)
            corners[count++] = z * (hills->quads_x + 1) + x;
    return count;
}

static void chunk_sphere(const struct hills *hills, size_t chunk, float sphere[4])
{
    uint32_t corners[CHUNK_CORNERS];
    size_t count = chunk_corners(hills, chunk, corners);
    float low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (size_t k = 0; k < count; k++)
        for (int i = 0; i < 3; i++) {
            low[i] = fminf(low[i], hills->mesh->positions[corners[k]][i]);
            high[i] = fmaxf(high[i], hills->mesh->positions[corners[k]][i]);
        }
    float square = 0;
    for (int i = 0; i < 3; i++) {
        sphere[i] = 0.5f * (low[i] + high[i]);
        square += 0.25f * (high[i] - low[i]) * (high[i] - low[i]);
    }
    sphere[3] = 1.0001f * sqrtf(square);
}

struct hills *hills_prepare(struct arena *arena, const struct terrain *terrain, bool by_rays)
{
    struct hills *hills = ARENA_NEW(arena, struct hills);
    hills->terrain = terrain;
    if (by_rays) {
        hills->rays = terrain_rays_create(arena, terrain);
        return hills;
    }
    hills->mesh = terrain_mesh(arena, terrain);
    hills->quads_x = terrain->samples_x - 1;
    hills->quads_z = terrain->samples_z - 1;
    hills->chunks_x = (hills->quads_x + CHUNK_SIDE - 1) / CHUNK_SIDE;
    hills->chunks_z = (hills->quads_z + CHUNK_SIDE - 1) / CHUNK_SIDE;
    hills->screen = arena_alloc(arena, hills->mesh->vertices_count, sizeof *hills->screen);
    hills->chunks = ARENA_ARRAY(arena, struct bounds, (size_t)hills->chunks_x * hills->chunks_z);
    hills->spheres =
        arena_alloc(arena, (size_t)hills->chunks_x * hills->chunks_z, sizeof *hills->spheres);
    for (size_t chunk = 0; chunk < (size_t)hills->chunks_x * hills->chunks_z; chunk++)
        chunk_sphere(hills, chunk, hills->spheres[chunk]);
    return hills;
}

static const struct bounds nowhere = {{INFINITY, INFINITY}, {-INFINITY, -INFINITY}};
static const struct bounds everywhere = {{-INFINITY, -INFINITY}, {INFINITY, INFINITY}};

/* of corners on the screen; all of it when one is not well before the eye */
static inline struct bounds bounds_of(const float (*screen)[3], const uint32_t *corners,
                                      size_t count, float near_m)
{
    struct bounds bounds = nowhere;
    size_t behind = 0;
    for (size_t k = 0; k < count; k++) {
        const float *at = screen[corners[k]];
        behind += at[2] < near_m;
        for (int i = 0; i < 2; i++) {
            bounds.low[i] = bounds.low[i] < at[i] ? bounds.low[i] : at[i];
            bounds.high[i] = bounds.high[i] > at[i] ? bounds.high[i] : at[i];
        }
    }
    if (behind == count)
        return nowhere;
    return behind ? everywhere : bounds;
}

/* Spheres outside the frustum would cover all of the screen where they reach behind the eye. */
static struct bounds chunk_bounds(const struct hills *hills, size_t chunk, const struct view *view)
{
    uint32_t corners[CHUNK_CORNERS];
    if (!view_sees_sphere(view, hills->spheres[chunk], hills->spheres[chunk][3]))
        return nowhere;
    size_t count = chunk_corners(hills, chunk, corners);
    return bounds_of((const float(*)[3])hills->screen, corners, count, view->near_m);
}

void hills_begin(struct hills *hills, const struct view *view, int threads)
{
    if (hills->rays)
        return;
    const float focal = 0.5f * (float)view->height_px / tanf(0.5f * view->fov_y_rad);
    const size_t vertices = hills->mesh->vertices_count;
    const size_t chunks = (size_t)hills->chunks_x * hills->chunks_z;
#pragma omp parallel num_threads(threads)
    {
#pragma omp for schedule(static)
        for (size_t v = 0; v < vertices; v++) {
            const float *p = hills->mesh->positions[v];
            float at[3] = {0, 0, 0};
            for (int i = 0; i < 3; i++) {
                float away = p[i] - view->eye_m[i];
                at[0] += away * view->right[i];
                at[1] -= away * view->up[i];
                at[2] += away * view->forward[i];
            }
            hills->screen[v][0] = 0.5f * (float)view->width_px + focal * at[0] / at[2];
            hills->screen[v][1] = 0.5f * (float)view->height_px + focal * at[1] / at[2];
            hills->screen[v][2] = at[2];
        }
#pragma omp for schedule(static)
        for (size_t chunk = 0; chunk < chunks; chunk++)
            hills->chunks[chunk] = chunk_bounds(hills, chunk, view);
    }
}

/* The pixels of a tile whose centres are within bounds, and a little more; false when none is. */
static inline bool pixels_of(const struct bounds *bounds, const struct backdrop_tile *tile,
                             int low[2], int high[2])
{
    const int first[2] = {tile->x_px, tile->y_px}, size[2] = {tile->width_px, tile->height_px};
    float from[2], to[2];
    for (int i = 0; i < 2; i++) {
        from[i] = bounds->low[i] - (float)first[i] - 0.51f;
        to[i] = bounds->high[i] - (float)first[i] - 0.49f;
        if (!(from[i] < (float)size[i]) || !(to[i] > -1))
            return false;
    }
    for (int i = 0; i < 2; i++) {
        low[i] = from[i] > 0 ? (int)from[i] : 0;
        high[i] = to[i] < (float)(size[i] - 1) ? (int)to[i] + 1 : size[i] - 1;
    }
    return true;
}

/* A triangle as seen from the eye: a ray's products with the planes are its weights. */
struct facet {
    double planes[3][3];
    double volume; /* positive where the front is seen */
    const float *normals[3];
    const float *colors[3]; /* NULL: all of one */
};

static bool facet_of(const struct mesh *mesh, const uint32_t corners[3], const float eye_m[3],
                     struct facet *facet)
{
    double p[3][3];
    for (int k = 0; k < 3; k++) {
        facet->normals[k] = mesh->normals[corners[k]];
        facet->colors[k] = mesh->colors ? mesh->colors[corners[k]] : NULL;
        for (int i = 0; i < 3; i++)
            p[k][i] = (double)mesh->positions[corners[k]][i] - eye_m[i];
    }
    facet->volume = 0;
    for (int k = 0; k < 3; k++) {
        const double *a = p[(k + 1) % 3], *b = p[(k + 2) % 3];
        for (int i = 0; i < 3; i++) {
            int j = (i + 1) % 3, l = (i + 2) % 3;
            facet->planes[k][i] = a[j] * b[l] - a[l] * b[j];
            facet->volume += k == 0 ? p[0][i] * facet->planes[0][i] : 0;
        }
    }
    return facet->volume != 0;
}

/* Returns how much of the sun's light it is. */
static float facet_light(const struct facet *facet, const float weights[3],
                         const struct backdrop_light *light, float rgb[3])
{
    float normal[3], length = 0, cosine = 0;
    for (int i = 0; i < 3; i++) {
        normal[i] = 0;
        for (int k = 0; k < 3; k++)
            normal[i] += weights[k] * facet->normals[k][i];
        length += normal[i] * normal[i];
        cosine += normal[i] * light->sun_direction[i];
    }
    cosine *=
        facet->volume < 0 ? 1 : -1; /* corners run clockwise around a ray that meets the front */
    cosine = cosine > 0 ? cosine / sqrtf(length) : 0;
    for (int i = 0; i < 3; i++)
        rgb[i] = light->in_sun[i] * cosine + light->in_shade[i];
    for (int i = 0; i < 3 && facet->colors[0]; i++)
        rgb[i] *= weights[0] * facet->colors[0][i] + weights[1] * facet->colors[1][i] +
                  weights[2] * facet->colors[2][i];
    return cosine;
}

/* A place of a facet as a pixel's nearest. */
static void pixel_put(const struct facet *facet, const float weights[3], float depth_m,
                      const struct backdrop_rays *rays, const struct backdrop_light *light,
                      const struct backdrop_tile *tile, int x, int y)
{
    const int at = y * tile->stride + x;
    float *rgb = tile->rgb[at];
    tile->depths_m[at] = depth_m;
    float sun = facet_light(facet, weights, light, rgb);
    if (light->fog_density_per_m > 0) {
        float square = 0;
        for (int i = 0; i < 3; i++) {
            float ray = rays->first[i] + (float)(tile->x_px + x) * rays->right[i] +
                        (float)(tile->y_px + y) * rays->down[i];
            square += ray * ray;
        }
        backdrop_fog(light, depth_m * sqrtf(square), rgb);
        sun *= tile->suns ? backdrop_clear(light, depth_m * sqrtf(square)) : 0;
    }
    if (tile->suns)
        tile->suns[at] = sun;
}

static void facet_draw(const struct facet *facet, const struct backdrop_rays *rays,
                       const struct backdrop_light *light, const struct backdrop_tile *tile,
                       const int low[2], const int high[2])
{
    double sign = facet->volume < 0 ? -1 : 1, right[3];
    for (int k = 0; k < 3; k++)
        right[k] =
            sign * (facet->planes[k][0] * rays->right[0] + facet->planes[k][1] * rays->right[1] +
                    facet->planes[k][2] * rays->right[2]);
    for (int y = low[1]; y <= high[1]; y++) {
        double first[3];
        float *depths_m = tile->depths_m + y * tile->stride;
        for (int k = 0; k < 3; k++) {
            first[k] = 0;
            for (int i = 0; i < 3; i++)
                first[k] += sign * facet->planes[k][i] *
                            (rays->first[i] + (double)tile->x_px * rays->right[i] +
                             (double)(tile->y_px + y) * rays->down[i]);
        }
        for (int x = low[0]; x <= high[0]; x++) {
            double a = first[0] + x * right[0], b = first[1] + x * right[1];
            double c = first[2] + x * right[2], sum = a + b + c;
            if (!(a >= 0 && b >= 0 && c >= 0 && sum > 0))
                continue;
            double depth = sign * facet->volume / sum;
            if (!(depth < depths_m[x]))
                continue;
            const float weights[3] = {(float)(a / sum), (float)(b / sum), (float)(c / sum)};
            pixel_put(facet, weights, (float)depth, rays, light, tile, x, y);
        }
    }
}

/* By a ray a pixel. */
static void rays_tile(const struct hills *hills, const struct backdrop_rays *rays,
                      const float eye_m[3], const struct backdrop_light *light,
                      const struct backdrop_tile *tile)
{
    const struct terrain *terrain = hills->terrain;
    for (int y = 0; y < tile->height_px; y++)
        for (int x = 0; x < tile->width_px; x++) {
            struct terrain_hit hit;
            struct facet facet;
            float ray[3];
            for (int i = 0; i < 3; i++)
                ray[i] = rays->first[i] + (float)(tile->x_px + x) * rays->right[i] +
                         (float)(tile->y_px + y) * rays->down[i];
            if (!terrain_rays_hit(hills->rays, eye_m, ray,
                                  (double)tile->depths_m[y * tile->stride + x], &hit))
                continue;
            facet.volume = hit.front ? -1 : 1;
            for (int k = 0; k < 3; k++) {
                facet.normals[k] = terrain->normals[hit.corners[k]];
                facet.colors[k] = terrain->colors ? terrain->colors[hit.corners[k]] : NULL;
            }
            pixel_put(&facet, hit.weights, (float)hit.distance, rays, light, tile, x, y);
        }
}

void hills_tile(const struct hills *hills, const struct backdrop_rays *rays, const float eye_m[3],
                const struct backdrop_light *light, const struct backdrop_tile *tile)
{
    const size_t chunks = (size_t)hills->chunks_x * hills->chunks_z;
    const struct mesh *mesh = hills->mesh;
    int low[2], high[2];
    if (hills->rays) {
        rays_tile(hills, rays, eye_m, light, tile);
        return;
    }
    for (size_t chunk = 0; chunk < chunks; chunk++) {
        if (!pixels_of(&hills->chunks[chunk], tile, low, high))
            continue;
        uint32_t cx = (uint32_t)(chunk % hills->chunks_x);
        uint32_t cz = (uint32_t)(chunk / hills->chunks_x);
        for (uint32_t z = cz * CHUNK_SIDE; z < end_of(cz, hills->quads_z); z++)
            for (uint32_t q = 2 * cx * CHUNK_SIDE; q < 2 * end_of(cx, hills->quads_x); q++) {
                const uint32_t *corners = mesh->triangles[2 * (size_t)z * hills->quads_x + q];
                struct bounds bounds =
                    bounds_of((const float(*)[3])hills->screen, corners, 3, 1e-6f);
                struct facet facet;
                if (pixels_of(&bounds, tile, low, high) && facet_of(mesh, corners, eye_m, &facet))
                    facet_draw(&facet, rays, light, tile, low, high);
            }
    }
}
