/* Drawing of forests as stacks of slices: programs, buffers, runs of trees. */
#include "bake/stack_bake.h"
#include "bake/tally.h"

#include "stack.glsl.h"

#include <string.h>

/* A batch is what is uploaded at a time. */
enum { BATCH_PARTS = 1 << 16, BATCH_QUADS = 1 << 18, INDEXED_QUADS = 1 << 14, CORNERS = 4 };
enum {
    TREE_QUADS = STACK_CROSSED_MOST > PARTS_MOST *STACK_QUADS_MOST
                     ? (int)STACK_CROSSED_MOST
                     : PARTS_MOST *(int)STACK_QUADS_MOST
};

static GLuint upload_indices(struct gl *gl)
{
    static const uint32_t corners[6] = {0, 1, 2, 0, 2, 3};
    struct arena *scratch = arena_create(0);
    uint32_t *indices = ARENA_ARRAY(scratch, uint32_t, 6 * INDEXED_QUADS);
    for (uint32_t i = 0; i < 6 * INDEXED_QUADS; i++)
        indices[i] = CORNERS * (i / 6) + corners[i % 6];
    GLuint buffer = gl_buffer(gl, 6 * INDEXED_QUADS * sizeof *indices, indices, 0);
    arena_destroy(scratch);
    return buffer;
}

static enum status stack_program(struct workspace *workspace, struct stack *stack)
{
    const struct stack_request *request = &stack->request;
    struct arena *scratch = arena_create(0);
    const char *defines = arena_printf(
        scratch, "%s%s%s%s%s%s%s%s%s%s%s", request->trilinear ? "TRILINEAR 1\n" : "",
        request->straight ? "STRAIGHT 1\n" : "", request->rough ? "ROUGH 1\n" : "",
        request->interpolate ? "INTERPOLATE 1\n" : "", request->facing ? "FACING 1\n" : "",
        request->oblique ? "OBLIQUE 1\n" : "",
        request->interpolate || request->smooth || request->mix != STACK_ONE ? "POWER 1\n" : "",
        scene_is_stretched(stack->scene) ? "STRETCHED 1\n" : "",
        request->turns > 0 ? "LIT 1\n" : "", request->ground != GROUND_UPRIGHT ? "BENT 1\n" : "",
        workspace->effects & EFFECT_FOG ? "FOG 1\n" : "");
    enum status status = shadow_receiver_program(workspace, sun_shadows_map(stack->shadows),
                                                 "stack", stack_glsl, defines, &stack->program);
    arena_destroy(scratch);
    return status;
}

enum status stack_prepare(struct workspace *workspace, const struct scene *scene,
                          const struct stack_request *request, struct stack **result)
{
    struct gl *gl = workspace->gl;
    struct arena *arena = workspace->arena;
    struct stack *stack = *result = ARENA_NEW(arena, struct stack);
    stack->scene = scene;
    stack->request = *request;
    const float octaves = request->groups > 0 ? 0 : request->near_octaves;
    enum status status = backdrop_prepare(workspace, scene, &stack->backdrop);
    if (status == STATUS_OK)
        status = shadow_choice_prepare(workspace, scene, &request->sun, true, stack->backdrop,
                                       &stack->shadows);
    if (status == STATUS_OK)
        status = stack_bake(workspace, stack);
    if (status == STATUS_OK)
        status = stack_program(workspace, stack);
    if (status == STATUS_OK)
        status = nearby_prepare(workspace, scene, request->near_radii, octaves,
                                sun_shadows_map(stack->shadows), &stack->nearby);
    if (status == STATUS_OK && octaves > 0)
        status = stack_near_prepare(workspace, &stack->turning);
    if (status == STATUS_OK && request->distant_px > 0 && !stack->shadows &&
        workspace->lod == LOD_AUTO && request->ground == GROUND_UPRIGHT &&
        !scene_is_stretched(scene))
        status = distant_prepare(workspace, scene, request->distant_px,
                                 request->smooth ? 1.0f / STACK_BAND : 0, &stack->distant);
    if (status == STATUS_OK && request->groups > 0)
        status = stack_front_prepare(workspace, &stack->front);
    if (status != STATUS_OK)
        return status;
    struct cull_bound *bounds = ARENA_ARRAY(arena, struct cull_bound, scene->species_count + 1);
    for (size_t i = 0; i < scene->instances_count; i++)
        bounds[scene->instances[i].species] = stack_plant_of(stack, &scene->instances[i])->bound;
    stack->cull = cull_create(arena, scene, bounds);
    stack->trees = ARENA_ARRAY(arena, struct stack_tree, BATCH_PARTS);
    stack->quads = ARENA_ARRAY(arena, struct stack_quad, BATCH_QUADS);
    stack->trees_buffer =
        gl_buffer(gl, BATCH_PARTS * sizeof *stack->trees, NULL, GL_DYNAMIC_STORAGE_BIT);
    stack->quads_buffer =
        gl_buffer(gl, BATCH_QUADS * sizeof *stack->quads, NULL, GL_DYNAMIC_STORAGE_BIT);
    if (request->ground != GROUND_UPRIGHT) {
        stack->bends = ARENA_ARRAY(arena, struct stack_bend, BATCH_PARTS);
        stack->bends_buffer =
            gl_buffer(gl, BATCH_PARTS * sizeof *stack->bends, NULL, GL_DYNAMIC_STORAGE_BIT);
    }
    stack->vertices = gl_vertex_array(gl);
    gl->VertexArrayElementBuffer(stack->vertices, upload_indices(gl));
    return gl_check(gl, "stacks", workspace->error);
}

