/* Triangles of trees: programs, instanced or sifted drawing. */
#include "bake/triangles.h"
#include "bake/backdrop.h"
#include "bake/levels.h"
#include "bake/plant_draws.h"
#include "bake/sift_gl.h"
#include "bake/sift_plant.h"
#include "base/random.h"

#include "triangles.glsl.h"

#include <string.h>

enum { PROBES_MAX = 512, SPECIES_MAX = 64 };

enum {
    VARIANT_BARK,
    VARIANT_LEAF,
    VARIANT_LEAF_LIT,
    VARIANT_BARK_TEXTURED,
    VARIANT_LEAF_TEXTURED,
    VARIANT_PRUNED,
    VARIANT_SIFTED, /* and, in the order of the streams, the next two */
    VARIANTS = VARIANT_SIFTED + SIFT_STREAMS
};
static const char *const variant_defines[VARIANTS] = {"",
                                                      "LEAF 1",
                                                      "LEAF 1\nLIT_AT_VERTICES 1",
                                                      "TEXTURED 1",
                                                      "LEAF 1\nTEXTURED 1",
                                                      "PRUNED 1\nLIT_AT_VERTICES 1",
                                                      "SIFTED 1",
                                                      "SIFTED 1\nLEAF 1",
                                                      "SIFTED 1\nLIT_AT_VERTICES 1"};

/* A species. */
struct kind {
    bool drawn; /* some tree is of it */
    struct levels levels;
    struct plant_gl gpu;     /* instanced drawing, */
    struct sift_plant *sift; /* or sifted */
    uint32_t probes_count;
    struct prune_vertex *probes; /* some elements, for the plant's mean radiance */
    uint32_t first_group, groups_count;
};

/* One call's worth of commands: which program, which mesh. */
struct call {
    const struct kind *kind;
    const struct plant_gl_batch *batch; /* NULL: pruning */
    size_t first, count;
    uint64_t triangles;
};

struct triangles {
    const struct scene *scene;
    struct triangles_request request;
    size_t kinds_count;
    struct kind *kinds;
    struct cull_bound *bounds; /* kinds_count */
    GLuint programs[VARIANTS]; /* those in use */
    uint8_t *runs;             /* instances_count: which run of elements; NULL: none is pruned */
    /* instanced drawing */
    GLuint placed_buffer, command_buffer;
    size_t commands_room;
    struct plant_command *commands;
    struct call *calls; /* of a frame: one a batch and one a kind's pruning at most */
    uint32_t *groups;   /* trees_room */
    uint32_t *first;    /* groups_count + 1 */
    size_t groups_count;
    /* sifted drawing, if any */
    struct sift_gl sifted;
    struct sift_tree *sift_trees; /* trees_room */
    struct sift_run *sift_runs;
};

static float taper_of(const struct triangles *triangles)
{
    return triangles->request.smooth ? 0.5f : 0;
}

static int batch_variant(const struct plant_gl_batch *batch)
{
    bool leaf = batch->kind == MATERIAL_LEAF;
    if (batch->texture)
        return leaf ? VARIANT_LEAF_TEXTURED : VARIANT_BARK_TEXTURED;
    if (leaf)
        return batch->flat ? VARIANT_LEAF_LIT : VARIANT_LEAF;
    return VARIANT_BARK;
}

static void keep_probes(struct arena *arena, struct kind *kind, const struct prune *prune)
{
    kind->probes_count = prune->count < PROBES_MAX ? (uint32_t)prune->count : PROBES_MAX;
    kind->probes = ARENA_ARRAY(arena, struct prune_vertex, kind->probes_count);
    for (uint32_t i = 0; i < kind->probes_count; i++)
        kind->probes[i] = prune->vertices[3 * i];
}

