/* Cells of trees that stand near each other: squares of the ground, cut until few trees are in each
 * (the leaves of a quadtree). Not those of cells.h: these hold trees of all species, so that a cell
 * is drawn whole, its trees in the order of its memory, without a list of trees made and sorted a
 * picture; those are of one species, whose moments stand for their trees. */
#include "bake/distant_parts.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Trees of a cell; cells as deep as bits of a place allow. */
enum { CELL_TREES = 64, PLACE_BITS = 16 };

/* Bits of x and z in turn: places near each other have numbers near each other (Morton 1966). */
static uint32_t morton(uint32_t x, uint32_t z)
{
    uint32_t code = 0;
    for (int bit = 0; bit < PLACE_BITS; bit++)
        code |= (x >> bit & 1) << (2 * bit) | (z >> bit & 1) << (2 * bit + 1);
    return code;
}

struct placed {
    uint32_t code, instance;
};

static int compare_placed(const void *a, const void *b)
{
    const struct placed *first = a, *second = b;
    if (first->code != second->code)
        return first->code < second->code ? -1 : 1;
    return first->instance < second->instance ? -1 : first->instance > second->instance;
}

static void sort_by_place(const struct scene *scene, struct placed *placed)
{
    float low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
    for (size_t i = 0; i < scene->instances_count; i++)
        for (int k = 0; k < 2; k++) {
            low[k] = fminf(low[k], scene->instances[i].position_m[2 * k]);
            high[k] = fmaxf(high[k], scene->instances[i].position_m[2 * k]);
        }
    float side = fmaxf(fmaxf(high[0] - low[0], high[1] - low[1]), 1e-12f);
    float per_m = (float)((1 << PLACE_BITS) - 1) / side;
    for (size_t i = 0; i < scene->instances_count; i++) {
        uint32_t at[2];
        for (int k = 0; k < 2; k++)
            at[k] = (uint32_t)((scene->instances[i].position_m[2 * k] - low[k]) * per_m);
        placed[i] = (struct placed){morton(at[0], at[1]), (uint32_t)i};
    }
    qsort(placed, scene->instances_count, sizeof *placed, compare_placed);
}

static struct distant_tree tree_of(const struct instance *instance)
{
    double turns = instance->rotation_rad / (2 * M_PI);
    long step = lround((turns - floor(turns)) * DISTANT_STEPS) % DISTANT_STEPS;
    return (struct distant_tree){
        .position_m = {instance->position_m[0], instance->position_m[1], instance->position_m[2]},
        .scale = instance->scale,
        .species = (uint16_t)instance->species,
        .step = (uint8_t)step};
}

/* The sphere around the middle of the box of a cell's feet; reach_m: of any tree from its foot. */
static void cell_bound(const struct distant_tree *trees, struct distant_cell *cell, float reach_m)
{
    float low[3], high[3], square = 0;
    for (int k = 0; k < 3; k++) {
        low[k] = high[k] = trees[cell->first].position_m[k];
        for (uint32_t i = cell->first; i < cell->first + cell->count; i++) {
            low[k] = fminf(low[k], trees[i].position_m[k]);
            high[k] = fmaxf(high[k], trees[i].position_m[k]);
        }
        cell->middle_m[k] = 0.5f * (low[k] + high[k]);
        square += 0.25f * (high[k] - low[k]) * (high[k] - low[k]);
    }
    cell->radius_m = sqrtf(square) + reach_m;
}

/* Cuts trees [first, first + count) where the highest bit in which their places differ changes. */
static void cells_cut(struct distant_cells *cells, const struct placed *placed, uint32_t first,
                      uint32_t count)
{
    if (count > CELL_TREES && placed[first].code != placed[first + count - 1].code) {
        uint32_t differ = placed[first].code ^ placed[first + count - 1].code, bit = 1u << 31;
        while (!(differ & bit))
            bit >>= 1;
        uint32_t low = first, high = first + count - 1; /* bit is 0 at low, 1 at high */
        while (high - low > 1) {
            uint32_t middle = low + (high - low) / 2;
            *(placed[middle].code & bit ? &high : &low) = middle;
        }
        cells_cut(cells, placed, first, high - first);
        cells_cut(cells, placed, high, first + count - high);
        return;
    }
    cells->cells[cells->cells_count++] = (struct distant_cell){.first = first, .count = count};
}

struct distant_cells *distant_cells_create(struct arena *arena, const struct scene *scene,
                                           float reach_m)
{
    size_t count = scene->instances_count;
    struct arena *scratch = arena_create(0);
    struct distant_cells *cells = ARENA_NEW(arena, struct distant_cells);
    struct placed *placed = ARENA_ARRAY(scratch, struct placed, count);
    sort_by_place(scene, placed);
    cells->instances = ARENA_ARRAY(arena, uint32_t, count);
    cells->trees = ARENA_ARRAY(arena, struct distant_tree, count);
    for (size_t i = 0; i < count; i++) {
        cells->instances[i] = placed[i].instance;
        cells->trees[i] = tree_of(&scene->instances[placed[i].instance]);
    }
    cells->cells = ARENA_ARRAY(scratch, struct distant_cell, count);
    if (count > 0)
        cells_cut(cells, placed, 0, (uint32_t)count);
    struct distant_cell *kept = ARENA_ARRAY(arena, struct distant_cell, cells->cells_count);
    if (count > 0)
        memcpy(kept, cells->cells, cells->cells_count * sizeof *kept);
    cells->cells = kept;
    for (size_t i = 0; i < cells->cells_count; i++)
        cell_bound(cells->trees, &cells->cells[i], reach_m);
    arena_destroy(scratch);
    return cells;
}