static void use_program(struct workspace *workspace, const struct stack *stack,
                        const struct view *view)
{
    struct gl *gl = workspace->gl;
    gl->UseProgram(stack->program);
    gl->BindVertexArray(stack->vertices);
    gl->BindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, stack->trees_buffer);
    gl->BindBufferBase(GL_SHADER_STORAGE_BUFFER, 1, stack->quads_buffer);
    gl->BindBufferBase(GL_SHADER_STORAGE_BUFFER, 2, stack->bends_buffer);
    shade_uniforms(workspace, stack->program, stack->scene, view);
    shadow_receiver_uniforms(workspace, sun_shadows_map(stack->shadows), stack->program);
    if (stack->front) {
        stack_front_under(workspace);
        return;
    }
    gl->Enable(GL_BLEND);
    gl->BlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
    gl->DepthMask(GL_FALSE);
}

/* Quads [first, first + count) of one texture array. */
static void draw_run(struct workspace *workspace, const struct stack *stack, size_t index,
                     size_t first, size_t count)
{
    struct gl *gl = workspace->gl;
    const struct stack_array *array = &stack->arrays[index];
    gl->BindTextureUnit(0, array->color);
    gl->BindTextureUnit(1, array->normal);
    gl->Uniform2f(gl_uniform(gl, stack->program, "layer_px"), (float)array->width_px,
                  (float)array->height_px);
    GLint where = gl_uniform(gl, stack->program, "first_quad");
    for (size_t at = first, next, end = first + count; at < end; at = next) {
        next = end - at < INDEXED_QUADS ? end : at + INDEXED_QUADS;
        for (size_t i = at + 1; stack->request.each && i < next; i++)
            if (stack->quads[i].tree != stack->quads[at].tree)
                next = i;
        gl->Uniform1i(where, (GLint)at);
        gl_draw_elements(gl, GL_TRIANGLES, (GLsizei)(6 * (next - at)), GL_UNSIGNED_INT, 0, 1, 0, 0);
    }
}

/* What of a batch is filled. */
struct fill {
    size_t parts, quads;
};

/* The levels that replace others, behind those that they replace; returns how many the latter are.
 * Either have at most one part of a side, and keep their order. */
static int levels_apart(struct stack_part *parts, int count)
{
    struct stack_part later[PARTS_MOST];
    int first = 0, second = 0;
    for (int k = 0; k < count; k++)
        if (k > 0 && parts[k].side == parts[k - 1].side)
            later[second++] = parts[k];
        else
            parts[first++] = parts[k];
    memcpy(parts + first, later, (size_t)second * sizeof *later);
    return first;
}

/* Quads of parts that cross. Where numbers of slices change, each number is in order by itself. */
static struct fill fill_crossed(const struct stack *stack, const struct stack_part *parts,
                                int count, int apart, struct fill fill)
{
    for (int set = 0; set < 2; set++) {
        int first = set ? apart : 0, some = set ? count - apart : apart;
        if (some > 0)
            fill.quads += stack_crossed_quads(stack, parts + first, some, &stack->trees[fill.parts],
                                              (uint32_t)fill.parts, stack->quads + fill.quads);
        fill.parts += (size_t)some;
    }
    return fill;
}

