/* polygons: every triangle, instanced and culled; an error-controlled level of detail far away.
 *
 * A tree's level follows from how large a metre appears at its nearest point. Near: all leaves,
 * with the coarsest bark whose surface has moved by less than error_px. Far: a run of the plant's
 * pruned elements (bake/prune.h), as many as its area has pixels of error_px squared, so that no
 * element grows past that size; a tree below a pixel is two of them. Each tree takes its own of 16
 * runs, so that far trees are not all the same two leaves. The representation with fewer triangles
 * is drawn. */
#include "bake/backdrop.h"
#include "bake/cull.h"
#include "bake/detail.h"
#include "bake/prune.h"
#include "bake/sampling.h"
#include "base/random.h"
#include "method/method.h"

#include "polygons.glsl.h"

#include <math.h>
#include <string.h>

enum { RUNS = 16, STEPS_MAX = 64, PROBES_MAX = 512 };

struct options {
    int samples;
    float error_px;
    bool smooth, contrast;
};

/* clang-format off */
static const struct option option_table[] = {
    OPTION_WORD(struct options, samples, 0, "1|4|16",
        "samples a pixel: 4 are multisampled, 16 too where the driver has them, else 4 in 2 x 2 texels"),
    OPTION(struct options, error_px, 1, 0.1, 64, "px",
        "how large a pruned leaf may grow, and 8 times how far bark may move, at lod=auto; "
        "twice as much at intermediate, four times at low"),
    OPTION(struct options, smooth, 1, 0, 1, "", "pruned leaves shrink away one by one instead of in steps"),
    OPTION(struct options, contrast, 1, 0, 1, "",
        "pruned leaves are drawn nearer to their mean radiance, as each stands for many"),
    OPTION_END,
};
/* clang-format on */

enum {
    VARIANT_BARK,
    VARIANT_LEAF,
    VARIANT_LEAF_LIT,
    VARIANT_BARK_TEXTURED,
    VARIANT_LEAF_TEXTURED,
    VARIANT_PRUNED,
    VARIANTS
};
static const char *const variant_defines[VARIANTS] = {"",
                                                      "LEAF 1",
                                                      "LEAF 1\nLIT_AT_VERTICES 1",
                                                      "TEXTURED 1",
                                                      "LEAF 1\nTEXTURED 1",
                                                      "PRUNED 1\nLIT_AT_VERTICES 1"};

struct batch {
    int variant;
    bool bark;
    GLuint texture; /* 0: none */
    bool cull_back;
    struct detail_range levels[DETAIL_LEVELS_MAX];
};

/* A species on the GPU. Its groups of instances: one a detail level, then RUNS a step of pruning.
 */
struct kind {
    bool drawn; /* some tree is of it */
    struct cull_bound bound;
    float half_height_m, radius_m;           /* of the cylinder about its axis that holds it */
    GLuint detail_vertices, pruned_vertices; /* vertex arrays */
    size_t batches_count;
    struct batch *batches;
    size_t levels_count;
    float errors_m[DETAIL_LEVELS_MAX];
    size_t level_triangles[DETAIL_LEVELS_MAX];
    uint32_t probes_count;
    struct prune_vertex *probes; /* some elements, for the plant's mean radiance */
    float area_m2;
    uint32_t elements; /* of pruning; 0: none */
    uint32_t steps_count;
    int step_bark[STEPS_MAX]; /* the level of bark that is drawn with a step; -1: its elements */
    uint32_t step_elements[STEPS_MAX]; /* descending, each 1/sqrt(2) of the one before */
    uint32_t first_group, groups_count;
};

/* The instanced attributes `place` and `turn` of polygons.glsl. */
struct placed {
    float place[4], turn[4];
};

struct command { /* DrawElementsIndirectCommand */
    uint32_t count, instances, first_index;
    int32_t base_vertex;
    uint32_t base_instance;
};

/* One call's worth of commands: which program, which mesh. */
struct call {
    const struct kind *kind;
    const struct batch *batch; /* NULL: pruning */
    size_t first, count;
    uint64_t triangles;
};