static enum status prepare_kind(struct workspace *workspace, struct triangles *triangles,
                                uint32_t species)
{
    struct kind *kind = &triangles->kinds[species];
    const struct mesh *mesh;
    enum status status =
        plant_mesh(triangles->scene->species[species].plant, &mesh, workspace->error);
    if (status != STATUS_OK)
        return status;
    struct arena *passing = arena_create(0);
    bool simplify = triangles->request.tolerance_px > 0;
    const struct detail *detail = detail_create(passing, mesh, simplify);
    const struct prune *prune = simplify ? prune_create(passing, mesh, workspace->seed) : NULL;
    levels_fill(&kind->levels, mesh, detail, prune, taper_of(triangles));
    if (prune)
        keep_probes(workspace->arena, kind, prune);
    if (triangles->sifted.sift) {
        kind->sift = sift_plant_create(workspace->arena, detail, prune, &kind->levels, species);
    } else {
        plant_gl_detail(workspace, detail, &kind->levels, triangles->placed_buffer, &kind->gpu);
        if (prune)
            plant_gl_pruned(workspace, prune, triangles->placed_buffer, &kind->gpu);
    }
    arena_destroy(passing);
    return STATUS_OK;
}

static enum status prepare_programs(struct workspace *workspace, struct triangles *triangles)
{
    bool wanted[VARIANTS] = {false};
    bool fog = workspace->effects & EFFECT_FOG && triangles->scene->fog.density_per_m > 0;
    for (size_t k = 0; k < triangles->kinds_count; k++) {
        for (size_t b = 0; b < triangles->kinds[k].gpu.batches_count; b++)
            wanted[batch_variant(&triangles->kinds[k].gpu.batches[b])] = true;
        wanted[VARIANT_PRUNED] |= triangles->kinds[k].gpu.pruned > 0;
    }
    for (int v = VARIANT_SIFTED; v < VARIANTS; v++)
        wanted[v] = triangles->sifted.sift;
    for (int v = 0; v < VARIANTS; v++) {
        if (!wanted[v])
            continue;
        const char *defines = arena_printf(workspace->arena, "SPECIES %d\n%s%s",
                                           triangles->kinds_count ? (int)triangles->kinds_count : 1,
                                           fog ? "FOG 1\n" : "", variant_defines[v]);
        enum status status = gl_program(workspace->gl, "triangles", triangles_glsl, defines,
                                        &triangles->programs[v], workspace->error);
        if (status != STATUS_OK)
            return status;
    }
    return STATUS_OK;
}

/* What each tree keeps, and room for the lists of a frame. */
static void prepare_instances(struct workspace *workspace, struct triangles *triangles)
{
    struct arena *arena = workspace->arena;
    size_t room = triangles->request.trees_room, count = triangles->scene->instances_count;
    size_t calls_room = 0, runs_room = 1;
    triangles->bounds = ARENA_ARRAY(arena, struct cull_bound, triangles->kinds_count);
    for (size_t k = 0; k < triangles->kinds_count; k++) {
        struct kind *kind = &triangles->kinds[k];
        triangles->bounds[k] = kind->levels.bound;
        kind->first_group = (uint32_t)triangles->groups_count;
        kind->groups_count = plant_groups_count(&kind->levels);
        triangles->groups_count += kind->groups_count;
        calls_room += kind->gpu.batches_count + 1;
        triangles->commands_room += kind->groups_count * (kind->gpu.batches_count + 1);
        if (kind->sift && runs_room < kind->sift->batches_count + 1)
            runs_room = kind->sift->batches_count + 1;
    }
    if (triangles->request.tolerance_px > 0)
        triangles->runs = ARENA_ARRAY(arena, uint8_t, count);
    for (size_t i = 0; triangles->runs && i < count; i++)
        triangles->runs[i] = (uint8_t)(random_mix(workspace->seed + i) % LEVELS_RUNS);
    if (triangles->sifted.sift) {
        triangles->sift_trees = ARENA_ARRAY(arena, struct sift_tree, room);
        triangles->sift_runs = ARENA_ARRAY(arena, struct sift_run, room * runs_room);
        return;
    }
    triangles->groups = ARENA_ARRAY(arena, uint32_t, room);
    triangles->first = ARENA_ARRAY(arena, uint32_t, triangles->groups_count + 1);
    triangles->calls = ARENA_ARRAY(arena, struct call, calls_room);
    triangles->commands = ARENA_ARRAY(arena, struct plant_command, triangles->commands_room);
    triangles->command_buffer = gl_buffer(
        workspace->gl, (GLsizeiptr)(triangles->commands_room * sizeof(struct plant_command)), NULL,
        GL_DYNAMIC_STORAGE_BIT);
}

