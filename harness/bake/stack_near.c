/* A tree that turns into its triangles: two pictures, their mix over the target. */
#include "bake/stack_near.h"

#include "stack_near.glsl.h"

enum { BY_SLICES, BY_TRIANGLES, PICTURES };

struct stack_near {
    GLuint program, vertices;
    GLuint framebuffers[PICTURES], colors[PICTURES];
    GLuint depth;            /* of the triangles' picture */
    int width_px, height_px; /* of the pictures */
};

enum status stack_near_prepare(struct workspace *workspace, struct stack_near **result)
{
    struct gl *gl = workspace->gl;
    struct stack_near *near = *result = ARENA_NEW(workspace->arena, struct stack_near);
    near->vertices = gl_vertex_array(gl);
    for (int k = 0; k < PICTURES; k++)
        near->framebuffers[k] = gl_framebuffer(gl);
    return gl_program(gl, "stack_near", stack_near_glsl, NULL, &near->program, workspace->error);
}

/* Textures of the target's size, made for the first tree that needs them. */
static void fit(struct gl *gl, struct stack_near *near, const struct target *target)
{
    if (near->width_px == target->width_px && near->height_px == target->height_px)
        return;
    GLenum format = target->format == TARGET_RGBA32F ? GL_RGBA32F : GL_RGBA16F;
    near->width_px = target->width_px;
    near->height_px = target->height_px;
    for (int k = 0; k < PICTURES; k++) {
        if (near->colors[k])
            gl_delete_texture(gl, near->colors[k]);
        near->colors[k] =
            gl_texture(gl, GL_TEXTURE_2D, 1, format, near->width_px, near->height_px, 1);
        gl->NamedFramebufferTexture(near->framebuffers[k], GL_COLOR_ATTACHMENT0, near->colors[k],
                                    0);
    }
    if (near->depth)
        gl_delete_texture(gl, near->depth);
    near->depth =
        gl_texture(gl, GL_TEXTURE_2D, 1, GL_DEPTH_COMPONENT32F, near->width_px, near->height_px, 1);
    gl->NamedFramebufferTexture(near->framebuffers[BY_TRIANGLES], GL_DEPTH_ATTACHMENT, near->depth,
                                0);
}

static void bind_empty(struct gl *gl, GLuint framebuffer)
{
    static const float empty[4] = {0, 0, 0, 0};
    gl->BindFramebuffer(GL_FRAMEBUFFER, framebuffer);
    gl->ClearBufferfv(GL_COLOR, 0, empty);
}

void stack_near_slices(struct workspace *workspace, struct stack_near *near,
                       const struct target *target)
{
    struct gl *gl = workspace->gl;
    fit(gl, near, target);
    gl->NamedFramebufferTexture(near->framebuffers[BY_SLICES], GL_DEPTH_ATTACHMENT, target->depth,
                                0);
    bind_empty(gl, near->framebuffers[BY_SLICES]);
}

void stack_near_triangles(struct workspace *workspace, const struct stack_near *near,
                          const struct target *target)
{
    struct gl *gl = workspace->gl;
    gl->BlitNamedFramebuffer(target->framebuffer, near->framebuffers[BY_TRIANGLES], 0, 0,
                             near->width_px, near->height_px, 0, 0, near->width_px, near->height_px,
                             GL_DEPTH_BUFFER_BIT, GL_NEAREST);
    bind_empty(gl, near->framebuffers[BY_TRIANGLES]);
}

void stack_near_end(struct workspace *workspace, const struct stack_near *near,
                    const struct target *target, float share)
{
    struct gl *gl = workspace->gl;
    gl->BindFramebuffer(GL_FRAMEBUFFER, target->framebuffer);
    gl->Disable(GL_DEPTH_TEST);
    gl->Enable(GL_BLEND);
    gl->BlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
    gl->UseProgram(near->program);
    gl->BindVertexArray(near->vertices);
    gl->Uniform1f(gl_uniform(gl, near->program, "share"), share);
    for (GLuint k = 0; k < PICTURES; k++)
        gl->BindTextureUnit(k, near->colors[k]);
    gl_draw_arrays(gl, GL_TRIANGLES, 0, 3, 1);
    for (GLuint k = 0; k < PICTURES; k++)
        gl->BindTextureUnit(k, 0);
    gl->Disable(GL_BLEND);
    gl->Enable(GL_DEPTH_TEST);
}
