/* Cells made: trees of a species halved at the median of their longer side, as a k-d tree (Bentley
 * 1975, doi:10.1145/361002.361007), and moments summed from halves to the whole. */
#include "bake/cells_parts.h"

#include <stddef.h>
#include <string.h>

struct item {
    float side_m[2]; /* x, z */
    uint32_t instance;
};

static void swap_items(struct item *a, struct item *b)
{
    struct item kept = *a;
    *a = *b;
    *b = kept;
}

/* Puts the items before `middle` that are no greater than those from it on. Hoare 1961. */
static void split(struct item *items, ptrdiff_t count, ptrdiff_t middle, int axis)
{
    ptrdiff_t low = 0, high = count - 1;
    while (low < high) {
        float pivot = items[middle].side_m[axis];
        ptrdiff_t i = low, j = high;
        do {
            while (items[i].side_m[axis] < pivot)
                i++;
            while (pivot < items[j].side_m[axis])
                j--;
            if (i <= j)
                swap_items(&items[i++], &items[j--]);
        } while (i <= j);
        low = j < middle ? i : low;
        high = middle < i ? j : high;
    }
}

static int longer_axis(const struct item *items, size_t count)
{
    float low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
    for (size_t k = 0; k < count; k++)
        for (int axis = 0; axis < 2; axis++) {
            float side_m = items[k].side_m[axis];
            low[axis] = side_m < low[axis] ? side_m : low[axis];
            high[axis] = side_m > high[axis] ? side_m : high[axis];
        }
    return high[1] - low[1] > high[0] - low[0];
}

/* Moments of single trees, or of the halves: of a mean and a covariance, weighed. */
struct gathered {
    double weight, fourth, foot_m[3], second[6];
};

static void gather(struct gathered *to, double square, double fourth, const float foot_m[3],
                   const float spread_m2[6])
{
    static const int rows[6] = {0, 1, 2, 0, 0, 1}, columns[6] = {0, 1, 2, 1, 2, 2};
    to->weight += square;
    to->fourth += fourth;
    for (int i = 0; i < 3; i++)
        to->foot_m[i] += square * foot_m[i];
    for (int i = 0; i < 6; i++)
        to->second[i] += square * ((double)foot_m[rows[i]] * foot_m[columns[i]] + spread_m2[i]);
}

static void gathered_sums(const struct gathered *from, size_t trees, struct cells_sums *sums)
{
    static const int rows[6] = {0, 1, 2, 0, 0, 1}, columns[6] = {0, 1, 2, 1, 2, 2};
    double weight = from->weight > 0 ? from->weight : 1, foot_m[3];
    for (int i = 0; i < 3; i++) {
        foot_m[i] = from->foot_m[i] / weight;
        sums->foot_m[i] = (float)foot_m[i];
    }
    for (int i = 0; i < 6; i++)
        sums->spread_m2[i] =
            (float)(from->second[i] / weight - foot_m[rows[i]] * foot_m[columns[i]]);
    sums->square = (float)from->weight;
    sums->fourth = (float)from->fourth;
    sums->scale = (float)sqrt(from->weight / (double)trees);
}

static void leaf_fill(struct cells *cells, struct cells_node *node, struct cells_sums *sums,
                      const struct item *items)
{
    static const float none[6] = {0};
    const struct cull_bound *bound = &cells->bounds[node->species];
    struct gathered gathered = {0};
    float low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (uint32_t k = node->begin; k < node->end; k++) {
        const struct instance *tree = &cells->scene->instances[items[k].instance];
        float *sphere = cells->spheres[k];
        cells->instances[k] = items[k].instance;
        memcpy(sphere, tree->position_m, 3 * sizeof *sphere);
        sphere[1] += tree->scale * tree->stretch * bound->center_y_m;
        sphere[3] = instance_reach(tree) * bound->radius_m;
        for (int i = 0; i < 3; i++) {
            low[i] = fminf(low[i], sphere[i]);
            high[i] = fmaxf(high[i], sphere[i]);
        }
        double square = (double)tree->scale * tree->scale;
        gather(&gathered, square, square * square, tree->position_m, none);
    }
    for (int i = 0; i < 3; i++)
        node->center_m[i] = 0.5f * (low[i] + high[i]);
    for (uint32_t k = node->begin; k < node->end; k++) {
        const float *sphere = cells->spheres[k];
        float square = 0;
        for (int i = 0; i < 3; i++)
            square += (sphere[i] - node->center_m[i]) * (sphere[i] - node->center_m[i]);
        node->radius_m = fmaxf(node->radius_m, 1.00001f * (sqrtf(square) + sphere[3]));
    }
    gathered_sums(&gathered, node->end - node->begin, sums);
}

