/* Slices of every species, at every number of them, in texture arrays. */
#include "bake/stack_bake.h"

#include <string.h>

/* Layers of one texture array, as OpenGL 4.5 promises them. */
enum { LAYERS_MOST = 2048 };

/* The slices of one stack: [0] as seen from the front, [1] from behind, level by level; [2] and [3]
 * the same in the shade, where light is baked in and shadows are received. */
struct pyramid {
    int levels, kinds;
    const struct slices *slices[STACK_LEVELS][STACK_LIGHTS];
};

static int texels_of(float extent_m, float texel_m)
{
    int texels = (int)ceilf(extent_m / texel_m / 8) * 8;
    return texels < 8 ? 8 : texels > SLICES_MOST ? SLICES_MOST : texels;
}

/* Texels of a picture; the box is found with a stack of one texel. */
static enum status size_of(struct workspace *workspace, struct arena *scratch, struct plant *plant,
                           const struct stack_request *request, float *longest_m,
                           struct slices_request *bake)
{
    struct slices_request small = *bake;
    const struct slices *box;
    small.width_px = small.height_px = small.count = small.samples = 1;
    small.views = 0;
    enum status status =
        slices_create(scratch, plant, &small, workspace->threads, &box, workspace->error);
    if (status != STATUS_OK)
        return status;
    float longest = 0, extent[2] = {0, 0};
    for (size_t d = 0; d < bake->directions_count; d++)
        for (int axis = 0; axis < 2; axis++) {
            extent[axis] = box->stacks[d].high_m[axis] - box->stacks[d].low_m[axis];
            longest = fmaxf(longest, extent[axis]);
        }
    if (!(*longest_m > 0))
        *longest_m = fmaxf(longest, 1e-12f);
    float texel_m = *longest_m / (float)request->resolution_px;
    bake->width_px = request->square ? request->resolution_px : texels_of(extent[0], texel_m);
    bake->height_px = request->square ? request->resolution_px : texels_of(extent[1], texel_m);
    return STATUS_OK;
}

/* The slices whose colours are lit by one of their lights. */
static const struct slices *lit_slices(struct arena *scratch, const struct slices *slices,
                                       size_t light)
{
    struct slices *lit = ARENA_NEW(scratch, struct slices);
    *lit = *slices;
    lit->color = slices->lit + light * slices->texels_count;
    lit->albedo_scale = slices->lit_scale;
    return lit;
}

/* All numbers of slices of one direction. Lights, of the front and from behind, are baked in. */
static enum status pyramid_create(struct workspace *workspace, struct arena *scratch,
                                  struct plant *plant, const struct slices_request *bake,
                                  struct pyramid *pyramid)
{
    const struct slices *slices;
    enum status status =
        slices_create(scratch, plant, bake, workspace->threads, &slices, workspace->error);
    if (status != STATUS_OK)
        return status;
    pyramid->kinds = bake->lights_count > 0 ? (int)bake->lights_count : 2;
    for (int kind = 0; kind < pyramid->kinds; kind++)
        pyramid->slices[0][kind] =
            bake->lights_count > 0 ? lit_slices(scratch, slices, (size_t)kind) : slices;
    pyramid->levels = 1;
    while (pyramid->levels < STACK_LEVELS && pyramid->slices[pyramid->levels - 1][0]->count > 1) {
        for (int kind = 0; kind < pyramid->kinds; kind++)
            pyramid->slices[pyramid->levels][kind] =
                slices_fused(scratch, pyramid->slices[pyramid->levels - 1][kind], kind % 2);
        pyramid->levels++;
    }
    return STATUS_OK;
}

/* The array of a size with room for the layers; a new one where there is none. */
static size_t array_find(struct stack *stack, int width_px, int height_px, int layers)
{
    for (size_t i = 0; i < stack->arrays_count; i++) {
        struct stack_array *array = &stack->arrays[i];
        if (array->width_px == width_px && array->height_px == height_px &&
            array->layers + layers <= LAYERS_MOST)
            return i;
    }
    struct stack_array *made = &stack->arrays[stack->arrays_count];
    made->width_px = width_px;
    made->height_px = height_px;
    for (int side = width_px > height_px ? width_px : height_px; side > 0; side /= 2)
        made->levels++;
    return stack->arrays_count++;
}

