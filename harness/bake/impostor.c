/* Impostors: trees and order on the GL, programs, the state of blending, test and coverage. */
#include "bake/impostor.h"

#include "bake/impostor_tall.h"
#include "bake/tally.h"

#include "impostor.glsl.h"

#include <string.h>

/* As impostor.glsl reads it. */
struct tree {
    float position_m[3], scale;
    float cos, sin, species, sun_step;
};

struct sunlight {
    float factors[4], rest, unused[3];
};

/* Most trees that are drawn with the polygon of ATLAS_HULL corners at a time. */
enum { HULLS_MOST = 65536, BUFFERS = 6 };

/* A pixel, of ATLAS_COVERAGE. */
enum { COVERAGE_SAMPLES = 4 };

/* Fans between two flushes, at least; flushes of a draw, at most. */
enum { FLUSH_LEAST = 2500, FLUSHES_MOST = 8 };

/* The nearest of the rotations that light is computed for. */
static float sun_step(float rotation_rad)
{
    double turns = rotation_rad / (2 * M_PI), share = turns - floor(turns);
    return (float)(lround(share * IMPOSTOR_SUN_STEPS) % IMPOSTOR_SUN_STEPS);
}

GLuint impostor_trees(struct gl *gl, const struct scene *scene)
{
    struct arena *scratch = arena_create(0);
    struct tree *trees = ARENA_ARRAY(scratch, struct tree, scene->instances_count + 1);
    for (size_t i = 0; i < scene->instances_count; i++) {
        const struct instance *instance = &scene->instances[i];
        trees[i] = (struct tree){.position_m = {instance->position_m[0], instance->position_m[1],
                                                instance->position_m[2]},
                                 .scale = instance->scale,
                                 .cos = cosf(instance->rotation_rad),
                                 .sin = sinf(instance->rotation_rad),
                                 .species = (float)instance->species,
                                 .sun_step = sun_step(instance->rotation_rad)};
    }
    GLuint buffer =
        gl_buffer(gl, (GLsizeiptr)((scene->instances_count + 1) * sizeof *trees), trees, 0);
    arena_destroy(scratch);
    return buffer;
}

GLuint impostor_stretches(struct gl *gl, const struct scene *scene)
{
    struct arena *scratch = arena_create(0);
    float *stretches = ARENA_ARRAY(scratch, float, scene->instances_count + 1);
    for (size_t i = 0; i < scene->instances_count; i++)
        stretches[i] = scene->instances[i].stretch;
    GLuint buffer =
        gl_buffer(gl, (GLsizeiptr)((scene->instances_count + 1) * sizeof *stretches), stretches, 0);
    arena_destroy(scratch);
    return buffer;
}

/* Triangles of fans: first the quads, then the hulls. Both number their corners from 0. */
static GLuint upload_indices(struct gl *gl, size_t quads, size_t hulls)
{
    enum { HULL_INDICES = 3 * (ATLAS_HULL - 2) };
    struct arena *scratch = arena_create(0);
    size_t count = 6 * quads + HULL_INDICES * hulls;
    uint32_t *indices = ARENA_ARRAY(scratch, uint32_t, count + 1), *at = indices;
    for (size_t i = 0; i < quads + hulls; i++) {
        uint32_t corners = i < quads ? 4 : ATLAS_HULL;
        uint32_t first = corners * (uint32_t)(i < quads ? i : i - quads);
        for (uint32_t k = 1; k + 1 < corners; k++) {
            *at++ = first;
            *at++ = first + k;
            *at++ = first + k + 1;
        }
    }
    GLuint buffer = gl_buffer(gl, (GLsizeiptr)((count + 1) * sizeof *indices), indices, 0);
    arena_destroy(scratch);
    return buffer;
}

