/* Which representation of a plant stands at which distance. */
#include "bake/levels.h"
#include "bake/cover.h"
#include "bake/stout.h"
#include "base/file.h"
#include "base/hash.h"

#include <math.h>
#include <string.h>

/* Twigs are thinner than a pixel long before they may be left out: bark moves by this share of a
 * tolerance. */
static const float BARK_SHARE = 0.125f;
/* Stems of this mean width, in tolerances, are still drawn whole: their feet are twice as wide. */
static const float STOUT_WIDTH = 0.7f;

/* Elements that are looked at to find a step's cover, and how well it is matched. */
enum { RUN_ELEMENTS = 4096, MATCH_ROUNDS = 4 };
static const double MATCH_ERROR = 0.005, SIZE_LEAST = 0.1, SIZE_MOST = 1.5;

/* Where the shrinking end of a run is summed element by element. */
enum { EXACT_ELEMENTS = 16 };

/* How many elements of full size a run is as large as, where its last share, taper, shrinks
 * linearly: the sum of the squared sizes, of many their integral. */
static float run_area(float kept, float taper)
{
    if (kept > EXACT_ELEMENTS || taper <= 0)
        return kept * (1 - taper * 2 / 3);
    float sum = 0, slope = 1 / (taper * kept);
    int count = (int)ceilf(kept - 0.5f);
    for (int i = 0; i < count; i++) {
        float size = fminf((kept - 0.5f - (float)i) * slope, 1);
        sum += size * size;
    }
    return sum;
}

/* What keeps the area. */
static float growth_of(const struct levels *levels, float kept, float taper)
{
    return sqrtf((float)levels->elements / run_area(kept, taper));
}

uint32_t levels_begin(const struct levels *levels, uint32_t run)
{
    return (uint32_t)((uint64_t)run * levels->elements / LEVELS_RUNS);
}

static void fill_steps(struct levels *levels, const struct prune *prune)
{
    levels->elements = (uint32_t)prune->count;
    levels->area_m2 = (float)prune->area_m2;
    double left = (double)prune->count;
    while (levels->steps_count < LEVELS_STEPS_MAX && left >= 1) {
        levels->step_elements[levels->steps_count++] = (uint32_t)ceil(left);
        if (left <= 2)
            break;
        left = fmax(2, left * 0.70710678118654752);
    }
}

static uint32_t bark_level(const struct levels *levels, float per_m)
{
    uint32_t level = 0;
    while (level + 1 < levels->levels_count && levels->errors_m[level + 1] * per_m <= BARK_SHARE)
        level++;
    return level;
}

/* The bark of each step of pruning: what is no dot yet is drawn whole. */
static void choose_bark(struct levels *levels)
{
    for (uint32_t step = 0; step < levels->steps_count; step++) {
        float per_m = sqrtf((float)levels->step_elements[step] / levels->area_m2);
        levels->step_bark[step] = bark_level(levels, per_m);
        levels->step_stout[step] = stout_pack(STOUT_WIDTH / per_m);
    }
}

/* Square metres that a step's runs cover at a size, the mean of so many runs that chance averages
 * out. */
static double step_cover(struct cover *cover, const struct levels *levels,
                         const struct prune *prune, uint32_t step, float taper, float size)
{
    float kept = (float)levels->step_elements[step];
    uint32_t wanted = RUN_ELEMENTS / levels->step_elements[step];
    uint32_t runs = wanted < 1 ? 1 : wanted > LEVELS_RUNS ? LEVELS_RUNS : wanted;
    double sum = 0;
    for (uint32_t r = 0; r < runs; r++) {
        struct cover_run run = {.prune = prune,
                                .begin = levels_begin(levels, r * LEVELS_RUNS / runs),
                                .kept = kept,
                                .growth = size * growth_of(levels, kept, taper),
                                .taper = taper,
                                .bark = levels->step_bark[step],
                                .stout = levels->step_stout[step]};
        sum += cover_of_run(cover, &run);
    }
    return sum / runs;
}

