/* Sun shadows of the march: what is built when the sun has moved, and what a tree is given of it.
 */
#include "bake/march_shadow_parts.h"
#include "bake/shadow_ground.h"

#include <math.h>
#include <string.h>

/* Light falls from another side on a tree that is turned: a volume for each step. */
enum { TURNS = 32 };

/* A species turned by a step, if a tree stands so or is looked at so from afar. */
struct kind {
    uint32_t species, trees;
    bool is_wanted;
    double turn_rad, stretch; /* means of its trees */
    float cell_m, leaf_m;
    struct shadow_volume volume;
};

struct march_shadows {
    struct arena *arena;
    const struct scene *scene;
    const struct march_tree *trees;
    const struct march_species *species;
    enum march_model model;
    struct kind *kinds; /* TURNS a species */
    size_t kinds_count;
    float least_cell_m;
    int side;       /* of a tree's gains */
    uint8_t *gains; /* of each tree side x side: light that reaches its side of the sun, 0..255 */
    uint8_t *unshaded;               /* side x side: all of it */
    struct shadow_means *means;      /* of each tree's gains */
    const struct cells *cells;       /* NULL: none */
    struct shadow_means *cell_means; /* of a cell's trees, weighted by what they hide */
    struct shadow_caster *casters;   /* by depth */
    float *keys, *scratch_keys;
    uint32_t *order, *scratch_order;
    struct shadow_light light;
    struct shadow_ground ground;
};

enum {
    TEXELS_MAX = 1 << 21, /* of the map */
    GAINS_MAX = 1 << 21,  /* of all trees */
    SIDE_MAX = 16,
    PASSES_MAX = 1 << 27, /* cells of all volumes, about */
};

static struct kind *kind_of(const struct march_shadows *shadows, const struct march_tree *tree)
{
    float turns = atan2f(tree->sine, tree->cosine) / 6.2831853f + 1;
    uint32_t turn = (uint32_t)(turns * TURNS + 0.5f) % TURNS;
    return &shadows->kinds[TURNS * (size_t)tree->species + turn];
}

/* The step's own angle and, in the mean, how far its trees are from it. From afar plants are looked
 * at in MARCH_TURNS steps. */
static void kinds_turn(struct march_shadows *shadows)
{
    const double step_rad = 2 * M_PI / TURNS;
    for (size_t i = 0; i < shadows->scene->instances_count; i++) {
        const struct march_tree *tree = &shadows->trees[i];
        struct kind *kind = kind_of(shadows, tree);
        double away_rad = (double)shadows->scene->instances[i].rotation_rad -
                          step_rad * (double)((kind - shadows->kinds) % TURNS);
        kind->turn_rad += away_rad - 2 * M_PI * rint(away_rad / (2 * M_PI));
        kind->stretch += (double)tree->stretch;
        kind->trees++;
        kind->is_wanted = true;
        shadows->kinds[TURNS * (size_t)tree->species + tree->turn * (TURNS / MARCH_TURNS)]
            .is_wanted = true;
    }
    for (size_t k = 0; k < shadows->kinds_count; k++) {
        struct kind *kind = &shadows->kinds[k];
        kind->turn_rad = step_rad * (double)(k % TURNS) + kind->turn_rad / fmax(1, kind->trees);
        kind->stretch = kind->trees ? kind->stretch / kind->trees : 1;
    }
}

/* Cells as large as a level's voxels, the least that are not smaller than asked for; larger ones
 * where many species would need too many. */
