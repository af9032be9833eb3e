/* A plant's volume of light: what is left of the sun at each place in it, by one sweep along the
 * light through the opacities that the march itself uses. */
#include "bake/march_shadow_parts.h"

#include <math.h>
#include <string.h>

/* Turns little where the light does, at the zenith too: Duff et al. 2017, JCGT 6(1). */
struct shadow_axes shadow_axes_of(const float toward_sun[3])
{
    const float x = toward_sun[0], y = toward_sun[1], z = toward_sun[2];
    const float sign = copysignf(1, y), a = -1 / (sign + y), b = x * z * a;
    return (struct shadow_axes){
        {{1 + sign * x * x * a, -sign * x, sign * b}, {b, -z, sign + z * z * a}, {-x, -y, -z}}};
}

static float dot3(const float a[3], const float b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Plates and how many elements they have together. */
static size_t plates_lay(struct shadow_volume *volume)
{
    size_t count = 0;
    int32_t across = volume->size[0], up = volume->size[1];
    for (volume->plates_count = 0; volume->plates_count < SHADOW_PLATES_MAX;) {
        int level = volume->plates_count++;
        volume->plates_size[level][0] = across;
        volume->plates_size[level][1] = up;
        count += (size_t)across * (size_t)up;
        if (across == 1 && up == 1)
            break;
        across = (across + 1) / 2;
        up = (up + 1) / 2;
    }
    return count;
}

void shadow_volume_lay_plates(struct arena *arena, struct shadow_volume *volume)
{
    size_t plates = plates_lay(volume);
    volume->plates[0] = shadow_room(arena, volume->plates[0], plates, &volume->plates_capacity,
                                    sizeof *volume->plates[0]);
    for (int level = 1; level < volume->plates_count; level++)
        volume->plates[level] =
            volume->plates[level - 1] +
            (size_t)volume->plates_size[level - 1][0] * (size_t)volume->plates_size[level - 1][1];
}

void shadow_volume_size(struct arena *arena, const struct voxels *voxels,
                        const struct shadow_axes *frame, float stretch, float cell_m,
                        struct shadow_volume *volume)
{
    const struct voxels_level *grid = &voxels->levels[0];
    float middle_m[3];
    volume->frame = volume->back = *frame;
    for (int k = 0; k < 3; k++) {
        volume->frame.axes[k][1] *= stretch;
        volume->back.axes[k][1] /= stretch;
    }
    volume->cell_m = cell_m;
    for (int i = 0; i < 3; i++)
        middle_m[i] = voxels->origin_m[i] + 0.5f * (float)grid->size[i] * grid->voxel_m;
    for (int k = 0; k < 3; k++) {
        const float *axis = volume->frame.axes[k];
        float reach_m = 0;
        for (int i = 0; i < 3; i++)
            reach_m += 0.5f * (float)grid->size[i] * grid->voxel_m * fabsf(axis[i]);
        /* From the middle on, so that cells move little where the light does. */
        int32_t half = (int32_t)ceilf(reach_m / cell_m - 1e-3f);
        volume->size[k] = 2 * half + (k == 2);
        volume->low_m[k] = dot3(axis, middle_m) - cell_m * (float)half;
    }
    size_t passes = 4 + (size_t)volume->size[0] * (size_t)volume->size[1] * (size_t)volume->size[2];
    volume->passes = shadow_room(arena, volume->passes, passes, &volume->capacity, 1);
    shadow_volume_lay_plates(arena, volume);
}

/* Optical depth of a voxel's side along the form's direction. */
static float voxel_hides(const struct voxel *voxel, const struct march_form *form)
{
    float value = form->factors[0];
    for (int i = 0; i < 5; i++)
        value += (float)(voxel->shape >> (6 * i) & 63) * form->factors[i + 1];
    return voxel->extinction * sqrtf(fmaxf(value, 0));
}

/* A ray through a level of voxels, in its voxels' sides. */
struct ray {
    const struct voxels *voxels;
    const struct voxels_level *grid;
    struct march_form form;
    float step[3]; /* a layer */
};

/* The cell of a place, or that of nothing. */
static uint32_t cell_at(const struct voxels_level *grid, const float at[3])
{
    for (int i = 0; i < 3; i++)
        if (!(at[i] >= 0 && at[i] < (float)grid->size[i]))
            return 1;
    return grid
        ->cells[((size_t)at[2] * grid->size[1] + (size_t)at[1]) * grid->size[0] + (size_t)at[0]];
}

/* Light above each layer of a column that begins at a place in voxels. */
static struct shadow_plate column_sweep(const struct ray *ray, const float begin[3], float length,
                                        int32_t layers, uint8_t *passes)
{
    float depth = 0, pass = 1;
    int32_t first = layers, last = 0;
    for (int32_t k = 0; k < layers; k++) {
        float at[3];
        passes[k] = (uint8_t)(255 * pass + 0.5f);
        for (int i = 0; i < 3; i++)
            at[i] = begin[i] + ((float)k + 0.5f) * ray->step[i];
        uint32_t cell = cell_at(ray->grid, at);
        if (cell < VOXELS_FIRST)
            continue;
        depth += length * voxel_hides(&ray->voxels->voxels[cell - VOXELS_FIRST], &ray->form);
        pass = expf(-depth);
        first = first < k ? first : k;
        last = k + 1;
    }
    return (struct shadow_plate){1 - pass, (1 - pass) * (float)first, (1 - pass) * (float)last};
}

static void plate_halve(const struct shadow_volume *volume, int level)
{
    const int32_t *fine = volume->plates_size[level - 1], *coarse = volume->plates_size[level];
    const struct shadow_plate *from = volume->plates[level - 1];
    struct shadow_plate *to = volume->plates[level];
    memset(to, 0, (size_t)coarse[0] * (size_t)coarse[1] * sizeof *to);
    for (int32_t y = 0; y < fine[1]; y++)
        for (int32_t x = 0; x < fine[0]; x++, from++) {
            struct shadow_plate *sum = &to[y / 2 * coarse[0] + x / 2];
            sum->cover += 0.25f * from->cover;
            sum->first_m += 0.25f * from->first_m;
            sum->last_m += 0.25f * from->last_m;
        }
}

void shadow_volume_halve_plates(const struct shadow_volume *volume)
{
    for (int level = 1; level < volume->plates_count; level++)
        plate_halve(volume, level);
}

void shadow_volume_sweep(const struct voxels *voxels, enum march_model model,
                         struct shadow_volume *volume)
{
    struct ray ray = {.voxels = voxels, .grid = &voxels->levels[0]};
    for (uint32_t l = 1; l < voxels->levels_count; l++)
        if (voxels->levels[l].voxel_m < 1.01f * volume->cell_m)
            ray.grid = &voxels->levels[l];
    const float per_m = 1 / ray.grid->voxel_m, length = volume->cell_m * per_m;
    const float *down = volume->back.axes[2];
    ray.form = march_form_of(model, down, down);
    for (int i = 0; i < 3; i++)
        ray.step[i] = length * down[i];
    struct shadow_plate *plate = volume->plates[0];
    uint8_t *passes = volume->passes;
    for (int32_t y = 0; y < volume->size[1]; y++)
        for (int32_t x = 0; x < volume->size[0]; x++, plate++, passes += volume->size[2]) {
            float begin[3];
            for (int i = 0; i < 3; i++)
                begin[i] = per_m * (volume->back.axes[0][i] *
                                        (volume->low_m[0] + ((float)x + 0.5f) * volume->cell_m) +
                                    volume->back.axes[1][i] *
                                        (volume->low_m[1] + ((float)y + 0.5f) * volume->cell_m) +
                                    down[i] * volume->low_m[2] - voxels->origin_m[i]);
            *plate = column_sweep(&ray, begin, length, volume->size[2], passes);
            plate->first_m = plate->cover * volume->low_m[2] + volume->cell_m * plate->first_m;
            plate->last_m = plate->cover * volume->low_m[2] + volume->cell_m * plate->last_m;
        }
    shadow_volume_halve_plates(volume);
}

struct shadow_plate shadow_volume_plate(const struct shadow_volume *volume, const float across_m[2],
                                        float width_m)
{
    int level = (int)fmaxf(0, floorf(log2f(width_m / volume->cell_m) + 0.5f));
    level = level < volume->plates_count ? level : volume->plates_count - 1;
    const int32_t *size = volume->plates_size[level];
    const float side_m = volume->cell_m * (float)(1 << level);
    float share[2], sum[3] = {0, 0, 0};
    int32_t low[2];
    for (int k = 0; k < 2; k++) {
        float at = (across_m[k] - volume->low_m[k]) / side_m - 0.5f;
        if (!(at > -1 && at < (float)size[k]))
            return (struct shadow_plate){0, 0, 0};
        low[k] = (int32_t)floorf(at);
        share[k] = at - (float)low[k];
    }
    for (int corner = 0; corner < 4; corner++) {
        int32_t x = low[0] + (corner & 1), y = low[1] + (corner >> 1);
        if (x < 0 || y < 0 || x >= size[0] || y >= size[1])
            continue;
        const struct shadow_plate *plate = &volume->plates[level][y * size[0] + x];
        float weight =
            (corner & 1 ? share[0] : 1 - share[0]) * (corner >> 1 ? share[1] : 1 - share[1]);
        sum[0] += weight * plate->cover;
        sum[1] += weight * plate->first_m;
        sum[2] += weight * plate->last_m;
    }
    return (struct shadow_plate){sum[0], sum[1], sum[2]};
}