/* Sifts where that pays and is possible. */
static enum status prepare_sift(struct workspace *workspace, struct triangles *triangles)
{
    bool use =
        triangles->request.sift && workspace->gl->software && triangles->kinds_count <= SPECIES_MAX;
    for (size_t k = 0; k < triangles->kinds_count && use; k++) {
        const struct mesh *mesh;
        enum status status = STATUS_OK;
        if (triangles->kinds[k].drawn)
            status = plant_mesh(triangles->scene->species[k].plant, &mesh, workspace->error);
        if (status != STATUS_OK)
            return status;
        use = !triangles->kinds[k].drawn || sift_plant_possible(mesh);
    }
    if (!use)
        return STATUS_OK;
    sift_gl_create(workspace, &triangles->sifted);
    return STATUS_OK;
}

enum status triangles_prepare(struct workspace *workspace, const struct scene *scene,
                              const struct triangles_request *request, struct triangles **result)
{
    struct triangles *triangles = *result = ARENA_NEW(workspace->arena, struct triangles);
    triangles->scene = scene;
    triangles->request = *request;
    triangles->kinds_count = scene->species_count;
    triangles->kinds = ARENA_ARRAY(workspace->arena, struct kind, scene->species_count);
    for (size_t i = 0; i < scene->instances_count; i++)
        triangles->kinds[scene->instances[i].species].drawn = true;
    enum status status = prepare_sift(workspace, triangles);
    if (!triangles->sifted.sift)
        triangles->placed_buffer = gl_buffer(
            workspace->gl, (GLsizeiptr)(request->trees_room * sizeof(struct plant_gl_placed)), NULL,
            GL_MAP_WRITE_BIT);
    for (uint32_t k = 0; k < triangles->kinds_count && status == STATUS_OK; k++)
        if (triangles->kinds[k].drawn)
            status = prepare_kind(workspace, triangles, k);
    if (status == STATUS_OK)
        status = prepare_programs(workspace, triangles);
    if (status != STATUS_OK)
        return status;
    prepare_instances(workspace, triangles);
    return gl_check(workspace->gl, "triangles", workspace->error);
}

const struct cull_bound *triangles_bounds(const struct triangles *triangles)
{
    return triangles->bounds;
}

enum cull_order triangles_order(const struct triangles *triangles)
{
    /* groups go from near to far by themselves; within a detail level the order saves shading */
    bool grouped = !triangles->sifted.sift && triangles->request.tolerance_px > 0;
    return grouped ? CULL_AS_PLACED : CULL_FRONT_TO_BACK;
}

/* How a listed tree is seen. */
static struct levels_seen seen_of(const struct triangles *triangles, const struct view *view,
                                  float focal_px, const struct cull_list *list, size_t i)
{
    const struct instance *instance = &triangles->scene->instances[list->instances[i]];
    return levels_seen(&triangles->kinds[instance->species].levels, view, focal_px,
                       triangles->request.tolerance_px, instance, list->depths_m[i]);
}

static struct levels_choice choose(const struct triangles *triangles, const struct levels *levels,
                                   float per_m)
{
    if (triangles->request.tolerance_px <= 0)
        return (struct levels_choice){0, -1};
    return levels_choose(levels, per_m);
}

static uint32_t run_of(const struct triangles *triangles, uint32_t instance)
{
    return triangles->runs ? triangles->runs[instance] : 0;
}