/* Mean silhouette of the trees over all pictures, in the world's size. */
static float mean_area(const struct scene *scene, const struct atlas *atlas)
{
    double sum = 0;
    for (size_t i = 0; i < scene->instances_count; i++) {
        const struct instance *instance = &scene->instances[i];
        const struct atlas_species *species = &atlas->species[instance->species];
        const struct atlas_view *view = &atlas->views[(size_t)species->first_view];
        sum += (double)instance->scale * instance->scale * (view->high[0] - view->low[0]) *
               (view->high[1] - view->low[1]);
    }
    return scene->instances_count ? (float)(sum / (double)scene->instances_count) : 0;
}

enum status impostor_prepare(struct workspace *workspace, const struct scene *scene,
                             const struct impostor_request *request, struct impostor **result)
{
    struct gl *gl = workspace->gl;
    struct impostor *impostor = *result = ARENA_NEW(workspace->arena, struct impostor);
    impostor->scene = scene;
    impostor->alpha = request->atlas.alpha;
    impostor->nearest = request->atlas.nearest;
    impostor->deep = request->atlas.depth;
    enum status status = backdrop_prepare(workspace, scene, &impostor->backdrop);
    if (status == STATUS_OK)
        status = shadow_choice_prepare(workspace, scene, &request->sun, true, impostor->backdrop,
                                       &impostor->shadows);
    struct atlas_request atlas = request->atlas;
    atlas.depth |= impostor->shadows != NULL;
    impostor->texels = (uint64_t)(request->mixed ? request->mixed : 1) * (atlas.depth ? 3 : 2) +
                       sun_shadows_samples(impostor->shadows);
    if (status == STATUS_OK)
        status = impostor_tall(workspace, scene, &impostor->tall);
    const struct scene *tall = impostor->tall;
    if (status == STATUS_OK)
        status = atlas_build(workspace, tall, &atlas, &impostor->atlas);
    if (status == STATUS_OK)
        status = nearby_prepare(workspace, scene, request->near_radii, 0,
                                sun_shadows_map(impostor->shadows), &impostor->nearby);
    if (status != STATUS_OK)
        return status;
    struct cull_bound *bounds =
        ARENA_ARRAY(workspace->arena, struct cull_bound, tall->species_count + 1);
    for (size_t i = 0; i < tall->species_count; i++) {
        bounds[i].center_y_m = impostor->atlas->species[i].center_y_m;
        bounds[i].radius_m = impostor->atlas->species[i].radius_m;
    }
    size_t count = scene->instances_count;
    impostor->cull = cull_create(workspace->arena, tall, bounds);
    impostor->area_m2 = mean_area(tall, impostor->atlas);
    impostor->fans_quad = count * request->quads_each;
    impostor->fans_hull = impostor->fans_quad < HULLS_MOST ? impostor->fans_quad : HULLS_MOST;
    impostor->instances_buffer = impostor_trees(gl, tall);
    if (tall != scene)
        impostor->stretches_buffer = impostor_stretches(gl, tall);
    impostor->order_buffer =
        gl_buffer(gl, (GLsizeiptr)((count + 1) * sizeof(uint32_t)), NULL, GL_DYNAMIC_STORAGE_BIT);
    size_t lights = (size_t)impostor->atlas->layers * IMPOSTOR_SUN_STEPS;
    impostor->sunlights_buffer = gl_buffer(gl, (GLsizeiptr)((lights + 1) * sizeof(struct sunlight)),
                                           NULL, GL_DYNAMIC_STORAGE_BIT);
    impostor->vertices = gl_vertex_array(gl);
    gl->VertexArrayElementBuffer(impostor->vertices,
                                 upload_indices(gl, impostor->fans_quad, impostor->fans_hull));
    return gl_check(gl, "impostors", workspace->error);
}

/* The three parts of a source: before the stages, the vertex and the fragment stage; "" where
 * absent. */
