/* The forest seen from the sun: in each texel the first boxes of matter that its rays pass, nearest
 * the sun first. Lokovic and Veach 2000, with boxes of even density for their curves' pieces. */
#include "bake/march_shadow_parts.h"

#include <math.h>
#include <string.h>

enum { DEPTH_STEPS = 32, DARK = 6 * DEPTH_STEPS }; /* a box's; more than so much is night */

/* The rectangle of texels that a tree may touch, both ends included. */
static void caster_rect(const struct shadow_map *map, const struct shadow_caster *caster,
                        int32_t low[2], int32_t high[2])
{
    for (int k = 0; k < 2; k++) {
        const struct shadow_volume *volume = caster->volume;
        float from_m = caster->place_m[k] + caster->scale * volume->low_m[k] - map->low_m[k];
        float wide_m = caster->scale * volume->cell_m * (float)volume->size[k];
        low[k] = (int32_t)floorf(from_m / map->texel_m);
        high[k] = (int32_t)floorf((from_m + wide_m) / map->texel_m);
        low[k] = low[k] > 0 ? low[k] : 0;
        high[k] = high[k] < map->size[k] ? high[k] : map->size[k] - 1;
    }
}

static struct shadow_box box_of(const struct shadow_map *map, const struct shadow_caster *caster,
                                const struct shadow_plate *plate)
{
    float first_m = caster->place_m[2] + caster->scale * plate->first_m / plate->cover;
    float length_m = caster->scale * (plate->last_m - plate->first_m) / plate->cover;
    float depth = -DEPTH_STEPS * logf(fmaxf(1 - plate->cover, 1e-3f));
    float length = length_m / map->depth_m + 0.5f;
    return (struct shadow_box){
        .first = (uint16_t)fmaxf((first_m - map->low_m[2]) / map->depth_m + 0.5f, 0),
        .length = (uint8_t)(length < 1     ? 1
                            : length < 255 ? length
                                           : 255),
        .depth = (uint8_t)(depth + 0.5f),
    };
}

/* What does not fit lengthens the last box. */
static void texel_add(struct shadow_texel *texel, struct shadow_box box)
{
    int count = 0, sum = 0;
    while (count < SHADOW_BOXES && texel->boxes[count].depth)
        sum += texel->boxes[count++].depth;
    if (sum > DARK)
        return;
    if (count < SHADOW_BOXES) {
        texel->boxes[count] = box;
        return;
    }
    struct shadow_box *last = &texel->boxes[SHADOW_BOXES - 1];
    int first = last->first < box.first ? last->first : box.first;
    int ends[2] = {last->first + last->length, box.first + box.length};
    int length = (ends[0] > ends[1] ? ends[0] : ends[1]) - first, depth = last->depth + box.depth;
    last->first = (uint16_t)first;
    last->length = (uint8_t)(length < 255 ? length : 255);
    last->depth = (uint8_t)(depth < 255 ? depth : 255);
}

static void caster_add(struct shadow_map *map, const struct shadow_caster *caster, int32_t begin,
                       int32_t end)
{
    int32_t low[2], high[2];
    caster_rect(map, caster, low, high);
    low[1] = low[1] > begin ? low[1] : begin;
    high[1] = high[1] < end ? high[1] : end - 1;
    for (int32_t y = low[1]; y <= high[1]; y++)
        for (int32_t x = low[0]; x <= high[0]; x++) {
            const int32_t at[2] = {x, y};
            float across_m[2];
            for (int k = 0; k < 2; k++)
                across_m[k] =
                    (map->low_m[k] + ((float)at[k] + 0.5f) * map->texel_m - caster->place_m[k]) /
                    caster->scale;
            struct shadow_plate plate =
                shadow_volume_plate(caster->volume, across_m, map->texel_m / caster->scale);
            if (plate.cover < 0.02f)
                continue;
            texel_add(&map->texels[(size_t)y * (size_t)map->size[0] + (size_t)x],
                      box_of(map, caster, &plate));
        }
}