static void kinds_refine(struct march_shadows *shadows, float coarsening)
{
    double cells[VOXELS_LEVELS_MAX] = {0};
    uint32_t more = 0;
    for (size_t k = 0; k < shadows->kinds_count; k++) {
        struct kind *kind = &shadows->kinds[k];
        const struct voxels *voxels = shadows->species[k / TURNS].voxels;
        kind->species = (uint32_t)(k / TURNS);
        for (uint32_t l = 0; l < voxels->levels_count && kind->is_wanted; l++)
            cells[l] += 4.0 * voxels->levels[l].size[0] * voxels->levels[l].size[1] *
                        voxels->levels[l].size[2];
    }
    uint32_t level = coarsening > 1 ? (uint32_t)ceilf(log2f(coarsening) - 1e-3f) : 0;
    while (level + more + 1 < VOXELS_LEVELS_MAX && cells[level + more] > PASSES_MAX)
        more++;
    level += more;
    shadows->least_cell_m = INFINITY;
    for (size_t k = 0; k < shadows->kinds_count; k++) {
        struct kind *kind = &shadows->kinds[k];
        const struct voxels *voxels = shadows->species[kind->species].voxels;
        uint32_t last = voxels->levels_count - 1;
        kind->cell_m = voxels->levels[level < last ? level : last].voxel_m;
        if (kind->is_wanted)
            shadows->least_cell_m = fminf(shadows->least_cell_m, kind->cell_m);
    }
}

/* The side of a square as large as a leaf of the mesh in the mean; 0: it has none. */
static float leaf_side(const struct mesh *mesh)
{
    double area_m2 = 0, leaves = 0;
    for (size_t p = 0; p < mesh->parts_count; p++) {
        const struct mesh_part *part = &mesh->parts[p];
        if (mesh->materials[part->material].kind != MATERIAL_LEAF)
            continue;
        leaves += part->elements_count;
        for (uint32_t t = 0; t < part->triangles_count; t++)
            area_m2 += mesh_triangle_area(mesh, part->first_triangle + t);
    }
    return leaves > 0 ? (float)sqrt(area_m2 / leaves) : 0;
}

static int side_of(size_t trees)
{
    int side = SIDE_MAX;
    while (side > 2 && trees * (size_t)(side * side) > GAINS_MAX)
        side /= 2;
    return side;
}

enum status march_shadows_create(struct workspace *workspace, const struct scene *scene,
                                 const struct march_options *options,
                                 const struct march_species *species,
                                 const struct march_tree *trees, const struct cells *cells,
                                 struct march_shadows **result)
{
    struct arena *arena = workspace->arena;
    struct march_shadows *shadows = *result = ARENA_NEW(arena, struct march_shadows);
    const size_t count = scene->instances_count;
    const int side = side_of(count);
    const size_t gains = (size_t)(side * side);
    *shadows = (struct march_shadows){.arena = arena,
                                      .scene = scene,
                                      .trees = trees,
                                      .cells = cells,
                                      .species = species,
                                      .model = options->model,
                                      .side = side};
    shadows->kinds_count = TURNS * scene->species_count;
    shadows->kinds = ARENA_ARRAY(arena, struct kind, shadows->kinds_count);
    for (size_t i = 0; i < scene->species_count; i++) {
        const struct mesh *mesh;
        enum status status = plant_mesh(scene->species[i].plant, &mesh, workspace->error);
        if (status)
            return status;
        const float leaf_m = leaf_side(mesh);
        for (size_t turn = 0; turn < TURNS; turn++)
            shadows->kinds[TURNS * i + turn].leaf_m = leaf_m;
    }
    kinds_turn(shadows);
    kinds_refine(shadows, (float)options->resolution / (float)options->shadow_resolution);
    shadows->gains = ARENA_ARRAY(arena, uint8_t, count * gains + 4);
    shadows->unshaded = ARENA_ARRAY(arena, uint8_t, gains + 4);
    memset(shadows->unshaded, 255, gains + 4);
    shadows->means = ARENA_ARRAY(arena, struct shadow_means, count);
    shadows->cell_means = ARENA_ARRAY(arena, struct shadow_means, cells ? cells_count(cells) : 0);
    shadows->casters = ARENA_ARRAY(arena, struct shadow_caster, count);
    shadows->keys = ARENA_ARRAY(arena, float, 2 * count);
    shadows->scratch_keys = shadows->keys + count;
    shadows->order = ARENA_ARRAY(arena, uint32_t, 2 * count);
    shadows->scratch_order = shadows->order + count;
    shadow_light_create(arena, &scene->terrain, &shadows->light);
    return STATUS_OK;
}

