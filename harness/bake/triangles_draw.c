/* Triangles of trees: a frame, instanced or sifted. */
#include "bake/backdrop.h"
#include "bake/triangles_parts.h"

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
                                    triangles_taper(triangles));
            placed[i].mean = (float)triangles_mean_of(kind, instance->stretch);
        }
    gl->UnmapNamedBuffer(triangles->placed_buffer);
}

/* The eye may be within the tree: the back faces of a closed surface are seen. */
static bool is_within(const struct triangles *triangles, const struct instance *instance,
                      const struct view *view)
{
    const struct levels *levels = &triangles->kinds[instance->species].levels;
    struct cull_cylinder cylinder = {levels->low_m, levels->high_m, levels->radius_m, 0};
    return cull_cylinder_holds(&cylinder, instance, view->eye_m, 2 * view->near_m);
}

/* The same view without a sun. */
static struct view view_in_shade(const struct view *view)
{
    struct view dark = *view;
    dark.sun_direction[0] = dark.sun_direction[1] = dark.sun_direction[2] = 0;
    return dark;
}

/* Mean radiances of bark and leaves of a species, for elements that stand for many; of each step of
 * stretch; where shadows are received, in the shade too. */
static void mean_uniforms(struct workspace *workspace, const struct triangles *triangles,
                          GLuint program, size_t k, const struct view *view)
{
    struct gl *gl = workspace->gl;
    const struct kind *kind = &triangles->kinds[k];
    float mean[2][3];
    char name[32];
    for (int step = 0; step < kind->means_count; step++) {
        const struct prune_light light = {triangles->scene, view, workspace->effects,
                                          triangles_mean_stretch(kind, step)};
        prune_mean_radiance(kind->probes, kind->probes_count, &light, mean);
        snprintf(name, sizeof name, "mean[%d]", 2 * (kind->first_mean + step));
        gl->Uniform3fv(gl_uniform(gl, program, name), 2, mean[0]);
        if (!triangles->request.shadows)
            continue;
        const struct view dark = view_in_shade(view);
        const struct prune_light shade = {triangles->scene, &dark, light.effects, light.stretch};
        prune_mean_radiance(kind->probes, kind->probes_count, &shade, mean);
        snprintf(name, sizeof name, "shaded_mean[%d]", 2 * (kind->first_mean + step));
        gl->Uniform3fv(gl_uniform(gl, program, name), 2, mean[0]);
    }
}

static void draw_call(struct workspace *workspace, const struct triangles *triangles,
                      const struct call *call, const struct view *view, bool cull_faces)
{
    struct gl *gl = workspace->gl;
    const struct plant_gl *gpu = &call->kind->gpu;
    GLuint program =
        triangles
            ->programs[call->batch ? triangles_variant(triangles, call->batch) : VARIANT_PRUNED];
    gl->UseProgram(program);
    shade_uniforms(workspace, program, triangles->scene, view);
    shadow_receiver_uniforms(workspace, triangles->request.shadows, program);
    if (!call->batch) {
        gl->Uniform1f(gl_uniform(gl, program, "elements"), (float)call->kind->levels.elements);
        gl->Uniform1f(gl_uniform(gl, program, "taper"), triangles_taper(triangles));
        gl->Uniform1i(gl_uniform(gl, program, "level_contrast"),
                      triangles->request.contrast && !workspace->masked);
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
                                   .within = is_within(triangles, instance, view),
                                   .mean = (int16_t)triangles_mean_of(kind, instance->stretch)};
        struct levels_seen seen = seen_of(triangles, view, focal_px, list, i);
        struct sift_part part = {.choice = choose(triangles, &kind->levels, seen.per_m),
                                 .run = run_of(triangles, at),
                                 .seen = seen,
                                 .taper = triangles_taper(triangles)};
        tree->runs_count =
            sift_plant_runs(kind->sift, &kind->levels, &part, triangles->sift_runs + runs);
        runs += tree->runs_count;
    }
    for (int v = VARIANT_SIFTED; v < VARIANTS; v++) {
        GLuint program = triangles->programs[v];
        gl->UseProgram(program);
        shade_uniforms(workspace, program, triangles->scene, view);
        gl->Uniform1i(gl_uniform(gl, program, "level_contrast"),
                      triangles->request.contrast && !workspace->masked);
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
