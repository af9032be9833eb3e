/* Terrain: heights from an image, of a fractal relief or flat, normals, the triangulated surface
 * and its height. */
#include "scene/terrain.h"

#include "base/file.h"
#include "base/hash.h"
#include "scene/relief.h"
#include "wall/image.h"

#include <string.h>

/* Heights as the cache keeps them: [0, 1], row 0 at the smallest z. */
struct height_image {
    uint32_t width, height;
    float *values;
};

static enum status height_check(const char *path, uint64_t width, uint64_t height,
                                struct error *error)
{
    if (width >= 2 && height >= 2 && width <= TERRAIN_SAMPLES_MAX && height <= TERRAIN_SAMPLES_MAX)
        return STATUS_OK;
    return error_set(error, STATUS_INVALID,
                     "%s: the height image is %llu x %llu px; allowed: 2..%d on each side", path,
                     (unsigned long long)width, (unsigned long long)height, TERRAIN_SAMPLES_MAX);
}

static bool height_from_cache(struct arena *arena, uint64_t hash, struct height_image *heights)
{
    void *data = NULL;
    size_t size = 0;
    if (!cache_get(arena, "terrain", hash, &data, &size) || size < 2 * sizeof(uint32_t))
        return false;
    uint32_t sides[2];
    memcpy(sides, data, sizeof sides);
    if (size != sizeof sides + (size_t)sides[0] * sides[1] * sizeof(float) ||
        height_check("", sides[0], sides[1], NULL) != STATUS_OK)
        return false;
    heights->width = sides[0];
    heights->height = sides[1];
    heights->values = (float *)(void *)((char *)data + sizeof sides);
    return true;
}

static void height_to_cache(struct arena *arena, uint64_t hash, const struct height_image *heights)
{
    uint32_t sides[2] = {heights->width, heights->height};
    size_t values_bytes = (size_t)sides[0] * sides[1] * sizeof(float);
    char *data = arena_alloc(arena, 1, sizeof sides + values_bytes);
    memcpy(data, sides, sizeof sides);
    memcpy(data + sizeof sides, heights->values, values_bytes);
    cache_put("terrain", hash, data, sizeof sides + values_bytes);
}

static enum status height_decode(struct arena *arena, const char *path,
                                 struct height_image *heights, struct error *error)
{
    struct image *image = NULL;
    enum status status = image_read(arena, path, false, &image, error);
    if (status != STATUS_OK)
        return status;
    status = height_check(path, (uint64_t)image->width_px, (uint64_t)image->height_px, error);
    if (status != STATUS_OK)
        return status;
    heights->width = (uint32_t)image->width_px;
    heights->height = (uint32_t)image->height_px;
    size_t count = (size_t)heights->width * heights->height;
    heights->values = ARENA_ARRAY(arena, float, count);
    for (size_t i = 0; i < count; i++) {
        float value = image->values[i * (size_t)image->channels_count];
        if (!(value >= 0 && value <= 1))
            return error_set(error, STATUS_INVALID,
                             "%s: the height at pixel (%zu, %zu) is %g; allowed: 0..1", path,
                             i % heights->width, i / heights->width, (double)value);
        heights->values[i] = value;
    }
    return STATUS_OK;
}

static enum status height_read(struct arena *arena, const char *path, struct height_image *heights,
                               struct error *error)
{
    char *bytes = NULL;
    size_t size = 0;
    enum status status = file_read(arena, path, 0, &bytes, &size, error);
    if (status != STATUS_OK)
        return status;
    uint64_t hash = hash_bytes(0, bytes, size);
    if (height_from_cache(arena, hash, heights))
        return STATUS_OK;
    status = height_decode(arena, path, heights, error);
    if (status == STATUS_OK)
        height_to_cache(arena, hash, heights);
    return status;
}

enum status terrain_build(struct arena *arena, const struct description *description,
                          struct terrain *terrain, struct error *error)
{
    const struct ground *ground = &description->ground;
    *terrain = (struct terrain){0};
    if (!ground->given)
        return STATUS_OK;
    struct height_image heights = {2, 2, NULL};
    double unit_m = ground->height_m;
    if (ground->level) {
        uint32_t samples[2];
        unit_m = 1;
        heights.values =
            relief_heights(arena, ground->level, ground->spike_m, ground->seed, samples);
        heights.width = samples[0];
        heights.height = samples[1];
    }
    if (ground->image) {
        enum status status = height_read(arena, ground->image, &heights, error);
        if (status != STATUS_OK)
            return error_context(error, "%s: terrain.image", description->path);
    }
    terrain->samples_x = heights.width;
    terrain->samples_z = heights.height;
    terrain->size_x_m = (float)ground->size_m[0];
    terrain->size_z_m = (float)ground->size_m[1];
    memcpy(terrain->albedo, ground->albedo, sizeof terrain->albedo);
    size_t count = (size_t)heights.width * heights.height;
    terrain->heights_m = ARENA_ARRAY(arena, float, count);
    for (size_t i = 0; heights.values && i < count; i++)
        terrain->heights_m[i] = (float)(heights.values[i] * unit_m);
    terrain_normals(arena, terrain);
    return STATUS_OK;
}

/* dy/dx between the neighbours on one axis; step: their distance in the array, quad_m: side of a
 * quad. */