static void volumes_build(struct march_shadows *shadows, int threads)
{
    for (size_t k = 0; k < shadows->kinds_count; k++) {
        struct kind *kind = &shadows->kinds[k];
        const struct march_tree turned = {.cosine = cosf((float)kind->turn_rad),
                                          .sine = sinf((float)kind->turn_rad),
                                          .stretch = 1};
        struct shadow_axes frame;
        for (int i = 0; i < 3; i++)
            march_to_plant(&turned, shadows->light.frame.axes[i], 1, frame.axes[i]);
        if (kind->is_wanted)
            shadow_volume_size(shadows->arena, shadows->species[kind->species].voxels, &frame,
                               (float)kind->stretch, kind->cell_m, &kind->volume);
    }
#pragma omp parallel for num_threads(threads) schedule(dynamic, 1)
    for (size_t k = 0; k < shadows->kinds_count; k++)
        if (shadows->kinds[k].is_wanted)
            shadow_volume_sweep(shadows->species[shadows->kinds[k].species].voxels, shadows->model,
                                &shadows->kinds[k].volume);
}

static struct shadow_caster caster_of(const struct march_shadows *shadows,
                                      const struct march_tree *tree)
{
    struct shadow_caster caster = {.scale = tree->scale, .volume = &kind_of(shadows, tree)->volume};
    shadow_along(&shadows->light.frame, tree->position_m, caster.place_m);
    return caster;
}

static void map_build(struct march_shadows *shadows, int threads)
{
    const size_t count = shadows->scene->instances_count;
    float least_scale = INFINITY;
    for (size_t i = 0; i < count; i++) {
        shadows->keys[i] = caster_of(shadows, &shadows->trees[i]).place_m[2];
        shadows->order[i] = (uint32_t)i;
        least_scale = fminf(least_scale, shadows->trees[i].scale);
    }
    cull_sort(shadows->keys, shadows->order, shadows->scratch_keys, shadows->scratch_order, count,
              false);
    for (size_t i = 0; i < count; i++)
        shadows->casters[i] = caster_of(shadows, &shadows->trees[shadows->order[i]]);
    shadow_map_fill(shadows->arena, &shadows->light.map, shadows->casters, count, TEXELS_MAX,
                    least_scale * shadows->least_cell_m, threads);
}

static struct shadow_means means_of_cell(const struct march_shadows *shadows, uint32_t cell)
{
    const uint32_t *instances;
    size_t count = cells_trees(shadows->cells, cell, &instances);
    double all = 0, seen = 0, squares = 0;
    for (size_t i = 0; i < count; i++) {
        const struct shadow_means *means = &shadows->means[instances[i]];
        double scale = (double)shadows->trees[instances[i]].scale;
        all += scale * scale * (double)means->all;
        seen += scale * scale * (double)means->seen;
        squares += scale * scale;
    }
    return squares > 0 ? (struct shadow_means){(float)(all / squares), (float)(seen / squares)}
                       : (struct shadow_means){1, 1};
}

bool march_shadows_light(struct march_shadows *shadows, const float sun_direction[3], int threads)
{
    const size_t count = shadows->scene->instances_count;
    if (!shadow_light_turn(&shadows->light, sun_direction))
        return false;
    volumes_build(shadows, threads);
    map_build(shadows, threads);
    shadow_ground_fill(shadows->arena, &shadows->ground, &shadows->light, threads);
#pragma omp parallel for num_threads(threads) schedule(static, 64)
    for (size_t i = 0; i < count; i++) {
        const struct shadow_caster caster = caster_of(shadows, &shadows->trees[i]);
        shadows->means[i] =
            shadow_light_gains(&shadows->light, &caster, shadows->side,
                               shadows->gains + i * (size_t)(shadows->side * shadows->side));
    }
    const size_t cells = shadows->cells ? cells_count(shadows->cells) : 0;
#pragma omp parallel for num_threads(threads) schedule(dynamic, 64)
    for (size_t cell = 0; cell < cells; cell++)
        shadows->cell_means[cell] = means_of_cell(shadows, (uint32_t)cell);
    return true;
}

size_t march_shadows_kinds(const struct march_shadows *shadows)
{
    return shadows->kinds_count;
}

