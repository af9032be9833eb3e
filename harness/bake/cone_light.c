/* Light between trees: the map of the forest, and what of the sun each tree gets from it. */
#include "bake/cone_light.h"
#include "bake/cone_light_parts.h"
#include "bake/cull.h"
#include "bake/shadow_light.h"

#include <math.h>
#include <string.h>

enum {
    TURNS = 32,
    TEXELS_MAX = 1 << 21, /* of the map */
    GAINS_MAX = 1 << 21,  /* of all trees */
    SIDE_MAX = 16,
};

struct cone_lights {
    struct arena *arena;
    const struct scene *scene;
    struct cone_plant *const *plants;
    struct cone_kind *kinds; /* TURNS a species */
    size_t kinds_count;
    int side;       /* of a tree's gains */
    uint8_t *gains; /* side x side a tree */
    struct shadow_caster *casters;
    float *keys, *scratch_keys;
    uint32_t *order, *scratch_order;
    struct shadow_light light;
    struct shadow_ground ground;
};

static struct cone_kind *kind_of(const struct cone_lights *lights, const struct instance *instance)
{
    double turns = (double)instance->rotation_rad / (2 * M_PI);
    uint32_t turn = (uint32_t)((turns - floor(turns)) * TURNS + 0.5) % TURNS;
    return &lights->kinds[TURNS * (size_t)instance->species + turn];
}

/* The step's own angle and, in the mean, how far its trees are from it. */
static void kinds_turn(struct cone_lights *lights)
{
    const double step_rad = 2 * M_PI / TURNS;
    for (size_t i = 0; i < lights->scene->instances_count; i++) {
        const struct instance *instance = &lights->scene->instances[i];
        struct cone_kind *kind = kind_of(lights, instance);
        double away_rad =
            (double)instance->rotation_rad - step_rad * (double)((kind - lights->kinds) % TURNS);
        kind->turn_rad += away_rad - 2 * M_PI * rint(away_rad / (2 * M_PI));
        kind->trees++;
    }
    for (size_t k = 0; k < lights->kinds_count; k++) {
        struct cone_kind *kind = &lights->kinds[k];
        kind->species = (uint32_t)(k / TURNS);
        kind->turn_rad = step_rad * (double)(k % TURNS) + kind->turn_rad / fmax(1, kind->trees);
    }
}

struct cone_lights *cone_lights_create(struct arena *arena, const struct scene *scene,
                                       struct cone_plant *const *plants)
{
    struct cone_lights *lights = ARENA_NEW(arena, struct cone_lights);
    const size_t count = scene->instances_count;
    *lights = (struct cone_lights){.arena = arena,
                                   .scene = scene,
                                   .plants = plants,
                                   .kinds_count = TURNS * scene->species_count,
                                   .side = SIDE_MAX};
    while (lights->side > 2 && count * (size_t)(lights->side * lights->side) > GAINS_MAX)
        lights->side /= 2;
    lights->kinds = ARENA_ARRAY(arena, struct cone_kind, lights->kinds_count);
    kinds_turn(lights);
    lights->gains = ARENA_ARRAY(arena, uint8_t, count * (size_t)(lights->side * lights->side));
    lights->casters = ARENA_ARRAY(arena, struct shadow_caster, count);
    lights->keys = ARENA_ARRAY(arena, float, 2 * count);
    lights->scratch_keys = lights->keys + count;
    lights->order = ARENA_ARRAY(arena, uint32_t, 2 * count);
    lights->scratch_order = lights->order + count;
    shadow_light_create(arena, &scene->terrain, &lights->light);
    return lights;
}

/* R_y(-turn) of a vector of the world. */
static void to_plant(double turn_rad, const float world[3], float plant[3])
{
    float c = cosf((float)turn_rad), s = sinf((float)turn_rad);
    plant[0] = world[0] * c - world[2] * s;
    plant[1] = world[1];
    plant[2] = world[0] * s + world[2] * c;
}

static struct shadow_caster caster_of(const struct cone_lights *lights, size_t tree)
{
    const struct instance *instance = &lights->scene->instances[tree];
    struct shadow_caster caster = {.scale = instance->scale,
                                   .volume = &kind_of(lights, instance)->volume};
    shadow_along(&lights->light.frame, instance->position_m, caster.place_m);
    return caster;
}