/* One tree at the end of the batch, its farthest quad first. */
static struct fill fill_behind(const struct stack *stack, const struct view *view, enum lod lod,
                               const struct instance *instance, struct fill fill)
{
    struct stack_part parts[PARTS_MOST];
    const bool crossed = stack->request.mix == STACK_CROSSED;
    int count = stack_parts(stack, view, lod, instance, parts);
    int apart = crossed ? levels_apart(parts, count) : 0;
    const size_t number = (size_t)(instance - stack->scene->instances);
    const float left = stack->distant ? 1 - distant_share(stack->distant, number) : 1;
    for (int k = 0; k < count; k++) {
        struct stack_tree *tree = &stack->trees[fill.parts + (size_t)k];
        stack_tree_fill(stack, view, instance, &parts[k], tree);
        tree->power *= left;
        if (stack->bends)
            stack_bend_fill(stack, instance, tree, &stack->bends[fill.parts + (size_t)k]);
    }
    if (crossed)
        return fill_crossed(stack, parts, count, apart, fill);
    for (int first = 0, end; first < count; first = end) {
        for (end = first + 1; end < count && parts[end].side == parts[first].side;)
            end++;
        fill.quads += stack_quads(stack, parts + first, end - first, stack->trees + fill.parts,
                                  (uint32_t)fill.parts, stack->quads + fill.quads);
        fill.parts += (size_t)(end - first);
    }
    return fill;
}

/* In the order in which what is bound is drawn. */
static struct fill fill_tree(const struct stack *stack, const struct view *view, enum lod lod,
                             const struct instance *instance, struct fill fill)
{
    struct fill filled = fill_behind(stack, view, lod, instance, fill);
    if (!stack->front)
        return filled;
    for (size_t low = fill.quads, high = filled.quads; low + 1 < high; low++, high--) {
        struct stack_quad swap = stack->quads[low];
        stack->quads[low] = stack->quads[high - 1];
        stack->quads[high - 1] = swap;
    }
    return filled;
}

static void draw_batch(struct workspace *workspace, const struct stack *stack, struct fill fill)
{
    struct gl *gl = workspace->gl;
    if (fill.quads == 0)
        return;
    gl->NamedBufferSubData(stack->trees_buffer, 0, (GLsizeiptr)(fill.parts * sizeof *stack->trees),
                           stack->trees);
    if (stack->bends)
        gl->NamedBufferSubData(stack->bends_buffer, 0,
                               (GLsizeiptr)(fill.parts * sizeof *stack->bends), stack->bends);
    gl->NamedBufferSubData(stack->quads_buffer, 0, (GLsizeiptr)(fill.quads * sizeof *stack->quads),
                           stack->quads);
    for (size_t first = 0, end; first < fill.quads; first = end) {
        uint32_t array = stack->trees[stack->quads[first].tree].array;
        for (end = first + 1;
             end < fill.quads && stack->trees[stack->quads[end].tree].array == array;)
            end++;
        draw_run(workspace, stack, array, first, end - first);
    }
}

enum status stack_backdrop(struct workspace *workspace, struct stack *stack,
                           const struct view *view, struct target *target)
{
    enum status status = stack_relight(workspace, stack, view->sun_direction);
    if (status == STATUS_OK)
        status = sun_shadows_update(workspace, stack->shadows, view, NULL);
    if (status != STATUS_OK)
        return status;
    workspace->gl->BindFramebuffer(GL_FRAMEBUFFER, target->framebuffer);
    backdrop_draw(workspace, stack->backdrop, view);
    workspace->gl->Flush(); /* a software GL fills it while the trees are culled and sorted */
    return STATUS_OK;
}

/* Trees [first, end) of a list in its order. */
static void draw_stacks(struct workspace *workspace, const struct stack *stack,
                        const struct view *view, const struct cull_list *list, size_t first,
                        size_t end)
{
    struct fill fill = {0, 0};
    if (first == end)
        return;
    use_program(workspace, stack, view);
    tally_texels_begin(workspace);
    for (size_t i = first; i < end; i++) {
        if (fill.parts + PARTS_MOST > BATCH_PARTS || fill.quads + TREE_QUADS > BATCH_QUADS) {
            draw_batch(workspace, stack, fill);
            fill = (struct fill){0, 0};
        }
        fill = fill_tree(stack, view, workspace->lod, &stack->scene->instances[list->instances[i]],
                         fill);
    }
    draw_batch(workspace, stack, fill);
    uint64_t textures = stack->request.turns > 0 && !stack->shadows ? 1 : 2;
    tally_texels_end(workspace,
                     textures * (stack->request.interpolate ? 2 : 1) +
                         sun_shadows_samples(stack->shadows),
                     false);
    workspace->gl->Disable(GL_BLEND);
    workspace->gl->DepthMask(GL_TRUE);
}