/* Chooses and groups the trees, and uploads what the shaders need of each. */
static void place_trees(struct workspace *workspace, struct triangles *triangles,
                        const struct triangles_frame *frame, struct cull_list *list)
{
    struct gl *gl = workspace->gl;
    const struct scene *scene = triangles->scene;
    float focal_px = cull_focal_px(frame->view);
    for (size_t i = 0; i < list->count; i++) {
        uint32_t at = list->instances[i];
        const struct kind *kind = &triangles->kinds[scene->instances[at].species];
        struct levels_seen seen = seen_of(triangles, frame->view, focal_px, list, i);
        struct levels_choice choice = choose(triangles, &kind->levels, seen.per_m);
        triangles->groups[i] =
            kind->first_group + plant_group(&kind->levels, &choice, run_of(triangles, at));
    }
    cull_group(frame->cull, list, triangles->groups, triangles->groups_count, triangles->first);
    GLsizeiptr bytes = (GLsizeiptr)(list->count * sizeof(struct plant_gl_placed));
    struct plant_gl_placed *placed = gl->MapNamedBufferRange(
        triangles->placed_buffer, 0, bytes, GL_MAP_WRITE_BIT | GL_MAP_INVALIDATE_BUFFER_BIT);
    for (uint32_t group = 0; group < triangles->groups_count; group++)
        for (uint32_t i = triangles->first[group]; i < triangles->first[group + 1]; i++) {
            const struct instance *instance = &scene->instances[list->instances[i]];
            const struct kind *kind = &triangles->kinds[instance->species];
            struct levels_seen seen = seen_of(triangles, frame->view, focal_px, list, i);
            placed[i] = plant_place(&kind->levels, group - kind->first_group, instance, &seen,
                                    taper_of(triangles));
        }
    gl->UnmapNamedBuffer(triangles->placed_buffer);
}

/* The eye may be within the tree: the back faces of a closed surface are seen. */
static bool is_within(const struct triangles *triangles, const struct instance *instance,
                      const struct view *view)
{
    const struct levels *levels = &triangles->kinds[instance->species].levels;
    struct cull_cylinder cylinder = {levels->low_m, levels->high_m, levels->radius_m};
    return cull_cylinder_holds(&cylinder, instance, view->eye_m, 2 * view->near_m);
}

/* Mean radiances of bark and leaves of a species, for elements that stand for many. */
static void mean_uniforms(struct workspace *workspace, const struct triangles *triangles,
                          GLuint program, size_t k, const struct view *view)
{
    struct gl *gl = workspace->gl;
    const struct kind *kind = &triangles->kinds[k];
    float mean[2][3];
    char name[32];
    prune_mean_radiance(kind->probes, kind->probes_count, triangles->scene, workspace->effects,
                        view, mean);
    snprintf(name, sizeof name, "mean[%d]", triangles->sifted.sift ? (int)(2 * k) : 0);
    gl->Uniform3fv(gl_uniform(gl, program, name), 2, mean[0]);
}

static void draw_call(struct workspace *workspace, const struct triangles *triangles,
                      const struct call *call, const struct view *view, bool cull_faces)
{
    struct gl *gl = workspace->gl;
    const struct plant_gl *gpu = &call->kind->gpu;
    GLuint program = triangles->programs[call->batch ? batch_variant(call->batch) : VARIANT_PRUNED];
    gl->UseProgram(program);
    shade_uniforms(workspace, program, triangles->scene, view);
    if (!call->batch) {
        gl->Uniform1f(gl_uniform(gl, program, "elements"), (float)call->kind->levels.elements);
        gl->Uniform1f(gl_uniform(gl, program, "taper"), taper_of(triangles));
        gl->Uniform1i(gl_uniform(gl, program, "level_contrast"), triangles->request.contrast);
        mean_uniforms(workspace, triangles, program, (size_t)(call->kind - triangles->kinds), view);
    }
    gl->BindVertexArray(call->batch ? gpu->detail : gpu->pruned);
    if (call->batch && call->batch->texture)
        gl->BindTextureUnit(0, call->batch->texture);
    if (cull_faces && call->batch && call->batch->closed)
        gl->Enable(GL_CULL_FACE);
    gl_multi_draw_elements_indirect(gl, GL_TRIANGLES, GL_UNSIGNED_INT,
                                    call->first * sizeof(struct plant_command),
                                    (GLsizei)call->count, call->triangles);
    gl->Disable(GL_CULL_FACE);
}

