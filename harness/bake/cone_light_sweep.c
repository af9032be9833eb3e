/* Light within a plant: twigs and bark in the order in which the sun meets them, on a grid of what
 * is left. */
#include "bake/cone_light_parts.h"
#include "bake/cull.h"

#include <math.h>
#include <string.h>

#define PI 3.14159265f
enum { TEXELS_LEAST = 32, TEXELS_MOST = 256 }; /* across a plant */

static float dot3(const float a[3], const float b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static float texel_of(const struct cone_plant *plant)
{
    double sum = 0;
    for (size_t i = 0; i < plant->twigs_count; i++)
        sum += (double)plant->twigs[i].radius_m;
    float wide_m = 2 * plant->radius_m;
    float mean_m = plant->twigs_count ? (float)sum / (float)plant->twigs_count : wide_m;
    return fminf(fmaxf(mean_m, wide_m / TEXELS_MOST), wide_m / TEXELS_LEAST);
}

void cone_kind_lay(struct arena *arena, const struct cone_plant *plant,
                   const struct shadow_axes *frame, struct cone_kind *kind)
{
    struct shadow_volume *volume = &kind->volume;
    volume->frame = volume->back = *frame;
    volume->cell_m = fmaxf(texel_of(plant), 1e-9f);
    int32_t half = (int32_t)ceilf(plant->radius_m / volume->cell_m);
    for (int k = 0; k < 3; k++) {
        volume->size[k] = 2 * half;
        volume->low_m[k] = dot3(frame->axes[k], plant->center_m) - (float)half * volume->cell_m;
    }
    const size_t texels = (size_t)volume->size[0] * (size_t)volume->size[1];
    shadow_volume_lay_plates(arena, volume);
    kind->passes =
        shadow_room(arena, kind->passes, 4 * texels, &kind->texels_capacity, sizeof *kind->passes);
    kind->firsts_m = kind->passes + texels;
    kind->lasts_m = kind->firsts_m + texels;
    kind->taken = kind->lasts_m + texels;
    if (kind->cones)
        return;
    const size_t items = plant->twigs_count + plant->barks_count;
    kind->cones = ARENA_ARRAY(arena, uint8_t, plant->cones_count);
    kind->barks = ARENA_ARRAY(arena, uint8_t, plant->barks_count);
    kind->keys = ARENA_ARRAY(arena, float, 2 * items);
    kind->scratch_keys = kind->keys + items;
    kind->order = ARENA_ARRAY(arena, uint32_t, 2 * items);
    kind->scratch_order = kind->order + items;
}

/* A square of the grid, in texels. */
struct square {
    float low[2], high[2];
    int32_t first[2], last[2];
};

static struct square square_of(const struct cone_kind *kind, const float place_m[3], float half_m)
{
    const struct shadow_volume *volume = &kind->volume;
    struct square square;
    for (int k = 0; k < 2; k++) {
        float at = (dot3(volume->frame.axes[k], place_m) - volume->low_m[k]) / volume->cell_m;
        float half = half_m / volume->cell_m, most = (float)volume->size[k] - 1e-3f;
        square.low[k] = fminf(fmaxf(at - half, 0), most);
        square.high[k] = fminf(fmaxf(at + half, 0), most);
        square.first[k] = (int32_t)square.low[k];
        square.last[k] = (int32_t)square.high[k];
    }
    return square;
}

static float share_of(const struct square *square, int axis, int32_t texel)
{
    float low = fmaxf(square->low[axis], (float)texel);
    float high = fminf(square->high[axis], (float)(texel + 1));
    return high > low ? high - low : 0;
}

/* The mean of what is left. */
static float light_of(const struct cone_kind *kind, const float place_m[3], float half_m)
{
    const struct square square =
        square_of(kind, place_m, fmaxf(half_m, 0.5f * kind->volume.cell_m));
    float sum = 0, area = 0;
    for (int32_t y = square.first[1]; y <= square.last[1]; y++)
        for (int32_t x = square.first[0]; x <= square.last[0]; x++) {
            float share = share_of(&square, 0, x) * share_of(&square, 1, y);
            sum += share * kind->passes[y * kind->volume.size[0] + x];
            area += share;
        }
    return area > 0 ? sum / area : 1;
}

/* Lays a square of an opacity into what an item takes. */
static void lay(struct cone_kind *kind, const float place_m[3], float half_m, float opacity,
                struct square *touched)
{
    const struct square square = square_of(kind, place_m, half_m);
    const float depth_m = dot3(kind->volume.frame.axes[2], place_m);
    for (int32_t y = square.first[1]; y <= square.last[1]; y++)
        for (int32_t x = square.first[0]; x <= square.last[0]; x++) {
            const int32_t at = y * kind->volume.size[0] + x;
            kind->taken[at] += opacity * share_of(&square, 0, x) * share_of(&square, 1, y);
            kind->firsts_m[at] = fminf(kind->firsts_m[at], depth_m - half_m);
            kind->lasts_m[at] = fmaxf(kind->lasts_m[at], depth_m + half_m);
        }
    for (int k = 0; k < 2; k++) {
        touched->first[k] =
            touched->first[k] < square.first[k] ? touched->first[k] : square.first[k];
        touched->last[k] = touched->last[k] > square.last[k] ? touched->last[k] : square.last[k];
    }
}

/* Parts of one item lie beside each other: what they take of a texel is their sum. What is left of
 * it is that of items by chance. */
static void take(struct cone_kind *kind, const struct square *touched)
{
    for (int32_t y = touched->first[1]; y <= touched->last[1]; y++)
        for (int32_t x = touched->first[0]; x <= touched->last[0]; x++) {
            const int32_t at = y * kind->volume.size[0] + x;
            kind->passes[at] *= 1 - fminf(kind->taken[at], 1);
            kind->taken[at] = 0;
        }
}

static const struct square untouched = {.first = {INT32_MAX, INT32_MAX}, .last = {-1, -1}};

/* Where the needles of a cone are in the mean. */
static void cone_middle(const struct cone_twig *twig, uint32_t cone, float place_m[3])
{
    float along = twig->cone_0_m + (float)cone * twig->twig->spacing_m +
                  0.5f * twig->twig->needle_length_m * twig->cosine;
    for (int i = 0; i < 3; i++)
        place_m[i] = twig->base_m[i] + along * twig->axis[i];
}

static void twig_pass(const struct cone_twig *twig, struct cone_kind *kind)
{
    const struct conifer_twig *from = twig->twig;
    const float *down = kind->volume.frame.axes[2];
    float sun[3], seen[2];
    for (int i = 0; i < 3; i++) {
        const float *axis = i == 0 ? twig->across : i == 1 ? twig->along : twig->axis;
        sun[i] = -dot3(axis, down);
    }
    needles_cone_seen(twig->sine, twig->cosine, sun, seen);
    float flat = sqrtf(sun[0] * sun[0] + sun[1] * sun[1]);
    float needles_m2 = (float)from->needles_count * from->needle_radius_m * from->needle_length_m *
                       (seen[0] + seen[1]) / PI;
    float outline_m2 = 2 * twig->radius_m *
                       (from->spacing_m * flat +
                        0.5f * PI * twig->radius_m * fabsf(sun[2]) / (float)from->cones_count);
    const float wide_m2 = fmaxf(4 * twig->radius_m * twig->radius_m, 1e-20f);
    struct square touched = untouched;
    float place_m[3], opacity = 1 - expf(-needles_m2 / fmaxf(outline_m2, 1e-20f));
    opacity *= outline_m2 / wide_m2; /* cones nearer to each other than they are wide */
    for (uint32_t k = 0; k < from->cones_count; k++) {
        cone_middle(twig, k, place_m);
        kind->cones[twig->first_cone + k] =
            (uint8_t)(255 * light_of(kind, place_m, twig->radius_m) + 0.5f);
    }
    for (uint32_t k = 0; k < from->cones_count; k++) {
        cone_middle(twig, k, place_m);
        lay(kind, place_m, twig->radius_m, opacity, &touched);
    }
    take(kind, &touched);
}

static void bark_pass(const struct cone_bark *bark, struct cone_kind *kind, uint8_t *light)
{
    float radius_m = 0.5f * (bark->radius_m[0] + bark->radius_m[1]), way[3], middle_m[3];
    for (int i = 0; i < 3; i++) {
        way[i] = bark->to_m[i] - bark->from_m[i];
        middle_m[i] = bark->from_m[i] + 0.5f * way[i] - radius_m * kind->volume.frame.axes[2][i];
    }
    float right = dot3(way, kind->volume.frame.axes[0]), up = dot3(way, kind->volume.frame.axes[1]);
    float length_m = sqrtf(right * right + up * up);
    int count = (int)fminf(fmaxf(ceilf(length_m / (2 * radius_m + 1e-9f)), 1), 64);
    struct square touched = untouched;
    /* Light is read so far within that the piece before this one does not darken it. */
    const float within =
        fmaxf(1 - 2 * fmaxf(radius_m, kind->volume.cell_m) / (length_m + 1e-9f), 0);
    float sum = 0;
    for (int pass = 0; pass < 2; pass++)
        for (int k = 0; k < count; k++) {
            float place_m[3], at = ((float)k + 0.5f) / (float)count - 0.5f;
            at *= pass == 0 ? within : 1;
            for (int i = 0; i < 3; i++)
                place_m[i] = middle_m[i] + at * way[i];
            if (pass == 0)
                sum += light_of(kind, place_m, radius_m);
            else
                lay(kind, place_m,
                    0.5f * sqrtf(2 * radius_m * fmaxf(length_m / (float)count, radius_m)), 1,
                    &touched);
        }
    take(kind, &touched);
    *light = (uint8_t)(255 * sum / (float)count + 0.5f);
}

static void plates_fill(struct cone_kind *kind)
{
    const size_t texels = (size_t)kind->volume.size[0] * (size_t)kind->volume.size[1];
    for (size_t k = 0; k < texels; k++) {
        float cover = 1 - kind->passes[k];
        kind->volume.plates[0][k] =
            cover > 0
                ? (struct shadow_plate){cover, cover * kind->firsts_m[k], cover * kind->lasts_m[k]}
                : (struct shadow_plate){0, 0, 0};
    }
    shadow_volume_halve_plates(&kind->volume);
}

void cone_kind_sweep(const struct cone_plant *plant, struct cone_kind *kind)
{
    const size_t texels = (size_t)kind->volume.size[0] * (size_t)kind->volume.size[1];
    const size_t items = plant->twigs_count + plant->barks_count;
    const float *down = kind->volume.frame.axes[2];
    for (size_t k = 0; k < texels; k++) {
        kind->passes[k] = 1;
        kind->taken[k] = 0;
        kind->firsts_m[k] = INFINITY;
        kind->lasts_m[k] = -INFINITY;
    }
    for (size_t k = 0; k < items; k++) {
        float middle_m[3];
        if (k < plant->twigs_count) {
            cone_twig_reach(&plant->twigs[k], middle_m);
        } else {
            const struct cone_bark *bark = &plant->barks[k - plant->twigs_count];
            for (int i = 0; i < 3; i++)
                middle_m[i] = 0.5f * (bark->from_m[i] + bark->to_m[i]);
        }
        kind->keys[k] = dot3(down, middle_m);
        kind->order[k] = (uint32_t)k;
    }
    cull_sort(kind->keys, kind->order, kind->scratch_keys, kind->scratch_order, items, false);
    for (size_t k = 0; k < items; k++) {
        size_t item = kind->order[k];
        if (item >= plant->twigs_count)
            bark_pass(&plant->barks[item - plant->twigs_count], kind,
                      &kind->barks[item - plant->twigs_count]);
        else if (plant->twigs[item].twig->cones_count)
            twig_pass(&plant->twigs[item], kind);
    }
    plates_fill(kind);
}