/* The longest way from an element's centre to a corner. */
static float element_reach(const struct prune *prune)
{
    float most2 = 0;
    for (size_t i = 0; i < 3 * prune->count; i++) {
        const struct prune_vertex *corner = &prune->vertices[i];
        float reach2 = 0;
        for (int axis = 0; axis < 3; axis++) {
            float way = corner->position_m[axis] - corner->center_m[axis];
            reach2 += way * way;
        }
        most2 = fmaxf(most2, reach2);
    }
    return sqrtf(most2);
}

/* The logarithm of the size at which a step's runs cover so much: secants through the logarithms
 * of size and cover. first: where to begin, and what is left where nothing is covered. */
static double match_step(struct cover *cover, const struct levels *levels,
                         const struct prune *prune, uint32_t step, float taper, double wanted,
                         double first)
{
    double at[2] = {first, first}, off[2] = {0, 0};
    for (int round = 0; round < MATCH_ROUNDS; round++) {
        double slope = 1; /* between cover of single leaves, 2, and of a closed crown, 0 */
        if (round > 1 && fabs(at[1] - at[0]) > 1e-6)
            slope = fmin(fmax((off[1] - off[0]) / (at[1] - at[0]), 0.3), 2);
        double next = round ? at[1] - off[1] / slope : first;
        at[0] = at[1];
        off[0] = off[1];
        at[1] = fmin(fmax(next, log(SIZE_LEAST)), log(SIZE_MOST));
        off[1] = log(step_cover(cover, levels, prune, step, taper, (float)exp(at[1]))) - wanted;
        if (!isfinite(off[1]))
            return first;
        if (fabs(off[1]) < MATCH_ERROR)
            break;
    }
    return at[1];
}

static uint64_t match_key(const struct detail *detail, const struct prune *prune, float taper)
{
    const char version[] = "cover 1"; /* of how sizes are found */
    uint64_t key = hash_bytes(0, version, sizeof version);
    key = hash_bytes(key, &taper, sizeof taper);
    key = hash_bytes(key, prune->vertices, 3 * prune->count * sizeof *prune->vertices);
    key = hash_bytes(key, detail->vertices, detail->vertices_count * sizeof *detail->vertices);
    return hash_bytes(key, detail->indices, detail->indices_count * sizeof *detail->indices);
}

/* The size of each step's elements at which they cover what the plant covers, by elevation: a
 * crown's leaves hide each other more from one side than from another, single ones do not. */
static void match_cover(struct levels *levels, const struct mesh *mesh, const struct detail *detail,
                        const struct prune *prune, float taper)
{
    struct arena *passing = arena_create(0);
    uint64_t key = match_key(detail, prune, taper);
    void *cached;
    size_t size;
    if (cache_get(passing, "cover", key, &cached, &size) && size == sizeof levels->step_size4) {
        memcpy(levels->step_size4, cached, size);
        arena_destroy(passing);
        return;
    }
    struct cover *covers[LEVELS_RISES];
    for (int rise = 0; rise < LEVELS_RISES; rise++)
        covers[rise] = cover_create(passing, mesh, detail);
    float reach_m = element_reach(prune);
#pragma omp parallel for schedule(dynamic)
    for (int rise = 0; rise < LEVELS_RISES; rise++) {
        struct cover *cover = covers[rise];
        float elevation_rad = asinf(sqrtf((float)rise / (LEVELS_RISES - 1)));
        cover_look(cover, elevation_rad, 0);
        double wanted = log(cover_plant(cover)), size_log = 0;
        for (uint32_t step = 0; step < levels->steps_count; step++) {
            float growth = growth_of(levels, (float)levels->step_elements[step], taper);
            cover_look(cover, elevation_rad, fmaxf(0, growth - 1) * reach_m);
            if (isfinite(wanted))
                size_log = match_step(cover, levels, prune, step, taper, wanted, size_log);
            levels->step_size4[step][rise] = (float)exp(4 * size_log);
        }
    }
    cache_put("cover", key, levels->step_size4, sizeof levels->step_size4);
    arena_destroy(passing);
}