struct state {
    const struct scene *scene;
    const struct options *options;
    float tolerance_px; /* 0: every triangle */
    struct backdrop *backdrop;
    struct sampling *sampling;
    struct cull *cull;
    size_t kinds_count;
    struct kind *kinds;
    GLuint programs[VARIANTS]; /* those in use */
    float (*turns)[2];         /* instances_count: scale cos, scale sin */
    uint8_t *runs;             /* instances_count: which run of elements */
    GLuint placed_buffer, command_buffer;
    size_t commands_room, commands_count;
    struct command *commands;
    struct call *calls; /* of a frame: one a batch and one a kind's pruning at most */
    uint32_t *groups;   /* instances_count */
    uint32_t *first;    /* groups_count + 1 */
    size_t groups_count;
    struct target sampled,
        enlarged; /* multisampled twin; its size, for 16 samples in 2 x 2 texels */
};

/* Twigs are thinner than a pixel long before they may be left out: bark moves by this share of
 * error_px. */
static const float BARK_SHARE = 0.125f, BARK_AREA_KEPT = 0.75f;

static const int samples_of_word[] = {1, 4, 16};

static void attribute(struct gl *gl, GLuint array, GLuint location, GLuint binding, GLint size,
                      GLenum type, size_t offset)
{
    gl->VertexArrayAttribFormat(array, location, size, type, type != GL_FLOAT, (GLuint)offset);
    gl->VertexArrayAttribBinding(array, location, binding);
    gl->EnableVertexArrayAttrib(array, location);
}

/* Binding 0: vertices, 1: texture coordinates, 2: instances. */
static GLuint vertex_array(struct gl *gl, GLuint vertices, GLsizei stride, size_t normal_offset,
                           size_t albedo_offset, GLuint elements, GLuint placed)
{
    GLuint array = gl_vertex_array(gl);
    gl->VertexArrayVertexBuffer(array, 0, vertices, 0, stride);
    gl->VertexArrayVertexBuffer(array, 2, placed, 0, sizeof(struct placed));
    gl->VertexArrayBindingDivisor(array, 2, 1);
    gl->VertexArrayElementBuffer(array, elements);
    attribute(gl, array, 0, 0, 3, GL_FLOAT, 0);
    attribute(gl, array, 1, 0, 4, GL_SHORT, normal_offset);
    attribute(gl, array, 2, 0, 4, GL_UNSIGNED_SHORT, albedo_offset);
    attribute(gl, array, 5, 2, 4, GL_FLOAT, offsetof(struct placed, place));
    attribute(gl, array, 6, 2, 4, GL_FLOAT, offsetof(struct placed, turn));
    return array;
}

/* At full resolution only: a texel's alpha decides as in the reference, and samples average the
 * result. */
