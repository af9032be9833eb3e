/* Two stacks of one tree whose slices cross, in the right order (stack.h, crossed).
 *
 * The slices of the second part stand whole. They cut space into slabs, and the slices of the first
 * part at their borders; from the farthest slab to the nearest come the pieces within it, farthest
 * first, then the slice in front of it. Cuts are rounded to half texels, the same for both sides of
 * a cut. */
#include "bake/stack_bake.h"

static float dot(const float a[3], const float b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Where slices of one tree meet those of another, as half texels plus 1 along the first's width:
 * from + j * whole + k * cut for its slice j and the other's slice k. */
struct crossing {
    float from, whole, cut;
};

/* On the plane of the other's slice k, its normal w: w . x = w . (base + (k + 1/2) w). Points of
 * slice j: base + u U + (j + 1/2) W + v V, and V is upright like the planes. */
static struct crossing crossing_of(const struct stack_tree *tree, const struct stack_tree *other,
                                   float width_px)
{
    const float *normal = other->w_m;
    float apart[3], across = dot(normal, tree->u_m);
    for (int i = 0; i < 3; i++)
        apart[i] = other->base_m[i] - tree->base_m[i];
    float scale = 2 * width_px / across, square = dot(normal, normal);
    float along = dot(normal, tree->w_m);
    return (struct crossing){
        .from = 1 + scale * (dot(normal, apart) + 0.5f * square - 0.5f * along),
        .whole = -scale * along,
        .cut = scale * square,
    };
}

/* The part of a quad between two of the other's slices, near and far; the ends count 65535 half
 * texels. */
static bool cut(struct stack_quad *quad, float near, float far)
{
    float low = fminf(near, far), high = fmaxf(near, far);
    if (low > (float)quad->rect[0])
        quad->rect[0] = (uint16_t)fminf(roundf(low), 65535);
    if (high < (float)quad->rect[2])
        quad->rect[2] = (uint16_t)fmaxf(roundf(high), 0);
    return quad->rect[0] < quad->rect[2];
}

size_t stack_crossed_quads(const struct stack *stack, const struct stack_part parts[2],
                           const struct stack_tree trees[2], uint32_t first_tree,
                           struct stack_quad *quads)
{
    int cut_count = parts[0].level->count, whole_count = parts[1].level->count;
    float width_px = (float)stack->arrays[parts[0].side->array].width_px;
    struct crossing crossing = crossing_of(&trees[0], &trees[1], width_px);
    /* toward the eye the other's slices are met at growing or falling places */
    float nearest = crossing.cut > 0 ? -INFINITY : INFINITY;
    size_t filled = 0;
    for (int slab = whole_count; slab >= 0; slab--) {
        for (int j = cut_count - 1; j >= 0; j--) {
            struct stack_quad *quad = &quads[filled];
            float start = crossing.from + (float)j * crossing.whole;
            float near = slab > 0 ? start + (float)(slab - 1) * crossing.cut : nearest;
            float far = slab < whole_count ? start + (float)slab * crossing.cut : -nearest;
            quad->tree = first_tree;
            filled +=
                stack_quad_at(stack, &parts[0], &trees[0], (float)j, quad) && cut(quad, near, far);
        }
        if (slab > 0) {
            quads[filled].tree = first_tree + 1;
            filled += stack_quad_at(stack, &parts[1], &trees[1], (float)(slab - 1), &quads[filled]);
        }
    }
    return filled;
}