/* Places the map around all casters. */
static void map_frame(struct shadow_map *map, const struct shadow_caster *casters, size_t count,
                      size_t texels_max, float texel_m)
{
    float high_m[3] = {-INFINITY, -INFINITY, -INFINITY}, longest_m = 0, area_m2 = 1;
    for (int k = 0; k < 3; k++)
        map->low_m[k] = INFINITY;
    for (size_t i = 0; i < count; i++)
        for (int k = 0; k < 3; k++) {
            const struct shadow_volume *volume = casters[i].volume;
            float from_m = casters[i].place_m[k] + casters[i].scale * volume->low_m[k];
            float wide_m = casters[i].scale * volume->cell_m * (float)volume->size[k];
            map->low_m[k] = fminf(map->low_m[k], from_m);
            high_m[k] = fmaxf(high_m[k], from_m + wide_m);
            longest_m = k == 2 ? fmaxf(longest_m, wide_m) : longest_m;
        }
    for (int k = 0; k < 2; k++)
        area_m2 *= high_m[k] - map->low_m[k];
    map->depth_m = fmaxf((high_m[2] - map->low_m[2]) / 65000, longest_m / 250);
    map->texel_m = fmaxf(texel_m, sqrtf(area_m2 / (float)texels_max));
    for (int k = 0; k < 2; k++)
        map->size[k] = 1 + (int32_t)((high_m[k] - map->low_m[k]) / map->texel_m);
}

void shadow_map_fill(struct arena *arena, struct shadow_map *map,
                     const struct shadow_caster *casters, size_t count, size_t texels_max,
                     float texel_m, int threads)
{
    map->size[0] = map->size[1] = 0;
    if (count == 0)
        return;
    map_frame(map, casters, count, texels_max, texel_m);
    const int32_t rows = map->size[1];
    const size_t texels = (size_t)map->size[0] * (size_t)rows;
    map->texels = shadow_room(arena, map->texels, texels, &map->capacity, sizeof *map->texels);
    memset(map->texels, 0, texels * sizeof *map->texels);
#pragma omp parallel for num_threads(threads) schedule(static, 1)
    for (int thread = 0; thread < threads; thread++) {
        int32_t begin = (int32_t)((int64_t)rows * thread / threads);
        int32_t end = (int32_t)((int64_t)rows * (thread + 1) / threads);
        for (size_t i = 0; i < count; i++)
            caster_add(map, &casters[i], begin, end);
    }
}

/* Optical depth above a depth, in DEPTH_STEPS. */
static float texel_depth(const struct shadow_texel *texel, float depth)
{
    float sum = 0;
    for (int k = 0; k < SHADOW_BOXES && texel->boxes[k].depth; k++) {
        const struct shadow_box *box = &texel->boxes[k];
        float share = (depth - (float)box->first) / (float)box->length;
        sum += (float)box->depth * (share < 0 ? 0 : share < 1 ? share : 1);
    }
    return sum;
}

float shadow_map_at(const struct shadow_map *map, const float place_m[3])
{
    float share[2], pass = 1, depth = (place_m[2] - map->low_m[2]) / map->depth_m;
    int32_t low[2];
    for (int k = 0; k < 2; k++) {
        float at = (place_m[k] - map->low_m[k]) / map->texel_m - 0.5f;
        if (!(at > -1 && at < (float)map->size[k]))
            return 1;
        low[k] = (int32_t)floorf(at);
        share[k] = at - (float)low[k];
    }
    for (int corner = 0; corner < 4; corner++) {
        int32_t x = low[0] + (corner & 1), y = low[1] + (corner >> 1);
        if (x < 0 || y < 0 || x >= map->size[0] || y >= map->size[1])
            continue;
        float weight =
            (corner & 1 ? share[0] : 1 - share[0]) * (corner >> 1 ? share[1] : 1 - share[1]);
        float hidden =
            texel_depth(&map->texels[(size_t)y * (size_t)map->size[0] + (size_t)x], depth);
        if (hidden > 0)
            pass -= weight * (1 - expf(-hidden / DEPTH_STEPS));
    }
    return pass;
}
