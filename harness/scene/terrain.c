/* Terrain: heights from an image, of a fractal relief or flat, normals, the triangulated surface
 * and its height. */
#include "scene/terrain.h"

#include "scene/relief.h"
#include "scene/terrain_image.h"

#include <string.h>

/* Up to so many, a terrain has no levels of detail unless the scene asks for them. */
enum { TRIANGLES_ALL_DRAWN = 1 << 21 };

/* Heights of an image, m. */
static enum status heights_read(struct arena *arena, const struct description *description,
                                struct terrain *terrain, struct error *error)
{
    const struct ground *ground = &description->ground;
    struct terrain_image image;
    enum status status = terrain_image_heights(arena, ground->image, &image, error);
    if (status != STATUS_OK)
        return error_context(error, "%s: terrain.image", description->path);
    terrain->samples_x = image.width;
    terrain->samples_z = image.height;
    terrain->heights_m = image.values;
    for (size_t i = 0; i < (size_t)image.width * image.height; i++) {
        double height_m = (double)image.values[i] * ground->height_m;
        if (!(fabs(height_m) <= HEIGHT_M_MAX))
            return error_set(error, STATUS_INVALID,
                             "%s: terrain.image: %s: the height at pixel (%zu, %zu) is %g m; "
                             "allowed: -%g..%g",
                             description->path, ground->image, i % image.width, i / image.width,
                             height_m, HEIGHT_M_MAX, HEIGHT_M_MAX);
        terrain->heights_m[i] = (float)height_m;
    }
    return STATUS_OK;
}

static enum status heights_make(struct arena *arena, const struct description *description,
                                struct terrain *terrain, struct error *error)
{
    const struct ground *ground = &description->ground;
    uint32_t samples[2] = {2, 2};
    if (ground->image)
        return heights_read(arena, description, terrain, error);
    if (ground->level)
        terrain->heights_m =
            relief_heights(arena, ground->level, ground->spike_m, ground->seed, samples);
    else if (ground->noise.samples[0]) {
        memcpy(samples, ground->noise.samples, sizeof samples);
        terrain->heights_m = relief_perlin(arena, &ground->noise, ground->size_m);
    } else
        terrain->heights_m = ARENA_ARRAY(arena, float, 4);
    terrain->samples_x = samples[0];
    terrain->samples_z = samples[1];
    return STATUS_OK;
}

static enum status colors_read(struct arena *arena, const struct description *description,
                               struct terrain *terrain, struct error *error)
{
    struct arena *scratch = arena_create(0);
    struct terrain_image image;
    enum status status = terrain_image_colors(scratch, description->ground.color, &image, error);
    if (status == STATUS_OK)
        terrain->colors =
            terrain_image_resample(arena, &image, terrain->samples_x, terrain->samples_z);
    else
        error_context(error, "%s: terrain.color", description->path);
    arena_destroy(scratch);
    return status;
}

enum status terrain_build(struct arena *arena, const struct description *description,
                          struct terrain *terrain, struct error *error)
{
    const struct ground *ground = &description->ground;
    *terrain = (struct terrain){0};
    if (!ground->given)
        return STATUS_OK;
    terrain->size_x_m = (float)ground->size_m[0];
    terrain->size_z_m = (float)ground->size_m[1];
    memcpy(terrain->albedo, ground->albedo, sizeof terrain->albedo);
    enum status status = heights_make(arena, description, terrain, error);
    const uint64_t triangles = (uint64_t)(terrain->samples_x - 1) * (terrain->samples_z - 1) * 2;
    const float usual_px = triangles > TRIANGLES_ALL_DRAWN ? 0.5f : 0;
    terrain->detail_px = ground->detail_px < 0 ? usual_px : ground->detail_px;
    if (status == STATUS_OK && ground->color)
        status = colors_read(arena, description, terrain, error);
    if (status == STATUS_OK)
        terrain_normals(arena, terrain);
    return status;
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

void terrain_albedo(const struct terrain *terrain, float x_m, float z_m, float albedo[3])
{
    memcpy(albedo, terrain->albedo, sizeof terrain->albedo);
    if (!terrain->colors)
        return;
    double u, v;
    uint32_t i = quad_of(x_m, terrain->size_x_m, terrain->samples_x, &u);
    uint32_t j = quad_of(z_m, terrain->size_z_m, terrain->samples_z, &v);
    const float(*row)[3] = (const float(*)[3])terrain->colors + (size_t)j * terrain->samples_x + i;
    const float(*next)[3] = row + terrain->samples_x;
    for (int c = 0; c < 3; c++) {
        double base = (double)row[0][c], corner = (double)next[1][c];
        double side = (double)(u >= v ? row[1][c] : next[0][c]);
        double first = u >= v ? u : v, second = u >= v ? v : u;
        albedo[c] *= (float)(base + first * (side - base) + second * (corner - side));
    }
}

float terrain_slope_deg(const struct terrain *terrain, float x_m, float z_m)
{
    if (terrain->samples_x < 2 || terrain->samples_z < 2)
        return 0;
    double u, v;
    uint32_t i = quad_of(x_m, terrain->size_x_m, terrain->samples_x, &u);
    uint32_t j = quad_of(z_m, terrain->size_z_m, terrain->samples_z, &v);
    const float *near_row = terrain->heights_m + (size_t)j * terrain->samples_x + i;
    const float *far_row = near_row + terrain->samples_x;
    bool east = u >= v;
    double rise_x_m = (double)(east ? near_row[1] - near_row[0] : far_row[1] - far_row[0]);
    double rise_z_m = (double)(east ? far_row[1] - near_row[1] : far_row[0] - near_row[0]);
    double slope_x = rise_x_m / (double)terrain->size_x_m * (terrain->samples_x - 1);
    double slope_z = rise_z_m / (double)terrain->size_z_m * (terrain->samples_z - 1);
    return (float)(atan(sqrt(slope_x * slope_x + slope_z * slope_z)) * 57.29577951308232);
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
    mesh->colors = terrain->colors;
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