uint32_t march_shadows_kind(const struct march_shadows *shadows, const struct march_tree *tree)
{
    return (uint32_t)(kind_of(shadows, tree) - shadows->kinds);
}

const struct shadow_volume *march_shadows_volume(const struct march_shadows *shadows, size_t kind)
{
    return shadows->kinds[kind].is_wanted ? &shadows->kinds[kind].volume : NULL;
}

const uint8_t *march_shadows_gains(const struct march_shadows *shadows, int *side)
{
    *side = shadows->side;
    return shadows->gains;
}

const struct shadow_light *march_shadows_sun(const struct march_shadows *shadows)
{
    return &shadows->light;
}

const struct shadow_ground *march_shadows_ground(const struct march_shadows *shadows)
{
    return &shadows->ground;
}

void march_shadows_to_cells(const struct march_shadows *shadows, size_t number, uint32_t level,
                            float to_cells[3][4])
{
    /* A leaf or a wall of bark lies across cells, where it would shade itself: light is taken so
     * far before it. Measured: what is seen of coarse voxels lies deeper than a ray's sample by
     * about so much of their side. */
    static const float before_leaves = 0.5f, deeper_voxels = 0.25f;
    const struct kind *kind = &shadows->kinds[number];
    const struct voxels *voxels = shadows->species[kind->species].voxels;
    const struct shadow_volume *volume = &kind->volume;
    const float per_m = 1 / volume->cell_m, voxel_m = voxels->levels[level].voxel_m;
    const float later_m = deeper_voxels * voxel_m - before_leaves * kind->leaf_m;
    for (int k = 0; k < 3; k++) {
        const float *axis = volume->frame.axes[k];
        to_cells[k][3] = ((k == 2 ? later_m : 0) - volume->low_m[k]) * per_m;
        for (int i = 0; i < 3; i++) {
            to_cells[k][i] = axis[i] * voxel_m * per_m;
            to_cells[k][3] += axis[i] * voxels->origin_m[i] * per_m;
        }
    }
}

void march_shadows_fill(const struct march_shadows *shadows, const struct march_tree *tree,
                        uint32_t level, struct march_job *job)
{
    const uint32_t kind = march_shadows_kind(shadows, tree);
    const struct shadow_volume *volume = &shadows->kinds[kind].volume;
    struct march_sun *light = &job->light;
    march_shadows_to_cells(shadows, kind, level, light->to_cells);
    memcpy(light->size, volume->size, sizeof light->size);
    light->bark_cells = march_shadows_bark_cells;
    light->passes = volume->passes;
    light->side = shadows->side;
    for (int k = 0; k < 2; k++)
        light->to_gains[k] = (float)(shadows->side - 1) / (float)volume->size[k];
    light->gains = tree->alone ? shadows->unshaded
                               : shadows->gains + (size_t)(tree - shadows->trees) *
                                                      (size_t)(shadows->side * shadows->side);
}

/* Of ways through a layer of crowns, those that rise by a sine s pass 1 / s as many as upright
 * ones: where g of the sun comes through, g to the power of the sun's sine over the eye's is in
 * sight. So weighted, a tree's mean goes from the plain one (0) to what the sun sees (1). */
static float mean_seen(const struct shadow_means *means, float sun_rise, float rise)
{
    float power = fminf(fmaxf(sun_rise, 0) / fmaxf(fabsf(rise), 1e-3f), 1);
    return means->all + power * (means->seen - means->all);
}

float march_shadows_of_tree(const struct march_shadows *shadows, uint32_t tree, float rise)
{
    return mean_seen(&shadows->means[tree], shadows->light.sun_direction[1], rise);
}

float march_shadows_of_cell(const struct march_shadows *shadows, uint32_t cell, float rise)
{
    return mean_seen(&shadows->cell_means[cell], shadows->light.sun_direction[1], rise);
}

void march_shadows_shade_ground(const struct march_shadows *shadows,
                                const struct shadow_pixel *pixel, float sun, float rgb[3])
{
    shadow_ground_shade(&shadows->ground, &shadows->light, pixel, sun, shadows->scene->sun.radiance,
                        rgb);
}
