/* The stack, the number of slices, the place and the light of one tree in one view. */
#include "bake/stack_bake.h"

#include <string.h>

static float dot(const float a[3], const float b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* R_y(-rotation): from the world's axes to the plant's. */
static void to_plant(const struct instance *instance, const float world[3], float own[3])
{
    float c = cosf(instance->rotation_rad), s = sinf(instance->rotation_rad);
    own[0] = world[0] * c - world[2] * s;
    own[1] = world[1];
    own[2] = world[0] * s + world[2] * c;
}

/* R_y(rotation) diag(1, stretch, 1) times a factor. */
static void to_world(const struct instance *instance, const float own[3], float factor,
                     float world[3])
{
    float c = cosf(instance->rotation_rad), s = sinf(instance->rotation_rad);
    world[0] = factor * (own[0] * c + own[2] * s);
    world[1] = factor * instance->stretch * own[1];
    world[2] = factor * (-own[0] * s + own[2] * c);
}

/* The same of what is squeezed back to the plant's height: a way of the world, or, as light is
 * expressed for normals that are stretched the other way, the direction to the sun. */
static void to_plant_squeezed(const struct instance *instance, const float world[3], float own[3])
{
    to_plant(instance, world, own);
    own[1] /= instance->stretch;
}

/* What of a side the eye sees. */
struct seen {
    const struct stack_side *side;
    bool behind;
    float cosine;     /* between toward and the way to the eye, >= 0 */
    float distance_m; /* to the box's middle, of the world over the tree's scale */
    float to_eye[3];  /* plant's axes, unit */
};

/* eye and forward: plant's axes and height. Within a crown it counts more where the eye looks than
 * where it is: from radius_m to the middle the one turns into the other. */
static struct seen see(const struct stack_side *side, const float eye[3], const float forward[3],
                       float stretch, float radius_m)
{
    const struct slices_stack *frame = &side->frame;
    const float *axes[3] = {frame->right, frame->up, frame->toward};
    float along[3];
    for (int axis = 0; axis < 3; axis++)
        along[axis] = dot(eye, axes[axis]) - 0.5f * (frame->low_m[axis] + frame->high_m[axis]);
    float distance = fmaxf(sqrtf(dot(along, along)), 1e-12f);
    float within = fmaxf(0, radius_m - distance);
    for (int axis = 0; axis < 3; axis++)
        along[axis] -= within * dot(forward, axes[axis]);
    float length = fmaxf(sqrtf(dot(along, along)), 1e-12f);
    struct seen seen = {side, along[2] < 0, fabsf(along[2]) / length, distance, {0}};
    for (int i = 0; i < 3; i++)
        for (int axis = 0; axis < 3; axis++)
            seen.to_eye[i] += along[axis] * axes[axis][i] / length;
    float rise = seen.to_eye[1];
    if (stretch != 1)
        seen.distance_m *= sqrtf(1 + rise * rise * (stretch * stretch - 1));
    return seen;
}

/* The sides that face the eye (plant's axes and scale) most and second most, as Meyer and Neyret
 * 1998 choose. */
static void best_sides(const struct stack *stack, const struct stack_plant *plant,
                       const float eye[3], const float forward[3], float stretch,
                       struct seen best[2])
{
    size_t count = stack->request.bake.directions_count - (stack->request.above ? 1 : 0);
    best[0] = best[1] = (struct seen){.side = plant->sides, .cosine = -1};
    for (size_t d = 0; d < count; d++) {
        struct seen seen = see(&plant->sides[d], eye, forward, stretch, plant->bound.radius_m);
        if (seen.cosine > best[0].cosine) {
            best[1] = best[0];
            best[0] = seen;
        } else if (seen.cosine > best[1].cosine) {
            best[1] = seen;
        }
    }
}

/* The number of slices that must be surpassed (Meyer and Neyret 1998; 003, 4.3.2): by C1 the gap
 * between two neighbours, along them, is at most so many texels; by C2 their parallax so many
 * pixels. Of a near tree the ray that is turned farthest counts. */
static float slices_wanted(const struct stack *stack, const struct stack_plant *plant,
                           const struct seen *seen, float focal_px)
{
    const struct slices_stack *frame = &seen->side->frame;
    const struct stack_request *request = &stack->request;
    float radius_m = plant->bound.radius_m, height_m = frame->high_m[2] - frame->low_m[2];
    float spread = fminf(1, radius_m / seen->distance_m);
    float sine = sqrtf(fmaxf(0, 1 - seen->cosine * seen->cosine));
    /* sin(a + b), as long as that is not past a right angle */
    float turned =
        seen->cosine > spread ? sine * sqrtf(1 - spread * spread) + seen->cosine * spread : 1;
    float gap_m = request->criterion_texels * plant->texel_m, wanted = 0;
    if (gap_m > 0)
        wanted = height_m * turned / (gap_m * sqrtf(fmaxf(1e-6f, 1 - turned * turned)));
    if (request->criterion_px > 0 || gap_m <= 0)
        wanted = fmaxf(wanted, focal_px * height_m * turned /
                                   (seen->distance_m *
                                    (request->criterion_px > 0 ? request->criterion_px : 1)));
    return wanted;
}

/* At low detail a plant has an eighth of its slices: 8 of 64 (Senegas 2001, 5.9). */
static int level_low(const struct stack_side *side)
{
    return side->levels_count - 1 < 3 ? side->levels_count - 1 : 3;
}

/* The level, and in *next the share of the one below it that begins to replace it. */
static int level_for(const struct stack *stack, const struct stack_side *side, enum lod lod,
                     float wanted, float *next)
{
    int low = level_low(side), level = 0;
    *next = 0;
    if (lod == LOD_LOW)
        return low;
    if (lod == LOD_INTERMEDIATE)
        return wanted > (float)side->levels[low].count ? 0 : low;
    if (lod == LOD_HIGH ||
        !(stack->request.criterion_px > 0 || stack->request.criterion_texels > 0))
        return 0;
    while (level + 1 < side->levels_count && (float)side->levels[level + 1].count > wanted)
        level++;
    if (stack->request.smooth && level + 1 < side->levels_count) {
        float excess = (float)side->levels[level].count / fmaxf(wanted, 1e-6f);
        float whole = (float)side->levels[level].count / (float)side->levels[level + 1].count;
        *next = fmaxf(0, 1 - STACK_BAND * log2f(whole / excess));
    }
    return level;
}

/* The one or two levels of a side. */
static int side_parts(const struct stack *stack, const struct seen *seen, enum lod lod,
                      float wanted, float share, struct stack_part *parts)
{
    float next, drawn;
    int level = level_for(stack, seen->side, lod, wanted, &next), count = 0;
    const struct stack_level *levels = &seen->side->levels[level];
    drawn = (float)levels->count;
    if (stack->request.interpolate && lod != LOD_LOW && level == 0 && wanted > drawn)
        drawn = ceilf(fminf(wanted, STACK_DENSER * drawn));
    struct stack_part part = {.side = seen->side,
                              .level = levels,
                              .behind = seen->behind,
                              .share = share * (1 - next),
                              .drawn = drawn,
                              .distance_m = seen->distance_m};
    memcpy(part.to_eye, seen->to_eye, sizeof part.to_eye);
    parts[count++] = part;
    if (next > 0) {
        part.level = levels + 1;
        part.share = share * next;
        part.drawn = (float)part.level->count;
        parts[count++] = part;
    }
    return count;
}

/* The share of the second of two neighbouring vertical sides: the angle to the first over the angle
 * between them. That to the first follows from the cosines, both of which shrink alike as the eye
 * rises. */
static float mixed_share(const struct seen best[2])
{
    const float *first = best[0].side->frame.toward, *second = best[1].side->frame.toward;
    float between = acosf(fminf(fabsf(dot(first, second)), 1));
    float angle =
        atan2f(best[1].cosine - best[0].cosine * cosf(between), best[0].cosine * sinf(between));
    return between > 0 ? fminf(fmaxf(angle / between, 0), 0.5f) : 0;
}

/* The share of the horizontal side: vertical ones alone show a tree as well up to 30 degrees above
 * it (an oak's coverage, pixel by pixel: off by .20 with it and without), and cost less. */
static float share_above(float sine)
{
    const float begin_rad = (float)M_PI / 6;
    return fmaxf(0, (asinf(fminf(sine, 1)) - begin_rad) / ((float)M_PI_2 - begin_rad));
}

int stack_parts(const struct stack *stack, const struct view *view, enum lod lod,
                const struct instance *instance, struct stack_part *parts)
{
    const struct stack_plant *plant = stack_plant_of(stack, instance);
    float away[3], eye[3], forward[3], focal = cull_focal_px(view);
    for (int i = 0; i < 3; i++)
        away[i] = (view->eye_m[i] - instance->position_m[i]) / instance->scale;
    to_plant_squeezed(instance, away, eye);
    to_plant_squeezed(instance, view->forward, forward);
    struct seen best[3];
    float shares[3] = {1, 0, 0};
    best_sides(stack, plant, eye, forward, instance->stretch, best);
    focal *= fmaxf(1, instance->stretch); /* a metre of the plant appears at most so large */
    if (stack->request.smooth && best[1].cosine >= 0)
        shares[1] = fmaxf(0, 0.5f - (best[0].cosine - best[1].cosine) * STACK_BAND);
    if (stack->request.mix != STACK_ONE && best[1].cosine >= 0)
        shares[1] = mixed_share(best);
    if (stack->request.above) {
        const struct stack_side *above = plant->sides + stack->request.bake.directions_count - 1;
        best[2] = see(above, eye, forward, instance->stretch, plant->bound.radius_m);
        shares[2] = share_above(best[2].cosine);
    }
    shares[1] *= 1 - shares[2];
    shares[0] -= shares[1] + shares[2];
    /* Sides are drawn in the order of the request, so that the turn of the better one is no turn of
     * the picture. */
    int count = 0, first = shares[1] > 0 && best[1].side < best[0].side;
    for (int i = 0; i < 3; i++) {
        int k = i < 2 ? first ^ i : i;
        if (!(shares[k] > 0))
            continue;
        float wanted = slices_wanted(stack, plant, &best[k], focal);
        count += side_parts(stack, &best[k], lod, wanted, shares[k], parts + count);
    }
    return count;
}

static void place_tree(const struct instance *instance, const struct stack_part *part,
                       struct stack_tree *tree)
{
    const struct slices_stack *frame = &part->side->frame;
    const struct stack_level *level = part->level;
    float corner[3], thick = (level->high_m - level->low_m) / (float)level->count;
    for (int i = 0; i < 3; i++)
        corner[i] = frame->low_m[0] * frame->right[i] + frame->low_m[1] * frame->up[i] +
                    (part->behind ? level->low_m : level->high_m) * frame->toward[i];
    to_world(instance, corner, instance->scale, tree->base_m);
    for (int i = 0; i < 3; i++)
        tree->base_m[i] += instance->position_m[i];
    to_world(instance, frame->right, instance->scale * (frame->high_m[0] - frame->low_m[0]),
             tree->u_m);
    to_world(instance, frame->up, instance->scale * (frame->high_m[1] - frame->low_m[1]),
             tree->v_m);
    to_world(instance, frame->toward, instance->scale * (part->behind ? thick : -thick), tree->w_m);
    tree->layer = (float)(part->behind ? level->layer[1] : level->layer[0] + level->count - 1);
    tree->step = part->behind ? 1 : -1;
    tree->count = (float)level->count;
}

/* Normals face the front: seen from behind, a leaf's is negated and bark's mirrored, or the light
 * is. */
static void light_tree(const struct instance *instance, const struct stack_part *part,
                       const float sun[3], struct stack_tree *tree)
{
    float own[3];
    to_plant_squeezed(instance, sun, own);
    tree->rise = 1 / instance->stretch;
    float along = dot(own, part->side->frame.toward);
    for (int i = 0; i < 3; i++) {
        tree->leaf_light[i] = part->behind ? -own[i] : own[i];
        tree->bark_light[i] = own[i] - (part->behind ? 2 * along * part->side->frame.toward[i] : 0);
    }
}

void stack_tree_fill(const struct stack *stack, const struct view *view,
                     const struct instance *instance, const struct stack_part *part,
                     struct stack_tree *tree)
{
    const struct stack_plant *plant = stack_plant_of(stack, instance);
    place_tree(instance, part, tree);
    light_tree(instance, part, view->sun_direction, tree);
    bool upright = part->side->frame.up[1] > 0.5f; /* then texels are stretched: by their area */
    float focal_px = cull_focal_px(view) * (upright ? sqrtf(instance->stretch) : 1);
    float texel_px = focal_px * plant->texel_m / part->distance_m;
    float mip = log2f(fmaxf(stack->request.texel_px / texel_px, 1));
    mip = stack->request.smooth ? mip : floorf(mip + 0.5f);
    tree->level = fminf(mip, (float)(stack->arrays[part->side->array].levels - 1));
    tree->power = part->share * (float)part->level->count / part->drawn;
    tree->albedo_scale = plant->albedo_scale;
    float facing = fmaxf(fabsf(dot(part->to_eye, part->side->frame.toward)), 1e-3f);
    for (int i = 0; i < 3; i++) {
        tree->eye[i] = part->to_eye[i] / facing;
        tree->toward[i] = part->side->frame.toward[i];
    }
    tree->array = (uint32_t)part->side->array;
}

/* Half texels plus 1 of what a slice's rectangle fills of the mip level, with half a texel of that
 * around it, within the picture; false where nothing is covered. A trilinear filter's level may be
 * two above. */
static bool quad_rect(const struct stack *stack, const struct slice *slice,
                      const struct stack_array *array, int level, uint16_t rect[4])
{
    const int most[2] = {2 * array->width_px, 2 * array->height_px};
    if (stack->request.rectangles && slice->width == 0)
        return false;
    const int grid =
        1 << (level + (stack->request.trilinear ? 2 : 0)); /* texels of the level lie on it */
    const int low[2] = {2 * (slice->left / grid * grid) - grid,
                        2 * (slice->bottom / grid * grid) - grid};
    const int high[2] = {2 * ((slice->left + slice->width + grid - 1) / grid * grid) + grid,
                         2 * ((slice->bottom + slice->height + grid - 1) / grid * grid) + grid};
    for (int i = 0; i < 2; i++) {
        bool whole = !stack->request.rectangles;
        rect[i] = (uint16_t)(whole || low[i] < 0 ? 1 : low[i] + 1);
        rect[i + 2] = (uint16_t)(whole || high[i] > most[i] ? most[i] + 1 : high[i] + 1);
    }
    return true;
}

bool stack_quad_at(const struct stack *stack, const struct stack_part *part,
                   const struct stack_tree *tree, float place, struct stack_quad *quad)
{
    const struct stack_array *array = &stack->arrays[part->side->array];
    int last = part->level->count - 1, near = (int)floorf(place);
    int both[2] = {near < 0 ? 0 : near, near + 1 > last ? last : near + 1};
    bool covered = false;
    quad->slice = fminf(fmaxf(place, 0), (float)last);
    if (quad->slice == floorf(quad->slice))
        both[0] = both[1] = (int)quad->slice;
    for (int k = 0; k < 2; k++) {
        uint16_t rect[4];
        int slice = part->behind ? both[k] : last - both[k];
        if (!quad_rect(stack, &part->level->slices[slice], array, (int)ceilf(tree->level), rect))
            continue;
        for (int i = 0; i < 2; i++) {
            quad->rect[i] = covered && quad->rect[i] < rect[i] ? quad->rect[i] : rect[i];
            quad->rect[i + 2] =
                covered && quad->rect[i + 2] > rect[i + 2] ? quad->rect[i + 2] : rect[i + 2];
        }
        covered = true;
    }
    return covered;
}

size_t stack_quads(const struct stack *stack, const struct stack_part *parts, int count,
                   const struct stack_tree *trees, uint32_t first_tree, struct stack_quad *quads)
{
    int left[PARTS_MOST];
    size_t filled = 0;
    for (int i = 0; i < count; i++)
        left[i] = (int)parts[i].drawn;
    for (;;) {
        int farthest = -1;
        float depth = -1;
        for (int i = 0; i < count; i++) {
            float own = ((float)left[i] - 0.5f) / parts[i].drawn;
            if (left[i] > 0 && own > depth) {
                depth = own;
                farthest = i;
            }
        }
        if (farthest < 0)
            return filled;
        const struct stack_part *part = &parts[farthest];
        quads[filled].tree = first_tree + (uint32_t)farthest;
        left[farthest]--;
        float place = depth * (float)part->level->count - 0.5f;
        if (part->drawn <= (float)part->level->count)
            place = (float)left[farthest];
        filled += stack_quad_at(stack, part, &trees[farthest], place, &quads[filled]);
    }
}
