/* polygons: every triangle, instanced and culled; an error-controlled level of detail far away.
 *
 * A tree's level (bake/levels.h) follows from how large a metre appears at its nearest point. Near:
 * all leaves. Far: a run of the plant's pruned elements (bake/prune.h), as many as its area has
 * pixels of error_px squared, so that no element grows past that size; a tree below a pixel is two
 * of them. Each tree takes its own of 16 runs, so that far trees are not all the same two leaves.
 *
 * Where GL is software, triangles that meet no sample or are hidden are dropped before it sees them
 * (bake/sift.h): most of a forest's are smaller than a pixel. */
#include "bake/backdrop.h"
#include "bake/levels.h"
#include "bake/plant_draws.h"
#include "bake/sampling.h"
#include "bake/sift_gl.h"
#include "bake/sift_plant.h"
#include "base/random.h"
#include "method/method.h"

#include "polygons.glsl.h"

#include <math.h>
#include <string.h>

enum { PROBES_MAX = 512, SPECIES_MAX = 64 };

struct options {
    int samples;
    float error_px;
    bool smooth, contrast, sift;
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
    OPTION(struct options, sift, 1, 0, 1, "",
        "triangles that meet no sample are found on the CPU and not drawn; only where GL is software, "
        "with plants without textures"),
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
    uint8_t *runs;             /* instances_count: which run of elements */
    /* instanced drawing */
    GLuint placed_buffer, command_buffer;
    size_t commands_room;
    struct plant_command *commands;
    struct call *calls; /* of a frame: one a batch and one a kind's pruning at most */
    uint32_t *groups;   /* instances_count */
    uint32_t *first;    /* groups_count + 1 */
    size_t groups_count;
    /* sifted drawing, if any */
    struct sift_gl sifted;
    struct sift_tree *sift_trees; /* instances_count */
    struct sift_run *sift_runs;
};

static const int samples_of_word[] = {1, 4, 16};