/* Groups of as many trees each; near trees first, as back to front. */
static enum status draw_front_to_back(struct workspace *workspace, struct stack *stack,
                                      const struct view *view, const struct target *target,
                                      const struct cull_list *list)
{
    size_t groups = (size_t)stack->request.groups;
    enum status status = nearby_draw(workspace, stack->nearby, view, 1, stack->cull);
    stack_front_begin(workspace, stack->front, target);
    for (size_t group = 0; group < groups; group++) {
        size_t first = list->count * group / groups, end = list->count * (group + 1) / groups;
        if (first == end)
            continue;
        if (first > 0)
            stack_front_close(workspace, stack->front);
        draw_stacks(workspace, stack, view, list, first, end);
    }
    stack_front_end(workspace, stack->front, target);
    workspace->gl->Disable(GL_BLEND);
    workspace->gl->DepthMask(GL_TRUE);
    return status;
}

/* One tree by its slices and by its triangles, mixed. */
static enum status draw_turning(struct workspace *workspace, struct stack *stack,
                                const struct view *view, const struct target *target,
                                const struct cull_list *list, size_t at)
{
    uint32_t instance = list->instances[at];
    stack_near_slices(workspace, stack->turning, target);
    draw_stacks(workspace, stack, view, list, at, at + 1);
    stack_near_triangles(workspace, stack->turning, target);
    enum status status = nearby_draw_one(workspace, stack->nearby, view, instance, 1, stack->cull);
    stack_near_end(workspace, stack->turning, target, nearby_share(stack->nearby, instance));
    return status;
}

/* Near trees first: slices before their triangles are over them, those behind are not drawn. */
static enum status draw_back_to_front(struct workspace *workspace, struct stack *stack,
                                      const struct view *view, const struct target *target,
                                      const struct cull_list *list)
{
    enum status status = nearby_draw(workspace, stack->nearby, view, 1, stack->cull);
    size_t first = 0;
    for (size_t i = 0; i < list->count && stack->turning && status == STATUS_OK; i++) {
        if (!(nearby_share(stack->nearby, list->instances[i]) > 0))
            continue;
        draw_stacks(workspace, stack, view, list, first, i);
        status = draw_turning(workspace, stack, view, target, list, i);
        first = i + 1;
    }
    draw_stacks(workspace, stack, view, list, first, list->count);
    return status;
}

enum status stack_trees(struct workspace *workspace, struct stack *stack, const struct view *view,
                        const struct target *target)
{
    struct gl *gl = workspace->gl;
    enum cull_order order = stack->front ? CULL_FRONT_TO_BACK : CULL_BACK_TO_FRONT;
    struct cull_list list = stack->distant ? distant_cull(stack->distant, stack->cull, view, order)
                                           : cull_view(stack->cull, view, order);
    enum status status;
    nearby_take(stack->nearby, view, order, &list);
    status = stack->distant ? distant_draw(workspace, stack->distant, view) : STATUS_OK;
    if (status != STATUS_OK)
        return status;
    status = stack->front ? draw_front_to_back(workspace, stack, view, target, &list)
                          : draw_back_to_front(workspace, stack, view, target, &list);
    gl->BindVertexArray(0);
    gl->UseProgram(0);
    for (GLuint i = 0; i < 3; i++) {
        gl->BindTextureUnit(i, 0);
        gl->BindBufferBase(GL_SHADER_STORAGE_BUFFER, i, 0);
    }
    return status == STATUS_OK ? gl_check(gl, "stacks", workspace->error) : status;
}

enum status stack_draw(struct workspace *workspace, struct stack *stack, const struct view *view,
                       struct target *target)
{
    enum status status = stack_backdrop(workspace, stack, view, target);
    return status == STATUS_OK ? stack_trees(workspace, stack, view, target) : status;
}
