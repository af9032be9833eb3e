/* Shares of the sun on the ground, filled once a sun, looked up by pixels' footprints. */
#include "bake/shadow_ground.h"

#include <math.h>
#include <string.h>

enum {
    CELLS_MAX = 1 << 20,
    PROBES = 16, /* along a footprint, at most */
};

static float dot3(const float a[3], const float b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static float height_at(const struct shadow_light *light, float x_m, float z_m)
{
    return light->terrain_m ? terrain_height(light->terrain, x_m, z_m)
                            : light->terrain->heights_m[0];
}

/* Where the light that passes the map's corners meets the lowest and the highest ground, within the
 * terrain. False: nowhere. */
static bool rect_of(const struct shadow_light *light, float low_m[2], float high_m[2])
{
    const struct shadow_map *map = &light->map;
    const float(*axes)[3] = light->frame.axes;
    const float half_m[2] = {0.5f * light->terrain->size_x_m, 0.5f * light->terrain->size_z_m};
    for (int i = 0; i < 2; i++) {
        low_m[i] = INFINITY;
        high_m[i] = -INFINITY;
    }
    for (int corner = 0; corner < 8; corner++) {
        const float height_m = corner & 4 ? light->most_m : light->least_m;
        float across_m[2];
        for (int k = 0; k < 2; k++)
            across_m[k] =
                map->low_m[k] +
                (corner >> k & 1 ? map->texel_m * (float)(map->size[k] + 1) : -map->texel_m);
        const float down_m =
            (height_m - across_m[0] * axes[0][1] - across_m[1] * axes[1][1]) / axes[2][1];
        for (int i = 0; i < 2; i++) {
            const float at_m = across_m[0] * axes[0][2 * i] + across_m[1] * axes[1][2 * i] +
                               down_m * axes[2][2 * i];
            low_m[i] = fminf(low_m[i], at_m);
            high_m[i] = fmaxf(high_m[i], at_m);
        }
    }
    for (int i = 0; i < 2; i++) {
        low_m[i] = fmaxf(low_m[i], -half_m[i]);
        high_m[i] = fminf(high_m[i], half_m[i]);
    }
    return low_m[0] < high_m[0] && low_m[1] < high_m[1];
}

static void levels_lay(struct arena *arena, struct shadow_ground *ground, const float high_m[2])
{
    size_t cells = 0;
    for (int k = 0; k < 2; k++)
        ground->size[0][k] = 1 + (int32_t)((high_m[k] - ground->low_m[k]) / ground->cell_m);
    for (int level = 0; level < SHADOW_GROUND_LEVELS; level++) {
        const int32_t *size = ground->size[level];
        cells += (size_t)size[0] * (size_t)size[1];
        ground->levels_count = level + 1;
        if ((size[0] == 1 && size[1] == 1) || level + 1 == SHADOW_GROUND_LEVELS)
            break;
        for (int k = 0; k < 2; k++)
            ground->size[level + 1][k] = (size[k] + 1) / 2;
    }
    ground->levels[0] = shadow_room(arena, ground->levels[0], cells, &ground->capacity, 1);
    for (int level = 1; level < ground->levels_count; level++) {
        const int32_t *size = ground->size[level - 1];
        ground->levels[level] = ground->levels[level - 1] + (size_t)size[0] * (size_t)size[1];
    }
}

/* The cell of a level; what is beyond its border is lit. */
static unsigned cell_at(const struct shadow_ground *ground, int level, int32_t x, int32_t z)
{
    const int32_t *size = ground->size[level];
    return x >= 0 && z >= 0 && x < size[0] && z < size[1]
               ? ground->levels[level][(size_t)z * (size_t)size[0] + (size_t)x]
               : 255;
}

static void level_halve(const struct shadow_ground *ground, int level)
{
    const int32_t *size = ground->size[level];
    uint8_t *to = ground->levels[level];
    for (int32_t z = 0; z < size[1]; z++)
        for (int32_t x = 0; x < size[0]; x++) {
            unsigned sum = 2;
            for (int k = 0; k < 4; k++)
                sum += cell_at(ground, level - 1, 2 * x + (k & 1), 2 * z + (k >> 1));
            *to++ = (uint8_t)(sum / 4);
        }
}

void shadow_ground_fill(struct arena *arena, struct shadow_ground *ground,
                        const struct shadow_light *light, int threads)
{
    float high_m[2];
    ground->levels_count = 0;
    if (light->terrain->samples_x == 0 || light->map.size[0] == 0 ||
        !(light->sun_direction[1] > 0) || !rect_of(light, ground->low_m, high_m))
        return;
    const float area_m2 = (high_m[0] - ground->low_m[0]) * (high_m[1] - ground->low_m[1]);
    ground->cell_m = fmaxf(light->map.texel_m, sqrtf(area_m2 / CELLS_MAX));
    levels_lay(arena, ground, high_m);
    const int32_t *size = ground->size[0];
#pragma omp parallel for num_threads(threads) schedule(dynamic, 16)
    for (int32_t z = 0; z < size[1]; z++)
        for (int32_t x = 0; x < size[0]; x++) {
            float place_m[3] = {ground->low_m[0] + ((float)x + 0.5f) * ground->cell_m, 0,
                                ground->low_m[1] + ((float)z + 0.5f) * ground->cell_m};
            place_m[1] = height_at(light, place_m[0], place_m[2]);
            ground->levels[0][(size_t)z * (size_t)size[0] + (size_t)x] =
                (uint8_t)(255 * shadow_light_at(light, place_m) + 0.5f);
        }
    for (int level = 1; level < ground->levels_count; level++)
        level_halve(ground, level);
}

static float level_at(const struct shadow_ground *ground, int level, float x_m, float z_m)
{
    const float per_m = 1 / (ground->cell_m * (float)(1 << level));
    const float x = (x_m - ground->low_m[0]) * per_m - 0.5f;
    const float z = (z_m - ground->low_m[1]) * per_m - 0.5f;
    const int32_t *size = ground->size[level];
    if (!(x > -1 && z > -1 && x < (float)size[0] && z < (float)size[1]))
        return 1;
    const int32_t column = (int32_t)(x + 1) - 1, row = (int32_t)(z + 1) - 1;
    const float right = x - (float)column, down = z - (float)row;
    const bool inside = column >= 0 && row >= 0 && column + 1 < size[0] && row + 1 < size[1];
    float corners[4];
    if (inside) {
        const uint8_t *first =
            ground->levels[level] + (size_t)row * (size_t)size[0] + (size_t)column;
        for (int k = 0; k < 4; k++)
            corners[k] = (float)first[(k & 1) + (k >> 1) * size[0]];
    } else {
        for (int k = 0; k < 4; k++)
            corners[k] = (float)cell_at(ground, level, column + (k & 1), row + (k >> 1));
    }
    const float upper = corners[0] + right * (corners[1] - corners[0]);
    const float lower = corners[2] + right * (corners[3] - corners[2]);
    return (upper + down * (lower - upper)) * (1.0f / 255);
}

/* Of a part of the ground so wide. Levels are read with weights that reach beyond a cell: measured,
 * tests/test_shadow_ground.c. */
static float level_of(const struct shadow_ground *ground, float wide_m)
{
    static const float blended = 0.7f;
    return log2f(fmaxf(blended * wide_m / ground->cell_m, 1e-6f));
}

/* Mean over a part of the ground around a place. The light itself stands for what is finer than
 * level 0. */
static float part_at(const struct shadow_ground *ground, const struct shadow_light *light,
                     const float place_m[3], float level)
{
    const float most = (float)(ground->levels_count - 1);
    if (level < 0) {
        float world_m[3] = {place_m[0], place_m[1], place_m[2]};
        if (light->terrain_m)
            world_m[1] = terrain_height(light->terrain, place_m[0], place_m[2]);
        const float fine = shadow_light_at(light, world_m);
        return level <= -1
                   ? fine
                   : fine + (1 + level) * (level_at(ground, 0, place_m[0], place_m[2]) - fine);
    }
    const int whole = (int)fminf(level, most);
    const float fine = level_at(ground, whole, place_m[0], place_m[2]);
    if (level >= most || level == (float)whole)
        return fine;
    const float coarse = level_at(ground, whole + 1, place_m[0], place_m[2]);
    return fine + (level - (float)whole) * (coarse - fine);
}

/* Whether nothing shades a part of the ground so wide: the four cells of a level around its middle
 * that hold all of it. */
static bool is_lit(const struct shadow_ground *ground, const float middle_m[3], float wide_m)
{
    int level = 0, most = ground->levels_count - 1;
    for (float cell_m = ground->cell_m; cell_m < wide_m && level < most; cell_m *= 2)
        level++;
    return level < most && level_at(ground, level, middle_m[0], middle_m[2]) >= 1;
}

/* The ground's normal at its nearest sample. */
static void normal_at(const struct shadow_light *light, const float place_m[3], float normal[3])
{
    const struct terrain *terrain = light->terrain;
    normal[0] = normal[2] = 0;
    normal[1] = 1;
    if (!light->terrain_m)
        return;
    const float last[2] = {(float)(terrain->samples_x - 1), (float)(terrain->samples_z - 1)};
    const float x = (place_m[0] / terrain->size_x_m + 0.5f) * last[0] + 0.5f;
    const float z = (place_m[2] / terrain->size_z_m + 0.5f) * last[1] + 0.5f;
    const size_t column = (size_t)fminf(fmaxf(x, 0), last[0]);
    const size_t row = (size_t)fminf(fmaxf(z, 0), last[1]);
    memcpy(normal, terrain->normals[row * terrain->samples_x + column], 3 * sizeof *normal);
}

/* A footprint's long axis: places at eye + depth / (1 + slant s) (ray + s step), s in low..high of
 * the pixel's -1/2..1/2; where s is larger, the plane is nowhere or too far. */
struct axis {
    float slant, step[3], low, high;
};

/* False: the plane is seen from behind or along itself. */
static bool axis_of(const struct shadow_pixel *pixel, const float normal[3], struct axis *axis)
{
    static const float farthest = 20; /* times as far as the pixel's middle */
    const float toward = dot3(normal, pixel->ray);
    const float right = dot3(normal, pixel->right), down = dot3(normal, pixel->down);
    const float steep = sqrtf(right * right + down * down);
    *axis = (struct axis){.low = -0.5f, .high = 0.5f};
    if (!(toward < 0))
        return false;
    if (steep < -1e-6f * toward)
        return true;
    axis->slant = steep / toward; /* below 0: farther as s grows */
    for (int i = 0; i < 3; i++)
        axis->step[i] = (right * pixel->right[i] + down * pixel->down[i]) / steep;
    axis->high = fminf(0.5f, (1 / farthest - 1) / axis->slant);
    return true;
}

static void axis_place(const struct shadow_pixel *pixel, const struct axis *axis, float s,
                       float place_m[3])
{
    const float depth_m = pixel->depth_m / (1 + axis->slant * s);
    for (int i = 0; i < 3; i++)
        place_m[i] = pixel->eye_m[i] + depth_m * (pixel->ray[i] + s * axis->step[i]);
}

static float distance(const float a[3], const float b[3])
{
    const float way[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
    return sqrtf(dot3(way, way));
}

static float outside(float at, float low, float high)
{
    return at < low ? low - at : at > high ? at - high : 0;
}

/* Whether a footprint may reach what is shaded by trees. Its half length is at most depth |ray|
 * times the slant, if that is below 1. */
static bool is_near(const struct shadow_ground *ground, const struct shadow_pixel *pixel,
                    const float normal[3], const float middle_m[3])
{
    const float toward = dot3(normal, pixel->ray);
    const float right = dot3(normal, pixel->right), down = dot3(normal, pixel->down);
    const float steep2 = right * right + down * down, toward2 = toward * toward;
    float away2 = 0;
    for (int k = 0; k < 2; k++) {
        const float end_m = ground->low_m[k] + ground->cell_m * (float)ground->size[0][k];
        const float away_m = outside(middle_m[2 * k], ground->low_m[k], end_m);
        away2 += away_m * away_m;
    }
    return !(steep2 < toward2) ||
           !(away2 * toward2 > 2 * pixel->depth_m * pixel->depth_m *
                                   (dot3(pixel->ray, pixel->ray) * steep2 +
                                    dot3(pixel->right, pixel->right) * toward2));
}

/* Parts of the axis that are about as long as each other. */
static float even_mean(const struct shadow_ground *ground, const struct shadow_light *light,
                       const float from_m[3], const float to_m[3], float wide_m, int count)
{
    const float long_m = distance(from_m, to_m) / (float)count;
    float level = level_of(ground, fmaxf(wide_m, long_m)), sum = 0;
    if (count > 1) /* several places need no finer ones, and none between levels */
        level = level > 0 ? (float)(int)(level + 0.5f) : 0;
    for (int k = 0; k < count; k++) {
        const float share = ((float)k + 0.5f) / (float)count;
        float place_m[3];
        for (int i = 0; i < 3; i++)
            place_m[i] = from_m[i] + share * (to_m[i] - from_m[i]);
        sum += part_at(ground, light, place_m, level);
    }
    return sum / (float)count;
}

static float axis_mean(const struct shadow_ground *ground, const struct shadow_light *light,
                       const struct shadow_pixel *pixel, const struct axis *axis, float wide_m,
                       int count)
{
    float sum = 0, ends_m[2][3];
    axis_place(pixel, axis, axis->low, ends_m[0]);
    for (int k = 0; k < count; k++) {
        const float step = (axis->high - axis->low) / (float)count;
        const float s = axis->low + step * (float)(k + 1);
        float place_m[3], long_m;
        axis_place(pixel, axis, s, ends_m[1]);
        axis_place(pixel, axis, s - 0.5f * step, place_m);
        long_m = distance(ends_m[0], ends_m[1]);
        memcpy(ends_m[0], ends_m[1], sizeof ends_m[0]);
        sum += part_at(ground, light, place_m,
                       fmaxf(level_of(ground, fmaxf(wide_m, long_m)), count > 1 ? 0 : -1));
    }
    return sum / (float)count;
}

struct shadow_pixel shadow_pixel_of(const float eye_m[3], const struct backdrop_rays *rays,
                                    float x_px, float y_px, float depth_m)
{
    struct shadow_pixel pixel = {.depth_m = depth_m};
    for (int i = 0; i < 3; i++) {
        pixel.eye_m[i] = eye_m[i];
        pixel.right[i] = rays->right[i];
        pixel.down[i] = rays->down[i];
        pixel.ray[i] = rays->first[i] + x_px * rays->right[i] + y_px * rays->down[i];
    }
    return pixel;
}

float shadow_ground_at(const struct shadow_ground *ground, const struct shadow_light *light,
                       const struct shadow_pixel *pixel)
{
    static const float even = -0.1f;
    struct axis axis;
    float middle_m[3], ends_m[2][3], normal[3];
    for (int i = 0; i < 3; i++)
        middle_m[i] = pixel->eye_m[i] + pixel->depth_m * pixel->ray[i];
    if (ground->levels_count == 0)
        return shadow_light_at(light, middle_m);
    normal_at(light, middle_m, normal);
    if (!is_near(ground, pixel, normal, middle_m))
        return light->terrain_m ? shadow_light_at(light, middle_m) : 1;
    if (!axis_of(pixel, normal, &axis))
        return shadow_light_at(light, middle_m);
    const float wide_m = pixel->depth_m * sqrtf(dot3(pixel->right, pixel->right));
    axis_place(pixel, &axis, axis.low, ends_m[0]);
    axis_place(pixel, &axis, axis.high, ends_m[1]);
    const float long_m = distance(ends_m[0], ends_m[1]);
    const float probes = fminf(ceilf(long_m / fmaxf(wide_m, ground->cell_m)), PROBES);
    const int count = probes > 1 ? (int)probes : 1;
    if (count > 1 && is_lit(ground, middle_m, long_m + 2 * wide_m))
        return 1;
    return axis.slant > even ? even_mean(ground, light, ends_m[0], ends_m[1], wide_m, count)
                             : axis_mean(ground, light, pixel, &axis, wide_m, count);
}

void shadow_ground_shade(const struct shadow_ground *ground, const struct shadow_light *light,
                         const struct shadow_pixel *pixel, float sun, const float radiance[3],
                         float rgb[3])
{
    const float dark = (1 - shadow_ground_at(ground, light, pixel)) * sun;
    float albedo[3];
    if (!(dark > 0))
        return;
    terrain_albedo(light->terrain, pixel->eye_m[0] + pixel->depth_m * pixel->ray[0],
                   pixel->eye_m[2] + pixel->depth_m * pixel->ray[2], albedo);
    for (int c = 0; c < 3; c++)
        rgb[c] -= dark * albedo[c] * radiance[c];
}