static float slope_at(const float *height, uint32_t at, uint32_t samples, size_t step, float quad_m)
{
    size_t before = at > 0 ? step : 0, after = at + 1 < samples ? step : 0;
    float span_m = quad_m * (float)((before > 0) + (after > 0));
    return (height[after] - *(height - before)) / span_m;
}

void terrain_normals(struct arena *arena, struct terrain *terrain)
{
    uint32_t samples_x = terrain->samples_x, samples_z = terrain->samples_z;
    float quad_x_m = terrain->size_x_m / (float)(samples_x - 1);
    float quad_z_m = terrain->size_z_m / (float)(samples_z - 1);
    terrain->normals = arena_alloc(arena, (size_t)samples_x * samples_z, sizeof *terrain->normals);
    for (uint32_t j = 0; j < samples_z; j++)
        for (uint32_t i = 0; i < samples_x; i++) {
            size_t k = (size_t)j * samples_x + i;
            const float *height = terrain->heights_m + k;
            float slope_x = slope_at(height, i, samples_x, 1, quad_x_m);
            float slope_z = slope_at(height, j, samples_z, samples_x, quad_z_m);
            float scale = 1.0f / sqrtf(1.0f + slope_x * slope_x + slope_z * slope_z);
            terrain->normals[k][0] = -slope_x * scale;
            terrain->normals[k][1] = scale;
            terrain->normals[k][2] = -slope_z * scale;
        }
}

/* Quad number and place in it, 0..1, of a coordinate; clamped to the border. */
static uint32_t quad_of(float at_m, float size_m, uint32_t samples, double *fraction)
{
    double quads = samples - 1;
    double u = ((double)at_m / size_m + 0.5) * quads;
    if (!(u > 0))
        u = 0;
    if (u > quads)
        u = quads;
    uint32_t quad = (uint32_t)u < samples - 2 ? (uint32_t)u : samples - 2;
    *fraction = u - quad;
    return quad;
}

float terrain_height(const struct terrain *terrain, float x_m, float z_m)
{
    if (terrain->samples_x < 2 || terrain->samples_z < 2)
        return 0;
    double u, v;
    uint32_t i = quad_of(x_m, terrain->size_x_m, terrain->samples_x, &u);
    uint32_t j = quad_of(z_m, terrain->size_z_m, terrain->samples_z, &v);
    const float *near_row = terrain->heights_m + (size_t)j * terrain->samples_x + i;
    const float *far_row = near_row + terrain->samples_x;
    double base = near_row[0], corner = far_row[1];
    if (u >= v)
        return (float)(base + u * (near_row[1] - base) + v * (corner - near_row[1]));
    return (float)(base + v * (far_row[0] - base) + u * (corner - far_row[0]));
}

/* Two triangles a quad, counter-clockwise from above. */
static void mesh_triangles(const struct terrain *terrain, uint32_t (*triangles)[3])
{
    for (uint32_t j = 0; j + 1 < terrain->samples_z; j++)
        for (uint32_t i = 0; i + 1 < terrain->samples_x; i++) {
            uint32_t a = j * terrain->samples_x + i, b = a + 1;
            uint32_t c = a + terrain->samples_x, d = c + 1;
            uint32_t pair[2][3] = {{a, d, b}, {a, c, d}};
            memcpy(triangles, pair, sizeof pair);
            triangles += 2;
        }
}

static void mesh_vertices(const struct terrain *terrain, struct mesh *mesh)
{
    for (uint32_t j = 0; j < terrain->samples_z; j++)
        for (uint32_t i = 0; i < terrain->samples_x; i++) {
            size_t k = (size_t)j * terrain->samples_x + i;
            double u = (double)i / (terrain->samples_x - 1) - 0.5;
            double v = (double)j / (terrain->samples_z - 1) - 0.5;
            mesh->positions[k][0] = (float)(u * terrain->size_x_m);
            mesh->positions[k][1] = terrain->heights_m[k];
            mesh->positions[k][2] = (float)(v * terrain->size_z_m);
            memcpy(mesh->normals[k], terrain->normals[k], sizeof mesh->normals[k]);
        }
}

struct mesh *terrain_mesh(struct arena *arena, const struct terrain *terrain)
{
    if (terrain->samples_x < 2 || terrain->samples_z < 2)
        return NULL;
    struct mesh *mesh = ARENA_NEW(arena, struct mesh);
    mesh->vertices_count = (size_t)terrain->samples_x * terrain->samples_z;
    mesh->positions = arena_alloc(arena, mesh->vertices_count, sizeof *mesh->positions);
    mesh->normals = arena_alloc(arena, mesh->vertices_count, sizeof *mesh->normals);
    mesh_vertices(terrain, mesh);
    mesh->triangles_count = 2 * (size_t)(terrain->samples_x - 1) * (terrain->samples_z - 1);
    mesh->triangles = arena_alloc(arena, mesh->triangles_count, sizeof *mesh->triangles);
    mesh_triangles(terrain, mesh->triangles);
    mesh->materials_count = 1;
    mesh->materials = ARENA_NEW(arena, struct material);
    mesh->materials->name = arena_strdup(arena, "terrain");
    mesh->materials->kind = MATERIAL_BARK;
    memcpy(mesh->materials->albedo, terrain->albedo, sizeof terrain->albedo);
    mesh->parts_count = 1;
    mesh->parts = ARENA_NEW(arena, struct mesh_part);
    mesh->parts->triangles_count = (uint32_t)mesh->triangles_count;
    mesh_bounds(mesh);
    return mesh;
}