static void split_stages(struct arena *arena, const char *source, const char *parts[3])
{
    static const char *const marks[2] = {"#pragma stage vertex", "#pragma stage fragment"};
    const char *vertex = strstr(source, marks[0]), *fragment = strstr(source, marks[1]);
    const char *end = source + strlen(source);
    fragment = fragment ? fragment : end;
    vertex = vertex ? vertex : fragment;
    parts[0] = arena_printf(arena, "%.*s", (int)(vertex - source), source);
    size_t skip = vertex < fragment ? strlen(marks[0]) : 0;
    parts[1] =
        arena_printf(arena, "%.*s", (int)(fragment - vertex - (ptrdiff_t)skip), vertex + skip);
    parts[2] = fragment < end ? fragment + strlen(marks[1]) : "";
}

const char *impostor_source(struct arena *arena, const char *source)
{
    const char *shared[3], *own[3];
    split_stages(arena, impostor_glsl, shared);
    split_stages(arena, source, own);
    return arena_printf(arena, "%s%s\n#pragma stage vertex\n%s%s\n#pragma stage fragment\n%s%s",
                        shared[0], own[0], shared[1], own[1], shared[2], own[2]);
}

enum status impostor_program(struct workspace *workspace, const struct impostor *impostor,
                             const char *name, const char *source, const char *defines,
                             GLuint *program)
{
    struct arena *scratch = arena_create(0);
    const struct shadow_map *shadows = sun_shadows_map(impostor->shadows);
    const char *text = impostor_source(scratch, source);
    static const char *const modes[] = {"", "STRAIGHT 1\nALPHA_TEST 1\n",
                                        "STRAIGHT 1\nALPHA_COVERAGE 1\n"};
    const char *all = arena_printf(
        scratch, "SUN_STEPS %d\nNEAREST %d\n%s%s%s%s%s%s", IMPOSTOR_SUN_STEPS, impostor->nearest,
        impostor->stretches_buffer ? "STRETCHED 1\n" : "", defines ? defines : "",
        modes[impostor->alpha], impostor->deep ? "DEPTH 1\n" : "",
        impostor->atlas->depth ? "PICTURE_DEPTH 1\n" : "",
        workspace->effects & EFFECT_FOG ? "FOG 1\n" : "");
    enum status status = shadow_receiver_program(workspace, shadows, name, text, all, program);
    arena_destroy(scratch);
    return status;
}

/* The multisampled twin of a target; a twin of another size or format is replaced. */
static enum status twin(struct workspace *workspace, struct impostor *impostor,
                        const struct target *target)
{
    struct target *twin = &impostor->multisampled;
    if (twin->framebuffer && twin->width_px == target->width_px &&
        twin->height_px == target->height_px && twin->format == target->format)
        return STATUS_OK;
    if (twin->framebuffer) {
        gl_delete_texture(workspace->gl, twin->color);
        gl_delete_texture(workspace->gl, twin->depth);
    }
    memset(twin, 0, sizeof *twin);
    return gl_target_multisample(workspace->gl, target, COVERAGE_SAMPLES, twin, workspace->error);
}

/* What one species' channels give in a picture under a sun in the plant's own axes. */
static struct sunlight sunlight_of(const struct atlas_species *species,
                                   const struct atlas_view *view, const float sun[3])
{
    const float *axes[3] = {view->right, view->up, view->toward};
    float s[3], sums[1 + LIGHT_CHANNELS] = {0};
    for (int i = 0; i < 3; i++)
        s[i] = axes[i][0] * sun[0] + axes[i][1] * sun[1] + axes[i][2] * sun[2];
    const float q[LIGHT_TERMS] = {1,           s[0] * s[0], s[1] * s[1], s[2] * s[2], s[0] * s[1],
                                  s[0] * s[2], s[1] * s[2], s[0],        s[1],        s[2]};
    for (int k = 0; k <= LIGHT_CHANNELS; k++)
        for (int i = 0; i < LIGHT_TERMS; i++)
            sums[k] += species->light[k][i] * q[i];
    return (struct sunlight){{sums[1], sums[2], sums[3], sums[4]}, sums[0], {0}};
}

