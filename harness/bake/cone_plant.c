/* A conifer's pieces: bark cut so short that depth orders it, twigs with their frames, both dealt
 * in an order in which every beginning is a fair sample. */
#include "bake/cone_plant.h"
#include "base/random.h"

#include <math.h>
#include <string.h>

/* Thicker than this share of the thickest is always drawn; pieces are no longer than this share of
 * the plant's extent. */
#define TRUNK_SHARE 0.4f
#define PIECE_SHARE (1.0f / 20)

static float length_of(const float from[3], const float to[3])
{
    float x = to[0] - from[0], y = to[1] - from[1], z = to[2] - from[2];
    return sqrtf(x * x + y * y + z * z);
}

static size_t pieces_of(const struct conifer_branch *branch, float longest_m)
{
    float count = ceilf(length_of(branch->from_m, branch->to_m) / longest_m);
    return count > 1 ? count < 64 ? (size_t)count : 64 : 1;
}

static void bark_cut(const struct conifer_branch *branch, size_t pieces, struct cone_bark *barks)
{
    for (size_t k = 0; k < pieces; k++) {
        float at[2] = {(float)k / (float)pieces, (float)(k + 1) / (float)pieces};
        for (int i = 0; i < 3; i++) {
            float way = branch->to_m[i] - branch->from_m[i];
            barks[k].from_m[i] = branch->from_m[i] + at[0] * way;
            barks[k].to_m[i] = branch->from_m[i] + at[1] * way;
        }
        for (int end = 0; end < 2; end++)
            barks[k].radius_m[end] =
                branch->radius_from_m + at[end] * (branch->radius_to_m - branch->radius_from_m);
        barks[k].place = (uint32_t)k;
        barks[k].pieces = (uint32_t)pieces;
    }
}

/* Fisher and Yates. */
static void deal(void *items, size_t count, size_t size, struct random *random, char *swap)
{
    char *bytes = items;
    for (size_t k = count; k > 1; k--) {
        size_t other = random_below(random, (uint32_t)k);
        memcpy(swap, bytes + (k - 1) * size, size);
        memcpy(bytes + (k - 1) * size, bytes + other * size, size);
        memcpy(bytes + other * size, swap, size);
    }
}

/* Sums of the areas of the first so many, so that few can stand for all. */
static void areas_sum(struct arena *arena, struct cone_plant *plant)
{
    const size_t boughs = plant->barks_count - plant->trunks_count;
    double sum = 0;
    plant->twigs_areas = ARENA_ARRAY(arena, float, plant->twigs_count + 1);
    plant->barks_areas = ARENA_ARRAY(arena, float, boughs + 1);
    for (size_t i = 0; i < plant->twigs_count; i++) {
        const struct cone_twig *twig = &plant->twigs[i];
        sum += twig->length_m > 0
                   ? (double)twig->length_m * (double)twig->radius_m
                   : (double)twig->twig->length_m * (double)twig->twig->axis_radius_m;
        plant->twigs_areas[i + 1] = (float)sum;
    }
    sum = 0;
    for (size_t i = 0; i < boughs; i++) {
        const struct cone_bark *bark = &plant->barks[plant->trunks_count + i];
        sum += (double)length_of(bark->from_m, bark->to_m) *
               (double)(bark->radius_m[0] + bark->radius_m[1]);
        plant->barks_areas[i + 1] = (float)sum;
    }
}