void levels_fill(struct levels *levels, const struct mesh *mesh, const struct detail *detail,
                 const struct prune *prune, float taper)
{
    *levels = (struct levels){.bound = cull_bound_of(mesh),
                              .low_m = mesh->minimum_m[1],
                              .high_m = mesh->maximum_m[1],
                              .radius_m = mesh->radius_m,
                              .levels_count = detail->levels_count};
    memcpy(levels->errors_m, detail->errors_m, sizeof levels->errors_m);
    memcpy(levels->level_triangles, detail->triangles_count, sizeof levels->level_triangles);
    if (prune && prune->count > 0) {
        fill_steps(levels, prune);
        choose_bark(levels);
        match_cover(levels, mesh, detail, prune, taper);
    }
}

struct levels_seen levels_seen(const struct levels *levels, const struct view *view, float focal_px,
                               float tolerance_px, const struct instance *instance, float depth_m)
{
    float slope = fabsf(view->forward[1]), half_m = 0.5f * (levels->high_m - levels->low_m);
    float reach_m =
        half_m * instance->stretch * slope + levels->radius_m * sqrtf(fmaxf(0, 1 - slope * slope));
    float near_m = fmaxf(view->near_m, depth_m - instance->scale * reach_m);
    const float *foot = instance->position_m, *eye = view->eye_m;
    float x = foot[0] - eye[0], z = foot[2] - eye[2];
    /* the elevation in the plant: what is hidden there behind what is hidden in the stretched tree
     */
    float y = foot[1] + instance->scale * instance->stretch * (levels->low_m + half_m) - eye[1];
    y /= instance->stretch;
    return (struct levels_seen){.per_m =
                                    focal_px * instance_reach(instance) / (near_m * tolerance_px),
                                .rise = y * y / fmaxf(x * x + y * y + z * z, 1e-30f)};
}

struct levels_choice levels_choose(const struct levels *levels, float per_m)
{
    struct levels_choice choice = {bark_level(levels, per_m), -1};
    double wanted = (double)levels->area_m2 * per_m * per_m;
    if (!levels->elements || wanted > levels->elements ||
        wanted >= (double)levels->level_triangles[choice.level])
        return choice;
    choice.step = 0;
    if (wanted > 0)
        choice.step =
            (int)fmin(fmax(2 * log2(levels->elements / wanted), 0), levels->steps_count - 1);
    while (choice.step > 0 && levels->step_elements[choice.step] < wanted)
        choice.step--;
    return choice;
}

/* The size factor of a step. Its fourth power, the square of a cover, is linear in the rise where
 * the crown is a spheroid. */
static float size_of_step(const struct levels *levels, int step, float rise)
{
    float at = rise * (LEVELS_RISES - 1);
    int low = (int)fminf(at, LEVELS_RISES - 2);
    const float *sizes = levels->step_size4[step] + low;
    return sqrtf(sqrtf(sizes[0] + (at - (float)low) * (sizes[1] - sizes[0])));
}

/* The size factor at a number of elements, between the steps' by the logarithm. */
static float size_at(const struct levels *levels, int step, float kept, float rise)
{
    float most = (float)levels->step_elements[step], size = size_of_step(levels, step, rise);
    if (step + 1 >= (int)levels->steps_count || kept >= most)
        return size;
    float next = (float)levels->step_elements[step + 1];
    float share = fminf(logf(most / kept) / logf(most / next), 1);
    return size + share * (size_of_step(levels, step + 1, rise) - size);
}

struct levels_run levels_run_of(const struct levels *levels, int step,
                                const struct levels_seen *seen, float taper)
{
    float most = (float)levels->step_elements[step], kept = most;
    if (taper > 0)
        kept = fminf(most, fmaxf(levels->area_m2 * seen->per_m * seen->per_m, fminf(2, most)));
    float growth = growth_of(levels, kept, taper);
    return (struct levels_run){kept, growth * size_at(levels, step, kept, seen->rise)};
}