static float taper_of(const struct state *state)
{
    return state->options->smooth ? 0.5f : 0;
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

static enum status prepare_kind(struct workspace *workspace, struct state *state, uint32_t species)
{
    struct kind *kind = &state->kinds[species];
    const struct mesh *mesh;
    enum status status = plant_mesh(state->scene->species[species].plant, &mesh, workspace->error);
    if (status != STATUS_OK)
        return status;
    struct arena *passing = arena_create(0);
    bool simplify = state->tolerance_px > 0;
    const struct detail *detail = detail_create(passing, mesh, simplify);
    const struct prune *prune = simplify ? prune_create(passing, mesh, workspace->seed) : NULL;
    levels_fill(&kind->levels, mesh, detail, prune, taper_of(state));
    if (prune)
        keep_probes(workspace->arena, kind, prune);
    if (state->sifted.sift) {
        kind->sift = sift_plant_create(workspace->arena, detail, prune, &kind->levels, species);
    } else {
        plant_gl_detail(workspace, detail, &kind->levels, state->placed_buffer, &kind->gpu);
        if (prune)
            plant_gl_pruned(workspace, prune, state->placed_buffer, &kind->gpu);
    }
    arena_destroy(passing);
    return STATUS_OK;
}

static enum status prepare_programs(struct workspace *workspace, struct state *state)
{
    bool wanted[VARIANTS] = {false};
    bool fog = workspace->effects & EFFECT_FOG && state->scene->fog.density_per_m > 0;
    for (size_t k = 0; k < state->kinds_count; k++) {
        for (size_t b = 0; b < state->kinds[k].gpu.batches_count; b++)
            wanted[batch_variant(&state->kinds[k].gpu.batches[b])] = true;
        wanted[VARIANT_PRUNED] |= state->kinds[k].gpu.pruned > 0;
    }
    for (int v = VARIANT_SIFTED; v < VARIANTS; v++)
        wanted[v] = state->sifted.sift;
    for (int v = 0; v < VARIANTS; v++) {
        if (!wanted[v])
            continue;
        const char *defines = arena_printf(workspace->arena, "SPECIES %d\n%s%s",
                                           state->kinds_count ? (int)state->kinds_count : 1,
                                           fog ? "FOG 1\n" : "", variant_defines[v]);
        enum status status = gl_program(workspace->gl, "polygons", polygons_glsl, defines,
                                        &state->programs[v], workspace->error);
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
    size_t count = scene->instances_count, calls_room = 0, runs_room = 1;
    struct cull_bound *bounds = ARENA_ARRAY(arena, struct cull_bound, state->kinds_count);
    for (size_t k = 0; k < state->kinds_count; k++) {
        struct kind *kind = &state->kinds[k];
        bounds[k] = kind->levels.bound;
        kind->first_group = (uint32_t)state->groups_count;
        kind->groups_count = plant_groups_count(&kind->levels);
        state->groups_count += kind->groups_count;
        calls_room += kind->gpu.batches_count + 1;
        state->commands_room += kind->groups_count * (kind->gpu.batches_count + 1);
        if (kind->sift && runs_room < kind->sift->batches_count + 1)
            runs_room = kind->sift->batches_count + 1;
    }
    state->cull = cull_create(arena, scene, bounds);
    state->runs = ARENA_ARRAY(arena, uint8_t, count);
    for (size_t i = 0; i < count; i++)
        state->runs[i] = (uint8_t)(random_mix(workspace->seed + i) % LEVELS_RUNS);
    if (state->sifted.sift) {
        state->sift_trees = ARENA_ARRAY(arena, struct sift_tree, count);
        state->sift_runs = ARENA_ARRAY(arena, struct sift_run, count * runs_room);
        return;
    }
    state->groups = ARENA_ARRAY(arena, uint32_t, count);
    state->first = ARENA_ARRAY(arena, uint32_t, state->groups_count + 1);
    state->calls = ARENA_ARRAY(arena, struct call, calls_room);
    state->commands = ARENA_ARRAY(arena, struct plant_command, state->commands_room);
    state->command_buffer =
        gl_buffer(workspace->gl, (GLsizeiptr)(state->commands_room * sizeof(struct plant_command)),
                  NULL, GL_DYNAMIC_STORAGE_BIT);
}

/* Sifts where that pays and is possible. */
static enum status prepare_sift(struct workspace *workspace, struct state *state)
{
    bool use = state->options->sift && workspace->gl->software && state->kinds_count <= SPECIES_MAX;
    for (size_t k = 0; k < state->kinds_count && use; k++) {
        const struct mesh *mesh;
        enum status status = STATUS_OK;
        if (state->kinds[k].drawn)
            status = plant_mesh(state->scene->species[k].plant, &mesh, workspace->error);
        if (status != STATUS_OK)
            return status;
        use = !state->kinds[k].drawn || sift_plant_possible(mesh);
    }
    if (!use)
        return STATUS_OK;
    sift_gl_create(workspace, &state->sifted);
    return STATUS_OK;
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
    for (size_t i = 0; i < scene->instances_count; i++)
        made->kinds[scene->instances[i].species].drawn = true;
    enum status status = backdrop_prepare(workspace, scene, &made->backdrop);
    if (status == STATUS_OK)
        status =
            sampling_prepare(workspace, samples_of_word[made->options->samples], &made->sampling);
    if (status == STATUS_OK)
        status = prepare_sift(workspace, made);
    if (!made->sifted.sift)
        made->placed_buffer = gl_buffer(
            workspace->gl, (GLsizeiptr)(scene->instances_count * sizeof(struct plant_gl_placed)),
            NULL, GL_MAP_WRITE_BIT);
    for (uint32_t k = 0; k < made->kinds_count && status == STATUS_OK; k++)
        if (made->kinds[k].drawn)
            status = prepare_kind(workspace, made, k);
    if (status == STATUS_OK)
        status = prepare_programs(workspace, made);
    if (status != STATUS_OK)
        return status;
    prepare_instances(workspace, made);
    return gl_check(workspace->gl, "polygons", workspace->error);
}

/* How a listed tree is seen. */
static struct levels_seen seen_of(const struct state *state, const struct view *view,
                                  float focal_px, const struct cull_list *list, size_t i)
{
    const struct instance *instance = &state->scene->instances[list->instances[i]];
    return levels_seen(&state->kinds[instance->species].levels, view, focal_px, state->tolerance_px,
                       instance, list->depths_m[i]);
}

static struct levels_choice choose(const struct state *state, const struct levels *levels,
                                   float per_m)
{
    if (state->tolerance_px <= 0)
        return (struct levels_choice){0, -1};
    return levels_choose(levels, per_m);
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
        struct levels_choice choice =
            choose(state, &kind->levels, seen_of(state, view, focal_px, &list, i).per_m);
        state->groups[i] = kind->first_group + plant_group(&kind->levels, &choice, state->runs[at]);
    }
    cull_group(state->cull, &list, state->groups, state->groups_count, state->first);
    if (list.count == 0)
        return list;
    GLsizeiptr bytes = (GLsizeiptr)(list.count * sizeof(struct plant_gl_placed));
    struct plant_gl_placed *placed = gl->MapNamedBufferRange(
        state->placed_buffer, 0, bytes, GL_MAP_WRITE_BIT | GL_MAP_INVALIDATE_BUFFER_BIT);
    for (uint32_t group = 0; group < state->groups_count; group++)
        for (uint32_t i = state->first[group]; i < state->first[group + 1]; i++) {
            const struct instance *instance = &scene->instances[list.instances[i]];
            const struct kind *kind = &state->kinds[instance->species];
            struct levels_seen seen = seen_of(state, view, focal_px, &list, i);
            placed[i] = plant_place(&kind->levels, group - kind->first_group, instance, &seen,
                                    taper_of(state));
        }
    gl->UnmapNamedBuffer(state->placed_buffer);
    return list;
}

/* Mean radiances of bark and leaves of a species, for elements that stand for many. */
static void mean_uniforms(struct workspace *workspace, const struct state *state, GLuint program,
                          size_t k, const struct view *view)
{
    struct gl *gl = workspace->gl;
    const struct kind *kind = &state->kinds[k];
    float mean[2][3];
    char name[32];
    prune_mean_radiance(kind->probes, kind->probes_count, state->scene, workspace->effects, view,
                        mean);
    snprintf(name, sizeof name, "mean[%d]", state->sifted.sift ? (int)(2 * k) : 0);
    gl->Uniform3fv(gl_uniform(gl, program, name), 2, mean[0]);
}

static void draw_call(struct workspace *workspace, const struct state *state,
                      const struct call *call, const struct view *view)
{
    struct gl *gl = workspace->gl;
    const struct plant_gl *gpu = &call->kind->gpu;
    GLuint program = state->programs[call->batch ? batch_variant(call->batch) : VARIANT_PRUNED];
    gl->UseProgram(program);
    shade_uniforms(workspace, program, state->scene, view);
    if (!call->batch) {
        gl->Uniform1f(gl_uniform(gl, program, "elements"), (float)call->kind->levels.elements);
        gl->Uniform1f(gl_uniform(gl, program, "taper"), taper_of(state));
        gl->Uniform1i(gl_uniform(gl, program, "level_contrast"), state->options->contrast);
        mean_uniforms(workspace, state, program, (size_t)(call->kind - state->kinds), view);
    }
    gl->BindVertexArray(call->batch ? gpu->detail : gpu->pruned);
    if (call->batch && call->batch->texture)
        gl->BindTextureUnit(0, call->batch->texture);
    if (call->batch && call->batch->closed)
        gl->Enable(GL_CULL_FACE);
    gl_multi_draw_elements_indirect(gl, GL_TRIANGLES, GL_UNSIGNED_INT,
                                    call->first * sizeof(struct plant_command),
                                    (GLsizei)call->count, call->triangles);
    gl->Disable(GL_CULL_FACE);
}

static void draw_instanced(struct workspace *workspace, struct state *state,
                           const struct view *view)
{
    struct gl *gl = workspace->gl;
    struct call *calls = state->calls;
    size_t calls_count = 0;
    if (place_trees(workspace, state, view).count == 0)
        return;
    size_t commands = 0;
    for (size_t k = 0; k < state->kinds_count; k++) {
        const struct kind *kind = &state->kinds[k];
        size_t batches = kind->gpu.batches_count;
        for (size_t b = 0; b < batches + (kind->levels.elements > 0); b++) {
            struct call *call = &calls[calls_count++];
            *call = (struct call){.kind = kind, .first = commands};
            call->batch = b < batches ? &kind->gpu.batches[b] : NULL;
            call->count =
                plant_commands(&kind->levels, call->batch, state->first + kind->first_group,
                               state->commands + commands, &call->triangles);
            commands += call->count;
        }
    }
    gl->NamedBufferSubData(state->command_buffer, 0,
                           (GLsizeiptr)(commands * sizeof *state->commands), state->commands);
    gl->BindBuffer(GL_DRAW_INDIRECT_BUFFER, state->command_buffer);
    for (size_t c = 0; c < calls_count; c++)
        if (calls[c].count > 0)
            draw_call(workspace, state, &calls[c], view);
    gl->BindBuffer(GL_DRAW_INDIRECT_BUFFER, 0);
}

/* drawn: view with the size of what is bound. */
static void draw_sifted(struct workspace *workspace, struct state *state, const struct view *view,
                        const struct view *drawn)
{
    struct gl *gl = workspace->gl;
    float focal_px = cull_focal_px(view);
    struct cull_list list = cull_view(state->cull, view, CULL_FRONT_TO_BACK);
    size_t runs = 0;
    for (size_t i = 0; i < list.count; i++) {
        uint32_t at = list.instances[i];
        const struct instance *instance = &state->scene->instances[at];
        const struct kind *kind = &state->kinds[instance->species];
        struct sift_tree *tree = &state->sift_trees[i];
        *tree = (struct sift_tree){.instance = instance,
                                   .first_run = runs,
                                   .low_m = kind->levels.low_m,
                                   .high_m = kind->levels.high_m,
                                   .radius_m = kind->levels.radius_m};
        struct levels_seen seen = seen_of(state, view, focal_px, &list, i);
        struct sift_part part = {.choice = choose(state, &kind->levels, seen.per_m),
                                 .run = state->runs[at],
                                 .seen = seen,
                                 .taper = taper_of(state)};
        tree->runs_count =
            sift_plant_runs(kind->sift, &kind->levels, &part, state->sift_runs + runs);
        runs += tree->runs_count;
    }
    for (int v = VARIANT_SIFTED; v < VARIANTS; v++) {
        GLuint program = state->programs[v];
        gl->UseProgram(program);
        shade_uniforms(workspace, program, state->scene, view);
        gl->Uniform1i(gl_uniform(gl, program, "level_contrast"), state->options->contrast);
        for (size_t k = 0; k < state->kinds_count; k++)
            if (v == VARIANT_SIFTED + SIFT_LIT && state->kinds[k].probes_count > 0)
                mean_uniforms(workspace, state, program, k, view);
    }
    sift_begin(state->sifted.sift, drawn, sampling_places(state->sampling), state->sift_trees,
               list.count, state->sift_runs);
    if (list.count > 0)
        sift_gl_draw(workspace, &state->sifted, state->programs + VARIANT_SIFTED);
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
    if (own->sifted.sift)
        draw_sifted(workspace, own, view, &drawn);
    else /* error_px refers to the picture's size */
        draw_instanced(workspace, own, view);
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