static GLuint upload_texture(struct gl *gl, const struct texture *texture)
{
    GLuint name =
        gl_texture(gl, GL_TEXTURE_2D, 1, GL_RGBA16F, texture->width_px, texture->height_px, 1);
    gl->TextureSubImage2D(name, 0, 0, 0, texture->width_px, texture->height_px, GL_RGBA, GL_FLOAT,
                          texture->rgba);
    gl->TextureParameteri(name, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    gl->TextureParameteri(name, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    return name;
}

static int batch_variant(const struct detail_batch *batch)
{
    bool leaf = batch->kind == MATERIAL_LEAF;
    if (batch->texture)
        return leaf ? VARIANT_LEAF_TEXTURED : VARIANT_BARK_TEXTURED;
    if (leaf)
        return batch->flat ? VARIANT_LEAF_LIT : VARIANT_LEAF;
    return VARIANT_BARK;
}

static void upload_detail(struct workspace *workspace, struct state *state, struct kind *kind,
                          const struct detail *detail)
{
    struct gl *gl = workspace->gl;
    GLuint vertices = gl_buffer(gl, (GLsizeiptr)(detail->vertices_count * sizeof *detail->vertices),
                                detail->vertices, 0);
    GLuint elements = gl_buffer(gl, (GLsizeiptr)(detail->indices_count * sizeof *detail->indices),
                                detail->indices, 0);
    kind->detail_vertices =
        vertex_array(gl, vertices, sizeof *detail->vertices, offsetof(struct detail_vertex, normal),
                     offsetof(struct detail_vertex, albedo), elements, state->placed_buffer);
    if (detail->uvs) {
        GLuint uvs = gl_buffer(gl, (GLsizeiptr)(detail->vertices_count * sizeof *detail->uvs),
                               detail->uvs, 0);
        gl->VertexArrayVertexBuffer(kind->detail_vertices, 1, uvs, 0, sizeof *detail->uvs);
        attribute(gl, kind->detail_vertices, 3, 1, 2, GL_FLOAT, 0);
    }
    kind->batches_count = detail->batches_count;
    kind->batches = ARENA_ARRAY(workspace->arena, struct batch, detail->batches_count);
    for (size_t b = 0; b < detail->batches_count; b++) {
        const struct detail_batch *from = &detail->batches[b];
        struct batch *batch = &kind->batches[b];
        batch->variant = batch_variant(from);
        batch->bark = from->kind == MATERIAL_BARK;
        batch->cull_back = from->closed;
        batch->texture = from->texture ? upload_texture(gl, from->texture) : 0;
        memcpy(batch->levels, from->levels, sizeof batch->levels);
    }
    kind->levels_count = detail->levels_count;
    memcpy(kind->errors_m, detail->errors_m, sizeof kind->errors_m);
    memcpy(kind->level_triangles, detail->triangles_count, sizeof kind->level_triangles);
}

/* The index list is 0, 1, 2, ... twice: a run that starts late goes on at the beginning. */
static void upload_pruned(struct workspace *workspace, struct state *state, struct arena *passing,
                          struct kind *kind, const struct prune *prune)
{
    struct gl *gl = workspace->gl;
    size_t corners = 3 * prune->count;
    uint32_t *indices = ARENA_ARRAY(passing, uint32_t, 2 * corners);
    for (size_t i = 0; i < 2 * corners; i++)
        indices[i] = (uint32_t)(i < corners ? i : i - corners);
    GLuint vertices =
        gl_buffer(gl, (GLsizeiptr)(corners * sizeof *prune->vertices), prune->vertices, 0);
    GLuint elements = gl_buffer(gl, (GLsizeiptr)(2 * corners * sizeof *indices), indices, 0);
    kind->pruned_vertices =
        vertex_array(gl, vertices, sizeof *prune->vertices, offsetof(struct prune_vertex, normal),
                     offsetof(struct prune_vertex, albedo), elements, state->placed_buffer);
    attribute(gl, kind->pruned_vertices, 4, 0, 3, GL_FLOAT,
              offsetof(struct prune_vertex, center_m));
    kind->elements = (uint32_t)prune->count;
    kind->area_m2 = (float)prune->area_m2;
    kind->probes_count = prune->count < PROBES_MAX ? (uint32_t)prune->count : PROBES_MAX;
    kind->probes = ARENA_ARRAY(workspace->arena, struct prune_vertex, kind->probes_count);
    for (uint32_t i = 0; i < kind->probes_count; i++)
        kind->probes[i] = prune->vertices[3 * i];
    double elements_left = (double)prune->count;
    while (kind->steps_count < STEPS_MAX && elements_left >= 1) {
        kind->step_elements[kind->steps_count++] = (uint32_t)ceil(elements_left);
        if (elements_left <= 2)
            break;
        elements_left = fmax(2, elements_left * 0.70710678118654752);
    }
}

/* The bark of each step of pruning: the coarsest level within the error, while it keeps most of its
 * area. */
static void choose_bark(struct kind *kind, const struct detail *detail)
{
    for (uint32_t step = 0; step < kind->steps_count; step++) {
        float per_m = sqrtf((float)kind->step_elements[step] / kind->area_m2);
        size_t level = 0, bark = 0;
        while (level + 1 < kind->levels_count && kind->errors_m[level + 1] * per_m <= BARK_SHARE)
            level++;
        for (size_t b = 0; b < kind->batches_count; b++)
            bark += kind->batches[b].bark ? kind->batches[b].levels[level].indices_count / 3 : 0;
        bool whole = detail->bark_area_m2[level] >= BARK_AREA_KEPT * detail->bark_area_m2[0];
        bool use = bark > 0 && bark <= kind->step_elements[step] && whole;
        kind->step_bark[step] = use ? (int)level : -1;
    }
}

static enum status prepare_kind(struct workspace *workspace, struct state *state,
                                const struct species *species, struct kind *kind)
{
    const struct mesh *mesh;
    enum status status = plant_mesh(species->plant, &mesh, workspace->error);
    if (status != STATUS_OK)
        return status;
    struct arena *passing = arena_create(0);
    bool simplify = state->tolerance_px > 0;
    kind->bound = cull_bound_of(mesh);
    kind->half_height_m = 0.5f * (mesh->maximum_m[1] - mesh->minimum_m[1]);
    kind->radius_m = mesh->radius_m;
    const struct detail *detail = detail_create(passing, mesh, simplify);
    upload_detail(workspace, state, kind, detail);
    if (simplify)
        upload_pruned(workspace, state, passing, kind,
                      prune_create(passing, mesh, workspace->seed));
    choose_bark(kind, detail);
    arena_destroy(passing);
    return STATUS_OK;
}

static enum status prepare_programs(struct workspace *workspace, struct state *state)
{
    bool wanted[VARIANTS] = {false};
    for (size_t k = 0; k < state->kinds_count; k++) {
        for (size_t b = 0; b < state->kinds[k].batches_count; b++)
            wanted[state->kinds[k].batches[b].variant] = true;
        wanted[VARIANT_PRUNED] |= state->kinds[k].elements > 0;
    }
    for (int v = 0; v < VARIANTS; v++) {
        if (!wanted[v])
            continue;
        enum status status = gl_program(workspace->gl, "polygons", polygons_glsl,
                                        variant_defines[v], &state->programs[v], workspace->error);
        if (status != STATUS_OK)
            return status;
    }
    return STATUS_OK;
}

/* What each tree keeps, and room for the lists of a frame. */
static void prepare_instances(struct workspace *workspace, struct state *state)
{
    const struct scene *scene = state->scene;
    struct arena *arena = workspace->arena;
    size_t count = scene->instances_count;
    size_t calls_room = 0;
    struct cull_bound *bounds = ARENA_ARRAY(arena, struct cull_bound, state->kinds_count);
    for (size_t k = 0; k < state->kinds_count; k++) {
        struct kind *kind = &state->kinds[k];
        bounds[k] = kind->bound;
        kind->first_group = (uint32_t)state->groups_count;
        kind->groups_count = (uint32_t)kind->levels_count + kind->steps_count * RUNS;
        state->groups_count += kind->groups_count;
        calls_room += kind->batches_count + 1;
        state->commands_room += kind->groups_count * (kind->batches_count + 1);
    }
    state->cull = cull_create(arena, scene, bounds);
    state->turns = arena_alloc(arena, count, sizeof *state->turns);
    state->runs = ARENA_ARRAY(arena, uint8_t, count);
    state->groups = ARENA_ARRAY(arena, uint32_t, count);
    state->first = ARENA_ARRAY(arena, uint32_t, state->groups_count + 1);
    state->calls = ARENA_ARRAY(arena, struct call, calls_room);
    state->commands = ARENA_ARRAY(arena, struct command, state->commands_room);
    for (size_t i = 0; i < count; i++) {
        const struct instance *instance = &scene->instances[i];
        state->turns[i][0] = instance->scale * cosf(instance->rotation_rad);
        state->turns[i][1] = instance->scale * sinf(instance->rotation_rad);
        state->runs[i] = (uint8_t)(random_mix(workspace->seed + i) % RUNS);
    }
    state->command_buffer =
        gl_buffer(workspace->gl, (GLsizeiptr)(state->commands_room * sizeof(struct command)), NULL,
                  GL_DYNAMIC_STORAGE_BIT);
}

static enum status prepare(struct workspace *workspace, const struct scene *scene,
                           const void *options, void **state)
{
    static const float allowances[] = {
        [LOD_LOW] = 4, [LOD_INTERMEDIATE] = 2, [LOD_HIGH] = 0, [LOD_AUTO] = 1};
    struct state *made = *state = ARENA_NEW(workspace->arena, struct state);
    made->scene = scene;
    made->options = options;
    made->tolerance_px = made->options->error_px * allowances[workspace->lod];
    made->kinds_count = scene->species_count;
    made->kinds = ARENA_ARRAY(workspace->arena, struct kind, scene->species_count);
    made->placed_buffer =
        gl_buffer(workspace->gl, (GLsizeiptr)(scene->instances_count * sizeof(struct placed)), NULL,
                  GL_MAP_WRITE_BIT);
    for (size_t i = 0; i < scene->instances_count; i++)
        made->kinds[scene->instances[i].species].drawn = true;
    enum status status = backdrop_prepare(workspace, scene, &made->backdrop);
    if (status == STATUS_OK)
        status =
            sampling_prepare(workspace, samples_of_word[made->options->samples], &made->sampling);
    for (size_t k = 0; k < made->kinds_count && status == STATUS_OK; k++)
        if (made->kinds[k].drawn)
            status = prepare_kind(workspace, made, &scene->species[k], &made->kinds[k]);
    if (status == STATUS_OK)
        status = prepare_programs(workspace, made);
    if (status != STATUS_OK)
        return status;
    prepare_instances(workspace, made);
    return gl_check(workspace->gl, "polygons", workspace->error);
}

/* How large a metre of a tree is in tolerances, at the nearest point of the cylinder that holds it.
 */
static float tolerances_per_m(const struct state *state, const struct view *view, float focal_px,
                              const struct kind *kind, uint32_t instance, float depth_m)
{
    float scale = state->scene->instances[instance].scale;
    float slope = fabsf(view->forward[1]);
    float reach_m =
        kind->half_height_m * slope + kind->radius_m * sqrtf(fmaxf(0, 1 - slope * slope));
    float near_m = fmaxf(view->near_m, depth_m - scale * reach_m);
    return focal_px * scale / (near_m * state->tolerance_px);
}

/* The group of a tree: a detail level or a step and run of pruning. */
static uint32_t choose_group(const struct state *state, const struct kind *kind, uint32_t run,
                             float per_m)
{
    uint32_t level = 0;
    if (state->tolerance_px <= 0)
        return kind->first_group;
    while (level + 1 < kind->levels_count && kind->errors_m[level + 1] * per_m <= BARK_SHARE)
        level++;
    double wanted = (double)kind->area_m2 * per_m * per_m;
    if (!(kind->elements > 0) || wanted > kind->elements || wanted >= kind->level_triangles[level])
        return kind->first_group + level;
    uint32_t step = 0;
    if (wanted > 0)
        step = (uint32_t)fmin(fmax(2 * log2(kind->elements / wanted), 0), kind->steps_count - 1);
    while (step > 0 && kind->step_elements[step] < wanted)
        step--;
    return kind->first_group + (uint32_t)kind->levels_count + step * RUNS + run;
}

/* The elements to keep and their growth, so that the kept area is the whole area. */
static void prune_run(const struct state *state, const struct kind *kind, uint32_t group,
                      float per_m, float taper, struct placed *placed)
{
    uint32_t place = group - kind->first_group - (uint32_t)kind->levels_count;
    float most = (float)kind->step_elements[place / RUNS], kept = most;
    if (state->options->smooth)
        kept = fminf(most, fmaxf(kind->area_m2 * per_m * per_m, fminf(2, most)));
    placed->place[3] = (float)((uint64_t)(place % RUNS) * kind->elements / RUNS);
    placed->turn[2] = kept;
    /* the integral of the squared size over a run whose last share, taper, shrinks linearly to 0 */
    placed->turn[3] = sqrtf((float)kind->elements / (kept * (1 - taper * 2 / 3)));
    if (kind->step_bark[place / RUNS] >= 0)
        placed->turn[3] = -placed->turn[3];
}

static float taper_of(const struct state *state)
{
    return state->options->smooth ? 0.5f : 0;
}

/* Culls, chooses and groups the trees, and uploads what the shaders need of each. */
static struct cull_list place_trees(struct workspace *workspace, struct state *state,
                                    const struct view *view)
{
    struct gl *gl = workspace->gl;
    const struct scene *scene = state->scene;
    float focal_px = cull_focal_px(view);
    /* groups go from near to far by themselves; within a detail level the order saves shading */
    struct cull_list list =
        cull_view(state->cull, view, state->tolerance_px > 0 ? CULL_AS_PLACED : CULL_FRONT_TO_BACK);
    for (size_t i = 0; i < list.count; i++) {
        uint32_t at = list.instances[i];
        const struct kind *kind = &state->kinds[scene->instances[at].species];
        state->groups[i] =
            choose_group(state, kind, state->runs[at],
                         tolerances_per_m(state, view, focal_px, kind, at, list.depths_m[i]));
    }
    cull_group(state->cull, &list, state->groups, state->groups_count, state->first);
    if (list.count == 0)
        return list;
    struct placed *placed =
        gl->MapNamedBufferRange(state->placed_buffer, 0, (GLsizeiptr)(list.count * sizeof *placed),
                                GL_MAP_WRITE_BIT | GL_MAP_INVALIDATE_BUFFER_BIT);
    for (size_t k = 0; k < state->kinds_count; k++) {
        const struct kind *kind = &state->kinds[k];
        for (uint32_t g = 0; g < kind->groups_count; g++) {
            uint32_t group = kind->first_group + g;
            for (uint32_t i = state->first[group]; i < state->first[group + 1]; i++) {
                uint32_t at = list.instances[i];
                struct placed tree = {.turn = {state->turns[at][0], state->turns[at][1], 0, 1}};
                memcpy(tree.place, scene->instances[at].position_m, 3 * sizeof *tree.place);
                if (g >= kind->levels_count)
                    prune_run(state, kind, group,
                              tolerances_per_m(state, view, focal_px, kind, at, list.depths_m[i]),
                              taper_of(state), &tree);
                placed[i] = tree;
            }
        }
    }
    gl->UnmapNamedBuffer(state->placed_buffer);
    return list;
}

/* What a batch (NULL: the pruned elements) draws for the trees of a group; nothing: a count of 0.
 */
static struct detail_range group_range(const struct kind *kind, const struct batch *batch,
                                       uint32_t group)
{
    struct detail_range none = {0, 0};
    uint32_t levels = (uint32_t)kind->levels_count;
    if (group < levels)
        return batch ? batch->levels[group] : none;
    uint32_t step = (group - levels) / RUNS, run = (group - levels) % RUNS;
    if (batch)
        return batch->bark && kind->step_bark[step] >= 0 ? batch->levels[kind->step_bark[step]]
                                                         : none;
    return (struct detail_range){3 * (uint32_t)((uint64_t)run * kind->elements / RUNS),
                                 3 * kind->step_elements[step]};
}

/* Commands of one batch for every group that has trees; returns their triangles. */
static uint64_t add_commands(struct state *state, const struct kind *kind,
                             const struct batch *batch)
{
    uint64_t triangles = 0;
    for (uint32_t g = 0; g < kind->groups_count; g++) {
        uint32_t base = state->first[kind->first_group + g];
        uint32_t trees = state->first[kind->first_group + g + 1] - base;
        struct detail_range range = group_range(kind, batch, g);
        if (trees == 0 || range.indices_count == 0)
            continue;
        state->commands[state->commands_count++] =
            (struct command){.count = range.indices_count,
                             .instances = trees,
                             .first_index = range.first_index,
                             .base_instance = base};
        triangles += (uint64_t)range.indices_count / 3 * trees;
    }
    return triangles;
}

static void prune_uniforms(struct workspace *workspace, const struct state *state, GLuint program,
                           const struct kind *kind, const struct view *view)
{
    struct gl *gl = workspace->gl;
    float mean[2][3];
    prune_mean_radiance(kind->probes, kind->probes_count, state->scene, workspace->effects, view,
                        mean);
    gl->Uniform1f(gl_uniform(gl, program, "elements"), (float)kind->elements);
    gl->Uniform1f(gl_uniform(gl, program, "taper"), taper_of(state));
    gl->Uniform1i(gl_uniform(gl, program, "level_contrast"), state->options->contrast);
    gl->Uniform3fv(gl_uniform(gl, program, "mean_bark"), 1, mean[0]);
    gl->Uniform3fv(gl_uniform(gl, program, "mean_leaf"), 1, mean[1]);
}

static void draw_call(struct workspace *workspace, const struct state *state,
                      const struct call *call, const struct view *view)
{
    struct gl *gl = workspace->gl;
    GLuint program = state->programs[call->batch ? call->batch->variant : VARIANT_PRUNED];
    gl->UseProgram(program);
    shade_uniforms(workspace, program, state->scene, view);
    if (!call->batch)
        prune_uniforms(workspace, state, program, call->kind, view);
    gl->BindVertexArray(call->batch ? call->kind->detail_vertices : call->kind->pruned_vertices);
    if (call->batch && call->batch->texture)
        gl->BindTextureUnit(0, call->batch->texture);
    if (call->batch && call->batch->cull_back)
        gl->Enable(GL_CULL_FACE);
    gl_multi_draw_elements_indirect(gl, GL_TRIANGLES, GL_UNSIGNED_INT,
                                    call->first * sizeof(struct command), (GLsizei)call->count,
                                    call->triangles);
    gl->Disable(GL_CULL_FACE);
}

static struct call make_call(struct state *state, const struct kind *kind,
                             const struct batch *batch)
{
    struct call call = {.kind = kind, .batch = batch, .first = state->commands_count};
    call.triangles = add_commands(state, kind, batch);
    call.count = state->commands_count - call.first;
    return call;
}

static void draw_trees(struct workspace *workspace, struct state *state, const struct view *view)
{
    struct gl *gl = workspace->gl;
    struct call *calls = state->calls;
    size_t calls_count = 0;
    if (place_trees(workspace, state, view).count == 0)
        return;
    state->commands_count = 0;
    for (size_t k = 0; k < state->kinds_count; k++) {
        const struct kind *kind = &state->kinds[k];
        for (size_t b = 0; b < kind->batches_count; b++)
            calls[calls_count++] = make_call(state, kind, &kind->batches[b]);
        if (kind->elements > 0)
            calls[calls_count++] = make_call(state, kind, NULL);
    }
    gl->NamedBufferSubData(state->command_buffer, 0,
                           (GLsizeiptr)(state->commands_count * sizeof *state->commands),
                           state->commands);
    gl->BindBuffer(GL_DRAW_INDIRECT_BUFFER, state->command_buffer);
    for (size_t c = 0; c < calls_count; c++)
        if (calls[c].count > 0)
            draw_call(workspace, state, &calls[c], view);
    gl->BindBuffer(GL_DRAW_INDIRECT_BUFFER, 0);
}

static enum status draw(struct workspace *workspace, void *state, const struct view *view,
                        struct target *target)
{
    struct state *own = state;
    struct view drawn;
    enum status status = sampling_begin(workspace, own->sampling, target, view, &drawn);
    if (status != STATUS_OK)
        return status;
    backdrop_draw(workspace, own->backdrop, &drawn);
    draw_trees(workspace, own, view); /* of the picture's size, to which error_px refers */
    sampling_end(workspace, own->sampling, target);
    return gl_check(workspace->gl, "polygons", workspace->error);
}

extern const struct method polygons_method;
const struct method polygons_method = {
    .abi = METHOD_ABI,
    .name = "polygons",
    .summary = "every triangle; far trees by simplified bark and stochastically pruned leaves",
    .source = "Cook, Halstead, Planck, Ryu, Stochastic simplification of aggregate detail, 2007, "
              "doi:10.1145/1276377.1276476; Garland, Heckbert, Surface simplification using "
              "quadric error metrics, 1997, doi:10.1145/258734.258849",
    .traits = EFFECT_TWO_SIDED | EFFECT_AMBIENT | EFFECT_FOG | TRAIT_STOCHASTIC,
    .options = option_table,
    .options_size = sizeof(struct options),
    .prepare = prepare,
    .draw = draw,
};