/* What the drawing must know of a stack, and places for its layers. */
static void side_plan(struct arena *arena, struct stack *stack, const struct pyramid *pyramid,
                      struct stack_side *side)
{
    const struct slices *finest = pyramid->slices[0][0];
    bool lit = stack->request.turns > 0; /* then front and back differ at every level */
    int layers = lit ? 2 * finest->count : finest->count, at;
    for (int l = 1; l < pyramid->levels; l++)
        layers += 2 * pyramid->slices[l][0]->count;
    side->frame = finest->stacks[0];
    side->levels_count = pyramid->levels;
    side->array = array_find(stack, finest->width_px, finest->height_px, layers);
    at = stack->arrays[side->array].layers;
    stack->arrays[side->array].layers += layers;
    for (int l = 0; l < pyramid->levels; l++) {
        const struct slices *slices = pyramid->slices[l][0];
        struct stack_level *level = &side->levels[l];
        level->count = slices->count;
        level->low_m = slices->stacks[0].low_m[2];
        level->high_m = slices->stacks[0].high_m[2];
        level->slices = ARENA_ARRAY(arena, struct slice, (size_t)slices->count);
        memcpy(level->slices, slices->slices, (size_t)slices->count * sizeof *slices->slices);
        for (int behind = 0; behind < 2; behind++) {
            level->layer[behind] = at;
            at += l > 0 || behind || lit ? slices->count : 0;
        }
    }
}

/* Room for one slice: values of this mip level and the next; bytes of all levels, one behind the
 * other. normal: NULL where none is drawn. */
struct page {
    float *texels, *half;
    uint8_t (*color)[4], (*normal)[4], (*spare)[4];
};
/* Slices that are encoded side by side. */
enum { PAGES = 8 };

static size_t mip_texels(const struct stack_array *array)
{
    size_t count = 0;
    for (int level = 0; level < array->levels; level++)
        count += (size_t)(array->width_px >> level ? array->width_px >> level : 1) *
                 (size_t)(array->height_px >> level ? array->height_px >> level : 1);
    return count;
}

/* The textures that slices go to: an array's, or its colours in the shade. */
static struct stack_array textures_of(const struct stack *stack, const struct stack_array *array,
                                      bool shaded)
{
    struct stack_array textures = *array;
    textures.color = shaded ? array->normal : array->color;
    textures.normal = stack->request.turns > 0 ? 0 : array->normal;
    return textures;
}

static void pages_open(struct arena *arena, const struct stack_array *array,
                       struct page pages[PAGES])
{
    size_t texels = (size_t)array->width_px * (size_t)array->height_px, all = mip_texels(array);
    for (int i = 0; i < PAGES; i++)
        pages[i] = (struct page){
            ARENA_ARRAY(arena, float, texels *SLICES_FLOATS),
            ARENA_ARRAY(arena, float, texels *SLICES_FLOATS), arena_alloc(arena, all, 4),
            array->normal ? arena_alloc(arena, all, 4) : NULL, arena_alloc(arena, texels, 4)};
}

/* Colours that carry their coverage stay 0 where there is none: only normals are dilated then. */
static void page_encode(const struct stack_request *request, struct page *page, size_t at,
                        int width_px, int height_px)
{
    size_t count = (size_t)width_px * (size_t)height_px;
    uint8_t(*color)[4] = page->color + at, (*normal)[4] = page->normal ? page->normal + at : NULL;
    slices_encode(page->texels, count, request->straight, request->unit, color, normal);
    if (!request->dilate)
        return;
    memcpy(page->spare, color, count * sizeof *color);
    slices_dilate(request->straight ? color : page->spare, normal, width_px, height_px, 2);
}

/* One slice and its mip levels. */
static void slice_encode(const struct stack_request *request, const struct stack_array *array,
                         const struct slices *slices, int slice, struct page *page)
{
    int width = array->width_px, height = array->height_px;
    size_t at = 0;
    slices_expand(slices, 0, slice, page->texels);
    for (int level = 0; level < array->levels; level++) {
        page_encode(request, page, at, width, height);
        at += (size_t)width * (size_t)height;
        slices_halve(page->texels, width, height, page->half);
        float *swap = page->texels;
        page->texels = page->half;
        page->half = swap;
        width = width > 1 ? width / 2 : 1;
        height = height > 1 ? height / 2 : 1;
    }
}

