/* Packing a plant for sift.h: each triangle with its own three corners, leaves as elements. */
#include "bake/sift_plant.h"

#include <string.h>

bool sift_plant_possible(const struct mesh *mesh)
{
    bool textured = false;
    for (size_t p = 0; p < mesh->parts_count; p++)
        textured |= mesh->uvs && mesh->materials[mesh->parts[p].material].texture;
    return !textured;
}

/* By their places: the sides of a needle have corners of their own. */
static bool shares_corner(const struct detail_vertex *vertices, const uint32_t *a,
                          const uint32_t *b)
{
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            if (memcmp(vertices[a[i]].position_m, vertices[b[j]].position_m,
                       sizeof vertices->position_m) == 0)
                return true;
    return false;
}

/* Leaves: triangles that follow each other and share a corner are one element. */
static size_t find_elements(const struct detail_vertex *vertices, const uint32_t *indices,
                            size_t triangles, bool leaf, uint32_t *first)
{
    size_t count = 0;
    for (size_t t = 0; t < triangles; t++) {
        bool goes_on = leaf && t > 0 && t - first[count - 1] < SIFT_TRIANGLES &&
                       shares_corner(vertices, indices + 3 * t, indices + 3 * (t - 1));
        if (!goes_on)
            first[count++] = (uint32_t)t;
    }
    first[count] = (uint32_t)triangles;
    return count;
}

static struct sift_set *set_of_range(struct arena *arena, const struct detail *detail,
                                     const struct detail_batch *batch, size_t level)
{
    struct detail_range range = batch->levels[level];
    bool leaf = batch->kind == MATERIAL_LEAF;
    struct arena *passing = arena_create(0);
    const uint32_t *indices = detail->indices + range.first_index;
    uint32_t *first = ARENA_ARRAY(passing, uint32_t, range.indices_count / 3 + 1);
    size_t count = find_elements(detail->vertices, indices, range.indices_count / 3, leaf, first);
    struct sift_vertex *vertices = ARENA_ARRAY(arena, struct sift_vertex, range.indices_count);
    for (uint32_t i = 0; i < range.indices_count; i++) {
        const struct detail_vertex *from = &detail->vertices[indices[i]];
        memcpy(vertices[i].position_m, from->position_m, sizeof from->position_m);
        memcpy(vertices[i].normal, from->normal, sizeof from->normal);
        memcpy(vertices[i].albedo, from->albedo, sizeof from->albedo);
        vertices[i].normal[3] = (int16_t)(leaf + (batch->thin ? 0 : SIFT_SOLID));
    }
    struct sift_set *set = sift_set_create(arena, vertices, count, first, NULL);
    set->closed = batch->closed;
    set->stream = leaf && batch->flat ? SIFT_LIT : batch->thin ? SIFT_LEAF : SIFT_BARK;
    arena_destroy(passing);
    return set;
}

static struct sift_set *set_of_pruned(struct arena *arena, const struct prune *prune)
{
    struct arena *passing = arena_create(0);
    struct sift_vertex *vertices = ARENA_ARRAY(arena, struct sift_vertex, 3 * prune->count);
    float(*centers)[3] = arena_alloc(passing, prune->count, sizeof *centers);
    for (size_t i = 0; i < 3 * prune->count; i++) {
        const struct prune_vertex *from = &prune->vertices[i];
        memcpy(vertices[i].position_m, from->position_m, sizeof from->position_m);
        memcpy(vertices[i].normal, from->normal, sizeof from->normal);
        memcpy(vertices[i].albedo, from->albedo, sizeof from->albedo);
        vertices[i].normal[3] =
            (int16_t)((from->normal[3] != 0) + (from->normal[3] < 0 ? SIFT_SOLID : 0));
        memcpy(centers[i / 3], from->center_m, sizeof *centers);
    }
    struct sift_set *set =
        sift_set_create(arena, vertices, prune->count, NULL, (const float(*)[3])centers);
    set->stream = SIFT_LIT;
    arena_destroy(passing);
    return set;
}

struct sift_plant *sift_plant_create(struct arena *arena, const struct detail *detail,
                                     const struct prune *prune, const struct levels *levels)
{
    struct sift_plant *plant = ARENA_NEW(arena, struct sift_plant);
    plant->batches_count = detail->batches_count;
    plant->bark = ARENA_ARRAY(arena, bool, detail->batches_count);
    plant->sets = arena_alloc(arena, detail->batches_count, sizeof *plant->sets);
    plant->stout = arena_alloc(arena, detail->batches_count, sizeof *plant->stout);
    for (size_t b = 0; b < detail->batches_count; b++) {
        plant->bark[b] = detail->batches[b].kind == MATERIAL_BARK;
        size_t count = plant->bark[b] ? detail->levels_count : 1;
        for (size_t level = 0; level < count; level++)
            plant->sets[b][level] = set_of_range(arena, detail, &detail->batches[b], level);
        for (uint32_t s = 0; s < levels->steps_count && plant->bark[b]; s++)
            plant->stout[b][s] =
                detail_stout(detail, b, levels->step_bark[s], levels->step_stout[s]).indices_count /
                3;
    }
    if (prune && prune->count > 0)
        plant->pruned = set_of_pruned(arena, prune);
    return plant;
}

size_t sift_plant_runs(const struct sift_plant *plant, const struct levels *levels,
                       const struct sift_part *part, struct sift_run *runs)
{
    int step = part->choice.step;
    bool pruned = step >= 0;
    size_t count = 0;
    for (size_t b = 0; b < plant->batches_count; b++) {
        uint32_t level = pruned ? levels->step_bark[step] : part->choice.level;
        const struct sift_set *set = plant->sets[b][plant->bark[b] ? level : 0];
        size_t kept = pruned ? plant->stout[b][step] : set->count;
        if (kept > 0)
            runs[count++] = (struct sift_run){.set = set, .kept = (float)kept, .growth = 1};
    }
    if (pruned) {
        struct levels_run kept = levels_run_of(levels, step, &part->seen, part->taper);
        runs[count++] = (struct sift_run){.set = plant->pruned,
                                          .begin = levels_begin(levels, part->run),
                                          .kept = kept.kept,
                                          .growth = kept.growth,
                                          .taper = part->taper,
                                          .stout = levels->step_stout[step]};
    }
    return count;
}
