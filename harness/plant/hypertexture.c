/* A hypertexture: a ball whose soft skin is moved in and out by noise, as a closed surface.
 *
 * Perlin and Hoffert 1989, doi:10.1145/74333.74359: a soft ball's density falls from 1 to 0 between
 * two radii, linear in the square of the distance; their fractal egg bends it by noise summed over
 * octaves: D(x (1 + sum of noise)). What is drawn here is the surface on which that density has a
 * given value (they marched rays through all of it). The noise is Perlin's of 2002, and the octaves
 * are scaled so that amplitude bounds their sum. */
#include "plant/generator.h"
#include "plant/isosurface.h"
#include "plant/noise.h"
#include "plant/normals.h"

#include <string.h>

static const float albedo[3] = {0.42f, 0.3f, 0.19f};

struct options {
    float radius, frequency, gain, amplitude, softness, threshold;
    int octaves, resolution, seed;
};

/* clang-format off */
static const struct option table[] = {
    OPTION(struct options, radius, 2, 0.05, 100, "m", "of the ball, to the middle of its skin"),
    OPTION(struct options, frequency, 1.5, 0, 32, "", "bumps of the first octave along a radius"),
    OPTION(struct options, octaves, 4, 1, 8, "", "of noise, each with twice the frequency of the one before"),
    OPTION(struct options, gain, 0.5, 0, 1, "", "amplitude of an octave over that of the one before"),
    OPTION(struct options, amplitude, 0.45, 0, 0.75, "", "share of a distance by which noise changes it at most"),
    OPTION(struct options, softness, 0.5, 0.01, 1, "", "width of the skin in which the density falls, over the radius"),
    OPTION(struct options, threshold, 0.5, 0.01, 0.99, "", "density of which the surface is drawn"),
    OPTION(struct options, resolution, 92, 8, 400, "", "grid cells along each side of the cube that holds the surface"),
    OPTION(struct options, seed, 1, 0, 1000000, "", "another shape for each"),
    OPTION_END,
};
/* clang-format on */

/* The distance from the middle at which a ball without noise has the density that is drawn. */
static double surface_radius(const struct options *options)
{
    double radius = (double)options->radius, half = radius * (double)options->softness / 2;
    double inner2 = (radius - half) * (radius - half), outer2 = (radius + half) * (radius + half);
    return sqrt(outer2 - (double)options->threshold * (outer2 - inner2));
}

static double noise_at(const struct options *options, struct vec p)
{
    double scale = (double)options->frequency / (double)options->radius;
    uint64_t seed = random_mix((uint64_t)options->seed);
    /* A shift, as noise is 0 on its lattice and the ball's middle would be on it. */
    struct vec at = vec_add(vec_scale(p, scale), (struct vec){0.37, 0.61, 0.43});
    return noise_octaves(seed, at, options->octaves, (double)options->gain);
}

/* Negative where the density is above the threshold: the density falls with the bent distance, so
 * the distance stands for it, and the surface is the same however steep the skin is. */
static double field_at(const struct options *options, struct vec p)
{
    double bent = 1 + (double)options->amplitude * noise_at(options, p);
    return vec_length(p) * bent - surface_radius(options);
}

static struct field sample(struct arena *scratch, const struct options *options)
{
    /* No point of the surface is farther out; a cell more on each side. */
    double half = surface_radius(options) / (1 - (double)options->amplitude);
    double cell = 2 * half / (options->resolution - 2);
    size_t points = (size_t)options->resolution + 1;
    float *values = ARENA_ARRAY(scratch, float, points *points *points);
    struct field field = {
        {points, points, points}, {-half - cell, -half - cell, -half - cell}, cell, values};
#pragma omp parallel for schedule(static)
    for (size_t z = 0; z < points; z++)
        for (size_t y = 0; y < points; y++)
            for (size_t x = 0; x < points; x++) {
                double low = field.minimum_m[0];
                struct vec p = {low + cell * (double)x, low + cell * (double)y,
                                low + cell * (double)z};
                values[(z * points + y) * points + x] = (float)field_at(options, p);
            }
    return field;
}

/* Hollows are darker. */
static float tint_at(const struct options *options, const float position[3])
{
    struct vec p = {(double)position[0], (double)position[1], (double)position[2]};
    return (float)fmin(fmax(0.7 - 0.6 * noise_at(options, p), 0.2), 1);
}

/* The surface, tinted and set on the ground: a plant's foot is at y = 0. */
static struct mesh *finish(struct arena *arena, const struct options *options,
                           const struct isosurface *surface)
{
    struct mesh *mesh = ARENA_NEW(arena, struct mesh);
    size_t count = mesh->vertices_count = surface->vertices_count;
    mesh->positions = arena_alloc(arena, count, sizeof *mesh->positions);
    mesh->normals = arena_alloc(arena, count, sizeof *mesh->normals);
    mesh->colors = arena_alloc(arena, count, sizeof *mesh->colors);
    float lowest = INFINITY;
    for (size_t i = 0; i < count; i++)
        lowest = fminf(lowest, surface->positions_m[i][1]);
#pragma omp parallel for schedule(static)
    for (size_t i = 0; i < count; i++) {
        const float *from = surface->positions_m[i];
        mesh->colors[i][0] = mesh->colors[i][1] = mesh->colors[i][2] = tint_at(options, from);
        memcpy(mesh->positions[i], from, sizeof *mesh->positions);
        mesh->positions[i][1] -= lowest;
    }
    mesh->triangles_count = surface->triangles_count;
    mesh->triangles = arena_alloc(arena, mesh->triangles_count, sizeof *mesh->triangles);
    memcpy(mesh->triangles, surface->triangles, mesh->triangles_count * sizeof *mesh->triangles);
    normals_smooth((const float(*)[3])mesh->positions, mesh->triangles, mesh->triangles_count,
                   mesh->normals);
    mesh->parts_count = mesh->materials_count = 1;
    mesh->parts = ARENA_NEW(arena, struct mesh_part);
    mesh->parts[0].triangles_count = (uint32_t)mesh->triangles_count;
    mesh->materials = ARENA_NEW(arena, struct material);
    mesh->materials[0] = (struct material){.name = arena_strdup(arena, "skin")};
    memcpy(mesh->materials[0].albedo, albedo, sizeof albedo);
    mesh_bounds(mesh);
    return mesh;
}

static enum status build(struct arena *arena, const void *values, struct mesh **made,
                         struct error *error)
{
    const struct options *options = values;
    struct arena *scratch = arena_create(0);
    struct field field = sample(scratch, options);
    struct isosurface surface = isosurface_extract(scratch, &field);
    enum status status = STATUS_OK;
    if (surface.triangles_count > 0)
        *made = finish(arena, options, &surface);
    else
        status =
            error_set(error, STATUS_INVALID, "resolution: %d cells find no surface; allowed: more",
                      options->resolution);
    arena_destroy(scratch);
    return status;
}

const struct generator hypertexture_generator = {"hypertexture", 1, table, sizeof(struct options),
                                                 build};
