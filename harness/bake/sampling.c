/* Multisampled twins of the target, and 16 samples where the driver stops at fewer. */
#include "bake/sampling.h"

#include "sampling.glsl.h"

struct sampling {
    int samples_texel; /* samples in each texel of the twin */
    int side;          /* texels of the twin along a pixel's side */
    bool stencil;
    GLuint program, no_vertices;
    struct target twin;
    struct sampling_places places;
};

struct sampling_places sampling_places_bound(struct gl *gl, int samples)
{
    struct sampling_places places = {.count = samples, .at = {{0.5f, 0.5f}}};
    for (int i = 0; i < samples && samples > 1; i++)
        gl->GetMultisamplefv(GL_SAMPLE_POSITION, (GLuint)i, places.at[i]);
    return places;
}

enum status sampling_prepare(struct workspace *workspace, int samples, struct sampling **sampling)
{
    struct gl *gl = workspace->gl;
    struct sampling *made = *sampling = ARENA_NEW(workspace->arena, struct sampling);
    made->side = samples > gl->samples_max ? 2 : 1;
    made->samples_texel = samples / (made->side * made->side);
    made->places = (struct sampling_places){.count = made->samples_texel, .at = {{0.5f, 0.5f}}};
    if (made->side == 1)
        return STATUS_OK;
    made->no_vertices = gl_vertex_array(gl);
    return gl_program(gl, "sampling", sampling_glsl, NULL, &made->program, workspace->error);
}

void sampling_stencil(struct sampling *sampling)
{
    sampling->stencil = true;
}

static bool has_twin(const struct sampling *sampling)
{
    return sampling->samples_texel > 1 || sampling->stencil;
}

struct view sampling_view(const struct sampling *sampling, const struct view *view)
{
    struct view drawn = *view;
    if (has_twin(sampling)) {
        drawn.width_px *= sampling->side;
        drawn.height_px *= sampling->side;
    }
    return drawn;
}

enum status sampling_begin(struct workspace *workspace, struct sampling *sampling,
                           const struct target *target, const struct view *view, struct view *drawn)
{
    struct gl *gl = workspace->gl;
    struct target *twin = &sampling->twin, enlarged = *target;
    enum status status = STATUS_OK;
    *drawn = sampling_view(sampling, view);
    if (!has_twin(sampling)) {
        gl->BindFramebuffer(GL_FRAMEBUFFER, target->framebuffer);
        return STATUS_OK;
    }
    enlarged.width_px = drawn->width_px = sampling->side * target->width_px;
    enlarged.height_px = drawn->height_px = sampling->side * target->height_px;
    if (twin->width_px != enlarged.width_px || twin->height_px != enlarged.height_px ||
        twin->format != target->format) {
        gl_delete_texture(gl, twin->color);
        gl_delete_texture(gl, twin->depth);
        status = sampling->stencil ? gl_target_stencil(gl, &enlarged, sampling->samples_texel, twin,
                                                       workspace->error)
                                   : gl_target_multisample(gl, &enlarged, sampling->samples_texel,
                                                           twin, workspace->error);
    }
    gl->BindFramebuffer(GL_FRAMEBUFFER, twin->framebuffer);
    if (status == STATUS_OK)
        sampling->places = sampling_places_bound(gl, sampling->samples_texel);
    return status;
}

const struct sampling_places *sampling_places(const struct sampling *sampling)
{
    return &sampling->places;
}

void sampling_end(struct workspace *workspace, const struct sampling *sampling,
                  const struct target *target)
{
    struct gl *gl = workspace->gl;
    if (!has_twin(sampling))
        return;
    if (sampling->side == 1) {
        gl_target_resolve(gl, &sampling->twin, target);
        return;
    }
    gl->BindFramebuffer(GL_FRAMEBUFFER, target->framebuffer);
    gl->Viewport(0, 0, target->width_px, target->height_px);
    gl->UseProgram(sampling->program);
    gl->BindVertexArray(sampling->no_vertices);
    gl->BindTextureUnit(0, sampling->twin.color);
    gl->Disable(GL_DEPTH_TEST);
    gl_draw_arrays(gl, GL_TRIANGLES, 0, 3, 1);
    gl->Enable(GL_DEPTH_TEST);
}