static void draw_instanced(struct workspace *workspace, struct triangles *triangles,
                           const struct triangles_frame *frame, struct cull_list *list)
{
    struct gl *gl = workspace->gl;
    struct call *calls = triangles->calls;
    size_t calls_count = 0, commands = 0;
    bool cull_faces = true;
    place_trees(workspace, triangles, frame, list);
    for (size_t i = 0; i < list->count && cull_faces; i++)
        cull_faces =
            !is_within(triangles, &triangles->scene->instances[list->instances[i]], frame->view);
    for (size_t k = 0; k < triangles->kinds_count; k++) {
        const struct kind *kind = &triangles->kinds[k];
        size_t batches = kind->gpu.batches_count;
        for (size_t b = 0; b < batches + (kind->levels.elements > 0); b++) {
            struct call *call = &calls[calls_count++];
            *call = (struct call){.kind = kind, .first = commands};
            call->batch = b < batches ? &kind->gpu.batches[b] : NULL;
            call->count =
                plant_commands(&kind->levels, call->batch, triangles->first + kind->first_group,
                               triangles->commands + commands, &call->triangles);
            commands += call->count;
        }
    }
    gl->NamedBufferSubData(triangles->command_buffer, 0,
                           (GLsizeiptr)(commands * sizeof *triangles->commands),
                           triangles->commands);
    gl->BindBuffer(GL_DRAW_INDIRECT_BUFFER, triangles->command_buffer);
    for (size_t c = 0; c < calls_count; c++)
        if (calls[c].count > 0)
            draw_call(workspace, triangles, &calls[c], frame->view, cull_faces);
    gl->BindBuffer(GL_DRAW_INDIRECT_BUFFER, 0);
}

static void draw_sifted(struct workspace *workspace, struct triangles *triangles,
                        const struct triangles_frame *frame, const struct cull_list *list)
{
    const struct view *view = frame->view;
    struct gl *gl = workspace->gl;
    float focal_px = cull_focal_px(view);
    size_t runs = 0;
    for (size_t i = 0; i < list->count; i++) {
        uint32_t at = list->instances[i];
        const struct instance *instance = &triangles->scene->instances[at];
        const struct kind *kind = &triangles->kinds[instance->species];
        struct sift_tree *tree = &triangles->sift_trees[i];
        *tree = (struct sift_tree){.instance = instance,
                                   .first_run = runs,
                                   .low_m = kind->levels.low_m,
                                   .high_m = kind->levels.high_m,
                                   .radius_m = kind->levels.radius_m,
                                   .within = is_within(triangles, instance, view)};
        struct levels_seen seen = seen_of(triangles, view, focal_px, list, i);
        struct sift_part part = {.choice = choose(triangles, &kind->levels, seen.per_m),
                                 .run = run_of(triangles, at),
                                 .seen = seen,
                                 .taper = taper_of(triangles)};
        tree->runs_count =
            sift_plant_runs(kind->sift, &kind->levels, &part, triangles->sift_runs + runs);
        runs += tree->runs_count;
    }
    for (int v = VARIANT_SIFTED; v < VARIANTS; v++) {
        GLuint program = triangles->programs[v];
        gl->UseProgram(program);
        shade_uniforms(workspace, program, triangles->scene, view);
        gl->Uniform1i(gl_uniform(gl, program, "level_contrast"), triangles->request.contrast);
        for (size_t k = 0; k < triangles->kinds_count; k++)
            if (v == VARIANT_SIFTED + SIFT_LIT && triangles->kinds[k].probes_count > 0)
                mean_uniforms(workspace, triangles, program, k, view);
    }
    sift_begin(triangles->sifted.sift, frame->drawn, frame->places, triangles->sift_trees,
               list->count, triangles->sift_runs);
    sift_gl_draw(workspace, &triangles->sifted, triangles->programs + VARIANT_SIFTED);
}

void triangles_draw(struct workspace *workspace, struct triangles *triangles,
                    const struct triangles_frame *frame, struct cull_list *list)
{
    if (list->count == 0)
        return;
    if (triangles->sifted.sift)
        draw_sifted(workspace, triangles, frame, list);
    else
        draw_instanced(workspace, triangles, frame, list);
}