/* Light for all pictures and rotations, when the sun has moved. */
static void relight(struct impostor *impostor, struct gl *gl, const float sun[3])
{
    const struct atlas *atlas = impostor->atlas;
    if (!memcmp(sun, impostor->sun_direction, sizeof impostor->sun_direction))
        return;
    memcpy(impostor->sun_direction, sun, sizeof impostor->sun_direction);
    struct arena *scratch = arena_create(0);
    size_t count = (size_t)atlas->layers * IMPOSTOR_SUN_STEPS;
    struct sunlight *lights = ARENA_ARRAY(scratch, struct sunlight, count + 1);
    for (size_t i = 0; i < atlas->species_count; i++)
        for (int step = 0; atlas->species[i].first_view >= 0 && step < IMPOSTOR_SUN_STEPS; step++) {
            double angle = 2 * M_PI * step / IMPOSTOR_SUN_STEPS;
            float c = (float)cos(angle), s = (float)sin(angle);
            const float own[3] = {sun[0] * c - sun[2] * s, sun[1], sun[0] * s + sun[2] * c};
            for (size_t k = 0; k < atlas->views_count; k++) {
                size_t layer = (size_t)atlas->species[i].first_view + k;
                lights[layer * IMPOSTOR_SUN_STEPS + (size_t)step] =
                    sunlight_of(&atlas->species[i], &atlas->views[layer], own);
            }
        }
    gl->NamedBufferSubData(impostor->sunlights_buffer, 0, (GLsizeiptr)(count * sizeof *lights),
                           lights);
    arena_destroy(scratch);
}

static enum status draw_near(struct workspace *workspace, const struct impostor *impostor,
                             const struct view *view)
{
    int samples = impostor->alpha == ATLAS_COVERAGE ? COVERAGE_SAMPLES : 1;
    return nearby_draw(workspace, impostor->nearby, view, samples, impostor->cull);
}

enum status impostor_begin(struct workspace *workspace, struct impostor *impostor,
                           const struct view *view, struct target *target, struct cull_list *list)
{
    struct gl *gl = workspace->gl;
    GLuint framebuffer = target->framebuffer;
    enum status status = sun_shadows_update(workspace, impostor->shadows, view, NULL);
    if (status == STATUS_OK && impostor->alpha == ATLAS_COVERAGE)
        status = twin(workspace, impostor, target);
    if (status != STATUS_OK)
        return status;
    if (impostor->alpha == ATLAS_COVERAGE)
        framebuffer = impostor->multisampled.framebuffer;
    gl->BindFramebuffer(GL_FRAMEBUFFER, framebuffer);
    backdrop_draw(workspace, impostor->backdrop, view);
    gl->Flush(); /* a software GL fills the backdrop while the trees are culled and sorted */
    relight(impostor, gl, view->sun_direction);
    bool blend = impostor->alpha == ATLAS_BLEND;
    enum cull_order order = blend ? CULL_BACK_TO_FRONT : CULL_FRONT_TO_BACK;
    *list = cull_view(impostor->cull, view, order);
    nearby_take(impostor->nearby, view, order, list);
    if (list->count > 0)
        gl->NamedBufferSubData(impostor->order_buffer, 0,
                               (GLsizeiptr)(list->count * sizeof *list->instances),
                               list->instances);
    status = blend ? STATUS_OK : draw_near(workspace, impostor, view);
    tally_texels_begin(workspace);
    if (!blend)
        return status;
    gl->Enable(GL_BLEND);
    gl->BlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
    gl->DepthMask(GL_FALSE);
    return STATUS_OK;
}