static void slice_upload(struct gl *gl, const struct stack_array *array, int layer,
                         const struct page *page)
{
    int width = array->width_px, height = array->height_px;
    size_t at = 0;
    for (int level = 0; level < array->levels; level++) {
        gl->TextureSubImage3D(array->color, level, 0, 0, layer, width, height, 1, GL_RGBA,
                              GL_UNSIGNED_BYTE, page->color + at);
        if (page->normal)
            gl->TextureSubImage3D(array->normal, level, 0, 0, layer, width, height, 1, GL_RGBA,
                                  GL_UNSIGNED_BYTE, page->normal + at);
        at += (size_t)width * (size_t)height;
        width = width > 1 ? width / 2 : 1;
        height = height > 1 ? height / 2 : 1;
    }
}

/* All slices of a level into its layers. */
static void level_upload(struct workspace *workspace, const struct stack *stack,
                         const struct stack_array *array, const struct slices *slices, int layer,
                         struct page pages[PAGES])
{
    for (int first = 0; first < slices->count; first += PAGES) {
        int count = slices->count - first < PAGES ? slices->count - first : PAGES;
#pragma omp parallel for num_threads(workspace->threads > 0 ? workspace->threads : 1)              \
    schedule(dynamic)
        for (int k = 0; k < count; k++)
            slice_encode(&stack->request, array, slices, first + k, &pages[k]);
        for (int k = 0; k < count; k++)
            slice_upload(workspace->gl, array, layer + first + k, &pages[k]);
    }
}

static void side_upload(struct workspace *workspace, const struct stack *stack,
                        const struct pyramid *pyramid, const struct stack_side *side)
{
    struct arena *scratch = arena_create(0);
    struct stack_array textures = textures_of(stack, &stack->arrays[side->array], false);
    struct page pages[PAGES];
    pages_open(scratch, &textures, pages);
    for (int kind = 0; kind < pyramid->kinds; kind++) {
        textures = textures_of(stack, &stack->arrays[side->array], kind / 2);
        for (int l = stack->request.turns > 0 || kind == 0 ? 0 : 1; l < pyramid->levels; l++)
            level_upload(workspace, stack, &textures, pyramid->slices[l][kind],
                         side->levels[l].layer[kind % 2], pages);
    }
    arena_destroy(scratch);
}