static void barks_fill(struct arena *arena, struct cone_plant *plant, struct random *random)
{
    const struct conifer *conifer = plant->conifer;
    const float longest_m = fmaxf(2 * plant->radius_m * PIECE_SHARE, 1e-6f);
    float thickest_m = 0;
    size_t count = 0;
    plant->piece_m = longest_m;
    for (size_t i = 0; i < conifer->branches_count; i++) {
        count += pieces_of(&conifer->branches[i], longest_m);
        thickest_m = fmaxf(thickest_m, conifer->branches[i].radius_from_m);
    }
    plant->barks = ARENA_ARRAY(arena, struct cone_bark, count + 1);
    for (int is_trunk = 1; is_trunk >= 0; is_trunk--) {
        for (size_t i = 0; i < conifer->branches_count; i++) {
            const struct conifer_branch *branch = &conifer->branches[i];
            if ((branch->radius_from_m >= TRUNK_SHARE * thickest_m) != is_trunk)
                continue;
            size_t pieces = pieces_of(branch, longest_m);
            bark_cut(branch, pieces, plant->barks + plant->barks_count);
            plant->barks_count += pieces;
        }
        if (is_trunk)
            plant->trunks_count = plant->barks_count;
    }
    char swap[sizeof(struct cone_bark)];
    deal(plant->barks + plant->trunks_count, plant->barks_count - plant->trunks_count,
         sizeof *plant->barks, random, swap);
}

static void twig_fill(const struct conifer_twig *from, struct cone_twig *twig)
{
    memcpy(twig->base_m, from->base_m, sizeof twig->base_m);
    memcpy(twig->axis, from->axis, sizeof twig->axis);
    conifer_frame(from->axis, twig->across, twig->along);
    twig->cone_0_m = 0.5f * from->spacing_m;
    twig->length_m = (float)from->cones_count * from->spacing_m;
    twig->sine = sinf(from->needle_angle_rad);
    twig->cosine = cosf(from->needle_angle_rad);
    twig->radius_m = fmaxf(from->needle_length_m * twig->sine, from->needle_radius_m);
    twig->twig = from;
}

float cone_twig_reach(const struct cone_twig *twig, float center_m[3])
{
    const struct conifer_twig *from = twig->twig;
    float low = 0, high = fmaxf(from->length_m, twig->length_m), tip = 0;
    if (from->cones_count) {
        tip = from->needle_length_m * twig->cosine;
        low = fminf(low, twig->cone_0_m + tip);
        high = fmaxf(high, twig->length_m - twig->cone_0_m + tip);
    }
    for (int i = 0; i < 3; i++)
        center_m[i] = twig->base_m[i] + 0.5f * (low + high) * twig->axis[i];
    float half = 0.5f * (high - low), radius = twig->radius_m + from->axis_radius_m;
    return sqrtf(half * half + radius * radius);
}

struct cone_plant *cone_plant_create(struct arena *arena, const struct conifer *conifer)
{
    struct cone_plant *plant = ARENA_NEW(arena, struct cone_plant);
    struct random random = random_seed(1, 1);
    float square = 0, wide = 0;
    plant->conifer = conifer;
    for (int i = 0; i < 3; i++) {
        float half = 0.5f * (conifer->maximum_m[i] - conifer->minimum_m[i]);
        plant->center_m[i] = conifer->minimum_m[i] + half;
        square += half * half;
        wide = i == 1 ? wide : fmaxf(wide, 2 * half);
    }
    plant->radius_m = sqrtf(square);
    plant->low_m = conifer->minimum_m[1];
    plant->high_m = conifer->maximum_m[1];
    plant->area_m2 = (plant->high_m - plant->low_m) * wide;
    barks_fill(arena, plant, &random);
    plant->twigs_count = conifer->twigs_count;
    plant->twigs = ARENA_ARRAY(arena, struct cone_twig, plant->twigs_count + 1);
    for (size_t i = 0; i < plant->twigs_count; i++)
        twig_fill(&conifer->twigs[i], &plant->twigs[i]);
    char swap[sizeof(struct cone_twig)];
    deal(plant->twigs, plant->twigs_count, sizeof *plant->twigs, &random, swap);
    for (size_t i = 0; i < plant->twigs_count; i++) {
        plant->twigs[i].first_cone = (uint32_t)plant->cones_count;
        plant->cones_count += plant->twigs[i].twig->cones_count;
    }
    areas_sum(arena, plant);
    return plant;
}
