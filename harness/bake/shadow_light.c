/* The sun through the forest's map and the terrain. */
#include "bake/shadow_light.h"
#include "bake/horizon.h"

#include <math.h>
#include <string.h>

void shadow_light_create(struct arena *arena, const struct terrain *terrain,
                         struct shadow_light *light)
{
    const size_t samples = (size_t)terrain->samples_x * terrain->samples_z;
    *light = (struct shadow_light){.terrain = terrain, .least_m = INFINITY, .most_m = -INFINITY};
    for (size_t i = 0; i < samples; i++) {
        light->least_m = fminf(light->least_m, terrain->heights_m[i]);
        light->most_m = fmaxf(light->most_m, terrain->heights_m[i]);
    }
    if (samples > 0 && !horizon_is_flat(terrain))
        light->terrain_m = ARENA_ARRAY(arena, float, samples);
}

bool shadow_light_turn(struct shadow_light *light, const float sun_direction[3])
{
    if (!memcmp(light->sun_direction, sun_direction, sizeof light->sun_direction))
        return false;
    memcpy(light->sun_direction, sun_direction, sizeof light->sun_direction);
    light->frame = shadow_axes_of(sun_direction);
    if (light->terrain_m && sun_direction[1] >= 0)
        shadow_terrain_sweep(light->terrain, sun_direction, light->terrain_m);
    return true;
}

void shadow_along(const struct shadow_axes *frame, const float world_m[3], float place_m[3])
{
    for (int k = 0; k < 3; k++)
        place_m[k] = frame->axes[k][0] * world_m[0] + frame->axes[k][1] * world_m[1] +
                     frame->axes[k][2] * world_m[2];
}

/* A sun below the horizon shines from below the terrain's lowest height, past its borders. */
static bool is_underground(const struct shadow_light *light, const float world_m[3])
{
    const float *sun = light->sun_direction;
    float away = (light->least_m - world_m[1]) / sun[1];
    return fabsf(world_m[0] + away * sun[0]) <= 0.5f * light->terrain->size_x_m &&
           fabsf(world_m[2] + away * sun[2]) <= 0.5f * light->terrain->size_z_m;
}

/* Of a place along the light's axes. */
static float light_along(const struct shadow_light *light, const float place_m[3])
{
    const struct terrain *terrain = light->terrain;
    const bool low = terrain->samples_x > 0 && light->sun_direction[1] < 0;
    float world_m[3];
    for (int i = 0; i < 3 && (low || light->terrain_m); i++)
        world_m[i] = place_m[0] * light->frame.axes[0][i] + place_m[1] * light->frame.axes[1][i] +
                     place_m[2] * light->frame.axes[2][i];
    if (low && is_underground(light, world_m))
        return 0;
    if (!low && light->terrain_m && shadow_terrain_at(terrain, light->terrain_m, world_m) <= 0)
        return 0;
    return shadow_map_at(&light->map, place_m);
}

float shadow_light_at(const struct shadow_light *light, const float world_m[3])
{
    float place_m[3];
    shadow_along(&light->frame, world_m, place_m);
    return light_along(light, place_m);
}

/* Where light meets a tree: before its first matter there, so that it does not shade itself. */
static float entry_of(const struct shadow_light *light, const struct shadow_caster *caster,
                      const float across_m[2], float *cover)
{
    const struct shadow_volume *volume = caster->volume;
    float width_m = light->map.texel_m / caster->scale;
    struct shadow_plate plate = shadow_volume_plate(volume, across_m, width_m);
    *cover = plate.cover;
    if (plate.cover < 0.02f)
        plate = shadow_volume_plate(volume, across_m, 4 * width_m);
    float entry_m = plate.cover < 0.02f
                        ? volume->low_m[2] + 0.5f * volume->cell_m * (float)volume->size[2]
                        : plate.first_m / plate.cover;
    return caster->place_m[2] + caster->scale * entry_m - light->map.texel_m;
}

struct shadow_means shadow_light_gains(const struct shadow_light *light,
                                       const struct shadow_caster *caster, int side, uint8_t *gains)
{
    const struct shadow_volume *volume = caster->volume;
    float sum = 0, squares = 0, weights = 0;
    for (int k = 0; k < side * side; k++) {
        const int at[2] = {k % side, k / side};
        float across_m[2], place_m[3], cover;
        for (int i = 0; i < 2; i++) {
            across_m[i] = volume->low_m[i] + volume->cell_m * (float)volume->size[i] *
                                                 (float)at[i] / (float)(side - 1);
            place_m[i] = caster->place_m[i] + caster->scale * across_m[i];
        }
        place_m[2] = entry_of(light, caster, across_m, &cover);
        float gain = light_along(light, place_m);
        gains[k] = (uint8_t)(255 * gain + 0.5f);
        sum += (cover + 1e-3f) * gain;
        squares += (cover + 1e-3f) * gain * gain;
        weights += cover + 1e-3f;
    }
    return (struct shadow_means){sum / weights, sum > 0 ? squares / sum : 0};
}