void impostor_use(struct workspace *workspace, const struct impostor *impostor, GLuint program,
                  const struct view *view, size_t first)
{
    struct gl *gl = workspace->gl;
    const struct atlas *atlas = impostor->atlas;
    const GLuint buffers[BUFFERS] = {impostor->instances_buffer, impostor->order_buffer,
                                     atlas->views_buffer,        atlas->species_buffer,
                                     impostor->sunlights_buffer, impostor->stretches_buffer};
    gl->UseProgram(program);
    gl->BindVertexArray(impostor->vertices);
    for (GLuint i = 0; i < BUFFERS; i++)
        gl->BindBufferBase(GL_SHADER_STORAGE_BUFFER, i, buffers[i]);
    gl->BindTextureUnit(0, atlas->albedo);
    gl->BindTextureUnit(1, atlas->light);
    gl->BindTextureUnit(2, atlas->depth);
    shade_uniforms(workspace, program, impostor->scene, view);
    shadow_receiver_uniforms(workspace, sun_shadows_map(impostor->shadows), program);
    gl->Uniform1i(gl_uniform(gl, program, "first_tree"), (GLint)first);
    gl->Uniform2f(gl_uniform(gl, program, "layer_px"), (float)atlas->width_px,
                  (float)atlas->height_px);
    gl->Uniform1f(gl_uniform(gl, program, "pixel_m"), 1 / cull_focal_px(view));
    gl->Uniform1i(gl_uniform(gl, program, "last_level"), atlas->levels - 1);
    gl->Uniform2f(gl_uniform(gl, program, "depth_terms"), -view->projection[2][2],
                  view->projection[3][2]);
}

void impostor_draw(struct workspace *workspace, const struct impostor *impostor, int corners,
                   size_t fans)
{
    size_t offset = corners == 4 ? 0 : 6 * impostor->fans_quad, each = 3 * (size_t)(corners - 2);
    size_t most = fans / FLUSHES_MOST < FLUSH_LEAST ? FLUSH_LEAST : fans / FLUSHES_MOST;
    for (size_t first = 0; first < fans; first += most) {
        size_t count = fans - first < most ? fans - first : most;
        if (corners == 3)
            gl_draw_arrays(workspace->gl, GL_TRIANGLES, (GLint)(3 * first), (GLsizei)(3 * count),
                           1);
        else
            gl_draw_elements(workspace->gl, GL_TRIANGLES, (GLsizei)(each * count), GL_UNSIGNED_INT,
                             (offset + each * first) * sizeof(uint32_t), 1, 0, 0);
        if (first + count < fans)
            workspace->gl->Flush();
    }
}

size_t impostor_near_count(const struct impostor *impostor, const struct view *view,
                           const struct cull_list *list, float area_px, size_t hulls_each)
{
    float focal = cull_focal_px(view), depth_m = focal * sqrtf(impostor->area_m2 / area_px);
    bool far_first = impostor->alpha == ATLAS_BLEND;
    size_t low = 0, high = list->count; /* how many at the near end are nearer than depth_m */
    while (low < high) {
        size_t middle = (low + high) / 2;
        float depth = list->depths_m[far_first ? list->count - 1 - middle : middle];
        if (depth < depth_m)
            low = middle + 1;
        else
            high = middle;
    }
    size_t most = impostor->fans_hull / hulls_each;
    return low < most ? low : most;
}

enum status impostor_end(struct workspace *workspace, const struct impostor *impostor,
                         const struct view *view, struct target *target, const char *where)
{
    struct gl *gl = workspace->gl;
    enum status status = STATUS_OK;
    tally_texels_end(workspace, impostor->texels, impostor->nearest);
    gl->Disable(GL_BLEND);
    gl->DepthMask(GL_TRUE);
    if (impostor->alpha == ATLAS_BLEND)
        status = draw_near(workspace, impostor, view);
    gl->BindVertexArray(0);
    gl->UseProgram(0);
    for (GLuint i = 0; i < 3; i++)
        gl->BindTextureUnit(i, 0);
    for (GLuint i = 0; i < BUFFERS; i++)
        gl->BindBufferBase(GL_SHADER_STORAGE_BUFFER, i, 0);
    if (impostor->alpha == ATLAS_COVERAGE)
        gl_target_resolve(gl, &impostor->multisampled, target);
    return status == STATUS_OK ? gl_check(gl, where, workspace->error) : status;
}
