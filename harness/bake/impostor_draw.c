/* Impostors: a picture, its passes, the state of blending, test and coverage. */
#include "bake/impostor.h"

#include "bake/tally.h"

#include <string.h>

enum { BUFFERS = 6 };

/* A pixel, of ATLAS_COVERAGE. */
enum { COVERAGE_SAMPLES = 4 };

/* Fans between two flushes, at least; flushes of a draw, at most. */
enum { FLUSH_LEAST = 2500, FLUSHES_MOST = 8 };

static int samples_of(const struct impostor *impostor)
{
    return impostor->alpha == ATLAS_COVERAGE ? COVERAGE_SAMPLES : 1;
}

/* Coverage has samples and volumes a stencil buffer, which a target has not. */
static bool has_twin(const struct impostor *impostor)
{
    return samples_of(impostor) > 1 || sun_shadows_count(impostor->shadows);
}

/* Of a target; a twin of another size or format is replaced. */
static enum status twin(struct workspace *workspace, struct impostor *impostor,
                        const struct target *target)
{
    struct target *twin = &impostor->twin;
    const int samples = samples_of(impostor);
    if (twin->framebuffer && twin->width_px == target->width_px &&
        twin->height_px == target->height_px && twin->format == target->format)
        return STATUS_OK;
    if (twin->framebuffer) {
        gl_delete_texture(workspace->gl, twin->color);
        gl_delete_texture(workspace->gl, twin->depth);
    }
    memset(twin, 0, sizeof *twin);
    return sun_shadows_count(impostor->shadows)
               ? gl_target_stencil(workspace->gl, target, samples, twin, workspace->error)
               : gl_target_multisample(workspace->gl, target, samples, twin, workspace->error);
}

/* What one species' channels give in a picture under a sun in the plant's own axes. */
static struct impostor_sunlight sunlight_of(const struct atlas_species *species,
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
    return (struct impostor_sunlight){{sums[1], sums[2], sums[3], sums[4]}, sums[0], {0}};
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
    struct impostor_sunlight *lights = ARENA_ARRAY(scratch, struct impostor_sunlight, count + 1);
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
    return nearby_draw(workspace, impostor->nearby, view, samples_of(impostor), impostor->cull);
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

/* What a picture's passes draw. */
struct surfaces {
    struct impostor *impostor;
    const struct view *view; /* the picture's */
    impostor_trees_draw *draw;
    const void *state;
};

static void release(struct gl *gl)
{
    gl->BindVertexArray(0);
    gl->UseProgram(0);
    for (GLuint i = 0; i < 3; i++)
        gl->BindTextureUnit(i, 0);
    for (GLuint i = 0; i < BUFFERS; i++)
        gl->BindBufferBase(GL_SHADER_STORAGE_BUFFER, i, 0);
}

static enum status draw_surfaces(struct workspace *workspace, void *state, const struct view *view)
{
    struct gl *gl = workspace->gl;
    const struct surfaces *surfaces = state;
    struct impostor *impostor = surfaces->impostor;
    backdrop_draw(workspace, impostor->backdrop, view);
    gl->Flush(); /* a software GL fills the backdrop while the trees are culled and sorted */
    relight(impostor, gl, view->sun_direction);
    bool blend = impostor->alpha == ATLAS_BLEND;
    enum cull_order order = blend ? CULL_BACK_TO_FRONT : CULL_FRONT_TO_BACK;
    struct cull_list list = cull_view(impostor->cull, surfaces->view, order);
    nearby_take(impostor->nearby, view, order, &list);
    if (list.count > 0)
        gl->NamedBufferSubData(impostor->order_buffer, 0,
                               (GLsizeiptr)(list.count * sizeof *list.instances), list.instances);
    enum status status = blend ? STATUS_OK : draw_near(workspace, impostor, view);
    if (status != STATUS_OK)
        return status;
    tally_texels_begin(workspace);
    if (blend) {
        gl->Enable(GL_BLEND);
        gl->BlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
        gl->DepthMask(GL_FALSE);
    }
    surfaces->draw(workspace, surfaces->state, view, &list);
    tally_texels_end(workspace, impostor->texels, impostor->nearest);
    gl->Disable(GL_BLEND);
    gl->DepthMask(GL_TRUE);
    if (blend)
        status = draw_near(workspace, impostor, view);
    release(gl);
    return status;
}

enum status impostor_picture(struct workspace *workspace, struct impostor *impostor,
                             const struct view *view, struct target *target,
                             impostor_trees_draw *draw, const void *state, const char *where)
{
    struct gl *gl = workspace->gl;
    struct surfaces surfaces = {impostor, view, draw, state};
    enum status status = sun_shadows_update(workspace, impostor->shadows, view, NULL);
    if (status == STATUS_OK && has_twin(impostor))
        status = twin(workspace, impostor, target);
    if (status != STATUS_OK)
        return status;
    gl->BindFramebuffer(GL_FRAMEBUFFER,
                        has_twin(impostor) ? impostor->twin.framebuffer : target->framebuffer);
    status = sun_shadows_draw(workspace, impostor->shadows, view, view, draw_surfaces, &surfaces);
    if (has_twin(impostor))
        gl_target_resolve(gl, &impostor->twin, target);
    return status == STATUS_OK ? gl_check(gl, where, workspace->error) : status;
}