static void map_build(struct cone_lights *lights, int threads)
{
    const size_t count = lights->scene->instances_count;
    float texel_m = INFINITY;
    for (size_t i = 0; i < count; i++) {
        struct shadow_caster caster = caster_of(lights, i);
        lights->keys[i] = caster.place_m[2];
        lights->order[i] = (uint32_t)i;
        texel_m = fminf(texel_m, caster.scale * caster.volume->cell_m);
    }
    cull_sort(lights->keys, lights->order, lights->scratch_keys, lights->scratch_order, count,
              false);
    for (size_t i = 0; i < count; i++)
        lights->casters[i] = caster_of(lights, lights->order[i]);
    shadow_map_fill(lights->arena, &lights->light.map, lights->casters, count, TEXELS_MAX, texel_m,
                    threads);
}

void cone_lights_shade_ground(const struct cone_lights *lights, const struct shadow_pixel *pixel,
                              float sun, float rgb[3])
{
    shadow_ground_shade(&lights->ground, &lights->light, pixel, sun, lights->scene->sun.radiance,
                        rgb);
}

static void kinds_build(struct cone_lights *lights, int threads)
{
    for (size_t k = 0; k < lights->kinds_count; k++) {
        struct cone_kind *kind = &lights->kinds[k];
        struct shadow_axes frame;
        for (int i = 0; i < 3; i++)
            to_plant(kind->turn_rad, lights->light.frame.axes[i], frame.axes[i]);
        if (kind->trees)
            cone_kind_lay(lights->arena, lights->plants[kind->species], &frame, kind);
    }
#pragma omp parallel for num_threads(threads) schedule(dynamic, 1)
    for (size_t k = 0; k < lights->kinds_count; k++)
        if (lights->kinds[k].trees)
            cone_kind_sweep(lights->plants[lights->kinds[k].species], &lights->kinds[k]);
}

void cone_lights_turn(struct cone_lights *lights, const float sun_direction[3], int threads)
{
    const size_t count = lights->scene->instances_count;
    if (!shadow_light_turn(&lights->light, sun_direction))
        return;
    kinds_build(lights, threads);
    map_build(lights, threads);
    shadow_ground_fill(lights->arena, &lights->ground, &lights->light, threads);
#pragma omp parallel for num_threads(threads) schedule(static, 64)
    for (size_t i = 0; i < count; i++) {
        const struct shadow_caster caster = caster_of(lights, i);
        shadow_light_gains(&lights->light, &caster, lights->side,
                           lights->gains + i * (size_t)(lights->side * lights->side));
    }
}

void cone_lights_of_tree(const struct cone_lights *lights, size_t tree,
                         struct cone_tree_light *light)
{
    const struct cone_kind *kind = kind_of(lights, &lights->scene->instances[tree]);
    const struct shadow_volume *volume = &kind->volume;
    light->cones = kind->cones;
    light->barks = kind->barks;
    light->side = lights->side;
    light->gains = lights->gains + tree * (size_t)(lights->side * lights->side);
    for (int k = 0; k < 2; k++) {
        float per_m = (float)(lights->side - 1) / (volume->cell_m * (float)volume->size[k]);
        for (int i = 0; i < 3; i++)
            light->to_gains[k][i] = per_m * volume->frame.axes[k][i];
        light->to_gains[k][3] = -per_m * volume->low_m[k];
    }
}

float cone_tree_light_gain(const struct cone_tree_light *light, const float place_m[3])
{
    int low[2];
    float share[2];
    for (int k = 0; k < 2; k++) {
        const float *row = light->to_gains[k];
        float at = row[0] * place_m[0] + row[1] * place_m[1] + row[2] * place_m[2] + row[3];
        at = fminf(fmaxf(at, 0), (float)(light->side - 1) - 1e-3f);
        low[k] = (int)at;
        share[k] = at - (float)low[k];
    }
    const uint8_t *row = light->gains + low[1] * light->side + low[0], *next = row + light->side;
    float near = (float)row[0] + share[0] * (float)(row[1] - row[0]);
    float far = (float)next[0] + share[0] * (float)(next[1] - next[0]);
    return (near + share[1] * (far - near)) / 255;
}
