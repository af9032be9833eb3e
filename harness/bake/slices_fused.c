/* The next level of the slice pyramid: each slice composites two. */
#include "bake/slices.h"

#include <math.h>
#include <string.h>

/* The smallest rectangle that holds both. */
static struct slice join(const struct slice *a, const struct slice *b)
{
    if (a->width == 0 || b->width == 0)
        return a->width ? *a : *b;
    struct slice both = {.left = a->left < b->left ? a->left : b->left,
                         .bottom = a->bottom < b->bottom ? a->bottom : b->bottom};
    int right[2] = {a->left + a->width, b->left + b->width};
    int top[2] = {a->bottom + a->height, b->bottom + b->height};
    both.width = (right[0] > right[1] ? right[0] : right[1]) - both.left;
    both.height = (top[0] > top[1] ? top[0] : top[1]) - both.bottom;
    return both;
}

/* Mean depth in the doubled slab, weighted by what of each is seen. */
static uint16_t mean_depth(const struct slices *slices, const size_t at[2], bool from_behind)
{
    float weights[2] = {0}, depth = 0;
    for (int k = 0; k < 2; k++)
        weights[k] = at[k] == SIZE_MAX ? 0 : (float)slices->color[at[k]][3] / 255.0f;
    weights[!from_behind] *= 1 - weights[from_behind]; /* the nearer one hides the other */
    for (int k = 0; k < 2; k++)                        /* 0 is the front half */
        if (weights[k] > 0)
            depth += weights[k] / (weights[0] + weights[1]) *
                     (0.5f * (float)slices->depth[at[k]] + (k == 0 ? 32767.5f : 0));
    return (uint16_t)lrintf(fminf(depth, 65535));
}

/* Texel (x, y) of the picture in a slice; SIZE_MAX outside of its rectangle. */
static size_t texel_at(const struct slice *slice, int x, int y)
{
    if (x < slice->left || y < slice->bottom || x >= slice->left + slice->width ||
        y >= slice->bottom + slice->height)
        return SIZE_MAX;
    return slice->first + (size_t)(y - slice->bottom) * (size_t)slice->width +
           (size_t)(x - slice->left);
}

static void fuse_pair(const struct slices *slices, size_t stack, int index, bool from_behind,
                      struct slices *fused)
{
    static const struct slice nothing;
    const struct slice *back = &slices->slices[stack * (size_t)slices->count + 2 * (size_t)index];
    const struct slice *front = 2 * index + 1 < slices->count ? back + 1 : &nothing;
    const struct slice *to = &fused->slices[stack * (size_t)fused->count + (size_t)index];
    for (int n = 0; n < to->width * to->height; n++) {
        int x = to->left + n % to->width, y = to->bottom + n / to->width;
        const size_t at[2] = {texel_at(front, x, y), texel_at(back, x, y)};
        float texels[2][SLICES_FLOATS] = {{0}};
        for (int k = 0; k < 2; k++)
            if (at[k] != SIZE_MAX)
                slices_decode(slices, at[k], 1, texels[k]);
        slices_fuse(texels[from_behind], texels[!from_behind], 1, texels[0]);
        slices_encode(texels[0], 1, false, false, fused->color + to->first + n,
                      fused->normal + to->first + n);
        fused->depth[to->first + (size_t)n] = mean_depth(slices, at, from_behind);
    }
}

const struct slices *slices_fused(struct arena *arena, const struct slices *slices,
                                  bool from_behind)
{
    static const struct slice nothing;
    struct slices *fused = ARENA_NEW(arena, struct slices);
    *fused = *slices;
    fused->count = (slices->count + 1) / 2;
    fused->texels_count = fused->lights_count = 0;
    fused->lit = NULL;
    fused->stacks = ARENA_ARRAY(arena, struct slices_stack, slices->stacks_count);
    memcpy(fused->stacks, slices->stacks, slices->stacks_count * sizeof *fused->stacks);
    fused->slices = ARENA_ARRAY(arena, struct slice, slices->stacks_count * (size_t)fused->count);
    for (size_t i = 0; i < slices->stacks_count * (size_t)fused->count; i++) {
        size_t stack = i / (size_t)fused->count;
        int back = 2 * (int)(i % (size_t)fused->count);
        const struct slice *pair = &slices->slices[stack * (size_t)slices->count + (size_t)back];
        fused->slices[i] = join(pair, back + 1 < slices->count ? pair + 1 : &nothing);
        fused->slices[i].first = fused->texels_count;
        fused->texels_count += (size_t)fused->slices[i].width * (size_t)fused->slices[i].height;
    }
    fused->color = arena_alloc(arena, fused->texels_count, sizeof *fused->color);
    fused->normal = arena_alloc(arena, fused->texels_count, sizeof *fused->normal);
    fused->depth = ARENA_ARRAY(arena, uint16_t, fused->texels_count);
    for (size_t stack = 0; stack < slices->stacks_count; stack++) {
        struct slices_stack *box = &fused->stacks[stack];
        float slab = (box->high_m[2] - box->low_m[2]) / (float)slices->count;
        box->high_m[2] = box->low_m[2] + slab * 2 * (float)fused->count;
    }
#pragma omp parallel for schedule(dynamic)
    for (size_t i = 0; i < slices->stacks_count * (size_t)fused->count; i++)
        fuse_pair(slices, i / (size_t)fused->count, (int)(i % (size_t)fused->count), from_behind,
                  fused);
    return fused;
}
