/* Stacks of one tree whose slices cross, in the right order (stack.h, crossed).
 *
 * Two vertical ones: the slices of the second part stand whole. They cut space into slabs, and the
 * slices of the first part at their borders; from the farthest slab to the nearest come the pieces
 * within it, farthest first, then the slice in front of it. A horizontal one cuts both of them into
 * layers in the same way. Cuts are rounded to half texels, the same for both sides of a cut. */
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

/* Between which places, half texels plus 1, something lies; the nearer to the eye first. */
struct span {
    float near, far;
};

/* The part of a quad within a span along its width (axis 0) or its height (1); the ends count 65535
 * half texels. */
static bool cut(struct stack_quad *quad, int axis, struct span span)
{
    float low = fminf(span.near, span.far), high = fmaxf(span.near, span.far);
    if (low > (float)quad->rect[axis])
        quad->rect[axis] = (uint16_t)fminf(roundf(low), 65535);
    if (high < (float)quad->rect[axis + 2])
        quad->rect[axis + 2] = (uint16_t)fmaxf(roundf(high), 0);
    return quad->rect[axis] < quad->rect[axis + 2];
}

/* One or two vertical parts of a tree, and the layer of each that is drawn. */
struct crossed {
    const struct stack *stack;
    const struct stack_part *parts;
    const struct stack_tree *trees;
    uint32_t first_tree;
    int count;
    struct span layers[2];
};

/* A slice of one of the parts, within the layer and a span of its width. */
static bool piece(const struct crossed *crossed, int part, int slice, struct span span,
                  struct stack_quad *quad)
{
    quad->tree = crossed->first_tree + (uint32_t)part;
    return stack_quad_at(crossed->stack, &crossed->parts[part], &crossed->trees[part], (float)slice,
                         quad) &&
           cut(quad, 1, crossed->layers[part]) && cut(quad, 0, span);
}

static const struct span everywhere = {-INFINITY, INFINITY};

static size_t layer_quads(const struct crossed *crossed, struct stack_quad *quads)
{
    const struct stack_part *parts = crossed->parts;
    int cut_count = parts[0].level->count;
    int whole_count = crossed->count > 1 ? parts[1].level->count : 0;
    float width_px = (float)crossed->stack->arrays[parts[0].side->array].width_px;
    struct crossing crossing = {0, 0, 0};
    if (crossed->count > 1)
        crossing = crossing_of(&crossed->trees[0], &crossed->trees[1], width_px);
    /* toward the eye the other's slices are met at growing or falling places */
    float nearest = crossing.cut > 0 ? -INFINITY : INFINITY;
    size_t filled = 0;
    for (int slab = whole_count; slab >= 0; slab--) {
        for (int j = cut_count - 1; j >= 0; j--) {
            float start = crossing.from + (float)j * crossing.whole;
            struct span span = {slab > 0 ? start + (float)(slab - 1) * crossing.cut : nearest,
                                slab < whole_count ? start + (float)slab * crossing.cut : -nearest};
            filled += piece(crossed, 0, j, span, &quads[filled]);
        }
        if (slab > 0)
            filled += piece(crossed, 1, slab - 1, everywhere, &quads[filled]);
    }
    return filled;
}

/* Where a vertical part's pictures are met by slice k of the horizontal one, half texels plus 1. */
static float layer_border(const struct crossed *crossed, int part, const struct stack_tree *flat,
                          int k)
{
    const struct stack_tree *tree = &crossed->trees[part];
    float height_px = (float)crossed->stack->arrays[crossed->parts[part].side->array].height_px;
    float y_m = flat->base_m[1] + ((float)k + 0.5f) * flat->w_m[1];
    return 1 + 2 * height_px * (y_m - tree->base_m[1]) / tree->v_m[1];
}

size_t stack_crossed_quads(const struct stack *stack, const struct stack_part *parts, int count,
                           const struct stack_tree *trees, uint32_t first_tree,
                           struct stack_quad *quads)
{
    const struct stack_part *last = &parts[count - 1];
    bool lies = fabsf(last->side->frame.toward[1]) > 0.5f;
    struct crossed crossed = {.stack = stack,
                              .parts = parts,
                              .trees = trees,
                              .first_tree = first_tree,
                              .count = count - lies,
                              .layers = {everywhere, everywhere}};
    if (!lies)
        return layer_quads(&crossed, quads);
    const struct stack_tree *flat = &trees[count - 1];
    int layers = last->level->count;
    float nearest = flat->w_m[1] < 0 ? INFINITY : -INFINITY;
    size_t filled = 0;
    for (int layer = layers; layer >= 0; layer--) {
        for (int part = 0; part < crossed.count; part++)
            crossed.layers[part] = (struct span){
                layer > 0 ? layer_border(&crossed, part, flat, layer - 1) : nearest,
                layer < layers ? layer_border(&crossed, part, flat, layer) : -nearest};
        if (crossed.count > 0)
            filled += layer_quads(&crossed, quads + filled);
        if (layer > 0) {
            quads[filled].tree = first_tree + (uint32_t)count - 1;
            filled += stack_quad_at(stack, last, flat, (float)(layer - 1), &quads[filled]);
        }
    }
    return filled;
}