static void array_create(struct gl *gl, const struct stack *stack, struct stack_array *array)
{
    const struct stack_request *request = &stack->request;
    GLuint *textures[2] = {&array->color, &array->normal};
    for (int i = 0; i < (request->turns > 0 && !stack->shadows ? 1 : 2); i++) {
        *textures[i] = gl_texture(gl, GL_TEXTURE_2D_ARRAY, array->levels, GL_RGBA8, array->width_px,
                                  array->height_px, array->layers);
        gl->TextureParameteri(*textures[i], GL_TEXTURE_MIN_FILTER,
                              request->trilinear || request->smooth ? GL_LINEAR_MIPMAP_LINEAR
                                                                    : GL_LINEAR_MIPMAP_NEAREST);
        gl->TextureParameteri(*textures[i], GL_TEXTURE_MAG_FILTER, GL_LINEAR);
        gl->TextureParameteri(*textures[i], GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
        gl->TextureParameteri(*textures[i], GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    }
}

/* A sphere about the plant's axis that holds all boxes. */
static struct cull_bound bound_of(const struct stack_plant *plant, size_t sides)
{
    float low = INFINITY, high = -INFINITY, across = 0;
    for (size_t d = 0; d < sides; d++)
        for (int corner = 0; corner < 8; corner++) {
            const struct slices_stack *box = &plant->sides[d].frame;
            float a = corner & 1 ? box->high_m[0] : box->low_m[0];
            float b = corner & 2 ? box->high_m[1] : box->low_m[1];
            float c = corner & 4 ? box->high_m[2] : box->low_m[2], p[3];
            for (int i = 0; i < 3; i++)
                p[i] = a * box->right[i] + b * box->up[i] + c * box->toward[i];
            low = fminf(low, p[1]);
            high = fmaxf(high, p[1]);
            across = fmaxf(across, hypotf(p[0], p[2]));
        }
    return (struct cull_bound){0.5f * (low + high), hypotf(across, 0.5f * (high - low))};
}

/* The slices of one plant (species and step of rotation), a pyramid a direction. */
static enum status plant_slices(struct workspace *workspace, struct arena *scratch,
                                const struct stack *stack, size_t index, struct pyramid *pyramids,
                                float *texel_m)
{
    const struct slices_request *all = &stack->request.bake;
    struct plant *plant = stack->scene->species[index / stack->steps_count].plant;
    struct slices_light lights[STACK_LIGHTS];
    struct slices_request whole = *all;
    float longest_m = 0;
    bool lit = stack->request.turns > 0;
    if (lit)
        stack_lights(workspace, stack, index, lights);
    enum status status = size_of(workspace, scratch, plant, &stack->request, &longest_m, &whole);
    for (size_t d = 0; d < all->directions_count && status == STATUS_OK; d++) {
        struct slices_request one = *all;
        one.directions_count = 1;
        one.directions = all->directions + d;
        one.lights_count = !lit ? 0 : stack->shadows ? STACK_LIGHTS : STACK_LIGHTS / 2;
        one.lights = lights;
        status = size_of(workspace, scratch, plant, &stack->request, &longest_m, &one);
        if (status == STATUS_OK)
            status = pyramid_create(workspace, scratch, plant, &one, &pyramids[d]);
    }
    *texel_m = longest_m / (float)stack->request.resolution_px;
    return status;
}

/* What the drawing must know of a plant. */
static void plant_plan(struct arena *arena, struct stack *stack, const struct pyramid *pyramids,
                       float texel_m, struct stack_plant *plant)
{
    size_t sides = stack->request.bake.directions_count;
    plant->sides = ARENA_ARRAY(arena, struct stack_side, sides);
    for (size_t d = 0; d < sides; d++)
        side_plan(arena, stack, &pyramids[d], &plant->sides[d]);
    plant->texel_m = texel_m;
    plant->albedo_scale = pyramids[0].slices[0][0]->albedo_scale;
    plant->bound = bound_of(plant, sides);
    if (stack->request.ground != GROUND_UPRIGHT)
        plant->bound.radius_m *= 2;
}

/* Bakes what has trees; plans and makes the textures the first time. */
static enum status bake_all(struct workspace *workspace, struct stack *stack, bool first)
{
    size_t sides = stack->request.bake.directions_count;
    struct arena *scratch = arena_create(0);
    struct pyramid *pyramids = ARENA_ARRAY(scratch, struct pyramid, stack->plants_count * sides);
    bool *wanted = ARENA_ARRAY(scratch, bool, stack->plants_count);
    enum status status = STATUS_OK;
    for (size_t i = 0; i < stack->scene->instances_count; i++)
        wanted[stack_plant_index(stack, &stack->scene->instances[i])] = true;
    for (size_t i = 0; i < stack->plants_count && status == STATUS_OK; i++) {
        float texel_m;
        if (!wanted[i])
            continue;
        status = plant_slices(workspace, scratch, stack, i, pyramids + i * sides, &texel_m);
        if (status == STATUS_OK && first)
            plant_plan(workspace->arena, stack, pyramids + i * sides, texel_m, &stack->plants[i]);
    }
    for (size_t i = 0; i < stack->arrays_count && status == STATUS_OK && first; i++)
        array_create(workspace->gl, stack, &stack->arrays[i]);
    for (size_t i = 0; i < stack->plants_count * sides && status == STATUS_OK; i++)
        if (wanted[i / sides])
            side_upload(workspace, stack, &pyramids[i], &stack->plants[i / sides].sides[i % sides]);
    arena_destroy(scratch);
    return status == STATUS_OK ? gl_check(workspace->gl, "slices", workspace->error) : status;
}

enum status stack_bake(struct workspace *workspace, struct stack *stack)
{
    struct view view;
    stack_steps(workspace, stack);
    stack->plants_count = stack->scene->species_count * stack->steps_count;
    stack->plants = ARENA_ARRAY(workspace->arena, struct stack_plant, stack->plants_count);
    stack->arrays = ARENA_ARRAY(workspace->arena, struct stack_array,
                                stack->plants_count * stack->request.bake.directions_count);
    view_at(stack->scene, 0, &view);
    memcpy(stack->sun_direction, view.sun_direction, sizeof stack->sun_direction);
    return bake_all(workspace, stack, true);
}

enum status stack_relight(struct workspace *workspace, struct stack *stack,
                          const float sun_direction[3])
{
    if (stack->request.turns == 0 ||
        !memcmp(stack->sun_direction, sun_direction, sizeof stack->sun_direction))
        return STATUS_OK;
    memcpy(stack->sun_direction, sun_direction, sizeof stack->sun_direction);
    return bake_all(workspace, stack, false);
}