/* The sphere around two spheres. */
static void sphere_around(const struct cells_node *a, const struct cells_node *b,
                          struct cells_node *to)
{
    float way[3], square = 0;
    for (int i = 0; i < 3; i++) {
        way[i] = b->center_m[i] - a->center_m[i];
        square += way[i] * way[i];
    }
    float length_m = sqrtf(square), radius_m = 0.5f * (a->radius_m + b->radius_m + length_m);
    if (radius_m <= a->radius_m || radius_m <= b->radius_m || !(length_m > 0)) {
        const struct cells_node *larger = a->radius_m > b->radius_m ? a : b;
        memcpy(to->center_m, larger->center_m, sizeof to->center_m);
        to->radius_m = larger->radius_m;
        return;
    }
    for (int i = 0; i < 3; i++)
        to->center_m[i] = a->center_m[i] + (radius_m - a->radius_m) / length_m * way[i];
    to->radius_m = 1.00001f * radius_m;
}

/* Trees [begin, end) as a node, its halves after it; returns its number. */
static uint32_t node_build(struct cells *cells, struct item *items, uint32_t species,
                           uint32_t begin, uint32_t end)
{
    uint32_t number = (uint32_t)cells->nodes_count++;
    struct cells_node *node = &cells->nodes[number];
    struct cells_sums *sums = &cells->sums[number];
    *node = (struct cells_node){.begin = begin, .end = end, .species = species};
    sums->species = species;
    if (end - begin <= CELLS_LEAF) {
        leaf_fill(cells, node, sums, items);
        return number;
    }
    uint32_t middle = begin + (end - begin) / 2;
    split(items + begin, (ptrdiff_t)(end - begin), (ptrdiff_t)(middle - begin),
          longer_axis(items + begin, end - begin));
    node_build(cells, items, species, begin, middle);
    node->far = node_build(cells, items, species, middle, end);
    sphere_around(node + 1, &cells->nodes[node->far], node);
    struct gathered gathered = {0};
    for (int half = 0; half < 2; half++) {
        const struct cells_sums *from = half ? &cells->sums[node->far] : sums + 1;
        gather(&gathered, from->square, from->fourth, from->foot_m, from->spread_m2);
    }
    gathered_sums(&gathered, end - begin, sums);
    return number;
}

/* Items species by species; first: species + 1 places. */
static void items_fill(const struct scene *scene, struct item *items, uint32_t *first)
{
    for (size_t i = 0; i < scene->instances_count; i++)
        first[scene->instances[i].species + 1]++;
    for (size_t s = 0; s < scene->species_count; s++)
        first[s + 1] += first[s];
    for (size_t i = 0; i < scene->instances_count; i++) {
        const struct instance *tree = &scene->instances[i];
        items[first[tree->species]++] =
            (struct item){{tree->position_m[0], tree->position_m[2]}, (uint32_t)i};
    }
    memmove(first + 1, first, scene->species_count * sizeof *first); /* each has run on by one */
    first[0] = 0;
}

struct cells *cells_create(struct arena *arena, const struct scene *scene,
                           const struct cull_bound *bounds)
{
    struct cells *cells = ARENA_NEW(arena, struct cells);
    struct arena *passing = arena_create(0);
    size_t count = cells->trees_count = scene->instances_count;
    /* Halves of more than a leaf's trees hold at least half a leaf's. */
    size_t most = 2 * (count / (CELLS_LEAF / 2) + scene->species_count);
    cells->scene = scene;
    cells->bounds = bounds;
    cells->roots = ARENA_ARRAY(arena, uint32_t, scene->species_count);
    cells->nodes = ARENA_ARRAY(arena, struct cells_node, most);
    cells->sums = ARENA_ARRAY(arena, struct cells_sums, most);
    cells->spheres = arena_alloc(arena, count, sizeof *cells->spheres);
    cells->instances = ARENA_ARRAY(arena, uint32_t, count);
    for (int i = 0; i < 2; i++) {
        cells->entries[i] = ARENA_ARRAY(arena, uint32_t, count + most);
        cells->depths_m[i] = ARENA_ARRAY(arena, float, count + most);
        cells->shares[i] = ARENA_ARRAY(arena, uint8_t, count + most);
        cells->order[i] = ARENA_ARRAY(arena, uint32_t, count + most);
    }
    cells->runs = ARENA_ARRAY(arena, struct cells_run, CELLS_RUNS + scene->species_count);
    struct item *items = ARENA_ARRAY(passing, struct item, count);
    uint32_t *first = ARENA_ARRAY(passing, uint32_t, scene->species_count + 1);
    items_fill(scene, items, first);
    for (uint32_t s = 0; s < scene->species_count; s++)
        if (first[s] < first[s + 1])
            cells->roots[cells->roots_count++] =
                node_build(cells, items, s, first[s], first[s + 1]);
    arena_destroy(passing);
    return cells;
}

size_t cells_count(const struct cells *cells)
{
    return cells->nodes_count;
}

const struct cells_sums *cells_sums(const struct cells *cells, uint32_t cell)
{
    return &cells->sums[cell];
}

size_t cells_trees(const struct cells *cells, uint32_t cell, const uint32_t **instances)
{
    *instances = cells->instances + cells->nodes[cell].begin;
    return cells->nodes[cell].end - cells->nodes[cell].begin;
}
