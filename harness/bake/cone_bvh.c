/* Halved at the median along the longest axis, nodes in depth-first order, each a sphere. */
#include "bake/cone_bvh.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { LEAF = 2, DEPTH = 64 };

/* Its first child follows it. */
struct node {
    float center_m[3], radius_m;
    uint32_t first, count; /* of a leaf: balls; else count 0, first: the second child */
};

struct cone_bvh {
    const struct cone_ball *balls;
    uint32_t *order;
    struct node *nodes;
    size_t nodes_count, count;
};

static void bound(const struct cone_bvh *bvh, size_t first, size_t end, struct node *node,
                  float sides_m[3])
{
    float radius_m = 0, square = 0;
    for (int i = 0; i < 3; i++) {
        float low = INFINITY, high = -INFINITY;
        for (size_t k = first; k < end; k++) {
            low = fminf(low, bvh->balls[bvh->order[k]].center_m[i]);
            high = fmaxf(high, bvh->balls[bvh->order[k]].center_m[i]);
        }
        node->center_m[i] = 0.5f * (low + high);
        sides_m[i] = high - low;
    }
    for (size_t k = first; k < end; k++) {
        const struct cone_ball *ball = &bvh->balls[bvh->order[k]];
        square = 0;
        for (int i = 0; i < 3; i++) {
            float way = ball->center_m[i] - node->center_m[i];
            square += way * way;
        }
        radius_m = fmaxf(radius_m, sqrtf(square) + ball->radius_m);
    }
    node->radius_m = radius_m * 1.0001f;
}

/* Puts the middle one of [first, end) along an axis to its place: Hoare's selection. */
static void median(const struct cone_bvh *bvh, size_t first, size_t end, int axis)
{
    const size_t middle = (first + end) / 2;
    uint32_t *order = bvh->order;
    while (end - first > 1) {
        float pivot = bvh->balls[order[(first + end) / 2]].center_m[axis];
        size_t low = first, high = end - 1;
        for (;;) {
            while (bvh->balls[order[low]].center_m[axis] < pivot)
                low++;
            while (bvh->balls[order[high]].center_m[axis] > pivot)
                high--;
            if (low >= high)
                break;
            uint32_t swap = order[low];
            order[low++] = order[high];
            order[high--] = swap;
        }
        if (middle < low)
            end = low;
        else if (middle > high)
            first = high + 1;
        else
            return;
    }
}

static void build(struct cone_bvh *bvh, size_t first, size_t end)
{
    struct node *node = &bvh->nodes[bvh->nodes_count++];
    float sides_m[3];
    bound(bvh, first, end, node, sides_m);
    if (end - first <= LEAF) {
        node->first = (uint32_t)first;
        node->count = (uint32_t)(end - first);
        return;
    }
    int axis = sides_m[1] > sides_m[0] ? 1 : 0;
    axis = sides_m[2] > sides_m[axis] ? 2 : axis;
    median(bvh, first, end, axis);
    build(bvh, first, (first + end) / 2);
    node->first = (uint32_t)bvh->nodes_count;
    build(bvh, (first + end) / 2, end);
}

struct cone_bvh *cone_bvh_create(struct arena *arena, const struct cone_ball *balls, size_t count)
{
    struct cone_bvh *bvh = ARENA_NEW(arena, struct cone_bvh);
    bvh->balls = balls;
    bvh->count = count;
    bvh->order = ARENA_ARRAY(arena, uint32_t, count + 1);
    bvh->nodes = ARENA_ARRAY(arena, struct node, 2 * count + 1);
    for (size_t i = 0; i < count; i++)
        bvh->order[i] = (uint32_t)i;
    if (count > 0)
        build(bvh, 0, count);
    return bvh;
}

size_t cone_bvh_find(const struct cone_bvh *bvh, const struct cone_beam *beam, uint32_t *found,
                     size_t room, uint64_t *nodes)
{
    uint32_t stack[DEPTH];
    size_t count = 0, waiting = 0;
    if (bvh->count > 0)
        stack[waiting++] = 0;
    while (waiting > 0) {
        const struct node *node = &bvh->nodes[stack[--waiting]];
        ++*nodes;
        if (!cone_beam_meets(beam, node->center_m, node->radius_m))
            continue;
        if (node->count == 0) {
            stack[waiting++] = node->first;
            stack[waiting++] = (uint32_t)(node - bvh->nodes) + 1;
        }
        for (uint32_t k = 0; k < node->count && count < room; k++) {
            const struct cone_ball *ball = &bvh->balls[bvh->order[node->first + k]];
            if (cone_beam_meets(beam, ball->center_m, ball->radius_m))
                found[count++] = bvh->order[node->first + k];
        }
    }
    return count;
}
